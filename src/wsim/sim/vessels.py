"""What of a world holds fluid beside tanks: its walls, its room, where it moves."""

from __future__ import annotations

import itertools
import math

import numpy as np

from wsim.errors import UserError
from wsim.geometry.rotations import rotate
from wsim.geometry.shapes import kind_of
from wsim.scene.hollows import hollow_of, surface_of_wall
from wsim.scene.usd_motion import curve_of
from wsim.scene.world import Body, Fluid, Quat, Shape, Vec3, World
from wsim.sim.filling import spread
from wsim.solvers.vessels import Vessel

Array = np.ndarray
KEYS = 16  # places between two keys of a path
FREE = 6.0  # of its own radius that what nobody leads may go
SHARE = 0.2  # of sound that water may be carried at: it is no flow, and compresses nothing


def vessels_of(world: World, k: int = -1) -> list[Vessel]:
    """What fluid fills beside tanks in world k, or in all, with the labels of the shapes that each stands for."""
    found: dict[str | None, Vessel] = {}
    for fluid in world.fluids:
        if fluid.volume is None or fluid.container in found:
            continue
        shapes, _, turn = _held_by(fluid, world)
        walls = [shape for shape in shapes if shape.collides and shape.kind != "plane"]
        body = next((body for body in world.bodies if body.prim == fluid.container), None)
        found[fluid.container] = Vessel(
            surfaces=tuple(surface_of_wall(shape) for shape in walls),
            upright=turn,
            shapes=frozenset(shape.prim for shape in walls),
            body=body.prim if body else None,
            goes=_room(body) if body else _around(walls),
            world=k,
        )
    return list(found.values())


def places_in(fluid: Fluid, world: World) -> Array:
    """Places in the hollow of the fluid's vessel (n, 3) [m].

    Raises:
        UserError: If it has none.
    """
    try:
        hollow = hollow_of(*_held_by(fluid, world), fluid.spacing)
    except ValueError as error:
        raise UserError(f"{fluid.prim}: {fluid.container} holds no fluid: {error}; name a vessel") from error
    return spread(hollow.filling(fluid.center[2] + 0.5 * fluid.size[2]), fluid.spacing, fluid.particles)


def carried_speed(fluid: Fluid, world: World) -> float:
    """What sound is to be ten times as fast as, for how its vessel is led [m/s]: it grows heavy, and flies.

    0 of one that nobody leads.
    """
    body = next((body for body in world.bodies if body.prim == fluid.container and body.path), None)
    if body is None or fluid.volume is None:
        return 0.0
    times, place, turned = way_of(body)
    local = rotate(np.array(body.rotation) * [-1, -1, -1, 1], np.array(fluid.center) - np.array(body.position))
    velocity = np.gradient(place + rotate(turned, local), times, axis=0)
    pull = float(np.linalg.norm(np.gradient(velocity, times, axis=0) - np.array(world.gravity), axis=1).max())
    fastest = float(np.linalg.norm(velocity, axis=1).max())
    return max(math.sqrt(pull * max(fluid.size)), SHARE * fastest)


def _held_by(fluid: Fluid, world: World) -> tuple[list[Shape], Vec3, Quat]:
    """The shapes of what holds a fluid, and the pose of their frame."""
    for body in world.bodies:
        if body.prim == fluid.container:
            return body.shapes, body.position, body.rotation
    shapes = next((static.shapes for static in world.statics if static.prim == fluid.container), [])
    return shapes, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)


def _room(body: Body) -> tuple[Vec3, Vec3]:
    """Corners of the room that a vessel moves in [m]: along its path, or around where it starts."""
    radius = max(float(np.linalg.norm(shape.position)) + kind_of(shape).radius_about for shape in body.shapes)
    place = way_of(body)[1] if body.path else np.array([body.position])
    margin = radius * (2.0 if body.path else FREE)
    low, high = (place.min(axis=0) - margin).tolist(), (place.max(axis=0) + margin).tolist()
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def _around(walls: list[Shape]) -> tuple[Vec3, Vec3]:
    """Corners of what is upright around shapes that stand still [m]."""
    points = np.concatenate([surface_of_wall(shape).vertices for shape in walls])
    low, high = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def way_of(body: Body) -> tuple[Array, Array, Array]:
    """Times [s], places [m] and rotations along a body's path."""
    assert body.path is not None
    keys = body.path.times
    times = np.unique(np.concatenate([np.linspace(a, b, KEYS) for a, b in itertools.pairwise(keys)]))
    curve = curve_of(body.path)
    poses = [curve.pose(time) for time in times.tolist()]
    return times, np.stack([place for place, _ in poses]), np.stack([turn for _, turn in poses])
