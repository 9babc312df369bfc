"""How bodies go on from a frame, or came to it: where their courses meet, a blow was.

Between two frames bodies go on as they did before and as they will after, but for the blow itself. Where the course of
one frame, carried on, meets that of the next, carried back, there was the blow, short beside the frames; and its
impulses have the arms that bodies had then.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, lengths, multiply, rotate
from wsim.judge.books.forces import Poses
from wsim.judge.evidence.motion import FLOAT32

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]
    Rows = NDArray[np.intp]

FINE = 0.1  # of the time between frames: about a step, where nobody says how long one is
WITHIN = 0.2  # of a step: courses that pass each other by no more of the jump meet


def step_of(evidence: Evidence) -> float:
    """The simulator's time step [s]."""
    known = evidence.recording.metadata.get("time_step") or evidence.world.time_step
    return float(known or FINE * evidence.motion.dt_frames)


class Courses:
    """How bodies go on from a frame, or came to it: with what sped them up in the interval before, or after."""

    def __init__(self, evidence: Evidence, changed: Bools) -> None:
        self.evidence, self.changed, motion = evidence, changed, evidence.motion
        self._met: dict[tuple[int, ...], float | None] = {}
        self.dt = step_of(evidence)
        falls = np.where(motion.kinematic[:, None], 0.0, motion.gravity[None])
        # (T - 1, B, 6), in an interval without a blow; in one with it, and beyond the ends, gravity's.
        own = np.concatenate([np.diff(motion.v, axis=0), np.diff(motion.w, axis=0)], axis=2) / motion.h[:, None, None]
        fall = np.concatenate([falls, np.zeros_like(falls)], axis=1)[None]
        known = np.where(changed[..., None], fall, own)
        # How far its steps take a body from its course in the intervals around.
        trapezoid = 0.5 * (motion.v[1:] + motion.v[:-1]) * motion.h[:, None, None]
        own = np.where(changed, 0.0, np.linalg.norm(np.diff(motion.com, axis=0) - trapezoid, axis=2))
        none = np.zeros((1, own.shape[1]))
        self.strays = np.minimum(np.concatenate([none, own[:-1]]), np.concatenate([own[1:], none]))
        self.before = np.concatenate([fall, known[:-1]])
        self.after = np.concatenate([known[1:], fall])
        # How what speeds bodies up changes from one interval to the next, where neither has a blow, (T - 2, B, 6).
        self._changes = np.where((changed[1:] | changed[:-1])[..., None], 0.0, np.diff(known, axis=0))

    def at(self, k: int, side: int, when: float, rows: list[int] | None = None) -> Poses:
        """Bodies `when` [s] after frame k, as they went before a blow in the interval (0), or after it (1).

        All of them, or those of some rows.
        """
        motion, frame, by = self.evidence.motion, *self._since(k, side, when)
        some = slice(None) if rows is None else rows
        v, com = self._going(k, side, when, some)
        rate = motion.w[frame, some]
        w = rate + (self.after if side else self.before)[k, some, 3:] * by
        angle = 0.5 * (rate + w) * by
        size = lengths(angle)[:, None]
        turn = np.concatenate([angle / np.maximum(size, 1e-12) * np.sin(0.5 * size), np.cos(0.5 * size)], axis=1)
        q = self.evidence.body_q[frame, some]
        place = com + rotate(turn, q[:, :3] - motion.com[frame, some])
        return Poses(np.concatenate([place, multiply(turn, q[:, 3:])], axis=1), com, v, w)

    def off(self, k: int, side: int, when: float) -> Floats:
        """By how much velocities and rates at `when` may be off, as what speeds bodies up changes, (B, 6) [m/s, rad/s].

        A course has what sped its body up in the interval next to it, on the whole as in the middle of that; what spins
        about another axis than its own, as a coin on its rim, has its torque and its rates go round meanwhile.
        """
        at, by, h = (k + 1 if side else k - 2), abs(self._since(k, side, when)[1]), float(self.evidence.motion.h[k])
        if not 0 <= at < len(self._changes):
            return np.zeros((len(self.evidence.motion.mass), 6))
        found: Floats = self._changes[at] / h * 0.5 * (h + by) * by
        return found

    def _going(self, k: int, side: int, when: float, rows: list[int] | slice) -> tuple[Floats, Floats]:
        """Velocities and centres of mass, as `at`."""
        motion, frame, by = self.evidence.motion, *self._since(k, side, when)
        before = motion.v[frame, rows]
        v = before + (self.after if side else self.before)[k, rows, :3] * by
        return v, motion.com[frame, rows] + 0.5 * (before + v) * by

    def _since(self, k: int, side: int, when: float) -> tuple[int, float]:
        """The frame that a course is told from, and how long after it that is [s]."""
        return k + side, when - side * float(self.evidence.motion.h[k])

    def meet(self, k: int, rows: list[int]) -> float | None:
        """When [s] after frame k the courses of some bodies before and after one blow meet; None if they do not."""
        key = k, *rows
        if key not in self._met:
            self._met[key] = self._meet(k, rows)
        return self._met[key]

    def _meet(self, k: int, rows: list[int]) -> float | None:
        motion, h = self.evidence.motion, float(self.evidence.motion.h[k])
        ends = [[self._going(k, side, when, rows)[1] for side in (0, 1)] for when in (0.0, h)]
        first, last = (before - after for before, after in ends)
        apart, gone = first, (last - first) / h  # but for what speeds up differently, a line
        when = float(-np.sum(apart * gone) / max(np.sum(gone * gone), 1e-12))
        when = min(max(when, 0.0), h)
        before, after = (self.at(k, side, when, rows) for side in (0, 1))
        far = lengths(before.com - after.com)
        jump = lengths(after.v - before.v)
        rounding = 4.0 * FLOAT32 * lengths(motion.com[k, rows])
        if np.any(far > WITHIN * jump * self.dt + 2.0 * self.strays[k, rows] + rounding):
            return None
        turn = multiply(after.q[:, 3:], conjugate(before.q[:, 3:]))
        angle = 2.0 * lengths(turn[:, :3])
        rate, spun = np.maximum(lengths(before.w), lengths(after.w)), lengths(after.w - before.w)
        if np.any(angle > spun * self.dt + 0.1 * (rate * h) ** 2 + 8.0 * FLOAT32):
            return None
        return when
