"""What policies are told: commands by time, or the way along a route; brought on slowly, and trimmed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from wsim.assets.policies import AXES, Trim
from wsim.scene.world import Policy

Floats = NDArray[np.float64]

NEAR = 0.15  # [m] to a way-point, where the next one is gone for
APPROACH = 1.0  # [1/s]: speed towards the last point for each metre to it, where that is less than the route's
TURN = 2.0  # [1/s]: rate of turning for each radian


class Commands:
    """What each of W worlds is told, brought on slowly and trimmed.

    Args:
        policies: The policy as each world states it.
    """

    def __init__(self, policies: Sequence[Policy]) -> None:
        spec = policies[0].spec
        self._times = [np.array(each.times) for each in policies]
        self._commands = [np.array(each.commands) for each in policies]
        self._routes = _Routes(policies) if policies[0].route else None
        self._limit = np.array(spec.command_limit)
        self._most = None if spec.command_slew is None else np.array(spec.command_slew) / spec.rate
        self._now = np.zeros((len(policies), AXES))
        self._trim = _Trimmed(spec.trim, 1.0 / spec.rate, len(policies)) if spec.trim else None

    def at(self, t: float, measured: Floats, where: Floats) -> Floats:
        """(W, 3) at a time [s].

        Args:
            t: The time.
            measured: How fast the robots go along their headings, to their left, and turn, (W, 3).
            where: x, y [m] and heading [rad] of each, (W, 3).
        """
        wanted = self._routes.from_(where) if self._routes else self._stated(t)
        change = np.clip(wanted, -self._limit, self._limit) - self._now
        self._now += change if self._most is None else np.clip(change, -self._most, self._most)
        return self._now + self._trim.of(self._now, measured) if self._trim else self._now

    def _stated(self, t: float) -> Floats:
        rows = [max(0, int(np.searchsorted(times, t + 1e-9, side="right")) - 1) for times in self._times]
        return np.stack([commands[row] for commands, row in zip(self._commands, rows, strict=True)])


class _Routes:
    """Brings each robot from one way-point to the next, and holds it at the last; the next one comes within `NEAR`."""

    def __init__(self, policies: Sequence[Policy]) -> None:
        self._points = [np.array(each.route) for each in policies]
        self._speeds = np.array([each.speed for each in policies])
        self._next = [0 for _ in policies]

    def from_(self, where: Floats) -> Floats:
        """What robots at `where` are told, (W, 3): straight to the point, turning to its heading on the way."""
        goals = np.stack([self._goal(w, at) for w, at in enumerate(where)])
        way = goals[:, :2] - where[:, :2]
        left = np.linalg.norm(way, axis=1)
        last = [at == len(points) - 1 for at, points in zip(self._next, self._points, strict=True)]
        speed = np.where(last, np.minimum(self._speeds, APPROACH * left), self._speeds)
        velocity = way * (speed / np.maximum(left, 1e-9))[:, None]
        c, s = np.cos(where[:, 2]), np.sin(where[:, 2])
        off = np.angle(np.exp(1j * (goals[:, 2] - where[:, 2])))  # the shorter way round
        ahead = c * velocity[:, 0] + s * velocity[:, 1]
        aside = c * velocity[:, 1] - s * velocity[:, 0]
        return np.stack([ahead, aside, TURN * off], axis=1)

    def _goal(self, w: int, at: Floats) -> Floats:
        points = self._points[w]
        while self._next[w] < len(points) - 1 and np.linalg.norm(points[self._next[w], :2] - at[:2]) < NEAR:
            self._next[w] += 1
        return np.asarray(points[self._next[w]])


class _Trimmed:
    """The integral of how far the measured, smoothed, is from what is wanted."""

    def __init__(self, trim: Trim, dt: float, worlds: int) -> None:
        self._dt, self._share = dt, dt / (trim.smoothing + dt)
        self._gain, self._limit = np.array(trim.gain), np.array(trim.limit)
        self._measured, self._sum = np.zeros((worlds, AXES)), np.zeros((worlds, AXES))

    def of(self, wanted: Floats, measured: Floats) -> Floats:
        self._measured += self._share * (measured - self._measured)
        more = self._gain * (wanted - self._measured) * self._dt
        self._sum = np.clip(self._sum + more, -self._limit, self._limit)
        return self._sum
