"""Where joints start and drives go: Newton's importer begins each joint at 0, and turns a target beyond a stop back."""

from __future__ import annotations

import math
from typing import Any

import newton
import numpy as np
import warp as wp

from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.scene.world import Body, Joint, World

LEAST = 5e-6  # [rad or m]: nearer to 0 is the rounding of anchors and poses in single precision


def place_joints(builder: Any, world: World) -> None:
    """Give hinges and sliders the coordinates at which their bodies stand in the description.

    Args:
        builder: The `newton.ModelBuilder` of one world.
        world: What the stage states.
    """
    bodies = {body.prim: body for body in world.bodies}
    index = {str(label): k for k, label in enumerate(builder.joint_label)}
    for joint in world.joints:
        if joint.closing or joint.kind not in ("revolute", "prismatic"):
            continue
        at = coordinate(joint, bodies)
        if abs(at) > LEAST:
            k = index[joint.prim]
            builder.joint_q[builder.joint_q_start[k]] = at
            if joint.parent is None and joint.parent_anchor is not None:
                # Of a single body on the world the importer puts the zero where the body stands.
                builder.joint_X_p[k] = wp.transform(joint.parent_anchor, joint.parent_turn)


def aim_drives(builder: Any, world: World) -> None:
    """Give drives the targets that are stated.

    For one beyond a stop, as of a preloaded hinge, the importer takes the middle between the stops. Of one with a
    stiffness it follows the position alone, which is half of its law where it has a velocity, or gets one by time.
    """
    index = {str(label): k for k, label in enumerate(builder.joint_label)}
    led = {each.target for each in world.schedules if each.quantity == "velocity"}
    for joint in world.joints:
        if joint.drive is not None and joint.prim in index and joint.kind in ("revolute", "prismatic"):
            k = index[joint.prim]
            builder.joint_target_q[builder.joint_q_start[k]] = joint.drive.position
            if joint.drive.leads or (joint.prim in led and joint.drive.stiffness > 0.0):
                builder.joint_target_mode[builder.joint_qd_start[k]] = int(newton.JointTargetMode.POSITION_VELOCITY)


def coordinate(joint: Joint, bodies: dict[str, Body]) -> float:
    """Where a hinge or a slider is at the start [rad or m]."""
    (ahead, facing), (behind, turned) = (_end(joint, bodies, side) for side in ("parent", "child"))
    axis = np.eye(3)["XYZ".index(joint.axis)]
    if joint.kind == "prismatic":
        return float(rotate(facing, axis) @ (behind - ahead))
    between = multiply(conjugate(facing), turned)
    sine, cosine = float(between[:3] @ axis), float(between[3])
    return 2.0 * (math.atan2(sine, cosine) if cosine >= 0.0 else math.atan2(-sine, -cosine))


def _end(joint: Joint, bodies: dict[str, Body], side: str) -> tuple[np.ndarray, np.ndarray]:
    """A joint's frame at one end, in the world."""
    anchor = np.array(getattr(joint, f"{side}_anchor") or (0.0, 0.0, 0.0))
    turn = np.array(getattr(joint, f"{side}_turn"))
    body = bodies.get(getattr(joint, side) or "")
    if body is None:
        return anchor, turn
    facing = np.array(body.rotation)
    return np.array(body.position) + rotate(facing, anchor), multiply(facing, turn)
