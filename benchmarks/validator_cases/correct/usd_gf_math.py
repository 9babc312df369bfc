"""Boards fanned around an axis, posed with Gf quaternions; Euler angles read back for the helpers."""
from pxr import Gf
from wsim.scene import Scene

AXIS = Gf.Vec3d(0.0, 0.0, 1.0)


def euler_xyz(rotation: Gf.Rotation):
    """Roll, pitch, yaw about fixed axes [deg]."""
    yaw, pitch, roll = rotation.Decompose(Gf.Vec3d.ZAxis(), Gf.Vec3d.YAxis(), Gf.Vec3d.XAxis())
    return roll, pitch, yaw


def build(scene: Scene) -> None:
    scene.ground()
    arm = Gf.Vec3d(0.6, 0.0, 0.0)
    for k in range(8):
        turn = Gf.Rotation(AXIS, 45.0 * k)
        q = turn.GetQuat().GetNormalized()
        p = turn.TransformDir(arm) + Gf.Vec3d(0, 0, 0.25)
        assert abs(q.GetReal()) <= 1.0 and q.GetImaginary().GetLength() <= 1.0
        scene.box(f"board_{k}", size=(0.04, 0.2, 0.5), position=tuple(p), rotation_deg=euler_xyz(turn), density=600)
    slerped = Gf.Slerp(0.5, Gf.Quatd(1.0), Gf.Rotation(AXIS, 90).GetQuat())
    mid = Gf.Rotation(slerped).GetAngle()
    dot = Gf.Dot(Gf.Vec3d(1, 0, 0), Gf.Vec3d(*arm).GetNormalized())
    eye = Gf.Cross(Gf.Vec3d(2, 0, 0), AXIS) + Gf.Vec3d(0, 0, 1.5)
    print(f"{mid:.1f} deg, {dot:.2f}, {Gf.RadiansToDegrees(1.0):.2f}, {Gf.IsClose(mid, 45.0, 1e-6)}")
    scene.camera("cam", eye=(eye[0], eye[1], eye[2]), target=(0, 0, 0.2))
