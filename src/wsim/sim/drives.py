"""Drives that damp get a row of MuJoCo's constraints each, as `wsim.solvers.drives` needs them."""

from __future__ import annotations

from typing import Any

import warp as wp

from wsim.scene.world import World

FIXED = 0  # of the mujoco:tendon_type attribute
ONE_DOF = ("revolute", "prismatic")
UNBOUNDED = 1e15  # [N m or N]


def add_drives(builder: Any, world: World) -> None:
    """Give each joint whose drive damps a tendon along it, whose dry friction is the most that the drive gives.

    The drives' targets are stated anew, as the world has them.

    Args:
        builder: The `newton.ModelBuilder` of one world, with MuJoCo's custom attributes registered.
        world: What the stage states.
    """
    joints = {str(label): k for k, label in enumerate(builder.joint_label)}
    for joint in world.joints:
        if joint.drive is None or joint.closing:
            continue
        if joint.drive.stiffness > 0.0 and joint.kind in ONE_DOF:
            # Newton puts a target that lies beyond a stop in the middle between both; it is to press against the stop.
            builder.joint_target_q[builder.joint_q_start[joints[joint.prim]]] = joint.drive.position
        if joint.drive.damping <= 0.0:
            continue
        most = joint.drive.max_effort
        first = len(builder.custom_attributes["mujoco:tendon_joint"].values or ())
        builder.add_custom_values(**{"mujoco:tendon_joint": joints[joint.prim], "mujoco:tendon_coef": 1.0})
        values: dict[str, Any] = {
            "world": builder.current_world,
            "label": f"{joint.prim}/drive",
            "type": FIXED,
            "wrap_adr": 0,
            "wrap_num": 0,
            "joint_adr": first,
            "joint_num": 1,
            "springlength": wp.vec2(-1.0, -1.0),
            "limited": 0,
            "frictionloss": UNBOUNDED if most is None else most,
        }
        builder.add_custom_values(**{f"mujoco:tendon_{name}": value for name, value in values.items()})


def drive_count(world: World) -> int:
    """Rows that the drives of a world take at most."""
    return sum(joint.drive is not None for joint in world.joints)
