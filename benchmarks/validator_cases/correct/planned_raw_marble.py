"""A marble on a ramp, the ramp authored as raw USD; every object is one of the plan's."""
from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics

from wsim.scene import Scene

WORLD = Sdf.Path("/World")


def build(scene: Scene) -> None:
    scene.ground()
    ramp = UsdGeom.Cube.Define(scene.stage, WORLD.AppendChild("ramp"))
    ramp.CreateSizeAttr(1.0)
    ramp.AddTranslateOp().Set(Gf.Vec3d(0.0, 0.0, 0.4))
    ramp.AddRotateYOp().Set(20.0)
    ramp.AddScaleOp().Set(Gf.Vec3f(1.6, 0.4, 0.04))
    ramp.CreateExtentAttr(UsdGeom.Boundable.ComputeExtentFromPlugins(ramp, Usd.TimeCode.Default()))
    UsdPhysics.CollisionAPI.Apply(ramp.GetPrim())

    catalogue = {"marble": dict(radius=0.05, position=(-0.6, 0, 0.75), density=2500)}
    for name, options in catalogue.items():
        scene.sphere(name, **options)
    end_stop = "stop"
    scene.box(end_stop, size=(0.05, 0.6, 0.2), position=(1.6, 0, 0.1), static=True)
    scene.camera("side", eye=(0.4, -3, 1), target=(0.4, 0, 0.3))
