"""Start velocities of jointed bodies: Newton's importer keeps those of loose bodies only."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import newton
import numpy as np

from wsim.errors import UserError
from wsim.geometry.rotations import rotate
from wsim.scene.world import Body, Joint, Vec3, World
from wsim.sim.start_ropes import check_ropes

Array = np.ndarray
CLOSE = 1e-3  # share of a stated speed by which the joints may miss it
ROUNDING = 1e-5  # share of the fastest speed of a world below which one is none: forward kinematics is single precision


def start(model: Any, worlds: Sequence[World], bodies: Array, state: Any) -> None:
    """Let bodies on joints start as the stage says, and nothing start as joints or ropes do not let it.

    Takes and raises what `start_joints` does.
    """
    start_joints(model, worlds, bodies, state)
    check_ropes(model, worlds, bodies, state)


def start_joints(model: Any, worlds: Sequence[World], bodies: Array, state: Any) -> None:
    """Give the joints the speeds with which the bodies move as the stage states.

    Velocities are linear in the joints' speeds: their matrix is read off forward kinematics, and the speeds are the
    least-squares solution. What a stage leaves out (the spin of a bob of which it gives the velocity) follows, from
    joints that are constraints and from gears as well; what they leave open stands still.

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
    coordinates = _coordinates(model)
    speeds = np.array([_speeds(world, jointed, own, coordinates) for world, own in zip(worlds, response, strict=True)])
    reached = _velocities(model, state, speeds, count)
    for world, velocities, own in zip(worlds, reached[:, bodies], speeds, strict=True):
        for body, velocity in zip(world.bodies, velocities, strict=True):
            if body.prim in jointed and not body.kinematic and _moves(body):
                _check(body, velocity)
        _check_held(world, velocities)
        _check_gears(world, own, coordinates)


def _check_held(world: World, velocities: Array) -> None:
    """Refuse starts that a joint which is a constraint, and none of a tree's, would undo in its first step."""
    fastest = float(np.linalg.norm(velocities, axis=1).max(initial=0.0))
    for joint, ends, held in _held(world, velocities[..., None]):
        gap, size = held @ (ends[1] - ends[0])[:, 0], float(np.linalg.norm(ends, axis=1).max())
        if np.linalg.norm(gap) > CLOSE * size + ROUNDING * fastest:
            way, turn = _shown(gap[:3]), _shown(gap[3:])
            raise UserError(
                f"{joint.prim}: what it holds together starts apart, at {way} m/s and {turn} rad/s; give {joint.child} "
                f"the velocity of {joint.parent or 'the world'} there, or leave the joint out"
            )


def _check_gears(world: World, speeds: Array, coordinates: dict[str, int]) -> None:
    """Refuse starts at which two joints do not go as a gear couples them."""
    fastest = float(np.abs(speeds).max(initial=0.0))
    for gear in world.gears:
        if gear.first in coordinates and gear.second in coordinates:
            first, second = speeds[coordinates[gear.first]], speeds[coordinates[gear.second]]
            goal = gear.ratio * first
            if abs(second - goal) > CLOSE * max(abs(second), abs(goal)) + ROUNDING * fastest:
                raise UserError(
                    f"{gear.prim}: <{gear.second}> starts with {second:.4g} rad/s or m/s, and the gear has {goal:.4g} "
                    f"for the {first:.4g} of <{gear.first}>; give what is on one of the two that speed, or none"
                )


def _held(world: World, velocities: Array) -> Iterator[tuple[Joint, Array, Array]]:
    """Each joint that is a constraint between bodies that go no way of their own.

    Args:
        world: What the stage states.
        velocities: Of its bodies, (bodies, 6), each of N columns: (bodies, 6, N).

    Yields:
        The joint, the velocities of both its ends at its anchor, (2, 6, N), and what it takes of their difference,
        (6, 6).
    """
    row = {body.prim: k for k, body in enumerate(world.bodies)}
    for joint in world.joints:
        sides = [(joint.parent, joint.parent_anchor), (joint.child, joint.child_anchor)]
        if not joint.closing or any(end and world.bodies[row[end]].kinematic for end, _ in sides):
            continue
        still = np.zeros(velocities.shape[1:])
        ends = [_at(world.bodies[row[end]], anchor, velocities[row[end]]) if end else still for end, anchor in sides]
        held = np.eye(6)
        if joint.kind == "revolute":  # which turns about its axis
            own = rotate(np.array(joint.child_turn), np.eye(3)["XYZ".index(joint.axis)])
            axis = rotate(np.array(world.bodies[row[joint.child]].rotation), own)
            held[3:, 3:] -= np.outer(axis, axis)
        elif joint.kind == "spherical":
            held[3:] = 0.0
        yield joint, np.array(ends), held


def _at(body: Body, anchor: Vec3 | None, velocities: Array) -> Array:
    """The velocity of a point of a body, given in its frame, and its spin, of each of N columns (6, N)."""
    arm = rotate(np.array(body.rotation), np.array(anchor or body.com) - np.array(body.com))
    speed = velocities[:3] + np.cross(velocities[3:], arm[:, None], axis=0)
    return np.concatenate([speed, velocities[3:]])


def _speeds(world: World, jointed: set[str], response: Array, coordinates: dict[str, int]) -> Array:
    """The joints' speeds of one world, (dofs,), from what each moves its bodies by, (bodies, 6, dofs).

    First as stated, then as far as that leaves open as constraints and gears hold, and then at rest.
    """
    dofs = response.shape[-1]
    stated: list[tuple[Array, Array]] = []
    quiet: list[tuple[Array, Array]] = []
    for body, moved in zip(world.bodies, response, strict=True):
        for part, value in ((slice(0, 3), body.velocity), (slice(3, 6), body.angular_velocity)):
            level = stated if body.prim not in jointed or any(value) else quiet
            level.append((moved[part], np.array(value)))
    held = [(rows @ (ends[1] - ends[0]), np.zeros(6)) for _, ends, rows in _held(world, response)]
    for gear in world.gears:
        if gear.first in coordinates and gear.second in coordinates:
            unit = np.eye(dofs)
            held.append((unit[[coordinates[gear.second]]] - gear.ratio * unit[[coordinates[gear.first]]], np.zeros(1)))
    found, free = np.zeros(dofs), np.eye(dofs)
    for level in (stated, held, quiet):
        if level:
            matrix, goal = (np.concatenate(parts) for parts in zip(*level, strict=True))
            found, free = _narrowed(matrix, goal, found, free)
    return found


def _narrowed(matrix: Array, goal: Array, found: Array, free: Array) -> tuple[Array, Array]:
    """The least-squares solution of `matrix` x = `goal` among x = found + free y, and what of `free` it leaves open."""
    left, sizes, right = np.linalg.svd(matrix @ free)
    rank = int((sizes > ROUNDING * np.linalg.norm(matrix, 2)).sum())
    way = (left[:, :rank].T @ (goal - matrix @ found)) / sizes[:rank]
    return found + free @ (right[:rank].T @ way), free @ right[rank:].T


def _coordinates(model: Any) -> dict[str, int]:
    """Of each joint of the first world with one degree of freedom its number, by prim."""
    starts = model.joint_qd_start.numpy()
    count = model.joint_count // max(1, model.world_count)
    return {
        str(label): int(starts[k])
        for k, label in enumerate(model.joint_label[:count])
        if starts[k + 1] - starts[k] == 1
    }


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
            stated, held = _shown(np.array(value)), _shown(got)
            raise UserError(
                f"{body.prim}: its joints do not let it start with the {field} {stated} {unit} that the stage states; "
                f"the nearest that they allow is {held}: give that, or another axis"
            )


def _shown(vector: Array) -> tuple[float, ...]:
    """Four digits of what a vector is mostly made of."""
    least = CLOSE * np.abs(vector).max()
    return tuple(float(f"{x:.4g}") if abs(x) > least else 0.0 for x in vector)
