"""A rigid body authored with raw UsdPhysics beside the helpers."""
from pxr import Gf, UsdGeom, UsdPhysics

from wsim.scene import Scene


def build(scene: Scene) -> None:
    scene.ground()
    stage = scene.stage

    body = UsdGeom.Xform.Define(stage, "/World/raw_block")
    body.AddTranslateOp().Set(Gf.Vec3d(0.0, 0.0, 1.0))
    body.AddRotateXYZOp().Set(Gf.Vec3f(0.0, 20.0, 0.0))
    UsdPhysics.RigidBodyAPI.Apply(body.GetPrim()).CreateVelocityAttr(Gf.Vec3f(1.0, 0.0, 0.0))
    mass = UsdPhysics.MassAPI.Apply(body.GetPrim())
    mass.CreateMassAttr(2.5)
    mass.CreateCenterOfMassAttr().Set(Gf.Vec3f(0.0, 0.0, -0.02))

    cube = UsdGeom.Cube.Define(stage, body.GetPath().AppendChild("geometry"))
    cube.CreateSizeAttr(0.3)
    cube.CreateExtentAttr([(-0.15, -0.15, -0.15), (0.15, 0.15, 0.15)])
    cube.CreateDisplayColorAttr([(0.2, 0.5, 0.8)])
    UsdPhysics.CollisionAPI.Apply(cube.GetPrim())

    scene.camera("side", eye=(0.0, -3.0, 1.0), target=(0.0, 0.0, 0.5))
