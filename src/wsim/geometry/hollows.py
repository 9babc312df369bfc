"""What a vessel of any shape holds: the room in it that water under a level does not run out of.

The space around its surfaces is cut into cells. Two neighbours are joined where no triangle crosses the line between
their centres, so that a sheet without thickness parts them, too. Water in a cell stands as high as it can before it
runs out: up to the lowest rim on any way from there to the open, as in a landscape (Barnes, Lehman & Mulla 2014,
Computers & Geosciences 62), here in space, with overhangs and necks.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wsim.geometry.crossings import crossings
from wsim.geometry.surfaces import Surface

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
Box = tuple[slice, ...]

CELLS = 250_000  # of a grid around a vessel: about sixty along each edge
FINEST = 3_000_000
OFFSET = np.array([0.381966, 0.276393, 0.437016])  # of a cell: faces at round numbers and angles miss its lines
PAD = 2  # cells around the vessel
SMALL = 0.02  # of the largest hollow: less is a crack


@dataclass(frozen=True)
class Filling:
    """The room in a hollow under a level.

    Attributes:
        cells: Centres of its cells (N, 3) [m].
        room: Volume of each (N,) [m^3]: cut at walls and at the level.
        edge: Of a whole cell [m].
        floor: Its lowest height [m].
        level: Height of the surface [m].
    """

    cells: Floats
    room: Floats
    edge: float
    floor: float
    level: float

    @property
    def volume(self) -> float:
        """[m^3]."""
        return float(self.room.sum())


class Hollow:
    """The largest hollow of a vessel: open to above, or closed all round where none is open.

    Args:
        surfaces: Of its parts, Z up; one that is not closed is a sheet.
        cell: Of the grid, at most [m]; by default what the vessel's size makes it.

    Attributes:
        floor: Its lowest height [m].
        rim: From where on it runs over [m], to half a cell; the top of one that is closed.
        sealed: Whether it is closed all round.

    Raises:
        ValueError: It has none.
    """

    def __init__(self, surfaces: Sequence[Surface], cell: float = math.inf) -> None:
        points = np.concatenate([surface.vertices for surface in surfaces])
        self._low, high = points.min(axis=0), points.max(axis=0)
        size = np.maximum(high - self._low, 1e-6)
        self.edge = min(cell, float(np.prod(size) / CELLS) ** (1 / 3), float(size.max()) / 8)
        self.edge = max(self.edge, float(np.prod(size) / FINEST) ** (1 / 3), float(size.max()) / 1000)
        self._low = self._low - (PAD + OFFSET) * self.edge
        x, y, z = (int(k) + 2 * PAD + 1 for k in np.ceil(size / self.edge))
        self._count = (x, y, z)
        self._heights = self._low[2] + (np.arange(self._count[2]) + 0.5) * self.edge
        self._room = np.ones(self._count)  # of each cell [cells], cut at what stands between it and its neighbours
        self._cut = np.full(self._count, np.inf)  # how far under each cell a floor is [cells]
        self._joined = [self._joins(surfaces, axis) for axis in range(3)]
        self._free = ~self._solid(surfaces)
        self._find()

    def filling(self, level: float) -> Filling:
        """What is in it under a level at that height [m]."""
        z = np.broadcast_to(self._heights, self._count)
        under = self._inside & (z < level)
        over = (level - z[under]) / self.edge
        top = np.where(over < 1.0, over - 0.5, 0.0)
        room = np.maximum(self._room[under] + top, 0.0) * self.edge**3
        cells = self._low + (np.argwhere(under) + 0.5) * self.edge
        return Filling(cells, room, self.edge, self.floor, level)

    def holds(self, points: Floats) -> Bools:
        """Whether points (n, 3) are in it, to a cell."""
        cells = np.floor((points - self._low) / self.edge).astype(np.int64)
        there = ((cells >= 0) & (cells < self._count)).all(axis=1)
        inside: Bools = np.zeros(len(points), dtype=bool)
        inside[there] = self._inside[tuple(cells[there].T)]
        return inside

    def level_of(self, volume: float) -> float:
        """The height of the surface [m] where it holds a volume [m^3]; ValueError where that is more than it holds."""
        if volume > self.filling(self.rim).volume:
            raise ValueError(f"{volume:g} m^3 is more than it holds")
        low, high = self.floor, self.rim
        for _ in range(40):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.filling(middle).volume < volume else (low, middle)
        return 0.5 * (low + high)

    def _joins(self, surfaces: Sequence[Surface], axis: int) -> Bools:
        """Whether nothing is between each cell and the next along an axis; what is there cuts the room of both."""
        count = self._count[axis]
        sides = [k for k in range(3) if k != axis]
        shape = (self._count[sides[0]], self._count[sides[1]], count - 1)
        nearest, farthest = np.full(shape, np.inf), np.full(shape, -np.inf)
        for surface in surfaces:
            corners = surface.vertices[surface.triangles]
            lines, place, _ = crossings(corners, axis, self._low, self.edge, self._count)
            along = (place - self._low[axis]) / self.edge - 0.5
            link = np.floor(along).astype(np.int64)
            keep = (link >= 0) & (link < count - 1)
            where = lines[keep, 0], lines[keep, 1], link[keep]
            np.minimum.at(nearest, where, (along - link)[keep])
            np.maximum.at(farthest, where, (along - link)[keep])
        nearest, farthest = (np.moveaxis(each, 2, axis) for each in (nearest, farthest))
        closed = np.isfinite(nearest)
        room, before, after = self._room, _cut(axis, None, -1), _cut(axis, 1, None)
        room[before] += np.where(closed, nearest - 0.5, 0.0)
        room[after] += np.where(closed, 0.5 - farthest, 0.0)
        if axis == 2:
            self._cut[after] = np.where(closed, 1.0 - farthest, np.inf)
        return ~closed

    def _solid(self, surfaces: Sequence[Surface]) -> Bools:
        """Which cells are inside a part that is closed: by how often the line from below has gone in, and out."""
        solid = np.zeros(self._count, dtype=bool)
        for surface in surfaces:
            if not is_closed(surface):
                continue
            corners = surface.vertices[surface.triangles]
            lines, place, towards = crossings(corners, 2, self._low, self.edge, self._count)
            cell = np.ceil((place - self._low[2]) / self.edge - 0.5).astype(np.int64).clip(0, self._count[2] - 1)
            turns = np.zeros(self._count)
            line = lines.astype(np.int64)
            np.add.at(turns, (line[:, 0], line[:, 1], cell), -towards)
            solid |= np.abs(np.cumsum(turns, axis=2)) > 0.5
        return solid

    def _find(self) -> None:
        z = np.broadcast_to(self._heights, self._count)
        spill = self._swept(np.full(self._count, np.inf), z)
        holds = self._free & (spill > z + 0.5 * self.edge)
        open_up = holds & np.isfinite(spill)
        self.sealed = not open_up.any()
        label = self._labels(holds if self.sealed else open_up)
        room = np.bincount(label[label >= 0], self._room[label >= 0]) if (label >= 0).any() else np.zeros(0)
        if not len(room) or room.max() < 8.0:
            raise ValueError("it has no hollow")
        self._inside = label == int(room.argmax())
        heights = (z - np.where(np.isfinite(self._cut), self._cut, 0.5) * self.edge)[self._inside]
        self.floor = float(heights.min())
        top = z[self._inside].max() + 0.5 * self.edge
        self.rim = float(top if self.sealed else min(spill[self._inside].max() - 0.5 * self.edge, top))

    def _swept(self, spill: Floats, z: Floats) -> Floats:
        """To what height water can stand in each cell: swept along the axes until nothing changes."""
        for axis in range(3):
            for end in (0, -1):
                rim = _cut(axis, end, None if end else 1)
                spill[rim] = np.where(self._free[rim], z[rim], np.inf)
        while True:
            before = spill.copy()
            for axis in range(3):
                self._sweep(spill, z, axis)
            if np.array_equal(before, spill):
                return spill

    def _sweep(self, spill: Floats, z: Floats, axis: int) -> None:
        values, floor = np.moveaxis(spill, axis, 0), np.moveaxis(z, axis, 0)
        free, joined = np.moveaxis(self._free, axis, 0), np.moveaxis(self._joined[axis], axis, 0)
        count = len(values)
        for here, there in [*((k, k - 1) for k in range(1, count)), *((k, k + 1) for k in range(count - 2, -1, -1))]:
            from_there = np.where(joined[min(here, there)] & free[here], np.maximum(values[there], floor[here]), np.inf)
            np.minimum(values[here], from_there, out=values[here])

    def _labels(self, wanted: Bools) -> NDArray[np.int64]:
        """The connected parts of some cells, numbered; -1 elsewhere."""
        label = np.where(wanted, np.arange(wanted.size).reshape(wanted.shape), np.iinfo(np.int64).max)
        while True:
            before = label.copy()
            for axis in range(3):
                values, inside = np.moveaxis(label, axis, 0), np.moveaxis(wanted, axis, 0)
                joined, count = np.moveaxis(self._joined[axis], axis, 0), len(values)
                ways = [*((k, k - 1) for k in range(1, count)), *((k, k + 1) for k in range(count - 2, -1, -1))]
                for here, there in ways:
                    ok = joined[min(here, there)] & inside[here] & inside[there]
                    values[here] = np.where(ok, np.minimum(values[here], values[there]), values[here])
            if np.array_equal(before, label):
                break
        found = np.full(wanted.shape, -1)
        found[wanted] = np.unique(label[wanted], return_inverse=True)[1].reshape(-1)
        return found


def is_closed(surface: Surface) -> bool:
    """Whether each edge of its triangles, corners at one place taken as one, has two of them."""
    _, same = np.unique(np.round(surface.vertices, 7), axis=0, return_inverse=True)
    corners = same.reshape(-1)[surface.triangles]
    whole = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
    ends = np.stack([corners[whole], np.roll(corners[whole], -1, axis=1)], axis=2).reshape(-1, 2)
    _, many = np.unique(np.sort(ends, axis=1), axis=0, return_counts=True)
    return bool((many % 2 == 0).all())


def _cut(axis: int, first: int | None, last: int | None) -> Box:
    """Everything along the other axes, a part along this."""
    return tuple(slice(first, last) if k == axis else slice(None) for k in range(3))
