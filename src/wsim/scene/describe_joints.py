"""Joints and gears of a stage, read back."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from pxr import Gf, Sdf, Usd, UsdPhysics

from wsim.scene import schema
from wsim.scene.articulation import dry_friction, joint_ends, may_break
from wsim.scene.spanning import WORLD_END
from wsim.scene.usd_prims import object_path, owner_of, rigid_frame, turn_of
from wsim.scene.usd_shapes import to_vec3
from wsim.scene.usd_values import line_of, value_of
from wsim.scene.world import Gear, Joint, Motor

MIMIC = "NewtonMimicAPI"
_JOINTS = (
    (UsdPhysics.FixedJoint, "fixed"),
    (UsdPhysics.RevoluteJoint, "revolute"),
    (UsdPhysics.PrismaticJoint, "prismatic"),
    (UsdPhysics.SphericalJoint, "spherical"),
)


def read_joints(prims: list[Usd.Prim]) -> Iterator[Joint]:
    """The joints among a stage's prims that hold a body."""
    for prim in prims:
        for usd, kind in _JOINTS if prim.IsA(UsdPhysics.Joint) else ():
            if not prim.IsA(usd):
                continue
            stage = prim.GetStage()
            paths = joint_ends(UsdPhysics.Joint(prim))
            parent, child = (_body_at(stage, path) for path in paths)
            if child is None:
                parent, child, paths = child, parent, paths[::-1]
            if child is None:
                continue  # holds nothing that moves
            axis = prim.GetAttribute("physics:axis").Get() if kind != "fixed" else "X"
            yield Joint.model_validate(
                {
                    "prim": str(prim.GetPath()),
                    "kind": kind,
                    "parent": parent,
                    "child": child,
                    "fixture": _fixture(prim, paths[0]) if parent is None else None,
                    "axis": axis,
                    **anchors_of(UsdPhysics.Joint(prim), parent, child),
                    **_motion(prim, kind),
                    **_strength(UsdPhysics.Joint(prim)),
                    "line": line_of(prim),
                }
            )


def _fixture(joint: Usd.Prim, end: Sdf.Path) -> str | None:
    """The static object that stands for the world at a joint's end: the joint's target, or noted beside it."""
    noted = joint.GetRelationship("wsim:fixture")
    path = next(iter(noted.GetTargets() if noted else []), end)
    return None if path == WORLD_END else object_path(joint.GetStage().GetPrimAtPath(path), joint.GetStage())


def anchors_of(joint: UsdPhysics.Joint, parent: str | None, child: str) -> dict[str, Any]:
    """Where a joint's frame is in its parent and in its child."""
    stage = joint.GetPrim().GetStage()
    found: dict[str, Any] = {}
    sides = (
        (joint.GetBody0Rel(), joint.GetLocalPos0Attr(), joint.GetLocalRot0Attr()),
        (joint.GetBody1Rel(), joint.GetLocalPos1Attr(), joint.GetLocalRot1Attr()),
    )
    for relation, position, rotation in sides:
        targets = relation.GetTargets()
        prim = stage.GetPrimAtPath(targets[0]) if targets else None
        owner = owner_of(prim) if prim else None
        frame = Gf.Matrix4d().SetRotate(Gf.Quatd(rotation.Get())).SetTranslateOnly(Gf.Vec3d(position.Get()))
        if prim:
            frame *= rigid_frame(prim)
        if owner is not None:
            frame *= rigid_frame(stage.GetPrimAtPath(owner)).GetInverse()
        side = "child" if owner == child else "parent"
        found[f"{side}_anchor"] = to_vec3(frame.ExtractTranslation())
        found[f"{side}_turn"] = turn_of(frame)
    return found


def _motion(prim: Usd.Prim, kind: str) -> dict[str, Any]:
    """A hinge's or a slider's limits and motor, in radians."""
    if kind not in ("revolute", "prismatic"):
        return {}
    unit = math.pi / 180.0 if kind == "revolute" else 1.0
    found: dict[str, Any] = {"friction": dry_friction(prim), "armature": float(_number(prim, "newton:armature", 0.0))}
    for name, attribute in (("low", "physics:lowerLimit"), ("high", "physics:upperLimit")):
        value = prim.GetAttribute(attribute).Get()
        if value is not None and math.isfinite(value):
            found[name] = float(value) * unit
    fastest = float(_number(prim, "newton:velocityLimit", math.inf))
    if 0.0 < fastest < math.inf:
        found["fastest"] = fastest * unit
    drive = UsdPhysics.DriveAPI.Get(prim, "angular" if kind == "revolute" else "linear")
    if drive:
        most = float(drive.GetMaxForceAttr().Get())
        found["drive"] = Motor(
            stiffness=float(drive.GetStiffnessAttr().Get()) / unit,
            damping=float(drive.GetDampingAttr().Get()) / unit,
            position=float(drive.GetTargetPositionAttr().Get()) * unit,
            velocity=float(drive.GetTargetVelocityAttr().Get()) * unit,
            max_effort=most if math.isfinite(most) else None,
            saturates=bool(value_of(prim, "saturates", False)),
        )
    return found


def _strength(joint: UsdPhysics.Joint) -> dict[str, Any]:
    """What a joint breaks at, and whether it is a constraint."""
    loads = {"break_force": joint.GetBreakForceAttr().Get(), "break_torque": joint.GetBreakTorqueAttr().Get()}
    found: dict[str, Any] = {name: float(load) for name, load in loads.items() if math.isfinite(load)}
    found["closing"] = may_break(joint) or bool(joint.GetExcludeFromArticulationAttr().Get())
    return found


def read_gears(prims: list[Usd.Prim]) -> Iterator[Gear]:
    """The gears among a stage's prims, and the joints that mimic another."""
    for prim in prims:
        applied = schema.applied(prim)
        if schema.GEAR in applied:
            yield Gear(
                prim=str(prim.GetPath()),
                first=_target(prim, "wsim:joint0"),
                second=_target(prim, "wsim:joint1"),
                ratio=value_of(prim, "ratio", 1.0),
                line=line_of(prim),
            )
        elif MIMIC in applied and is_mimic(prim):
            unit = math.pi / 180.0 if prim.IsA(UsdPhysics.RevoluteJoint) else 1.0
            yield Gear(
                prim=str(prim.GetPath()),
                first=_target(prim, "newton:mimicJoint"),
                second=str(prim.GetPath()),
                ratio=float(_number(prim, "newton:mimicCoef1", 1.0)),
                offset=float(_number(prim, "newton:mimicCoef0", 0.0)) * unit,
                line=line_of(prim),
            )


def is_mimic(prim: Usd.Prim) -> bool:
    """Whether a joint follows another by Newton's schema."""
    return schema.has(prim, MIMIC) and bool(_number(prim, "newton:mimicEnabled", True))


def _number(prim: Usd.Prim, name: str, default: float) -> Any:
    attribute = prim.GetAttribute(name)
    value = attribute.Get() if attribute else None
    return default if value is None else value


def _target(prim: Usd.Prim, name: str) -> str:
    relation = prim.GetRelationship(name)
    return str(next(iter(relation.GetTargets() if relation else []), ""))


def _body_at(stage: Usd.Stage, path: object) -> str | None:
    return None if path == WORLD_END else owner_of(stage.GetPrimAtPath(path))
