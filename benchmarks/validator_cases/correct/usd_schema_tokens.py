"""Attributes authored by their schema names, as one does with a prim in hand."""
from pxr import Sdf, Usd, UsdGeom, UsdPhysics, Gf
from wsim.scene import Scene

Types = Sdf.ValueTypeNames


def build(scene: Scene) -> None:
    scene.ground()
    stage = scene.stage
    prim = stage.DefinePrim("/World/token_ball", "Xform")
    prim.ApplyAPI(UsdPhysics.RigidBodyAPI)
    prim.ApplyAPI("PhysicsMassAPI")
    prim.GetAttribute("physics:mass").Set(2.0)
    prim.GetAttribute("physics:velocity").Set(Gf.Vec3f(0.5, 0, 0))
    prim.CreateAttribute("xformOp:translate", Types.Double3, False).Set(Gf.Vec3d(0, 0, 1.0))
    prim.CreateAttribute("xformOpOrder", Types.TokenArray, False, Sdf.VariabilityUniform).Set(["xformOp:translate"])
    ball = stage.DefinePrim(prim.GetPath().AppendChild("geometry"), "Sphere")
    ball.GetAttribute("radius").Set(0.15)
    ball.GetAttribute("extent").Set([(-0.15,) * 3, (0.15,) * 3])
    ball.ApplyAPI(UsdPhysics.CollisionAPI)
    ball.GetAttribute("physics:collisionEnabled").Set(True)
    ball.GetAttribute("primvars:displayColor").Set([Gf.Vec3f(0.9, 0.1, 0.2)])
    gravity = stage.GetPrimAtPath("/World/PhysicsScene").GetAttribute("physics:gravityMagnitude")
    assert gravity and gravity.Get() > 9, gravity
    assert Usd.SchemaRegistry().FindConcretePrimDefinition("Sphere") is not None
    assert UsdGeom.Xformable(prim).GetOrderedXformOps()
    scene.camera("cam", eye=(0, -2, 1), target=(0, 0, 0.5))
