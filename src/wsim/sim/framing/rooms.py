"""Views from within walls: where what stands there would hide all, a camera stands before it, and has a wider lens."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, line_of_sight, rotate
from wsim.sim.render_materials import OPAQUE
from wsim.sim.render_views import FILLED, is_ground, outline

if TYPE_CHECKING:
    from wsim.scene.world import Camera, World

Array = np.ndarray
BEFORE = 0.92  # of the way to a wall: there a camera stands
WIDEST = 100.0  # [deg] of a lens in a room


@dataclass(frozen=True)
class Walls:
    """Boxes round the opaque shapes that stand, but the ground.

    Attributes:
        low: (S, 3) lowest corners, in the shapes' frames [m].
        high: (S, 3) highest corners.
        place: (S, 3) of those frames [m].
        turned: (S, 4) from the world into them, xyzw.
    """

    low: Array
    high: Array
    place: Array
    turned: Array

    @classmethod
    def of(cls, world: World) -> Walls:
        """A world's."""
        shapes = [s for static in world.statics for s in static.shapes if s.opacity >= OPAQUE and not is_ground(s)]
        corners = [outline(shape) for shape in shapes]
        return cls(
            np.array([each.min(axis=0) for each in corners]).reshape(-1, 3),
            np.array([each.max(axis=0) for each in corners]).reshape(-1, 3),
            np.array([shape.position for shape in shapes]).reshape(-1, 3),
            conjugate(np.array([shape.rotation for shape in shapes]).reshape(-1, 4)),
        )

    def free_way(self, start: Array, way: Array) -> float:
        """How far it is from a point (3,) along a unit vector (3,) to the first box [m]; inf: none is in the way.

        A box round the point itself is none: it may be that of a room in one piece.
        """
        local, ahead = rotate(self.turned, start - self.place), rotate(self.turned, way[None])
        slope = np.where(np.abs(ahead) < 1e-12, 1e-12, ahead)
        ends = np.stack([(self.low - local) / slope, (self.high - local) / slope])
        enters, leaves = ends.min(axis=0).max(axis=1), ends.max(axis=0).min(axis=1)
        return float(enters[(enters > 0.0) & (enters <= leaves)].min(initial=math.inf))


def before_walls(view: Camera, points: Array, walls: Walls) -> Iterator[Camera]:
    """The view from between a wall and what is looked at, if a wall stands between that and the camera.

    Args:
        view: That stands; it looks at the middle of what it looks at.
        points: That are to be in its frame, (n, 3) [m].
        walls: That may be between.
    """
    aim = 0.5 * (points.min(axis=0) + points.max(axis=0))
    back = np.subtract(view.eye, view.target)
    back /= np.linalg.norm(back)
    away = BEFORE * walls.free_way(aim, back)
    if away < math.dist(view.eye, aim):
        eye = aim + away * back
        place, at = ((float(v[0]), float(v[1]), float(v[2])) for v in (eye, aim))
        moved = view.model_copy(update={"eye": place, "target": at})
        yield moved.model_copy(update={"fov": _lens(moved, points)})


def _lens(view: Camera, points: Array) -> float:
    """The field of view [deg] that has points in frame, no narrower than the camera's, and no wider than `WIDEST`."""
    right, ahead = line_of_sight(view.eye, view.target, view.up)
    local = points - np.array(view.eye)
    depth = np.maximum(local @ ahead, 1e-6)
    across = np.abs(local @ right) / depth
    above = np.abs(local @ np.cross(ahead, right)) / depth * view.width / view.height
    slope = float(max(across.max(), above.max())) / FILLED
    return float(np.clip(math.degrees(2.0 * math.atan(slope)), view.fov, max(WIDEST, view.fov)))
