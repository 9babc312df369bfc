"""A closed mesh that is a box, a ball, a cylinder or convex collides as that, exactly and quickly."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi

import numpy as np
import trimesh
from scipy.spatial import ConvexHull

from wsim.intake.model import Array, Collider, Mesh

SAME = 0.03  # of the volume; a cylinder of 16 sides lacks 2.6 % of the round one
_STRAY = 0.01  # of the longest edge, by which a point may lie outside of the plain shape
MOST_CORNERS = 64  # of a hull that collides beside others
_ALONE = 256  # of one that collides alone


def fit(mesh: Mesh) -> Collider | None:
    """The one convex body that a closed mesh is, or None if it is not convex."""
    try:
        hull = ConvexHull(mesh.points)
    except Exception:  # noqa: BLE001 - Qhull has one error for all that is flat
        return None
    if mesh.volume < (1.0 - SAME / 2) * hull.volume:
        return None
    corners = mesh.points[hull.vertices]
    stray = _STRAY * float(np.ptp(corners, axis=0).max())
    for shape, volume in _candidates(corners, float(hull.volume)):
        if abs(volume - hull.volume) <= SAME * hull.volume and _outside(shape, corners) <= stray:
            return shape
    return Collider("hull", points=few_corners(corners, _ALONE))


def _candidates(corners: Array, volume: float) -> Iterator[tuple[Collider, float]]:
    """Plain shapes that may be it, each with its volume, the plainest first."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    middle, size = (low + high) / 2, high - low
    yield Collider("box", tuple(size.tolist()), middle), float(np.prod(size))
    if size.max() < 1.02 * size.min():
        radius = float((3.0 * volume / (4.0 * pi)) ** (1 / 3))
        yield Collider("sphere", (radius,), middle), 4.0 / 3.0 * pi * radius**3
    for axis, turn in (
        (2, np.eye(3)),
        (0, np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])),
        (1, np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])),
    ):
        across = [k for k in range(3) if k != axis]
        radius = float(np.linalg.norm((corners - middle)[:, across], axis=1).max())
        yield Collider("cylinder", (radius, float(size[axis])), middle, turn), float(pi * radius**2 * size[axis])
    to_box, edges = trimesh.bounds.oriented_bounds(trimesh.Trimesh(corners, process=False))
    turned = np.linalg.inv(to_box)
    yield Collider("box", tuple(map(float, edges)), turned[:3, 3], turned[:3, :3]), float(np.prod(edges))


def _outside(shape: Collider, points: Array) -> float:
    """The most by which points lie outside of a plain shape [m]."""
    local = (points - shape.center) @ shape.turn
    if shape.kind == "box":
        return float((np.abs(local) - np.array(shape.size) / 2).max())
    if shape.kind == "sphere":
        return float(np.linalg.norm(local, axis=1).max() - shape.size[0])
    beyond = np.abs(local[:, 2]).max() - shape.size[1] / 2
    return float(max(np.linalg.norm(local[:, :2], axis=1).max() - shape.size[0], beyond))


def few_corners(points: Array, most: int = MOST_CORNERS) -> Array:
    """At most so many corners of a hull that they bound nearly all of it: those farthest out in even directions."""
    hull = points[ConvexHull(points).vertices]
    if len(hull) <= most:
        return hull
    index = np.arange(most - 6) + 0.5
    polar, turn = np.arccos(1.0 - 2.0 * index / len(index)), pi * (1.0 + 5.0**0.5) * index
    ways = np.stack([np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar)], axis=1)
    ways = np.concatenate([ways, np.eye(3), -np.eye(3)])
    scaled = (hull - hull.mean(axis=0)) / np.ptp(hull, axis=0)
    return hull[np.unique((scaled @ ways.T).argmax(axis=0))]
