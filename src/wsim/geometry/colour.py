"""Colour as a screen has it."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def srgb_of(linear: ArrayLike) -> NDArray[np.float64]:
    """Linear values in 0..1 by sRGB's transfer curve (IEC 61966-2-1)."""
    values = np.asarray(linear, dtype=np.float64)
    return np.where(values <= 0.0031308, 12.92 * values, 1.055 * values ** (1 / 2.4) - 0.055)
