"""Joints, and the drives that move them."""

from __future__ import annotations

import math

from wsim.plan.schema import Joint, JointDrive, PlanObject
from wsim.program.compose.draft import Draft
from wsim.program.compose.poses import position
from wsim.program.source import call, number, tuple_of

_CALLS = {"fixed": "fixed", "hinge": "revolute", "slider": "prismatic", "ball": "spherical"}
_LIMITS = {"hinge": "limits_deg", "slider": "limits"}


def statements(draft: Draft) -> list[str]:
    """A call for each joint."""
    lines: list[str] = []
    for joint in draft.plan.joints:
        parent = "None" if joint.parent is None else draft.handles[joint.parent]
        arguments = [f'"{joint.name}"', parent, draft.handles[joint.child]]
        if joint.anchor is not None:
            arguments.append(f"anchor={tuple_of(_anchor(draft.plan.object(joint.child), joint))}")
        if joint.kind in ("hinge", "slider"):
            arguments.append(f'axis="{joint.axis}"')
        if joint.limits is not None:
            arguments.append(f"{_LIMITS[joint.kind]}={tuple_of(joint.limits)}")
        if joint.drive is not None:
            arguments.append(f"drive={_drive(joint.drive)}")
        lines += call(f"scene.joint_{_CALLS[joint.kind]}", arguments)
    return lines


def _anchor(child: PlanObject, joint: Joint) -> tuple[float, float, float]:
    """Where a joint is in the world [m]: its anchor turned with its child, from the child's centre."""
    x, y, z = joint.anchor or (0.0, 0.0, 0.0)
    roll, pitch, yaw = (math.radians(angle) for angle in (child.pose.rotation_deg if child.pose else (0.0, 0.0, 0.0)))
    y, z = y * math.cos(roll) - z * math.sin(roll), y * math.sin(roll) + z * math.cos(roll)
    x, z = x * math.cos(pitch) + z * math.sin(pitch), -x * math.sin(pitch) + z * math.cos(pitch)
    x, y = x * math.cos(yaw) - y * math.sin(yaw), x * math.sin(yaw) + y * math.cos(yaw)
    at = position(child)
    return (at[0] + x, at[1] + y, at[2] + z)


def _drive(drive: JointDrive) -> str:
    """The `Drive` of a joint, with what it has of its own."""
    given = {name: value for name, value in drive.model_dump().items() if value}
    said = {name: str(value) if isinstance(value, bool) else number(value) for name, value in given.items()}
    return f"Drive({', '.join(f'{name}={value}' for name, value in said.items())})"
