"""What is kept from MuJoCo: meshes that stand still, which it would take the hulls of, and pairs with cylinders."""

from __future__ import annotations

from typing import Any

import numpy as np
from newton import GeoType, ShapeFlags

from wsim.geometry.rotations import rotate
from wsim.scene.world import Shape, World
from wsim.solvers.surface_contacts import SurfaceParts
from wsim.solvers.surface_mesh import Part

EXACT = (GeoType.BOX, GeoType.CAPSULE, GeoType.CYLINDER)  # what `wsim.solvers.cylinder_contacts` knows


def take_surfaces(builder: Any, world: World) -> SurfaceParts | None:
    """The surfaces among a builder's shapes; MuJoCo no longer sees them touch. None where there is none.

    Args:
        builder: The `newton.ModelBuilder` of one world, all that does not touch already filtered.
        world: What the stage states.
    """
    labels = {str(label): k for k, label in enumerate(builder.shape_label)}
    exact = [shape for static in world.statics for shape in static.shapes if shape.exact and shape.prim in labels]
    if not exact or not world.bodies:
        return None
    spared = frozenset((min(a, b), max(a, b)) for a, b in builder.shape_collision_filter_pairs)
    shapes = [labels[shape.prim] for shape in exact]
    collide = int(ShapeFlags.COLLIDE_SHAPES)
    moving = [k for k, body in enumerate(builder.shape_body) if body >= 0 and int(builder.shape_flags[k]) & collide]
    for surface in shapes:
        # Newton says which pairs do not touch in 32 colours, and a vehicle among forty rocks takes more: what is left
        # over would be met a second time, as a convex hull. A shape of no group has no colour, and touches nothing.
        builder.shape_collision_group[surface] = 0
        for k in moving:
            builder.add_shape_collision_filter_pair(surface, k)
    return SurfaceParts([_part(shape) for shape in exact], shapes, spared)


def take_cylinders(builder: Any) -> tuple[tuple[int, int], ...]:
    """The pairs of a cylinder and a box, a capsule or a cylinder that may touch; MuJoCo no longer sees them do so.

    Args:
        builder: The `newton.ModelBuilder` of one world, all that does not touch already filtered.
    """
    spared = {(min(a, b), max(a, b)) for a, b in builder.shape_collision_filter_pairs}
    kinds, bodies, collide = builder.shape_type, builder.shape_body, int(ShapeFlags.COLLIDE_SHAPES)
    solid = [k for k in range(builder.shape_count) if int(builder.shape_flags[k]) & collide and kinds[k] in EXACT]
    pairs = []
    for one in solid:
        for two in solid:
            both = kinds[one] == kinds[two] == GeoType.CYLINDER
            if kinds[one] != GeoType.CYLINDER or (both and one > two) or bodies[one] == bodies[two]:
                continue
            if (min(one, two), max(one, two)) not in spared:
                pairs.append((one, two))
                builder.add_shape_collision_filter_pair(one, two)
    return tuple(pairs)


def _part(shape: Shape) -> Part:
    turn, position = np.array(shape.rotation), np.array(shape.position)
    vertices = rotate(turn, np.array(shape.vertices, dtype=np.float64)) + position
    triangles = np.array(shape.triangles, dtype=np.int64)
    normals = rotate(turn, np.array(shape.normals, dtype=np.float64)).reshape(-1, 3, 3) if shape.normals else None
    return Part(vertices, triangles, normals)
