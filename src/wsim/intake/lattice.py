"""What of a box is inside of meshes, on a lattice of points: by winding numbers along columns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from wsim.intake.model import Array, Collider, Faces, Mesh
from wsim.intake.read_usd import plain

Bools = NDArray[np.bool_]
FINEST, COARSEST = 112, 40  # cells along an edge of the box
_PAIRS = 4_000_000  # of triangles and columns at a time
_OFF = (0.01237, 0.00713)  # of a cell: no column runs through the corners of round numbers


@dataclass(frozen=True)
class Lattice:
    """Cells of a box: its lowest corner [m], the cells' edges [m] and how many there are along each axis."""

    low: Array
    cell: Array
    count: tuple[int, int, int]

    @classmethod
    def around(cls, points: Array) -> Lattice:
        """Of the box round some points."""
        low, size = points.min(axis=0), np.ptp(points, axis=0)
        wanted = np.clip(np.ceil(size / size.max() * FINEST), COARSEST, FINEST).astype(int)
        return cls(low, size / wanted, (int(wanted[0]), int(wanted[1]), int(wanted[2])))

    def centers(self, axis: int) -> Array:
        """Of the cells along an axis [m]."""
        centers: Array = self.low[axis] + (np.arange(self.count[axis]) + 0.5) * self.cell[axis]
        return centers

    @property
    def volume(self) -> float:
        """Of a cell [m^3]."""
        return float(np.prod(self.cell))

    def inside(self, mesh: Mesh) -> Bools:
        """Which centres a closed mesh winds round, (X, Y, Z)."""
        nx, ny, nz = self.count
        crossed = np.zeros((nx * ny, nz + 1), dtype=np.int32)
        corners = (mesh.points[mesh.faces] - self.low) / self.cell - 0.5  # in cells, of which centres are whole
        corners[:, :, 0] += _OFF[0]
        corners[:, :, 1] += _OFF[1]
        first = np.maximum(np.ceil(corners[:, :, :2].min(axis=1)), 0).astype(int)
        last = np.minimum(np.floor(corners[:, :, :2].max(axis=1)), [nx - 1, ny - 1]).astype(int)
        wide = np.maximum(last - first + 1, 0)
        pairs = wide[:, 0] * wide[:, 1]
        ends = np.cumsum(pairs)
        start = 0
        while start < len(pairs):
            end = max(start + 1, int(np.searchsorted(ends, (ends[start - 1] if start else 0) + _PAIRS)))
            _cross(crossed, corners[start:end], first[start:end], wide[start:end], pairs[start:end], ny, nz)
            start = end
        return (np.cumsum(crossed[:, :nz], axis=1) > 0).reshape(nx, ny, nz)

    def union(self, colliders: list[Collider]) -> Bools:
        """Which centres lie in some collider."""
        found = np.zeros(self.count, dtype=bool)
        for collider in colliders:
            found |= self.inside(hull_of(collider))
        return found


def _cross(
    crossed: NDArray[np.int32], corners: Array, first: Faces, wide: Faces, pairs: Faces, ny: int, nz: int
) -> None:
    """Note where columns go in (+1) and out (-1) of triangles."""
    face = np.repeat(np.arange(len(corners)), pairs)
    if not len(face):
        return
    number = np.arange(len(face)) - np.repeat(np.cumsum(pairs) - pairs, pairs)
    i, j = first[face, 0] + number // wide[face, 1], first[face, 1] + number % wide[face, 1]
    a, b, c = (corners[:, k][face] for k in range(3))
    u, v = b - a, c - a
    area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    px, py = i - a[:, 0], j - a[:, 1]
    upright = area == 0.0
    area[upright] = np.inf  # which no column runs through
    s = (px * v[:, 1] - py * v[:, 0]) / area
    t = (u[:, 0] * py - u[:, 1] * px) / area
    hit = ~upright & (s >= 0.0) & (t >= 0.0) & (s + t <= 1.0)
    height = (a[:, 2] + s * u[:, 2] + t * v[:, 2])[hit]
    k = np.clip(np.ceil(height), 0, nz).astype(int)
    np.add.at(crossed, ((i * ny + j)[hit], k), np.where(area[hit] < 0.0, 1, -1))


def hull_of(collider: Collider) -> Mesh:
    """A collider as a closed mesh."""
    if collider.kind != "hull":
        made = plain(collider.kind, collider.size)
        return Mesh("", np.asarray(made.vertices), np.asarray(made.faces)).moved(collider.turn, collider.center)
    hull = ConvexHull(collider.points)
    middle = collider.points[hull.vertices].mean(axis=0)
    a, b, c = (collider.points[hull.simplices[:, k]] for k in range(3))
    inwards = np.einsum("ij,ij->i", np.cross(b - a, c - a), a - middle) < 0.0
    faces = hull.simplices.astype(np.int64)
    faces[inwards] = faces[inwards, ::-1]
    return Mesh("", collider.points, faces)
