"""Joints that close loops or may break, and gears: rows of MuJoCo's equality constraints, no joints of Newton's."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from newton.solvers import mujoco

from wsim.geometry.rotations import rotate
from wsim.scene.world import Joint, World
from wsim.solvers.breaking import Breakable

HALF_SPAN = 0.05  # [m] from a hinge's anchor to the two points along its axis that hold it
ROWS_A_JOINT = 6


def add_constraints(builder: Any, world: World) -> list[Breakable]:
    """Add the constraints to a model of one world.

    A hinge is two points on its axis, a ball joint one, a fixed joint a weld; a gear is a polynomial of its joints.

    Args:
        builder: The `newton.ModelBuilder` that the stage was imported into, without these joints.
        world: What the stage states.

    Returns:
        The joints that may break, in the world's order.
    """
    index = {str(label): k for k, label in enumerate(builder.body_label)}
    breakable = []
    for joint in world.joints:
        if not joint.closing:
            continue
        rows = _add(builder, joint, index)
        if joint.may_break:
            limits = [np.inf if load is None else load for load in (joint.break_force, joint.break_torque)]
            breakable.append(Breakable(joint.prim, tuple(rows), *limits))
    joints = {str(label): k for k, label in enumerate(builder.joint_label)}
    for gear in world.gears:
        mujoco.add_equality_joint(
            builder, joints[gear.second], joints[gear.first], polycoef=(gear.offset, gear.ratio), label=gear.prim
        )
    return breakable


def constraint_rows(world: World) -> int:
    """Rows that the constraints of a world, and the friction in its joints, take at most."""
    closing = sum(joint.closing for joint in world.joints)
    return ROWS_A_JOINT * closing + len(world.gears) + sum(joint.friction > 0.0 for joint in world.joints)


def held_points(world: World) -> np.ndarray:
    """Where each point-to-point constraint holds its child, in the child's axes [m], (rows, 3); NaN of the others.

    Newton works it out from the pose at the start, in single precision: what a chain of thirty links is then off by
    would stay, and so would the gap of a loop that does not close.
    """
    rows: list[np.ndarray] = []
    for joint in world.joints:
        if joint.closing:
            rows += (
                [np.full(3, np.nan)] if joint.kind == "fixed" else _points(joint, joint.child_anchor, joint.child_turn)
            )
    return np.array(rows + [np.full(3, np.nan)] * len(world.gears)).reshape(-1, 3)


def _points(joint: Joint, anchor: Sequence[float] | None, turn: Sequence[float]) -> list[np.ndarray]:
    """What holds a joint on one of its sides: the anchor of a ball joint, two points on the axis of a hinge."""
    place = np.array(anchor, dtype=float)
    if joint.kind == "spherical":
        return [place]
    arm = HALF_SPAN * rotate(np.array(turn), np.eye(3)["XYZ".index(joint.axis)])
    return [place - arm, place + arm]


def _add(builder: Any, joint: Joint, index: dict[str, int]) -> list[int]:
    """A joint's rows of `mujoco:equality_constraint`."""
    parent = -1 if joint.parent is None else index[joint.parent]
    child = index[joint.child]
    if joint.kind == "fixed":
        row = mujoco.add_equality_weld(builder, parent, child, label=joint.prim)
        # A weld holds the child's anchor, about which its torque is then.
        builder.custom_attributes["mujoco:equality_constraint_anchor"].values[row] = joint.child_anchor
        return [row]
    points = _points(joint, joint.parent_anchor, joint.parent_turn)
    return [mujoco.add_equality_connect(builder, parent, child, anchor=tuple(p), label=joint.prim) for p in points]
