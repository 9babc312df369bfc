"""How far what ties pass forces along turns between two frames.

An impulse is taken to act at the mean of its arms at both frames, along the mean of its axes. What a force F at an arm
r turns in an interval is h (r F) at that mean, less what curves (the trapezoidal rule's r'' h^2 / 12) and what both
change by together (r' F' h^2 / 12). Of a force that turns with its arm both are at most the square of the angle by
which that turns, over 12, of F r. A force may change by more than it turns: at a dead point, where two links of a
linkage line up, it goes through zero in a frame or two (`changing`). A rotor that spins about its own joint turns
neither.

A light link shakes faster than frames tell. Of an arm that swings by A cos(p k + q), p a frame, the mean of both ends
misses A (cos p/2 - sin(p/2) / (p/2)) of the mean over the interval, and its turn the mean of both rates by p times as
much, a quarter of a swing on: a share of m / p of the arm, m being the most that turns stray about there. That is
p^2 A / 12 below 1 rad, as above, and m at most beyond (`shaken`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.judge.evidence.joints import AXES, anchors_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Joint, Spring

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]
    Rows = NDArray[np.intp]

SHORT = 0.05  # of a body's size: an arm that is shorter counts as so long


def turned(evidence: Evidence, size: Floats) -> Floats:
    """The angle in each interval, the largest of each body's mechanism, (T - 1, B) [rad].

    Args:
        evidence: T frames of B bodies.
        size: How far from its centre of mass each body is held, or its radius if that is more, (B,) [m].
    """
    motion, world = evidence.motion, evidence.world
    row = {body.prim: i for i, body in enumerate(world.bodies)}
    found = np.zeros((len(motion.h), len(motion.mass)))
    for joint in world.joints:
        rows = [row[end] for end in (joint.parent, joint.child) if end in row]
        angle = _of_joint(evidence, joint, rows, size)
        found[:, rows] = np.maximum(found[:, rows], angle[:, None])
    rate = np.linalg.norm(motion.w, axis=2)
    rate = np.maximum(rate[1:], rate[:-1]) * motion.h[:, None]
    sprung = [row[guide.body] for spring in world.springs for guide in spring.path if guide.body in row]
    found[:, sprung] = np.maximum(found[:, sprung], rate[:, sprung])
    for unit in np.unique(motion.unit[motion.jointed]):
        own = np.flatnonzero(motion.unit == unit)
        found[:, own] = found[:, own].max(axis=1, keepdims=True)
    return found


def shaken(evidence: Evidence) -> Floats:
    """How far turns stray from the mean of the rates at both ends, (T - 1, B) [rad]: in each mechanism the most.

    In the intervals beside it; of bodies, and of springs' ways. Where a body turns by half a turn a frame or more
    nobody knows.
    """
    motion, q = evidence.motion, evidence.body_q[..., 3:]
    found = np.zeros((len(motion.h), len(motion.mass)))
    if not motion.jointed.any() or not len(found):
        return found
    turn = multiply(q[1:], conjugate(q[:-1]))
    turn = np.where(turn[..., 3:] < 0.0, -turn, turn)
    size = np.linalg.norm(turn[..., :3], axis=2, keepdims=True)
    angle = 2.0 * np.arctan2(size, turn[..., 3:]) * turn[..., :3] / np.maximum(size, 1e-12)
    off = np.linalg.norm(angle - 0.5 * (motion.w[1:] + motion.w[:-1]) * motion.h[:, None, None], axis=2)
    for spring in evidence.world.springs:
        held = [evidence.index(guide.body) for guide in spring.path if guide.body is not None]
        off[:, held] = np.maximum(off[:, held], _of_spring(evidence, spring)[:, None])
    off = np.pad(off, ((1, 1), (0, 0)), mode="edge")
    off = np.maximum(off[:-2], off[2:])  # what strays in one interval alone does not swing
    for unit in np.unique(motion.unit[motion.jointed]):
        own = np.flatnonzero(motion.unit == unit)
        found[:, own] = np.minimum(off[:, own].max(axis=1, keepdims=True), 1.0)
    return found


def _of_spring(evidence: Evidence, spring: Spring) -> Floats:
    """How far a spring's way strays from where the speeds of its ends take it, (T - 1,) [rad]."""
    motion = evidence.motion
    way, speed = np.zeros((2, len(evidence.time), 3))
    for guide, sign in zip(spring.path, (-1.0, 1.0), strict=True):
        if guide.body is None:
            way += sign * np.array(guide.position)
            continue
        i = evidence.index(guide.body)
        place = evidence.body_q[:, i, :3] + rotate(evidence.body_q[:, i, 3:], np.array(guide.position)[None])
        way += sign * place
        speed += sign * (motion.v[:, i] + np.cross(motion.w[:, i], place - motion.com[:, i]))
    length = np.maximum(np.linalg.norm(way, axis=1), 1e-9)
    off = np.diff(way, axis=0) - 0.5 * (speed[1:] + speed[:-1]) * motion.h[:, None]
    along = 0.5 * (way[1:] / length[1:, None] + way[:-1] / length[:-1, None])
    off -= np.einsum("ti,ti->t", off, along)[:, None] * along
    return np.asarray(np.linalg.norm(off, axis=1) / np.minimum(length[1:], length[:-1]))


def changing(asked: Floats, angle: Floats, mass: Floats, hit: Bools, unit: Rows) -> Floats:
    """What is missed of arms that turn while what they pass on changes, as an acceleration, (N, B) [m/s^2].

    The angle times the change of what a body's ties are asked for, over 12: the greater of that from the interval
    before and to the one after, of which neither has a blow in it, nor the interval itself. Links pass it on to all
    that hangs together; none gets more than all of it, as in `wsim.judge.books.admissible.explain`.

    Args:
        asked: Force over mass and torque over m R of each body in N intervals in a row, (N, B, 6) [m/s^2].
        angle: As `turned` has it, (N, B) [rad].
        mass: (B,) [kg].
        hit: Where a contact, a stop or a rope gave it a blow, (N, B).
        unit: Which mechanism each body is of, (B,).
    """
    found = np.zeros(angle.shape)
    for each in np.unique(unit[angle.any(axis=0)]):  # what no tie holds turns no arm
        own = np.flatnonzero(unit == each)
        calm = np.asarray(~hit[:, own].any(axis=1))
        change = np.linalg.norm(np.diff(asked[:, own], axis=0), axis=2) * (calm[1:] & calm[:-1])[:, None]
        change = np.maximum(np.pad(change, ((1, 0), (0, 0))), np.pad(change, ((0, 1), (0, 0))))
        missed = angle[:, own] * change / 12.0
        most = (missed * mass[own]).max(axis=1, keepdims=True) / mass[own]
        found[:, own] = np.minimum(most, np.linalg.norm(missed, axis=1, keepdims=True))
    return found


def _of_joint(evidence: Evidence, joint: Joint, rows: list[int], size: Floats) -> Floats:
    """Of one joint's arms on some bodies, and its axis, (T - 1,) [rad]."""
    motion = evidence.motion
    if joint.kind == "compound" or joint.child_anchor is None:  # axes of both ends, at points of either
        rate = np.linalg.norm(motion.w[:, rows], axis=2).max(axis=1)
        return np.asarray(np.maximum(rate[1:], rate[:-1]) * motion.h)
    anchors = anchors_of(evidence, joint)
    angle = np.zeros(len(motion.h))
    for i in rows:
        arm = anchors.below - motion.com[:, i]
        length = np.maximum(np.linalg.norm(arm, axis=1), SHORT * size[i])
        angle = np.maximum(angle, np.linalg.norm(np.diff(arm, axis=0), axis=1) / np.minimum(length[1:], length[:-1]))
    if joint.kind in ("revolute", "prismatic"):
        axis = rotate(anchors.above_turn, np.eye(3)[AXES[joint.axis]][None])
        angle = np.maximum(angle, np.linalg.norm(np.diff(axis, axis=0), axis=1))
    return angle


def ranging(force: Floats) -> Floats:
    """What a force (T,) ranges over in each interval, by the frames at its ends and beside these, (T - 1,)."""
    if len(force) <= 1:
        return np.zeros(0)
    around = np.pad(force, 1, mode="edge")
    four = np.stack([around[k : k + len(force) - 1] for k in range(4)])
    found = np.pad(np.ptp(four, axis=0), 1, mode="edge")
    found[[1, -2]] = np.maximum(found[[1, -2]], found[[2, -3]])  # of what is beyond the first and the last nobody knows
    return np.asarray(found[1:-1])


def bent(way: Floats) -> Floats:
    """What the mean of both ends may miss of ways (T, 6) in the mean of each interval, (T - 1, 2).

    Of one that turns with its end at a corner by j a quarter of what it turns by more than before, or after, at most;
    of one that bends evenly a twelfth.
    """
    if len(way) < 3:
        return np.zeros((len(way) - 1, 2))
    bends = np.linalg.norm(np.diff(way, n=2, axis=0).reshape(-1, 2, 3), axis=2)
    bends = np.pad(bends, ((1, 1), (0, 0)), mode="edge")
    return np.asarray(0.25 * np.maximum(bends[1:], bends[:-1]))
