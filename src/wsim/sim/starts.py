"""Start velocities of jointed bodies: Newton's importer keeps those of loose bodies only."""

from __future__ import annotations

from typing import Any

import newton
import numpy as np

from wsim.errors import UserError
from wsim.scene.world import Body, World

Array = np.ndarray
QUIET = 1e-3  # weight of standing still where nothing is said of a body's motion
CLOSE = 1e-3  # share of a stated speed by which the joints may miss it


def start_joints(model: Any, world: World, bodies: Array, state: Any) -> None:
    """Give the joints the speeds with which the bodies move as the stage states.

    Velocities are linear in the joints' speeds: their matrix is read off forward kinematics, and the speeds are the
    least-squares solution. What a stage leaves out (the spin of a bob of which it gives the velocity) follows.

    Args:
        model: The Newton model.
        world: What the stage states.
        bodies: Index of each of the world's bodies in the model's first world.
        state: Its `joint_qd` and `body_qd` are set, in all worlds alike.

    Raises:
        UserError: If the joints do not let a body start as stated.
    """
    jointed = {end for joint in world.joints for end in (joint.parent, joint.child) if end}
    stated = [b for b in world.bodies if b.prim in jointed and not b.kinematic and _moves(b)]
    if not stated:
        return
    worlds = max(1, model.world_count)
    dofs, count = model.joint_dof_count // worlds, model.body_count // worlds
    response = np.zeros((count, 6, dofs))
    for k in range(dofs):
        response[:, :, k] = _velocities(model, state, np.eye(dofs)[k], worlds)[:count]
    rows, goals = [], []
    for body, index in zip(world.bodies, bodies, strict=True):
        for part, value in ((slice(0, 3), body.velocity), (slice(3, 6), body.angular_velocity)):
            weight = 1.0 if body.prim not in jointed or any(value) else QUIET
            rows.append(weight * response[index, part])
            goals.append(weight * np.array(value))
    speeds = np.linalg.lstsq(np.concatenate(rows), np.concatenate(goals), rcond=None)[0]
    reached = _velocities(model, state, speeds, worlds)
    for body in stated:
        _check(body, reached[bodies[world.bodies.index(body)]])


def _moves(body: Body) -> bool:
    return any(body.velocity) or any(body.angular_velocity)


def _velocities(model: Any, state: Any, speeds: Array, worlds: int) -> Array:
    """The bodies' velocities under the joints' speeds of one world, given to all, (bodies, 6)."""
    state.joint_qd.assign(np.tile(speeds, worlds).astype(np.float32))
    newton.eval_fk(model, state.joint_q, state.joint_qd, state)
    return state.body_qd.numpy().astype(np.float64)


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
