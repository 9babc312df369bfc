"""Views from within walls: where what stands there would hide all, a camera stands before it, and has a wider lens."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, line_of_sight, rotate
from wsim.sim.render_views import FILLED, is_ground, outline

if TYPE_CHECKING:
    from wsim.scene.world import Camera, Shape, World

Array = np.ndarray
BEFORE = 0.92  # of the way to a wall: there a camera stands
WIDEST = 100.0  # [deg] of a lens in a room


def before_walls(view: Camera, points: Array, world: World) -> Iterator[Camera]:
    """The view from between a wall and what is looked at, if a wall stands between that and the camera.

    Args:
        view: That stands; it looks at the middle of what it looks at.
        points: That are to be in its frame, (n, 3) [m].
        world: Whose static shapes are walls.
    """
    aim = 0.5 * (points.min(axis=0) + points.max(axis=0))
    back = np.subtract(view.eye, view.target)
    back /= np.linalg.norm(back)
    away = BEFORE * free_way(aim, back, [s for static in world.statics for s in static.shapes])
    if away < math.dist(view.eye, aim):
        eye = aim + away * back
        place, at = ((float(v[0]), float(v[1]), float(v[2])) for v in (eye, aim))
        moved = view.model_copy(update={"eye": place, "target": at})
        yield moved.model_copy(update={"fov": _lens(moved, points)})


def free_way(start: Array, way: Array, shapes: Sequence[Shape]) -> float:
    """How far it is from a point (3,) along a unit vector (3,) to the first opaque shape's box [m]; inf: there is none.

    A box round the point itself is none in the way: it may be that of a room in one piece.
    """
    nearest = math.inf
    for shape in shapes:
        if is_ground(shape) or shape.opacity < 1.0:
            continue
        corners = outline(shape)
        turned = conjugate(np.array(shape.rotation))
        local, ahead = rotate(turned, start - np.array(shape.position)), rotate(turned, way)
        slope = np.where(np.abs(ahead) < 1e-12, 1e-12, ahead)
        ends = np.stack([corners.min(axis=0) - local, corners.max(axis=0) - local]) / slope
        enters, leaves = float(ends.min(axis=0).max()), float(ends.max(axis=0).min())
        if 0.0 < enters <= leaves:
            nearest = min(nearest, enters)
    return nearest


def _lens(view: Camera, points: Array) -> float:
    """The field of view [deg] that has points in frame, no narrower than the camera's, and no wider than `WIDEST`."""
    right, ahead = line_of_sight(view.eye, view.target, view.up)
    local = points - np.array(view.eye)
    depth = np.maximum(local @ ahead, 1e-6)
    across = np.abs(local @ right) / depth
    above = np.abs(local @ np.cross(ahead, right)) / depth * view.width / view.height
    slope = float(max(across.max(), above.max())) / FILLED
    return float(np.clip(math.degrees(2.0 * math.atan(slope)), view.fov, max(WIDEST, view.fov)))
