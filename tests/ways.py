"""Ways that drivers are asked to follow."""

from __future__ import annotations

import math

import numpy as np


def ring(radius: float, turns: float, spacing: float = 0.3) -> np.ndarray:
    """A circle to the left from the origin, along x at first, (N, 2) [m]."""
    angle = np.linspace(0.0, 2.0 * math.pi * turns, math.ceil(2.0 * math.pi * turns * radius / spacing))
    return np.stack([radius * np.sin(angle), radius * (1.0 - np.cos(angle))], axis=1)


def lane_change(x: np.ndarray, begin: float = 5.0, length: float = 24.0, aside: float = 3.5) -> np.ndarray:
    """How far aside it is at x, from one lane to another by a quintic, which has no kink in its bend [m]."""
    s = np.clip((x - begin) / length, 0.0, 1.0)
    return aside * s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
