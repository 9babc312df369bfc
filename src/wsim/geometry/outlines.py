"""Outlines: what the plane y = 0 cuts out of a closed triangle mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wsim.geometry.surfaces import Surface

Floats = NDArray[np.float64]
AT_ONCE = 2**21  # pairs of points and segments that are looked at together


@dataclass(frozen=True)
class Outline:
    """Closed lines in the x-z plane, as segments with the inside to their left, x to the right and z up.

    Attributes:
        segments: Ends as (x, z) [m], (S, 2, 2); none where the plane cuts nothing.
    """

    segments: Floats

    @property
    def area(self) -> float:
        """What is inside [m^2]."""
        return 0.5 * float(self._crossed.sum())

    @property
    def centroid(self) -> Floats:
        """Middle of what is inside, (x, z) [m]."""
        return np.asarray((self._crossed[:, None] * self.segments.sum(axis=1)).sum(axis=0) / (6.0 * self.area))

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner, (x, z) [m]."""
        ends = self.segments.reshape(-1, 2)
        return ends.min(axis=0), ends.max(axis=0)

    @property
    def _crossed(self) -> Floats:
        start, end = self.segments[:, 0], self.segments[:, 1]
        return np.asarray(start[:, 0] * end[:, 1] - start[:, 1] * end[:, 0])

    def moved(self, by: Floats) -> Outline:
        """The same outline elsewhere."""
        return Outline(self.segments + by)

    def depth(self, points: Floats) -> Floats:
        """How far inside points (n, 2) are from the outline, (n,) [m]; negative outside."""
        share = max(1, AT_ONCE // max(1, len(self.segments)))
        found = [self._depth(points[k : k + share]) for k in range(0, len(points), share)]
        return np.concatenate(found) if found else np.zeros(0)

    def _depth(self, points: Floats) -> Floats:
        start, end = self.segments[:, 0], self.segments[:, 1]
        along = end - start
        off = points[:, None] - start
        share = np.clip((off * along).sum(axis=2) / (along**2).sum(axis=1), 0.0, 1.0)
        apart = np.sqrt(((off - share[..., None] * along) ** 2).sum(axis=2).min(axis=1))
        # Whether a ray along x leaves the inside once more than it enters it: half-open, so that it meets one of two
        # segments that share an end.
        z = points[:, 1][:, None]
        spans = (start[:, 1] > z) != (end[:, 1] > z)
        left = along[:, 0] * off[..., 1] - along[:, 1] * off[..., 0] > 0.0
        inside = (spans & (left == (along[:, 1] > 0.0))).sum(axis=1) % 2 == 1
        return np.where(inside, apart, -apart)


def outline_of(surface: Surface) -> Outline:
    """What the plane y = 0 cuts out of a closed mesh whose triangles face outward.

    A corner in the plane counts as above it: lines stay closed, and a face in the plane adds none of its own.
    """
    corners = surface.vertices[surface.triangles]
    above = corners[:, :, 1] >= 0.0
    cut = above.any(axis=1) & ~above.all(axis=1)
    corners, above = corners[cut], above[cut]
    ends = np.zeros((2, len(corners), 2))  # where the plane is left upward, and downward
    for k in range(3):
        one, other = corners[:, k], corners[:, (k + 1) % 3]
        for way, crosses in enumerate((~above[:, k] & above[:, (k + 1) % 3], above[:, k] & ~above[:, (k + 1) % 3])):
            high, low = (other, one) if way == 0 else (one, other)  # so that both triangles at an edge find one point
            share = (high[crosses, 1] / (high[crosses, 1] - low[crosses, 1]))[:, None]
            at = high[crosses] + share * (low[crosses] - high[crosses])
            ends[way, crosses] = at[:, [0, 2]]
    segments = np.moveaxis(ends, 0, 1)
    return Outline(segments[(segments[:, 0] != segments[:, 1]).any(axis=1)])
