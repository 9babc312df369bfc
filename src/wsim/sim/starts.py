"""Start velocities of jointed bodies: Newton's importer keeps those of loose bodies only."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import newton
import numpy as np

from wsim.errors import UserError
from wsim.geometry.rotations import rotate
from wsim.scene.world import Body, Vec3, World

Array = np.ndarray
QUIET = 1e-3  # weight of standing still where nothing is said of a body's motion
CLOSE = 1e-3  # share of a stated speed by which the joints may miss it


def start_joints(model: Any, worlds: Sequence[World], bodies: Array, state: Any) -> None:
    """Give the joints the speeds with which the bodies move as the stage states.

    Velocities are linear in the joints' speeds: their matrix is read off forward kinematics, and the speeds are the
    least-squares solution. What a stage leaves out (the spin of a bob of which it gives the velocity) follows.

    Args:
        model: The Newton model.
        worlds: What the stage of all worlds alike, or that of each, states.
        bodies: Index of each of the world's bodies in the model's first world.
        state: Its `joint_qd` and `body_qd` are set.

    Raises:
        UserError: If the joints do not let a body start as stated.
    """
    first = worlds[0]
    jointed = {end for joint in first.joints for end in (joint.parent, joint.child) if end}
    if not any(
        body.prim in jointed and not body.kinematic and _moves(body) for world in worlds for body in world.bodies
    ):
        return
    count, dofs = len(worlds), model.joint_dof_count // max(1, model.world_count)
    response = np.zeros((count, len(bodies), 6, dofs))  # welds alone have no speeds: nothing moves
    for k, row in enumerate(np.eye(dofs)):
        response[..., k] = _velocities(model, state, row[None], count)[:, bodies]
    speeds = np.array([_speeds(world, jointed, own) for world, own in zip(worlds, response, strict=True)])
    reached = _velocities(model, state, speeds, count)
    for world, velocities in zip(worlds, reached[:, bodies], strict=True):
        for body, velocity in zip(world.bodies, velocities, strict=True):
            if body.prim in jointed and not body.kinematic and _moves(body):
                _check(body, velocity)
        _check_held(world, dict(zip((body.prim for body in world.bodies), velocities, strict=True)))


def _check_held(world: World, velocities: dict[str, Array]) -> None:
    """Refuse starts that a joint which may break would undo in its first step: it is a constraint, no tree's joint."""
    bodies = {body.prim: body for body in world.bodies}
    for joint in world.joints:
        ends = [(joint.parent, joint.parent_anchor), (joint.child, joint.child_anchor)]
        if not joint.may_break or any(end and bodies[end].kinematic for end, _ in ends):
            continue
        one, other = (_at(bodies[end], anchor, velocities[end]) if end else np.zeros(6) for end, anchor in ends)
        apart, limit = other - one, CLOSE * max(float(np.linalg.norm(each)) for each in (one, other))
        if joint.kind == "revolute":  # which turns about its axis
            body = bodies[joint.child]
            axis = rotate(
                np.array(body.rotation), rotate(np.array(joint.child_turn), np.eye(3)["XYZ".index(joint.axis)])
            )
            apart[3:] -= (apart[3:] @ axis) * axis
        elif joint.kind == "spherical":
            apart[3:] = 0.0
        if np.linalg.norm(apart) > limit:
            way, turn = (tuple(round(float(x), 4) + 0.0 for x in part) for part in (apart[:3], apart[3:]))
            raise UserError(
                f"{joint.prim}: what it holds together starts apart, at {way} m/s and {turn} rad/s; give {joint.child} "
                f"the velocity of {joint.parent or 'the world'} there, or leave the joint out"
            )


def _at(body: Body, anchor: Vec3 | None, velocity: Array) -> Array:
    """The velocity of a point of a body, given in its frame, and its spin, (6,)."""
    arm = rotate(np.array(body.rotation), np.array(anchor or body.com) - np.array(body.com))
    return np.concatenate([velocity[:3] + np.cross(velocity[3:], arm), velocity[3:]])


def _speeds(world: World, jointed: set[str], response: Array) -> Array:
    """The joints' speeds of one world, (dofs,), from what each moves its bodies by, (bodies, 6, dofs)."""
    rows, goals = [], []
    for body, moved in zip(world.bodies, response, strict=True):
        for part, value in ((slice(0, 3), body.velocity), (slice(3, 6), body.angular_velocity)):
            weight = 1.0 if body.prim not in jointed or any(value) else QUIET
            rows.append(weight * moved[part])
            goals.append(weight * np.array(value))
    return np.asarray(np.linalg.lstsq(np.concatenate(rows), np.concatenate(goals), rcond=None)[0])


def _moves(body: Body) -> bool:
    return any(body.velocity) or any(body.angular_velocity)


def _velocities(model: Any, state: Any, speeds: Array, count: int) -> Array:
    """The velocities of the bodies of the first `count` worlds, (count, bodies, 6).

    Args:
        model: The Newton model.
        state: Gets the speeds and the velocities.
        speeds: Of the joints of all worlds alike, or of each, (N, dofs).
        count: How many are asked for.
    """
    worlds = max(1, model.world_count)
    state.joint_qd.assign(np.broadcast_to(speeds, (worlds, speeds.shape[1])).astype(np.float32).ravel())
    newton.eval_fk(model, state.joint_q, state.joint_qd, state)
    return np.asarray(state.body_qd.numpy().astype(np.float64).reshape(worlds, -1, 6)[:count])


def _check(body: Body, reached: Array) -> None:
    for field, unit, value, got in (
        ("velocity", "m/s", body.velocity, reached[:3]),
        ("angular velocity", "rad/s", body.angular_velocity, reached[3:]),
    ):
        if any(value) and np.linalg.norm(got - value) > CLOSE * np.linalg.norm(value):
            stated, held = (tuple(round(float(x), 4) + 0.0 for x in vector) for vector in (value, got))
            raise UserError(
                f"{body.prim}: its joints do not let it start with the {field} {stated} {unit} that the stage states; "
                f"the nearest that they allow is {held}: give that, or another axis"
            )
