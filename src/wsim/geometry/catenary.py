"""The line in which a slack rope hangs between two points."""

from __future__ import annotations

import numpy as np

Array = np.ndarray
_SHORTEST = 1e-6  # of the length: two points that are one above the other count as that far apart


def hanging(start: Array, end: Array, length: float, count: int) -> Array:
    """Points evenly along a rope that hangs under gravity along -Z, (count, 3) [m].

    The catenary of parameter a through both: with d across, h up and u = d / (2 a), sinh(u) / u is the root of
    length² - h², by d (Jakob Bernoulli's problem, 1691). A rope no longer than the way is straight.

    Args:
        start: (3,) [m].
        end: (3,) [m].
        length: Of the rope [m].
        count: Of the points, both ends among them.
    """
    apart = end - start
    share = np.linspace(0.0, 1.0, count)[:, None]
    if length <= np.linalg.norm(apart) * (1.0 + 1e-9):
        straight: Array = start + share * apart
        return straight
    across, rise = float(np.hypot(apart[0], apart[1])), float(apart[2])
    width = max(across, _SHORTEST * length)
    way = apart[:2] / across if across > 0.0 else np.array([1.0, 0.0])
    u = _solve(np.sqrt(length**2 - rise**2) / width)
    a = width / (2.0 * u)
    lowest = 0.5 * width - a * np.arctanh(rise / length)
    foot = np.sinh(-lowest / a)
    x = lowest + a * np.arcsinh(share[:, 0] * length / a + foot)
    z = a * (np.cosh((x - lowest) / a) - np.cosh(lowest / a))
    points: Array = start + np.column_stack((x[:, None] * way, z))
    return points


def _solve(ratio: float) -> float:
    """The u > 0 at which sinh(u) / u is `ratio` > 1, by bisection in its logarithm."""
    low, high = 1e-9, 700.0
    for _ in range(200):
        u = 0.5 * (low + high)
        if u + np.log1p(-np.exp(-2.0 * u)) - np.log(2.0 * u) < np.log(ratio):
            low = u
        else:
            high = u
    return 0.5 * (low + high)
