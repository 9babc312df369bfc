"""Pendulums of many worlds: what a swinging body turns about, and how long a swing takes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


@dataclass
class Pendulum:
    """A rigid body on a hinge in each of W worlds."""

    angle: Floats  # of its centre of mass from the vertical, about the hinge, (W, T) [rad]
    rate: Floats  # of that, (W, T) [rad/s]
    mass: Floats  # (W,) [kg]
    arm: Floats  # from the hinge's axis to the centre of mass, (W,) [m]
    inertia: Floats  # about the hinge's axis, (W,) [kg m^2]


def swing_stretch(amplitude: Floats | float) -> Floats:
    """How much longer a pendulum's period is than that of a small swing, at an amplitude [rad].

    1 / agm(1, cos(amplitude / 2)), the arithmetic-geometric mean, which is exact.
    """
    a, b = np.broadcast_arrays(1.0, np.maximum(np.cos(np.asarray(amplitude) / 2), 1e-12))
    for _ in range(40):  # it doubles its digits each time; a swing from upside down needs the most
        a, b = (a + b) / 2, np.sqrt(a * b)
    return np.asarray(1.0 / a)


def period_of(swing: Pendulum, gravity: float) -> Floats:
    """The period of a physical pendulum at its largest angle, (W,) [s]; NaN where it has no arm, or nothing pulls."""
    torque = swing.mass * gravity * swing.arm
    small = 2 * math.pi * np.sqrt(swing.inertia / np.where(torque > 0.0, torque, np.nan))
    return np.asarray(small * swing_stretch(np.nanmax(np.abs(swing.angle), axis=1)))


def pivot_of(centre: Floats, velocity: Floats, spin: Floats) -> tuple[Floats, Floats]:
    """The fixed point that a body's centre of mass turns about, and the axis, of W worlds.

    The centre of a rotation is at c + w x v / w^2; the frames count as much as w^2. The axis is the direction of the
    greatest sum of w's squares.

    Args:
        centre: (W, T, 3) [m].
        velocity: Of the centre of mass, (W, T, 3) [m/s].
        spin: Angular velocity, (W, T, 3) [rad/s].

    Returns:
        The point (W, 3), the centre in a world that does not turn, and the unit axis (W, 3).
    """
    square = np.sum(spin * spin, axis=-1)
    weight = square.sum(axis=1)[:, None]
    summed = (square[..., None] * centre + np.cross(spin, velocity)).sum(axis=1)
    pivot = np.where(weight == 0.0, centre[:, 0], summed / np.where(weight == 0.0, 1.0, weight))
    moments = np.nan_to_num(np.einsum("wti,wtj->wij", spin, spin))
    return pivot, np.linalg.eigh(moments)[1][:, :, -1]
