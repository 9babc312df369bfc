"""Inertial measurement units: specific force and angular velocity in their own frames."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wsim.geometry.rotations import conjugate, lengths, rotate
from wsim.sim.sensor_mount import Mount

if TYPE_CHECKING:
    from wsim.sim.model import Built

Floats = NDArray[np.float64]


class IMU:
    """Reads one unit in W worlds.

    The specific force is (v - v0) / T - g, of the sensor's own point, whose velocity is that of the body's centre of
    mass and what turning adds; over the sample interval T, in the frame that the sensor has in its middle. Turning and
    gravity are then right to the second order of what it turns in an interval.

    Args:
        built: The model.
        k: Which of the world's sensors it is.
        interval: Between samples [s].
        seeds: What each world's noise differs by.

    Attributes:
        spans: Whether a sample tells of the time before it.
    """

    spans = True

    def __init__(self, built: Built, k: int, interval: float, seeds: Sequence[int]) -> None:
        self._mount, self._interval = Mount(built, k), interval
        bodies, stated = self._mount.bodies, self._mount.stated
        self._com = built.model.body_com.numpy()[bodies].astype(np.float64)
        self._gravity = np.array([built.world_of(w).gravity for w in range(len(stated))])
        self._before: tuple[Floats, Floats] | None = None
        parts = ("accelerometer", "gyroscope")
        self._bias = [np.array([getattr(each, f"{part}_bias") for each in stated]) for part in parts]
        # White noise of density N has the standard deviation N / sqrt(T) as the mean of an interval: what is summed of
        # it walks off by N sqrt(t), however often it is read.
        deviation = [np.array([[getattr(each, f"{part}_noise")] for each in stated]) for part in parts]
        self._deviation = [each / np.sqrt(interval) for each in deviation]
        self._random = self._mount.generators(built, seeds)

    def __call__(self, t: float, simulation: Any) -> dict[str, Floats]:
        """`accelerometer` [m/s^2] and `gyroscope` [rad/s], (W, 3) each.

        The first one, at the start, has no interval before it: it takes the sensor's point to move evenly.
        """
        place, turn = self._mount.frames(simulation.state)
        pose = simulation.state.body_q.numpy()[self._mount.bodies].astype(np.float64)
        motion = simulation.state.body_qd.numpy()[self._mount.bodies].astype(np.float64)
        spin = motion[:, 3:]
        velocity = motion[:, :3] + np.cross(spin, place - pose[:, :3] - rotate(pose[:, 3:], self._com))
        gained, middle = np.zeros_like(velocity), turn
        if self._before is not None:
            gained = (velocity - self._before[0]) / self._interval
            middle = _between(self._before[1], turn)
        self._before = velocity, turn
        force, turning = rotate(conjugate(middle), gained - self._gravity), rotate(conjugate(turn), spin)
        return {"accelerometer": self._told(force, 0), "gyroscope": self._told(turning, 1)}

    def _told(self, true: Floats, part: int) -> Floats:
        off = self._bias[part]
        if self._deviation[part].any():
            off = off + self._deviation[part] * np.array([random.standard_normal(3) for random in self._random])
        return true + off


def _between(a: Floats, b: Floats) -> Floats:
    """Rotations half way from a to b, (W, 4) each, less than half a turn apart."""
    same_side = np.where(np.sum(a * b, axis=1, keepdims=True) < 0.0, -1.0, 1.0)
    total = a + same_side * b
    return total / np.maximum(lengths(total), 1e-12)[:, None]
