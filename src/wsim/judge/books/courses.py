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
    from collections.abc import Sequence

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
    """How bodies go on from a frame, or came to it: with what sped them up in the interval before, or after.

    Of several recordings over the same times, of worlds that are `similar`, intervals and frames stand one after
    another: N = W (T - 1) intervals, of which `at` takes one, or as many as there are moments.
    """

    def __init__(self, copies: Sequence[Evidence], changed: Bools) -> None:
        """Of W copies; `changed` says of each interval whether a body has a blow in it, (N, B)."""
        self.copies, motions = copies, [evidence.motion for evidence in copies]
        self._met: dict[tuple[int, tuple[int, ...]], float | None] = {}
        self.count = len(motions[0].h)  # intervals of each copy
        self.dt = np.array([step_of(evidence) for evidence in copies])  # (W,)
        self._h = motions[0].h
        self._q, self._com, self._v, self._w = (
            np.stack([getattr(motion, name) for motion in motions]) for name in ("q", "com", "v", "w")
        )  # (W, T, B, ...)
        h, blow = self._h[:, None, None], changed.reshape(len(copies), self.count, -1)
        falls = np.where(motions[0].kinematic[:, None], 0.0, motions[0].gravity[None])
        # (W, T - 1, B, 6), in an interval without a blow; in one with it, and beyond the ends, gravity's.
        own = np.concatenate([np.diff(self._v, axis=1), np.diff(self._w, axis=1)], axis=3) / h
        fall = np.concatenate([falls, np.zeros_like(falls)], axis=1)
        known = np.where(blow[..., None], fall, own)
        # How far its steps take a body from its course in the intervals around.
        trapezoid = 0.5 * (self._v[:, 1:] + self._v[:, :-1]) * h
        strays = np.where(blow, 0.0, lengths(np.diff(self._com, axis=1) - trapezoid))
        none = np.zeros_like(strays[:, :1])
        self.strays = np.minimum(
            np.concatenate([none, strays[:, :-1]], axis=1), np.concatenate([strays[:, 1:], none], axis=1)
        )
        beyond = np.broadcast_to(fall, known[:, :1].shape)
        self.before = np.concatenate([beyond, known[:, :-1]], axis=1)
        self.after = np.concatenate([known[:, 1:], beyond], axis=1)
        # How what speeds bodies up changes from one interval to the next, where neither has a blow, (W, T - 2, B, 6).
        self._changes = np.where((blow[:, 1:] | blow[:, :-1])[..., None], 0.0, np.diff(known, axis=1))

    def at(self, k: int | Rows, side: int, when: float | Floats, rows: Rows | None = None) -> Poses:
        """Bodies `when` [s] after the frame before interval k, as they went before a blow in it (0), or after it (1).

        All of them, or those of some rows, (R,), or of each interval (K, R): (R, ...), or (K, R, ...) of K intervals
        and moments.
        """
        copy, interval = np.divmod(k, self.count)
        by, frame = self._since(interval, side, when), interval + side
        v, com = self._going(k, side, when, rows)
        rate = _of(self._w, copy, frame, rows)
        w = rate + _of(self.after if side else self.before, copy, interval, rows)[..., 3:] * by
        angle = 0.5 * (rate + w) * by
        size = lengths(angle)[..., None]
        turn = np.concatenate([angle / np.maximum(size, 1e-12) * np.sin(0.5 * size), np.cos(0.5 * size)], axis=-1)
        q = _of(self._q, copy, frame, rows)
        place = com + rotate(turn, q[..., :3] - _of(self._com, copy, frame, rows))
        return Poses(np.concatenate([place, multiply(turn, q[..., 3:])], axis=-1), com, v, w)

    def off(self, k: int, side: int, when: float) -> Floats:
        """By how much velocities and rates at `when` may be off, as what speeds bodies up changes, (B, 6) [m/s, rad/s].

        A course has what sped its body up in the interval next to it, on the whole as in the middle of that; what spins
        about another axis than its own, as a coin on its rim, has its torque and its rates go round meanwhile.
        """
        copy, interval = divmod(k, self.count)
        at, by, h = interval + 1 if side else interval - 2, float(abs(self._since(interval, side, when))), self._h
        if not 0 <= at < self._changes.shape[1]:
            return np.zeros(self._changes.shape[2:])
        found: Floats = self._changes[copy, at] / h[interval] * 0.5 * (h[interval] + by) * by
        return found

    def _going(self, k: int | Rows, side: int, when: float | Floats, rows: Rows | None) -> tuple[Floats, Floats]:
        """Velocities and centres of mass, as `at`."""
        copy, interval = np.divmod(k, self.count)
        by, before = self._since(interval, side, when), _of(self._v, copy, interval + side, rows)
        v = before + _of(self.after if side else self.before, copy, interval, rows)[..., :3] * by
        return v, _of(self._com, copy, interval + side, rows) + 0.5 * (before + v) * by

    def _since(self, interval: int | Rows, side: int, when: float | Floats) -> Floats:
        """How long after the frame that a course is told from [s]: of one moment, or (K, 1, 1)."""
        by = np.asarray(when - side * self._h[interval])
        return by if by.ndim == 0 else by[:, None, None]

    def meet(self, asked: Sequence[tuple[int, tuple[int, ...]]]) -> list[float | None]:
        """When [s] after its first frame some bodies' courses before and after one blow meet, or None.

        Args:
            asked: Of each blow its interval, and the rows of its bodies.
        """
        new = [key for key in dict.fromkeys(asked) if key not in self._met]
        for count in sorted({len(rows) for _, rows in new}):
            alike = [key for key in new if len(key[1]) == count]
            found = self._meet(*(np.array(each, dtype=np.intp) for each in zip(*alike, strict=True)))
            self._met.update(zip(alike, found, strict=True))
        return [self._met[key] for key in asked]

    def _meet(self, ks: Rows, rows: Rows) -> list[float | None]:
        """Of some intervals (K,) and bodies in each, (K, R)."""
        copy, interval = np.divmod(ks, self.count)
        h, dt = self._h[interval], self.dt[copy][:, None]
        ends = [[self._going(ks, side, when, rows)[1] for side in (0, 1)] for when in (np.zeros_like(h), h)]
        first, last = (before - after for before, after in ends)
        apart, gone = first, (last - first) / h[:, None, None]  # but for what speeds up differently, a line
        when = -np.sum(apart * gone, axis=(1, 2)) / np.maximum(np.sum(gone * gone, axis=(1, 2)), 1e-12)
        when = np.minimum(np.maximum(when, 0.0), h)
        before, after = (self.at(ks, side, when, rows) for side in (0, 1))
        far, jump = lengths(before.com - after.com), lengths(after.v - before.v)
        rounding = 4.0 * FLOAT32 * lengths(_of(self._com, copy, interval, rows))
        strays = _of(self.strays[..., None], copy, interval, rows)[..., 0]
        apart_then = np.any(far > WITHIN * jump * dt + 2.0 * strays + rounding, axis=1)
        turn = multiply(after.q[..., 3:], conjugate(before.q[..., 3:]))
        angle = 2.0 * lengths(turn[..., :3])
        rate, spun = np.maximum(lengths(before.w), lengths(after.w)), lengths(after.w - before.w)
        turned = np.any(angle > spun * dt + 0.1 * (rate * h[:, None]) ** 2 + 8.0 * FLOAT32, axis=1)
        return [None if off else float(at) for at, off in zip(when, apart_then | turned, strict=True)]


def _of(values: Floats, copy: int | Rows, at: int | Rows, rows: Rows | None) -> Floats:
    """Of values (W, T, B, n) those of some copies and frames, of all bodies, or of rows (R,), or (K, R) of each."""
    if rows is None:
        return np.asarray(values[copy, at])
    if rows.ndim == 1:
        return np.asarray(values[copy, at][..., rows, :])
    return np.asarray(values[np.asarray(copy)[:, None], np.asarray(at)[:, None], rows])
