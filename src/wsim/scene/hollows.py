"""The hollow that an object's shapes make, by their description alone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wsim.geometry.hollows import Hollow
from wsim.geometry.shapes import surface_of
from wsim.geometry.surfaces import Surface
from wsim.scene.world import Quat, Shape, Vec3

CELLS = 3  # of the grid that a hollow is found on, along a spacing at least


def hollow_of(shapes: Sequence[Shape], position: Vec3, rotation: Quat, spacing: float) -> Hollow:
    """What shapes hold in their frame's pose in the world.

    Args:
        shapes: Those that collide are its walls.
        position: Of their frame [m].
        rotation: Of their frame.
        spacing: Between particles of what is to be held [m].

    Raises:
        ValueError: They hold nothing.
    """
    walls = [surface_of_wall(shape) for shape in shapes if shape.collides and shape.kind != "plane"]
    if not walls:
        raise ValueError("nothing of it collides")
    place = np.array(rotation, dtype=np.float64), np.array(position, dtype=np.float64)
    return Hollow([wall.turned(*place) for wall in walls], spacing / CELLS)


def surface_of_wall(shape: Shape) -> Surface:
    """What collides of a shape, in its body's frame: of a mesh its convex hull, where that does."""
    surface = surface_of(shape)
    if not shape.convex:
        return surface
    import trimesh  # heavy, and only a mesh that moves needs it

    hull = trimesh.Trimesh(surface.vertices, surface.triangles, process=False).convex_hull
    return Surface(np.asarray(hull.vertices), np.asarray(hull.faces, dtype=np.intp))
