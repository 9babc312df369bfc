"""What springs, drives and dry friction give between two frames where a blow may come.

A blow leaves places as they are and changes speeds at once. A damper's mean force is its constant times the mean rate,
and that is how far the length went over the time, whenever the blow came. The mean of the length itself is the mean of
both ends', less d h / 12 where the rate changes evenly by d over the interval h, and less s (1 - s) j h / 2 where it
jumps by j after a share s of it, which follows from how far the length went; several jumps the same way do less.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.evidence.motion import FLOAT32

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]


def struck(evidence: Evidence, jerks: Iterable[tuple[Iterable[int], Bools]]) -> Bools:
    """Where the speeds of each body's mechanism may jump: at contacts, stops and ropes, (T - 1, B).

    Args:
        evidence: Of the run.
        jerks: Rows of bodies, and when a stop or a rope may jerk them, (T - 1,); a row below 0 stands still.
    """
    motion = evidence.motion
    hit = _touched(evidence)
    for rows, when in jerks:
        for row in rows:
            if row >= 0:
                hit[:, row] |= when
    for unit in np.unique(motion.unit):
        rows = np.flatnonzero(motion.unit == unit)
        hit[:, rows] = hit[:, rows].any(axis=1, keepdims=True)
    return hit


def _touched(evidence: Evidence) -> Bools:
    """Which bodies a contact pushed between frames, (T - 1, B), as is recorded; or where some may have."""
    world, contacts = evidence.world, evidence.recording.contacts
    hit = np.zeros((len(evidence.time), len(world.bodies)), dtype=bool)
    if contacts is None:
        return evidence.motion.meets.copy()
    owner = np.array([i for i, body in enumerate(world.bodies) for _ in body.shapes], dtype=np.intp)
    for side in (0, 1):
        moves = contacts.pair[:, side] < len(owner)
        hit[contacts.frame[moves], owner[contacts.pair[moves, side]]] = True
    return hit[1:]


def mean_place(place: Floats, rate: Floats, h: Floats) -> tuple[Floats, Floats]:
    """The least and the most that the mean of a length over each interval may be, (T - 1,) each.

    Its rate changes evenly by as much as in this interval, the one before or the one after, and in jumps by the rest.

    Args:
        place: The length, or an angle, at each frame, (T,).
        rate: Of its change, (T,).
        h: Lengths of the intervals, (T - 1,) [s].
    """
    gained, speeds = np.diff(rate), np.diff(rate) / h
    around = np.pad(speeds, 1, mode="edge")
    middle, found = 0.5 * (place[1:] + place[:-1]), []
    for speeding in (speeds, around[:-2], around[2:]):
        evenly = speeding * h
        jump = gained - evenly
        size = np.where(np.abs(jump) > 1e-12, jump, np.inf)
        after = np.clip((np.diff(place) / h - rate[:-1] - 0.5 * evenly) / size, 0.0, 1.0)
        smooth = middle - h * evenly / 12.0
        found += [smooth, smooth - 0.5 * after * (1.0 - after) * h * jump]
    return np.min(found, axis=0), np.max(found, axis=0)


def mean_force(gains: tuple[float, float], place: Floats, rate: Floats, h: Floats, dt: float) -> tuple[Floats, Floats]:
    """The mean of stiffness x length + damping x rate over each interval, and by how much it may be off, (T - 1,).

    The sum over a step's starts, not over time, is less by half the change of the length, and by all of the rate's, of
    a step: lengths go by the rates at the ends of steps.
    """
    low, high = mean_place(place, rate, h)
    far, faster = np.diff(place), np.diff(rate)
    late = np.minimum(dt / h, 1.0) * (0.5 * gains[0] * far + gains[1] * faster)
    mean = 0.5 * gains[0] * (low + high) + gains[1] * far / h - 0.5 * late
    return mean, 0.5 * gains[0] * (high - low) + 0.5 * np.abs(late)


def strayed(place: Floats, rate: Floats, h: Floats) -> Floats:
    """How far a length goes beside what its rates at both ends give, here or in the intervals beside, (T - 1,)."""
    bend = h / 12.0 * np.diff(np.gradient(rate)) if len(rate) > 1 else np.zeros(0)
    off = np.pad(np.abs(np.diff(place) - 0.5 * (rate[1:] + rate[:-1]) * h + bend), 1, mode="edge")
    found: Floats = np.max([off[:-2], off[1:-1], off[2:]], axis=0)
    return found


def between(place: Floats, rate: Floats, h: Floats) -> Bools:
    """Where a length goes as far as at some rate between those of both ends, or of an even change, (T - 1,).

    Else it went faster than at either end, or the other way, for a while.
    """
    bend = h / 12.0 * np.abs(np.diff(np.gradient(rate))) if len(rate) > 1 else np.zeros(0)
    off = bend + 8.0 * FLOAT32 * np.abs(place).max(initial=np.pi)
    low, high = np.minimum(rate[1:], rate[:-1]) * h, np.maximum(rate[1:], rate[:-1]) * h
    return np.asarray((np.diff(place) >= low - off) & (np.diff(place) <= high + off))


def reversed_share(place: Floats, rate: Floats, h: Floats, dt: float) -> Floats:
    """The most of each interval for which a joint may go back though it goes one way at both ends, (T - 1,).

    By one jump, and a speed that else changes evenly as around: how far the joint went tells when the jump was, to a
    step. Where no such course goes as far, it went for a share of the time at no more than its fastest, that at both
    ends and what it gains in this interval, the one before or the one after, and back for the rest.
    """
    way, gained = np.sign(rate[1:]), np.diff(rate)
    start, mean, step = way * rate[:-1], way * np.diff(place) / h, np.minimum(dt / h, 1.0)
    around = np.pad(gained / h, 1, mode="edge")
    most, fits = np.zeros(len(h)), np.abs(mean - start - 0.5 * way * gained) <= step * np.abs(gained)
    for speeding in (around[:-2], around[2:]):
        evenly = way * speeding * h
        jump = way * gained - evenly
        after = (mean - start - 0.5 * evenly) / np.where(np.abs(jump) > 1e-12, jump, np.inf)
        can = (after >= 0.0) & (after <= 1.0) & (np.abs(jump) > 1e-12)
        back = _below(start, evenly, 0.0, 1.0 - after) + _below(start + jump, evenly, 1.0 - after, 1.0)
        most = np.maximum(most, np.where(can & (back > 0.0), back + step, 0.0))
        fits |= can
    speed, jumps = np.abs(rate), np.abs(around) * np.pad(h, 1, mode="edge")
    fastest = np.maximum(speed[1:], speed[:-1]) + np.max([jumps[:-2], jumps[1:-1], jumps[2:]], axis=0)
    found: Floats = np.where(fits, most, 1.0 - mean / np.maximum(fastest, 1e-30))
    return np.clip(found, 0.0, 1.0)


def _below(start: Floats, slope: Floats, first: Floats | float, last: Floats | float) -> Floats:
    """For how long `start` + `slope` x is below zero from `first` to `last`, (n,)."""
    flat = np.abs(slope) < 1e-12
    zero = np.clip(-start / np.where(flat, 1.0, slope), first, last)
    found: Floats = np.where(slope < 0.0, last - zero, zero - first)
    return np.where(flat, np.where(start < 0.0, last - np.asarray(first), 0.0), found)
