"""The convex pieces that collide for a mesh, as Newton cut them: no more corners than its hulls may have."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from newton import GeoType, ShapeFlags

from wsim.geometry.rotations import rotate
from wsim.geometry.shapes import into
from wsim.sim.contacts import whole

if TYPE_CHECKING:
    from wsim.scene.world import Shape, World


def with_pieces(builder: Any, world: World) -> World:
    """A world whose meshes say which corners collide for them.

    Args:
        builder: The `newton.ModelBuilder` of one world.
        world: What the stage states.
    """
    collide = int(ShapeFlags.COLLIDE_SHAPES)
    convex = [
        k
        for k, kind in enumerate(builder.shape_type)
        if kind == GeoType.CONVEX_MESH and int(builder.shape_flags[k]) & collide
    ]
    if not convex:
        return world
    of_label: dict[str, list[int]] = {}
    for k in convex:
        of_label.setdefault(whole(str(builder.shape_label[k])), []).append(k)

    def cut(shape: Shape) -> Shape:
        found = [_corners(builder, k, shape) for k in of_label.get(shape.prim, [])]
        return shape.model_copy(update={"pieces": found}) if found else shape

    bodies = [body.model_copy(update={"shapes": [cut(shape) for shape in body.shapes]}) for body in world.bodies]
    statics = [
        static.model_copy(update={"shapes": [cut(shape) for shape in static.shapes]}) for static in world.statics
    ]
    return world.model_copy(update={"bodies": bodies, "statics": statics})


def _corners(builder: Any, k: int, shape: Shape) -> list[tuple[float, float, float]]:
    """Of one of the builder's shapes, in the frame of the stage's [m]."""
    own = np.asarray(builder.shape_source[k].vertices, dtype=np.float64) * np.array(builder.shape_scale[k])
    place = np.array(builder.shape_transform[k], dtype=np.float64)
    return [(x, y, z) for x, y, z in into(shape, rotate(place[3:], own) + place[:3]).tolist()]
