from pxr import Gf, UsdGeom


def build(scene):
    scene.box("block", size=(1.0, 1.0, 1.0), position=(0.0, 0.0, 1.0))
    block = UsdGeom.Xformable(scene.stage.GetPrimAtPath("/World/block"))
    block.GetOrderedXformOps()[0].Set(Gf.Vec3d(0.0, 0.0, float("nan")))
