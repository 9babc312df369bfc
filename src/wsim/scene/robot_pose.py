"""Where the links of a robot are for positions of its joints, and how low they reach."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics

from wsim.scene.robot_drives import is_angular


def one_freedom(prim: Usd.Prim) -> bool:
    """Whether a joint is a hinge or a slider."""
    return is_angular(prim) or bool(prim.IsA(UsdPhysics.PrismaticJoint))


def followed(joint: Usd.Prim) -> tuple[str, float, float] | None:
    """The joint that a joint mimics, the ratio and the offset [rad or m]; None if it follows none."""
    relation = joint.GetRelationship("newton:mimicJoint")
    targets = relation.GetTargets() if relation else []
    if not targets:
        return None
    unit = math.pi / 180.0 if is_angular(joint) else 1.0
    ratio, offset = (joint.GetAttribute(f"newton:mimicCoef{k}").Get() for k in (1, 0))
    return targets[0].name, float(ratio), float(offset) * unit


def place_links(robot: Usd.Prim, joints: list[Usd.Prim], coordinates: Mapping[str, float]) -> None:
    """Move a robot's links, by joints of which each comes after the one that its parent hangs by.

    Args:
        robot: Its root.
        joints: Its joints, parents first.
        coordinates: Of each hinge or slider [rad or m]; others are where they are in the file.
    """
    poses: dict[Sdf.Path, Gf.Matrix4d] = {}
    for joint in joints:
        api = UsdPhysics.Joint(joint)
        above, child = api.GetBody0Rel().GetTargets(), api.GetBody1Rel().GetTargets()[0]
        base = Gf.Matrix4d(1.0)
        if above:
            base = poses.get(above[0]) or _local(robot.GetStage().GetPrimAtPath(above[0]))
        moved = _moved(joint, coordinates.get(joint.GetName(), 0.0))
        ahead, back = (_frame(api, end) for end in "01")
        poses[child] = back.GetInverse() * moved * ahead * base
        xform = UsdGeom.Xformable(robot.GetStage().GetPrimAtPath(child))
        move, turn = xform.GetOrderedXformOps()
        move.Set(poses[child].ExtractTranslation())
        turn.Set(poses[child].ExtractRotationQuat().GetNormalized())


def _local(prim: Usd.Prim) -> Gf.Matrix4d:
    return UsdGeom.Xformable(prim).GetLocalTransformation()


def _frame(joint: UsdPhysics.Joint, end: str) -> Gf.Matrix4d:
    place, turn = (getattr(joint, f"GetLocal{what}{end}Attr")().Get() for what in ("Pos", "Rot"))
    return Gf.Matrix4d().SetRotate(Gf.Quatd(turn)).SetTranslateOnly(Gf.Vec3d(place))


def _moved(joint: Usd.Prim, coordinate: float) -> Gf.Matrix4d:
    """What a coordinate does in a joint's frame; its axis is X."""
    found = Gf.Matrix4d(1.0)
    if is_angular(joint):
        return found.SetRotate(Gf.Rotation(Gf.Vec3d.XAxis(), math.degrees(coordinate)))
    if one_freedom(joint):
        return found.SetTranslate(Gf.Vec3d(coordinate, 0.0, 0.0))
    return found


def lowest(robot: Usd.Prim) -> float | None:
    """The height of the lowest point of what collides of a robot, else of what is seen [m]; None without either."""
    parts = [prim for prim in Usd.PrimRange(robot) if prim.IsA(UsdGeom.Gprim)]
    solid = [prim for prim in parts if prim.HasAPI(UsdPhysics.CollisionAPI)]
    return min((low for prim in solid or parts for low in _low(prim)), default=None)


def _low(prim: Usd.Prim) -> Iterator[float]:
    matrix = np.array(UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(Usd.TimeCode.Default()))
    height, up = float(matrix[3, 2]), matrix[:3, 2]
    if prim.IsA(UsdGeom.Mesh):
        points = UsdGeom.Mesh(prim).GetPointsAttr().Get()
        yield height + float((np.asarray(points, dtype=np.float64) @ up).min())
    elif prim.IsA(UsdGeom.Cube):
        yield height - 0.5 * float(np.abs(up).sum())
    elif prim.IsA(UsdGeom.Sphere):
        yield height - float(UsdGeom.Sphere(prim).GetRadiusAttr().Get())
    elif prim.IsA(UsdGeom.Capsule):
        shape = UsdGeom.Capsule(prim)
        yield height - 0.5 * float(shape.GetHeightAttr().Get()) * abs(up[2]) - float(shape.GetRadiusAttr().Get())
    elif prim.IsA(UsdGeom.Cylinder):
        tube = UsdGeom.Cylinder(prim)
        rim = float(tube.GetRadiusAttr().Get()) * math.hypot(up[0], up[1])
        yield height - 0.5 * float(tube.GetHeightAttr().Get()) * abs(up[2]) - rim
