"""Static shelves in a hierarchy of Xforms, placed by transform ops of every kind."""
from pxr import Gf, Usd, UsdGeom, UsdPhysics
from wsim.scene import Scene


def collider(gprim: UsdGeom.Gprim) -> UsdGeom.Gprim:
    UsdPhysics.CollisionAPI.Apply(gprim.GetPrim())
    boundable = UsdGeom.Boundable(gprim)
    boundable.CreateExtentAttr(UsdGeom.Boundable.ComputeExtentFromPlugins(boundable, Usd.TimeCode.Default()))
    return gprim


def build(scene: Scene) -> None:
    stage = scene.stage
    scene.ground()
    rack = UsdGeom.Xform.Define(stage, "/World/rack")
    matrix = Gf.Matrix4d(1.0)
    matrix.SetRotate(Gf.Rotation(Gf.Vec3d(0, 0, 1), 30.0))
    matrix.SetTranslateOnly(Gf.Vec3d(0.5, 0.2, 0.0))
    rack.AddTransformOp().Set(matrix)

    for level, z in enumerate((0.3, 0.7, 1.1)):
        shelf = UsdGeom.Cube.Define(stage, rack.GetPath().AppendChild(f"shelf_{level}"))
        shelf.GetSizeAttr().Set(1.0)
        shelf.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(0, 0, z))
        shelf.AddScaleOp().Set(Gf.Vec3f(0.8, 0.3, 0.03))
        collider(shelf)
    pole = UsdGeom.Cylinder.Define(stage, "/World/rack/pole")
    pole.CreateRadiusAttr(0.02)
    pole.CreateHeightAttr(1.2)
    pole.CreateAxisAttr(UsdGeom.Tokens.z)
    UsdGeom.XformCommonAPI(pole.GetPrim()).SetTranslate(Gf.Vec3d(-0.38, 0, 0.6))
    collider(pole)

    cache = UsdGeom.XformCache(Usd.TimeCode.Default())
    for level in range(3):
        prim = stage.GetPrimAtPath(f"/World/rack/shelf_{level}")
        center = cache.GetLocalToWorldTransform(prim).ExtractTranslation()
        scene.sphere(f"ball_{level}", radius=0.05, position=(center[0], center[1], center[2] + 0.3), density=400)
    bounds = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [UsdGeom.Tokens.default_]).ComputeWorldBound(rack.GetPrim())
    size = bounds.ComputeAlignedRange().GetSize()
    scene.camera("corner", eye=(2.5, -2.5, 1.5), target=(0.5, 0.2, size[2] / 2))
