"""Where shapes are deepest in each other, by the limit of that: for long or for a moment."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Deepest:
    """Where two shapes are deepest in each other, by the limit of that."""

    value: float  # [m]
    limit: float
    time: float  # [s]
    lasts: bool
    size: float  # smallest extent [m]
    soft: float  # that contacts yield [m]


def held_through(depth: Floats, frames: int) -> Floats:
    """How deep each is all through so many frames, of depths (..., T), at each of their first frames, (..., T - n)."""
    count = depth.shape[-1]
    frames = min(count, frames)
    return functools.reduce(np.minimum, (depth[..., k : count - frames + 1 + k] for k in range(frames)))


def deepest_of(depth: Floats, size: Floats, give: Floats, shares: tuple[float, float], frames: int) -> int:
    """Which of n pairs of shapes is deepest by its limit.

    Args:
        depth: (n, T) [m].
        size: Smallest extent of each, (n,) [m].
        give: How deep soft contacts let each in, (n, T) [m].
        shares: Of the extent, that it may be in for long, and for a moment.
        frames: How many are long.
    """
    depth, rows = depth - give, np.arange(len(depth))
    held = held_through(depth, frames)
    lasting, brief = held.max(axis=1), depth.max(axis=1)
    lasts = lasting / shares[0] > brief / shares[1]
    soft = give[rows, np.where(lasts, held.argmax(axis=1), depth.argmax(axis=1))]
    limit = np.where(lasts, *shares) * size + soft
    value = np.where(lasts, lasting, brief) + soft
    share = np.divide(value, limit, out=np.full_like(value, np.inf), where=limit != 0.0)
    return int(np.argmax(share))
