"""Heave of a box in waves by linear potential flow in a plane, by matched eigenfunctions (Mei & Black 1969).

J. Fluid Mech. 38, 499-511: under the box the potential of a heave of unit velocity is ((z + s)^2 - x^2) / (2 s) and a
sum of cosh(n pi x / s) cos(n pi z / s), z over the bed and s the gap; beside it waves that run off and modes that die
off. Pressures are matched over the gap, velocities over the whole depth. Added mass and damping are the potential's
integral over the bottom, the exciting force follows from the damping (Haskind's relation, Newman 1977, section 6.18).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

MODES = 40


@dataclass(frozen=True)
class Heave:
    """Of one metre of a box, per density of water."""

    added_mass: float
    """[m^2]"""
    damping: float
    """[m^2/s]"""
    far: float
    """Amplitude of the waves that it makes, over that of its heave."""
    response: float
    """Amplitude of its heave in waves over theirs."""


def wave_numbers(omega: float, depth: float, gravity: float) -> tuple[float, np.ndarray]:
    """That of the waves, and those of what dies off [1/m]."""
    nu = omega**2 / gravity
    k = brentq(lambda k: k * math.tanh(k * depth) - nu, 1e-9, nu + 10.0 / depth)
    ends = ((n - 0.5 + 1e-9) * math.pi / depth for n in range(1, MODES))
    dying = [brentq(lambda q: q * math.tan(q * depth) + nu, a, a + (0.5 - 1e-9) * math.pi / depth) for a in ends]
    return k, np.array(dying)


def heave(omega: float, depth: float, width: float, draft: float, gravity: float) -> Heave:
    """Heave of a box that floats freely, in waves of a frequency [rad/s]; lengths [m], gravity [m/s^2]."""
    k, dying = wave_numbers(omega, depth, gravity)
    outer = np.array([-1j * k, *dying])  # exp(-q (x - l)) cosh-like in z: Z = cos(q z)
    inner = np.arange(MODES) * math.pi / (depth - draft)
    gap, half = depth - draft, 0.5 * width

    def overlap(a: np.ndarray, b: np.ndarray, end: float) -> np.ndarray:
        """Integrals of cos(a z) cos(b z) from the bed to `end`."""

        def sine(q: np.ndarray) -> np.ndarray:
            small = np.abs(q) < 1e-12
            return np.where(small, end, np.sin(q * end) / np.where(small, 1.0, q))

        return 0.5 * (sine(a[:, None] - b[None]) + sine(a[:, None] + b[None]))

    shared = overlap(inner.astype(complex), outer, gap)
    own = np.diag(overlap(outer, outer, depth))
    norm = np.where(inner > 0.0, 0.5 * gap, gap)
    slope = inner * np.tanh(inner * half)  # of cosh(n pi x / s) / cosh(n pi l / s) at the side
    # Velocity: -q own a = shared^T (slope c) + particular; pressure: norm c + particular = shared a.
    particular_slope = -half / gap * shared[0]
    particular = np.array([gap**2 / 6.0 - half**2 / 2.0, *(gap**2 * np.cos(inner[1:] * gap) / (inner[1:] * gap) ** 2)])
    matrix = np.diag(-outer * own) - shared.T @ (shared * (slope / norm)[:, None])
    right = particular_slope - shared.T @ (slope / norm * particular)
    a = np.linalg.solve(matrix, right)
    c = (shared @ a - particular) / norm
    lengths = np.where(inner > 0.0, 2.0 * np.tanh(inner * half) / np.maximum(inner, 1e-30), width)
    over = (c * np.cos(inner * gap) * lengths).sum() + gap * half - half**3 / (3.0 * gap)
    added, damping = float(over.real), float(omega * over.imag)
    far = abs(a[0]) * math.cosh(k * depth) * omega**2 / gravity
    group = 0.5 * omega / k * (1.0 + 2.0 * k * depth / math.sinh(2.0 * k * depth))
    exciting = math.sqrt(2.0 * gravity * group * damping)
    stiff = gravity * width - (width * draft + added) * omega**2
    return Heave(added, damping, float(far), exciting / math.hypot(stiff, omega * damping))
