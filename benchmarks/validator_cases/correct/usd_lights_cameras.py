"""A still life lit with raw UsdLux lights and framed with a raw camera."""
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux

from wsim.scene import Scene


def look_at(eye: Gf.Vec3d, target: Gf.Vec3d) -> Gf.Matrix4d:
    return Gf.Matrix4d().SetLookAt(eye, target, Gf.Vec3d.ZAxis()).GetInverse()


def build(scene: Scene) -> None:
    stage: Usd.Stage = scene.stage
    scene.ground()
    for i, kind in enumerate(["bowl", "mug", "plant"]):
        scene.asset(f"{kind}_{i}", kind, position=(0.0, 0.4 * (i - 1), 0.001), static=True)

    sun = UsdLux.DistantLight.Define(stage, "/World/sun")
    sun.CreateIntensityAttr(2500.0)
    sun.CreateAngleAttr(0.53)
    sun.CreateColorAttr(Gf.Vec3f(1.0, 0.96, 0.9))
    UsdGeom.Xformable(sun).AddRotateXYZOp().Set(Gf.Vec3f(-35.0, 20.0, 0.0))

    panel = UsdLux.RectLight.Define(stage, Sdf.Path("/World/panel"))
    panel.CreateWidthAttr(1.0)
    panel.CreateHeightAttr(0.6)
    panel.GetIntensityAttr().Set(800.0)
    panel.CreateExposureAttr(0.5)
    panel.CreateEnableColorTemperatureAttr(True)
    panel.CreateColorTemperatureAttr(4200.0)
    UsdGeom.XformCommonAPI(panel).SetTranslate((0.0, 0.0, 2.0))

    dome = UsdLux.DomeLight.Define(stage, "/World/sky")
    dome.GetPrim().GetAttribute("inputs:intensity").Set(250.0)

    camera = UsdGeom.Camera.Define(stage, "/World/macro")
    camera.CreateFocalLengthAttr(35.0)
    camera.CreateHorizontalApertureAttr(20.955)
    camera.CreateVerticalApertureAttr(11.787)
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.01, 100.0))
    camera.AddTransformOp().Set(look_at(Gf.Vec3d(1.5, 0.0, 0.8), Gf.Vec3d(0.0, 0.0, 0.1)))
    camera.GetPrim().SetDisplayName("Macro lens")
    scene.camera("side", eye=(1.5, -1.0, 0.8), target=(0.0, 0.0, 0.1))
