"""Tiles that space is cut into, to say in which parts of it what stands still has particles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wsim.kernels.sph.reach import BITS

Array = np.ndarray
AROUND = np.stack(np.meshgrid(*[[-1, 0, 1]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)


@dataclass(frozen=True)
class Tiles:
    """Cubes, but that some axes are not cut at all.

    Attributes:
        edge: Of a tile [m].
        cut: Which axes are, (3,).
    """

    edge: float
    cut: Array

    @property
    def inverse(self) -> Array:
        """One over the edges (3,) [1/m], 0 along an axis that is not cut."""
        return np.where(self.cut, 1.0 / self.edge, 0.0)

    def of(self, points: Array) -> Array:
        """Which tile each of some points (n, 3) is in, (n, 3)."""
        half = 1 << (BITS - 1)
        return np.clip(np.floor(points * self.inverse), -half, half - 1).astype(np.int64)

    def corners(self, tile: Array) -> tuple[Array, Array]:
        """Lower and upper corner of a tile (3,) [m]; infinite along an axis that is not cut."""
        low = np.where(self.cut, tile * self.edge, -np.inf)
        return low, np.where(self.cut, (tile + 1) * self.edge, np.inf)

    def around(self, tiles: Array) -> Array:
        """Tiles (n, 3) and all that touch them, each once."""
        return np.unique((tiles[:, None] + AROUND[(AROUND[:, ~self.cut] == 0).all(axis=1)]).reshape(-1, 3), axis=0)

    def spanning(self, low: Array, high: Array) -> Array:
        """All tiles that a box from one corner to another [m] is in, (n, 3)."""
        first, last = self.of(np.stack([low, high]))
        axes = [np.arange(a, b + 1) for a, b in zip(first, last, strict=True)]
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def keys_of(world: int, tiles: Array) -> Array:
    """One number for each of some tiles (n, 3) of a world, as `wsim.kernels.sph.reach.tile_key` has it."""
    span, at = 1 << BITS, np.asarray(tiles, dtype=np.int64) + (1 << (BITS - 1))
    return ((world * span + at[:, 0]) * span + at[:, 1]) * span + at[:, 2]
