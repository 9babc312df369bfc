"""Closed triangle meshes: their volume, what of it is under a plane, and round bodies as meshes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wsim.geometry.rotations import rotate

Floats = NDArray[np.float64]

_AROUND, _ALONG = 48, 24  # facets of a round shape


@dataclass(frozen=True)
class Surface:
    """A closed triangle mesh."""

    vertices: Floats  # (V, 3) [m]
    triangles: NDArray[np.intp]  # (F, 3)

    @property
    def volume(self) -> float:
        """Volume inside [m^3]."""
        return float(np.linalg.det(self.vertices[self.triangles]).sum() / 6.0)

    def volume_below(self, height: float) -> float:
        """Volume of the part with z < height [m^3].

        Each triangle is cut at the plane. Volumes are those of tetrahedra from a point in the plane, so the cut's own
        face adds nothing.
        """
        corners = self.vertices[self.triangles] - np.array([0.0, 0.0, height])
        signed = np.linalg.det(corners) / 6.0
        low, mid, high = np.sort(corners[:, :, 2], axis=1).T
        with np.errstate(divide="ignore", invalid="ignore"):
            tip = np.where(low < 0, low * low / ((mid - low) * (high - low)), 0.0)  # one corner is below
            cap = np.where(high > 0, high * high / ((high - low) * (high - mid)), 0.0)  # one corner is above
        share = np.where(high <= 0, 1.0, np.where(low >= 0, 0.0, np.where(mid >= 0, tip, 1.0 - cap)))
        return float(np.sum(signed * share))

    def turned(self, q: Floats, position: Floats | None = None) -> Surface:
        """The mesh turned by q (4,), then moved."""
        moved = rotate(q, self.vertices)
        return Surface(moved if position is None else moved + position, self.triangles)


def box_surface(edges: tuple[float, ...]) -> Surface:
    """A box by its edges [m]."""
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]) * np.array(edges)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return Surface(corners, np.array(triangles, dtype=np.intp))


def arc(radius: float, height: float, along: int = _ALONG) -> tuple[Floats, Floats]:
    """The profile (radius, z) [m] of a sphere that is pulled apart by `height` at its middle."""
    angle = np.linspace(-math.pi / 2, math.pi / 2, 2 * (along // 2))
    return radius * np.cos(angle), radius * np.sin(angle) + np.sign(angle) * height / 2


def revolved(radius: Floats, z: Floats, volume: float, radial: bool = False, around: int = _AROUND) -> Surface:
    """A profile turned about Z, then scaled to its true volume [m^3], radially only or all round."""
    angle = np.linspace(0.0, 2 * math.pi, around, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    vertices = np.concatenate([np.column_stack([r * ring, np.full(around, h)]) for r, h in zip(radius, z, strict=True)])
    i = np.arange(around)
    j = (i + 1) % around
    triangles = []
    for k in range(len(radius) - 1):
        a, b = k * around, (k + 1) * around
        triangles += [np.stack([a + i, a + j, b + j], axis=1), np.stack([a + i, b + j, b + i], axis=1)]
    mesh = Surface(vertices, np.concatenate(triangles))
    ratio = volume / mesh.volume
    scale = np.array([ratio**0.5, ratio**0.5, 1.0]) if radial else np.full(3, ratio ** (1 / 3))
    return Surface(vertices * scale, mesh.triangles)
