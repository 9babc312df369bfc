"""Blows of two objects between frames: how fast they came at each other along their contact's normal, and parted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, lengths, rotate
from wsim.judge.evidence.motion import FLOAT32
from wsim.judge.language.contacts import against, gap, normal_of, struck_poses, touch_reach

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.language.signals import Signals

    Floats = NDArray[np.float64]
    Rows = NDArray[np.intp]

FINE = 0.1  # of the time between frames: about a step, where nobody says how long one is
FLAT = 1e-3  # of a body's smallest extent: points as far out as that touch together


@dataclass(eq=False)
class Blows:
    """N blows of two objects in W worlds, each between two frames that follow one another, or with one between them."""

    world: Rows  # (N,)
    first: Rows  # the frame before it, (N,)
    last: Rows  # the frame after it, (N,)
    approach: Floats  # (N,) [m/s]
    parting: Floats  # (N,) [m/s]
    unsure: Floats  # of either: what a step of the simulator changes, and rounding (N,) [m/s]


def blows(signals: Signals, one: str, other: str) -> Blows:
    """What the frames tell of the blows of two objects: of those that are over before there is another."""
    course = against(signals, one, other)
    w, first, last = _alone(course.struck)
    near = gap(signals, one, other)
    reach = np.broadcast_to(touch_reach(signals, one, other)[0], near.shape)
    # One that goes on past a frame has them touch in it.
    whole = (last - first == 1) | (near[w, first + 1] <= reach[w, first + 1])
    w, first, last = w[whole], first[whole], last[whole]
    when, _, before, after = course.meet(first, last, w)
    rows = [signals.row(name) for name in (one, other) if signals.moves(name)]
    poses = struck_poses(signals, rows, w, first, last, when)
    apart, normal = normal_of(signals, one, other, rows, poses)
    arms = _arms(signals, one, other, rows, poses, normal)
    speeds = []
    for velocity, frame in ((before, first), (after, last)):
        for k, i in enumerate(rows):
            sign = 1.0 if signals.moves(one) and k == 0 else -1.0
            velocity = velocity + sign * np.cross(signals.body_qd[w, frame, i, 3:].astype(np.float64), arms[:, k])
        speeds.append(np.sum(velocity * normal, axis=1))
    met = apart <= np.maximum(reach[w, first], reach[w, last])
    step = signals.world.time_step or FINE * signals.step
    fastest = np.maximum(lengths(before), lengths(after))
    unsure = np.abs(normal @ course.pull) * step + 8.0 * FLOAT32 * fastest
    return Blows(w[met], first[met], last[met], -speeds[0][met], speeds[1][met], unsure[met])


def _alone(struck: NDArray[np.bool_]) -> tuple[Rows, Rows, Rows]:
    """World, frame before and frame after of stretches of one interval or two that are struck (W, T - 1)."""
    edges = np.diff(np.pad(struck, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    (w, first), last = np.nonzero(edges > 0), np.nonzero(edges < 0)[1]
    short = last - first <= 2
    return w[short], first[short], last[short]


def _arms(signals: Signals, one: str, other: str, rows: list[int], poses: Floats, normal: Floats) -> Floats:
    """From the centres of mass to the point that touches, (N, B, 3) [m]: of the body that has the fewest there."""
    names = [name for name in (one, other) if signals.moves(name)]
    found = np.zeros((len(poses), len(rows), 3))
    for n in range(len(poses)):
        points = []
        for k, (name, i) in enumerate(zip(names, rows, strict=True)):
            towards = -normal[n] if name == one else normal[n]
            points.append(_outermost(signals, i, poses[n, k], towards))
        _, point = min(points, key=lambda each: each[0])
        for k, i in enumerate(rows):
            com = np.array(signals.world.bodies[i].com)
            found[n, k] = point - poses[n, k, :3] - rotate(poses[n, k, 3:], com)
    return found


def _outermost(signals: Signals, i: int, pose: Floats, towards: Floats) -> tuple[int, Floats]:
    """How many of a body's points are the farthest out that way, and their middle (3,) [m]."""
    body = signals.world.bodies[i]
    own = rotate(conjugate(pose[3:]), towards)
    if all(shape.kind == "sphere" for shape in body.shapes if shape.collides):
        centres = np.array([np.array(s.position) + s.size[0] * own for s in body.shapes if s.collides])
    else:
        centres = np.concatenate([surface.vertices for surface in signals.solid(body.prim).surfaces])
    out = centres @ own
    far = centres[out >= out.max() - FLAT * signals.solid(body.prim).smallest]
    return len(far), rotate(pose[3:], far.mean(axis=0)) + pose[:3]
