"""Smooth motion through key frames: exact at the keys; its velocity never jumps, and its place never overshoots.

Between two keys the place is a cubic of time, with slopes at the keys that keep it monotone in each coordinate (Fritsch
and Butland 1984, the harmonic mean of the slopes on both sides): what waits between two equal keys stands still. The
rotation is that of the earlier key times the exponential of such a cubic, whose slopes are chosen so that the angular
velocity is the same from both sides (the end's by the inverse of the exponential's right Jacobian, Chirikjian 2011).
Before the first key and after the last it holds, and comes there with no speed, unless it repeats.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wsim.geometry.rotations import conjugate, multiply, rotate

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Curve:
    """A motion in pieces, one from each key to the next; K keys.

    Attributes:
        times: Of the keys [s], (K,).
        place: Coefficients of 1, s, s^2, s^3 with s the time since the piece's key, (K - 1, 4, 3) [m].
        base: Rotation at the piece's key, xyzw, (K - 1, 4).
        turn: The same of the rotation vector that follows `base`, in its axes, (K - 1, 4, 3) [rad].
        repeat: Whether it starts anew after the last key.
    """

    times: Floats
    place: Floats
    base: Floats
    turn: Floats
    repeat: bool

    @classmethod
    def through(cls, times: ArrayLike, places: ArrayLike, rotations: ArrayLike, repeat: bool = False) -> Curve:
        """The motion through keys: times (K,) [s] that rise, places (K, 3) [m], rotations (K, 4) xyzw; K of 2 or more.

        One that repeats ends as it begins.
        """
        t = np.asarray(times, dtype=np.float64)
        x = np.asarray(places, dtype=np.float64).reshape(-1, 3)
        q = np.asarray(rotations, dtype=np.float64).reshape(-1, 4)
        q = q / np.linalg.norm(q, axis=1, keepdims=True)
        h = np.diff(t)[:, None]
        step = np.diff(x, axis=0)
        slope = slopes(step / h, h, repeat)
        vector = logarithm(multiply(conjugate(q[:-1]), q[1:]))
        rate = slopes(vector / h, h, repeat)
        ends = np.array([np.linalg.solve(_right_jacobian(v), w) for v, w in zip(vector, rate[1:], strict=True)])
        return cls(
            t,
            np.concatenate([x[:-1, None], _cubic(step, slope[:-1], slope[1:], h)], axis=1),
            q[:-1],
            np.concatenate([np.zeros((len(h), 1, 3)), _cubic(vector, rate[:-1], ends, h)], axis=1),
            repeat,
        )

    def pose(self, time: float) -> tuple[Floats, Floats]:
        """Place (3,) [m] and rotation (4,) xyzw at a time [s]."""
        t = self._within(time)
        k = int(np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.base) - 1))
        powers = (t - self.times[k]) ** np.arange(4.0)
        return powers @ self.place[k], multiply(self.base[k], exponential(powers @ self.turn[k]))

    def velocity(self, time: float) -> tuple[Floats, Floats]:
        """Velocity (3,) [m/s] and angular velocity (3,) [rad/s] in the world's axes, from a time [s] on."""
        if time < self.times[0] or (time >= self.times[-1] and not self.repeat):
            return np.zeros(3), np.zeros(3)
        t = self._within(time)
        k = int(np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.base) - 1))
        s = t - self.times[k]
        slopes = np.array([0.0, 1.0, 2.0 * s, 3.0 * s**2])
        vector = s ** np.arange(4.0) @ self.turn[k]
        turned = multiply(self.base[k], exponential(vector))
        return slopes @ self.place[k], rotate(turned, _right_jacobian(vector) @ (slopes @ self.turn[k]))

    def _within(self, time: float) -> float:
        first, last = float(self.times[0]), float(self.times[-1])
        if self.repeat and time > last:
            return first + (time - first) % (last - first)
        return min(max(time, first), last)

    def speeds(self) -> tuple[Floats, Floats]:
        """Greatest speed [m/s] and rate of turning [rad/s] within each piece, (K - 1,) each, of a sample of it."""
        found = []
        for coefficients in (self.place, self.turn):
            s = np.linspace(0.0, 1.0, 17)[None, :, None] * np.diff(self.times)[:, None, None]
            c1, c2, c3 = (coefficients[:, n, None, :] for n in (1, 2, 3))
            found.append(np.linalg.norm(c1 + 2.0 * c2 * s + 3.0 * c3 * s**2, axis=2).max(axis=1))
        return found[0], found[1]


def slopes(secants: Floats, h: Floats, repeat: bool = False) -> Floats:
    """Slopes at K keys, (K, ...), from those between them, (K - 1, ...), and the times between, (K - 1, ...) [s]."""
    before, after = secants, np.roll(secants, -1, axis=0)
    width, next_width = h, np.roll(h, -1, axis=0)
    share = (width + 2.0 * next_width) / (3.0 * (width + next_width))
    same = before * after > 0.0
    mean = share * after + (1.0 - share) * before
    inner = np.divide(before * after, mean, out=np.zeros_like(before), where=same)
    inner = np.where(same, inner, 0.0)
    if repeat:
        return np.concatenate([inner[-1:], inner])
    inner[-1] = 0.0
    return np.concatenate([np.zeros_like(secants[:1]), inner])


def hermite(s: Floats, step: ArrayLike, start: ArrayLike, end: ArrayLike, h: ArrayLike) -> Floats:
    """How far what goes by `step` in `h`, with these slopes at its ends, has come at times `s` since; all broadcast."""
    step, start, end, h = (np.asarray(each, dtype=np.float64) for each in (step, start, end, h))
    square = (3.0 * step / h - 2.0 * start - end) / h
    cube = (start + end - 2.0 * step / h) / h**2
    return s * (start + s * (square + s * cube))


def _cubic(step: Floats, start: Floats, end: Floats, h: Floats) -> Floats:
    """Coefficients of s, s^2, s^3, (n, 3, 3), of what goes by `step` in `h` with these slopes at its ends."""
    square = (3.0 * step / h - 2.0 * start - end) / h
    cube = (start + end - 2.0 * step / h) / h**2
    return np.stack([start, square, cube], axis=1)


def logarithm(q: Floats) -> Floats:
    """Rotation vectors (..., 3) of quaternions (..., 4), of half a turn at most [rad]."""
    q = np.where(q[..., 3:] < 0.0, -q, q)
    sine = np.linalg.norm(q[..., :3], axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(sine, q[..., 3:])
    return q[..., :3] * np.divide(angle, sine, out=np.full_like(sine, 2.0), where=sine > 1e-12)


def exponential(vector: Floats) -> Floats:
    """Quaternions (..., 4) of rotation vectors (..., 3) [rad]."""
    angle = np.linalg.norm(vector, axis=-1, keepdims=True)
    return np.concatenate([vector * 0.5 * np.sinc(angle / (2.0 * np.pi)), np.cos(0.5 * angle)], axis=-1)


def _right_jacobian(vector: Floats) -> Floats:
    """What turns the rate of a rotation vector into the angular velocity in the turned axes, (3, 3)."""
    angle = float(np.linalg.norm(vector))
    x, y, z = vector
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    if angle < 1e-4:
        return np.eye(3) - 0.5 * cross + cross @ cross / 6.0
    first, second = (1.0 - np.cos(angle)) / angle**2, (angle - np.sin(angle)) / angle**3
    return np.eye(3) - first * cross + second * cross @ cross
