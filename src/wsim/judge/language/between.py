"""How something goes between two frames: its places and its velocities say more of its way than the frames alone.

Where it goes smoothly its way is the cubic that has both frames' places and velocities. In an interval with a blow it
goes on from the frame before as it went there, and comes to the next one as it goes then: where the two courses meet,
there was the blow.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import lengths

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]
    Rows = NDArray[np.intp]

UNLIKE = 0.5  # of what the velocity gains in the intervals around: what differs from it by more is a blow


@dataclass(eq=False)
class Course:
    """Places (W, T, C) of W points and their velocities at times (T,), and what they gain where nothing else acts (C,).

    Intervals are counted by the frame before them, T - 1 of them.
    """

    time: Floats
    place: Floats
    velocity: Floats
    pull: Floats

    @cached_property
    def h(self) -> Floats:
        """The intervals' lengths, (T - 1,) [s]."""
        return np.diff(self.time)

    @cached_property
    def _gains(self) -> tuple[Floats, Floats, Floats]:
        """Accelerations in each interval, in the one before it and in that after it, (W, T - 1, C)."""
        own = np.diff(self.velocity, axis=1) / self.h[:, None]
        fall = np.broadcast_to(self.pull, own[:, :1].shape)
        around = np.concatenate([fall, own, fall], axis=1)
        return own, around[:, :-2], around[:, 2:]

    @cached_property
    def struck(self) -> Bools:
        """Where the velocity changes otherwise than around, and in a fall, (W, T - 1)."""
        own, before, after = self._gains
        if not own.shape[1]:
            return np.zeros(own.shape[:2], dtype=bool)
        odd = np.min([lengths(own - other) for other in (before, after, np.zeros_like(own) + self.pull)], axis=0)
        usual = np.maximum(float(np.linalg.norm(self.pull)), UNLIKE * (lengths(before) + lengths(after)))
        return np.asarray(odd > usual)

    def speeding(self, first: Rows, last: Rows, w: Rows) -> tuple[Floats, Floats]:
        """Accelerations before and after blows between frames `first` and `last` of worlds w, (N, C) each."""
        own, count = self._gains[0], len(self.h)

        def known(interval: Rows) -> Floats:
            at = np.clip(interval, 0, count - 1)
            free = (interval >= 0) & (interval < count) & ~self.struck[w, at]
            return np.where(free[:, None], own[w, at], self.pull)

        return known(first - 1), known(last)

    def meet(self, first: Rows, last: Rows, w: Rows) -> tuple[Floats, Floats, Floats, Floats]:
        """Blows between frames `first` and `last` of worlds w, N of them, each where both courses meet.

        Returns:
            How long after the first frame it is (N,) [s], where (N, C), and the velocities before and after it (N, C).
        """
        a, b = self.speeding(first, last, w)
        x, y = self.place[w, first], self.place[w, last]
        u, v = self.velocity[w, first], self.velocity[w, last]
        span = (self.time[last] - self.time[first])[:, None]
        apart = x - (y - v * span + 0.5 * b * span**2)
        gone = ((x + u * span + 0.5 * a * span**2) - y - apart) / span  # but for a - b, a line
        when = -np.sum(apart * gone, axis=1, keepdims=True)
        when = np.clip(when / np.maximum(np.sum(gone * gone, axis=1, keepdims=True), 1e-30), 0.0, span)
        rest = when - span
        place = 0.5 * (x + u * when + 0.5 * a * when**2 + y + v * rest + 0.5 * b * rest**2)
        return when[:, 0], place, u + a * when, v + b * rest

    def samples(self, w: Rows, k: Rows, parts: int) -> Floats:
        """Places at even moments of intervals k of worlds w, both frames included, (N, parts + 1, C)."""
        h = self.h[k, None, None]
        s = np.linspace(0.0, 1.0, parts + 1)[:, None] * h
        x, y, u, v = (of[w, at][:, None] for of in (self.place, self.velocity) for at in (k, k + 1))
        r = s / h
        bent, rise = (u + v) * h - 2.0 * (y - x), y - x
        found: Floats = x + r * (u * h + r * (3.0 * rise - (2.0 * u + v) * h + r * bent))
        n = np.flatnonzero(self.struck[w, k])
        if len(n):
            when = self.meet(k[n], k[n] + 1, w[n])[0][:, None, None]
            a, b = (each[:, None] for each in self.speeding(k[n], k[n] + 1, w[n]))
            # The moment nearest to the blow is that of the blow.
            s, h = np.where(np.abs(s[n] - when) <= 0.5 * h[n] / parts, when, s[n]), h[n]
            before, after = x[n] + u[n] * s + 0.5 * a * s**2, y[n] + v[n] * (s - h) + 0.5 * b * (s - h) ** 2
            found[n] = np.where(s <= when, before, after)
        return found

    # ---- extremes along a direction
    def least(self, along: Floats) -> Floats:
        """The least coordinate along a direction (C,) in each interval, its frames included, (W, T - 1)."""
        x, v = self.place @ along, self.velocity @ along
        found = np.minimum(x[:, :-1], x[:, 1:])
        found = np.minimum(found, _least_of_cubic(x, v, self.h))
        w, k = np.nonzero(self.struck)
        if len(w):
            found[w, k] = self._least_of_blows(along, w, k)
        return np.where(np.isnan(x[:, :-1] + x[:, 1:]), np.nan, found)

    def greatest(self, along: Floats) -> Floats:
        """The greatest coordinate along a direction, likewise."""
        return -self.least(-along)

    def _least_of_blows(self, along: Floats, w: Rows, k: Rows) -> Floats:
        when, place, _, _ = self.meet(k, k + 1, w)
        a, b = (each @ along for each in self.speeding(k, k + 1, w))
        x, v = self.place @ along, self.velocity @ along
        found = np.minimum(np.minimum(x[w, k], x[w, k + 1]), place @ along)
        before = _vertex(x[w, k], v[w, k], a, 0.0, when)
        after = _vertex(x[w, k + 1], v[w, k + 1], b, when - self.h[k], 0.0)
        return np.asarray(np.minimum(found, np.minimum(before, after)))


def _vertex(x: Floats, v: Floats, a: Floats, low: Floats | float, high: Floats | float) -> Floats:
    """The least of x + v s + a s^2 / 2 where that turns between two moments, else infinity."""
    up = a > 0.0
    s = -v / np.where(up, a, 1.0)
    return np.where(up & (s > low) & (s < high), x + 0.5 * v * s, np.inf)


def _least_of_cubic(x: Floats, v: Floats, h: Floats) -> Floats:
    """The least inside of each interval of the cubic through both frames (W, T - 1), else infinity."""
    start, end, rise = v[:, :-1] * h, v[:, 1:] * h, np.diff(x, axis=1)
    # x + start s + q s^2 + c s^3, s from 0 to 1
    c, q = start + end - 2.0 * rise, 3.0 * rise - 2.0 * start - end
    under = q * q - 3.0 * c * start
    root = np.sqrt(np.maximum(under, 0.0))
    # It turns upwards where the second derivative, 2 root, is positive; -start / (q + root) loses no digits to c.
    below = q + root
    s = np.where(below != 0.0, -start / np.where(below != 0.0, below, 1.0), np.inf)
    inside = (under > 0.0) & (s > 0.0) & (s < 1.0)
    s = np.where(inside, s, 0.0)
    return np.where(inside, x[:, :-1] + s * (start + s * (q + s * c)), np.inf)


def peaks(values: Floats, between: Floats) -> Floats:
    """Numbers at frames (W, T), or how high they go in the intervals beside (W, T - 1) where they turn back there."""
    turns = between > np.maximum(values[:, :-1], values[:, 1:])
    high = np.where(turns, between, -np.inf)
    edge = np.full_like(values[:, :1], -np.inf)
    return np.maximum(values, np.maximum(np.concatenate([edge, high], axis=1), np.concatenate([high, edge], axis=1)))


def turned(rate: Floats, s: Floats) -> Floats:
    """Quaternions (N, P, 4) of a turn at rates (N, 3) [rad/s] for times (N, P) [s]."""
    speed = np.linalg.norm(rate, axis=-1)
    axis = rate / np.where(speed > 0.0, speed, 1.0)[:, None]
    half = speed[:, None] * s / 2
    return np.concatenate([axis[:, None] * np.sin(half)[..., None], np.cos(half)[..., None]], axis=-1)
