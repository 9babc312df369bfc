"""Two helper boxes held by a raw fixed joint that breaks at 40 N."""
from pxr import Gf, Sdf, Usd, UsdPhysics
from wsim.scene import Scene


def world_joint(stage: Usd.Stage, path: str, child: str, anchor: Gf.Vec3f) -> UsdPhysics.FixedJoint:
    joint = UsdPhysics.FixedJoint.Define(stage, path)
    joint.CreateBody1Rel().SetTargets([Sdf.Path(child)])
    joint.CreateLocalPos0Attr(anchor)
    joint.CreateLocalRot0Attr(Gf.Quatf(1.0))
    joint.CreateLocalPos1Attr().Set(Gf.Vec3f(0.0))
    joint.CreateLocalRot1Attr().Set(Gf.Quatf(1, 0, 0, 0))
    return joint


def build(scene: Scene) -> None:
    scene.ground()
    hung = scene.box("hung", size=(0.2, 0.2, 0.2), position=(0, 0, 1), mass=3)
    joint = world_joint(scene.stage, "/World/hook", hung.path, Gf.Vec3f(0, 0, 1))
    joint.CreateBreakForceAttr(40.0)
    joint.CreateBreakTorqueAttr().Set(float("inf"))
    joint.GetPrim().SetDocumentation("gives way under 40 N")
    assert joint.GetPath() == Sdf.Path("/World/hook") and joint.GetPrim().IsValid()
    scene.camera("side", eye=(0, -2, 1), target=(0, 0, 0.8))
