"""Numbers by time: of key frames, each kept until the next or gone straight from one to the next."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Profile:
    """K keys of n numbers each: none before the first one, and the last one's for good.

    Attributes:
        times: (K,) [s], rising.
        values: (K, n).
        linear: Whether it goes straight from key to key.
    """

    times: Floats
    values: Floats
    linear: bool = False

    @classmethod
    def of(cls, times: Sequence[float], values: Sequence[Sequence[float]], linear: bool) -> Profile:
        """Of keys as lists."""
        when = np.asarray(times, dtype=np.float64)
        return cls(when, np.asarray(values, dtype=np.float64).reshape(len(when), -1), linear)

    def at(self, t: ArrayLike) -> Floats:
        """At times (T,) [s], (T, n); zeros before the first key."""
        t = np.asarray(t, dtype=np.float64)
        k = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.times) - 1)
        found = self.values[k]
        if self.linear and len(self.times) > 1:
            found = np.stack([np.interp(t, self.times, column) for column in self.values.T], axis=-1)
        return np.asarray(np.where((t >= self.times[0])[..., None], found, 0.0))

    def sum_to(self, t: ArrayLike) -> Floats:
        """The integral from the first key to times (T,) [s], (T, n)."""
        t = np.asarray(t, dtype=np.float64)
        width = np.diff(self.times)
        ends = self.values[1:] if self.linear else self.values[:-1]
        pieces = 0.5 * (self.values[:-1] + ends) * width[:, None]
        before = np.concatenate([np.zeros((1, self.values.shape[1])), np.cumsum(pieces, axis=0)])
        k = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.times) - 1)
        since = np.maximum(t - self.times[k], 0.0)[..., None]
        return np.asarray(before[k] + 0.5 * (self.values[k] + self.at(np.maximum(t, self.times[0]))) * since)

    def means(self, t: ArrayLike) -> Floats:
        """Over each interval between times (T,) [s], (T - 1, n)."""
        t = np.asarray(t, dtype=np.float64)
        return np.asarray(np.diff(self.sum_to(t), axis=0) / np.diff(t)[:, None])

    def jumps(self, t: ArrayLike) -> NDArray[np.bool_]:
        """Whether it has a key within each interval between times (T,) [s] that it bends or jumps at, (T - 1,)."""
        t = np.asarray(t, dtype=np.float64)
        inside = (self.times > t[:-1, None]) & (self.times < t[1:, None])
        return np.asarray(inside.any(axis=1))
