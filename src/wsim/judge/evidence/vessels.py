"""Where a fluid's particles are, seen from a vessel of any shape: by the convex hull of what it is made of."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import ConvexHull

from wsim.geometry.rotations import conjugate, rotate
from wsim.geometry.shapes import Solid
from wsim.scene.hollows import hollow_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.scene.world import Quat, Shape

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]

LID = 0.5  # of the upward axis that a face's normal has: the hull closes the mouth with it


def strayed(
    shapes: Sequence[Shape],
    pose: Floats,
    position: NDArray[np.float32],
    slack: float,
    up: Floats,
    moves: bool = False,
    tapped: bool = False,
) -> Bools:
    """Which particles are beside or under a vessel, as of a tank: over its rim is not (T, N).

    What leaves one that moves, or that a tap fills, over its rim is poured, wherever it falls to; until it is in the
    hollow again.

    Args:
        shapes: Of the vessel, in its frame.
        pose: Of that frame at each of the particles' frames (T, 7) [m, xyzw].
        position: Of the particles (T, N, 3) [m]; NaN where one is not in the world, and has not strayed.
        slack: How far beyond the hull they may be [m].
        up: Against gravity, in the world (3,).
        moves: Whether it does.
        tapped: Whether one may come from a tap anywhere over the vessel.
    """
    walls, lids = faces_of(shapes, rotate(conjugate(pose[0, 3:]), up))
    hollow = hollow_of(shapes, (0.0, 0.0, 0.0), _quaternion(pose[0]), slack) if tapped else None
    found = np.empty(position.shape[:2], dtype=bool)
    poured, before = np.zeros(position.shape[1], dtype=bool), None
    for t, points in enumerate(position):  # one frame at a time: a recording may be larger than a cache
        places = rotate(conjugate(pose[t, 3:]), points - pose[t, :3])
        found[t] = (places @ walls[:, :3].T > walls[:, 3] + slack).any(axis=1)
        if moves or tapped:
            way = 0.0 if before is None else np.nan_to_num(np.linalg.norm(places - before, axis=1))
            near = (places @ lids[:, :3].T - lids[:, 3]).max(axis=1, initial=-np.inf) > -slack - way
            if hollow is not None:
                poured &= ~hollow.holds(rotate(pose[0, 3:], np.nan_to_num(places, nan=1e9)))
            poured |= near
            found[t] &= ~poured
            before = places
    return found


def _quaternion(pose: Floats) -> Quat:
    x, y, z, w = pose[3:].tolist()
    return x, y, z, w


def faces_of(shapes: Sequence[Shape], up: Floats) -> tuple[Floats, Floats]:
    """The hull's faces, n . x <= d behind each, (K, 4): walls and floor, and those that close the mouth."""
    surfaces = Solid([shape for shape in shapes if shape.collides]).surfaces
    vertices = np.vstack([surface.vertices for surface in surfaces])
    equations = ConvexHull(vertices).equations
    faces = np.hstack([equations[:, :3], -equations[:, 3:]])
    lid = faces[:, :3] @ up >= LID
    return faces[~lid], faces[lid]
