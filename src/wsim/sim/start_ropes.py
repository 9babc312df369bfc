"""Starts that would stretch a rope: its first step would undo them, by a jerk that nobody stated."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from wsim.errors import UserError
from wsim.geometry.ropes import path_length
from wsim.geometry.rotations import lengths, multiply, rotate
from wsim.scene.cord_paths import moving_stops
from wsim.scene.world import Body, Guide, Rope, World

Array = np.ndarray
TAUT = 1e-6  # of its length: a rope with less to spare is taut
CLOSE = 1e-3  # of the fastest of its points' speeds: a rope that comes to be longer by less is not stretched
APART = 1e-4  # [s] before and after the start, between which the rate of a length is taken


def check_ropes(model: Any, worlds: Sequence[World], bodies: Array, state: Any) -> None:
    """Refuse starts that part what a taut rope ties. What is led jerks it as it does whenever it comes taut.

    Args:
        model: The Newton model.
        worlds: What the stage of all worlds alike, or that of each, states.
        bodies: Index of each of the world's bodies in the model's first world.
        state: Its `body_qd` has the velocities of the start.

    Raises:
        UserError: With the speed at which the rope would be stretched, and a velocity at which it would not be.
    """
    if not any(world.ropes for world in worlds):
        return
    velocities = state.body_qd.numpy().astype(np.float64).reshape(max(1, model.world_count), -1, 6)[:, bodies]
    for world, own in zip(worlds, velocities, strict=False):
        moving = {body.prim: (body, velocity) for body, velocity in zip(world.bodies, own, strict=True)}
        for rope in world.ropes:
            tied = {guide.body: moving[guide.body] for guide in rope.path if guide.body is not None}
            if not any(body.kinematic and velocity.any() for body, velocity in tied.values()):
                _check(rope, tied)


def _check(rope: Rope, tied: dict[str, tuple[Body, Array]]) -> None:
    length, rate = _length(rope, tied)
    fastest = max((_speed(guide, *tied[guide.body]) for guide in rope.path if guide.body is not None), default=0.0)
    if rope.length - length > TAUT * rope.length or rate <= CLOSE * fastest:
        return
    name, (body, velocity) = max(tied.items(), key=lambda item: float(lengths(item[1][1][:3])))
    way = np.array([_length(rope, {**tied, name: (body, velocity + unit)})[1] - rate for unit in np.eye(3, 6)])
    nearest = velocity[:3] - rate * way / max(float(way @ way), 1e-12)
    told = tuple(float(f"{x:.4g}") if abs(x) > CLOSE * fastest else 0.0 for x in nearest)
    raise UserError(
        f"{rope.prim}: it is taut and would be stretched at {rate:.4g} m/s by how what it ties starts; give {name} the "
        f"velocity {told} m/s, the nearest that it allows, or the rope a length to spare"
    )


def _speed(guide: Guide, body: Body, velocity: Array) -> float:
    """How fast the points may be that a rope touches there [m/s]; those of what only spins are fast, too."""
    arm = float(lengths(np.array(guide.position) - np.array(body.com))) + guide.radius
    return float(lengths(velocity[:3]) + arm * lengths(velocity[3:]))


def _length(rope: Rope, tied: dict[str, tuple[Body, Array]]) -> tuple[float, float]:
    """The length of its way at the start [m], and how fast that grows [m/s]."""
    poses = {name: np.array([_pose(*each, t) for t in (-APART, 0.0, APART)]) for name, each in tied.items()}
    before, now, after = path_length(moving_stops(rope.path, poses))
    return float(now), float(after - before) / (2.0 * APART)


def _pose(body: Body, velocity: Array, t: float) -> Array:
    """Where a body is that goes on evenly for a while [s], (7,)."""
    place, own, com = np.array(body.position), np.array(body.rotation), np.array(body.com)
    half = 0.5 * t * velocity[3:]
    size = max(float(lengths(half)), 1e-300)
    turned = multiply(np.append(np.sin(size) / size * half, np.cos(size)), own)
    return np.concatenate([place + rotate(own, com) + t * velocity[:3] - rotate(turned, com), turned])
