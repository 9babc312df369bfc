"""A door on a raw revolute joint with limits, a drive and joint friction-like damping."""
import math
from pxr import Gf, UsdPhysics
from wsim.scene import Scene

DOOR = (0.9, 0.04, 2.0)


def build(scene: Scene) -> None:
    scene.simulation(duration=4.0)
    scene.ground()
    door = scene.box("door", size=DOOR, position=(DOOR[0] / 2, 0, DOOR[2] / 2 + 0.01), density=500)

    hinge = UsdPhysics.RevoluteJoint.Define(scene.stage, "/World/hinge")
    hinge.CreateAxisAttr(UsdPhysics.Tokens.z)
    hinge.CreateBody1Rel().SetTargets([door.path])
    hinge.CreateLocalPos0Attr(Gf.Vec3f(0, 0, DOOR[2] / 2 + 0.01))
    hinge.CreateLocalRot0Attr(Gf.Quatf(1))
    hinge.CreateLocalPos1Attr(Gf.Vec3f(-DOOR[0] / 2, 0, 0))
    hinge.CreateLocalRot1Attr(Gf.Quatf(1))
    hinge.CreateLowerLimitAttr(-100.0)
    hinge.CreateUpperLimitAttr(100.0)

    drive = UsdPhysics.DriveAPI.Apply(hinge.GetPrim(), "angular")
    drive.CreateTypeAttr("force")
    drive.CreateTargetPositionAttr(80.0)
    drive.CreateStiffnessAttr(20.0 * math.pi / 180)
    drive.CreateDampingAttr().Set(10.0 * math.pi / 180)
    drive.CreateMaxForceAttr(60.0)
    UsdPhysics.ArticulationRootAPI.Apply(hinge.GetPrim())
    limit = hinge.GetUpperLimitAttr()
    print(limit.GetName(), limit.Get(), limit.GetTypeName())

    scene.camera("front", eye=(0.5, -4.0, 1.5), target=(0.4, 0.0, 1.0))
