"""Fluid in boxes and vessels → particles."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from newton import GeoType, ParticleFlags, ShapeFlags

from wsim.errors import UserError
from wsim.geometry.filled import box_lattice
from wsim.geometry.rotations import conjugate, rotate
from wsim.geometry.shapes import into, kind_of
from wsim.scene.world import Fluid, Shape, World
from wsim.sim.falls import over_all, poured
from wsim.sim.openings import fastest_poured, taps_of, waiting
from wsim.sim.vessels import carried_speed, places_in
from wsim.solvers.inside import depth_in, is_open, solid_of
from wsim.solvers.shapes import OpenBox
from wsim.solvers.sph_config import ConfigSPH
from wsim.solvers.sph_mouths import in_pipe

SOUND_OVER_SPEED = 10.0  # keeps the density within 1 % (Monaghan 1994)

Array = np.ndarray
Depth = Callable[[Array], Array]


@dataclass(frozen=True)
class Seeded:
    """The particles of one fluid, n of them: positions [m] and velocities [m/s] (n, 3), masses [kg], pressures [Pa] and
    `ParticleFlags`; and what all of them are of, by the solver's names.

    Those that wait for taps follow the others; they are not `ParticleFlags.ACTIVE`.
    """

    prim: str
    position: Array
    velocity: Array
    mass: Array
    pressure: Array
    flags: Array
    liquid: dict[str, float]


def containers_of(world: World, k: int = -1) -> list[OpenBox]:
    """The tanks of world k, or of all, with the labels of the wall shapes that each stands for."""
    walls = {static.prim: frozenset(shape.prim for shape in static.shapes) for static in world.statics}
    return [
        OpenBox(c.inner_center, c.inner_size, c.rotation, walls.get(c.prim, frozenset()), world=k)
        for c in world.containers
    ]


def heaviest(world: World) -> Fluid:
    """The densest fluid, the first of them: it lies where water seeps to, and a world with one liquid is all of it.

    Raises:
        UserError: If two fluids have different spacings: the solver has one.
    """
    first = world.fluids[0]
    for other in world.fluids[1:]:
        if not math.isclose(first.spacing, other.spacing):
            raise UserError(
                f"{other.prim}: spacing = {other.spacing} differs from the {first.spacing} of {first.prim}; all fluids "
                "of a world must share it"
            )
    return max(world.fluids, key=lambda fluid: fluid.density)


def several_liquids(worlds: Sequence[World]) -> bool:
    """Whether two fluids of a world differ, or one yields, so that each particle needs its own numbers."""
    if not all(fluid.newtonian for world in worlds for fluid in world.fluids):
        return True
    return any(
        not math.isclose(getattr(world.fluids[0], name), getattr(other, name))
        for world in worlds
        for other in world.fluids[1:]
        for name in ("density", "viscosity")
    )


def sph_config(worlds: Sequence[World]) -> ConfigSPH | None:
    """The method's settings for worlds that are simulated at once; None without a fluid.

    They share the spacing, and sound is as fast as the one of them that needs it fastest has it. What each has of its
    own is in `of_worlds`.
    """
    if not worlds[0].fluids:
        return None
    fluids = [heaviest(world) for world in worlds]
    sound = [
        max(fluid.speed_of_sound for fluid in world.fluids) or SOUND_OVER_SPEED * expected_speed(world)
        for world in worlds
    ]
    return ConfigSPH(
        spacing=fluids[0].spacing,
        rest_density=fluids[0].density,
        # The solver takes a world's 0 for "as the method has it", so that must be 0 if one world's is.
        viscosity=min(fluid.viscosity for fluid in fluids),
        speed_of_sound=max(sound),
    )


def of_worlds(worlds: Sequence[World]) -> dict[str, list[float]]:
    """What the solver has of each world by itself, as `SolverSPH.register_custom_attributes` names it."""
    fluids = [heaviest(world) for world in worlds]
    return {"rest_density": [fluid.density for fluid in fluids], "viscosity": [fluid.viscosity for fluid in fluids]}


def largest_step(world: World, config: ConfigSPH) -> float:
    """The longest step that a world's fluids can take under common settings [s]."""
    return min(
        replace(config, rest_density=fluid.density, viscosity=fluid.viscosity).max_time_step
        if fluid.newtonian
        else config.yielding_time_step(_at_rest(fluid, config) / fluid.density)
        for fluid in world.fluids
    )


def _at_rest(fluid: Fluid, config: ConfigSPH) -> float:
    """Viscosity of what yields where it does not flow [Pa s]."""
    return float(config.largest_viscosity_of(np.array([fluid.density]), np.array([fluid.viscosity]))[0])


def expected_speed(world: World) -> float:
    """Largest speed that the fluid should see [m/s]: its start, waves or a collapse, jets, and bodies that fall in."""
    g = float(np.linalg.norm(world.gravity))
    speeds = [0.1, fastest_poured(world, g)]
    for fluid in world.fluids:
        # A fluid that fills its container from wall to wall can only slosh, at the shallow-water wave's speed;
        # a column in one falls by its height, a free one to the lowest that there is.
        falls = 2.0 * (fluid.size[2] if fluid.container else max(over_all(fluid, world), fluid.size[2]))
        wave = math.sqrt((fluid.size[2] if _fills(fluid, world) else falls) * g)
        speeds += [math.hypot(*fluid.velocity, wave), carried_speed(fluid, world)]
        speeds.append(math.sqrt(2.0 * g * poured(fluid, world)))
    for body in world.bodies:
        bottom = body.position[2] - 0.5 * min((kind_of(shape).thinnest for shape in body.shapes), default=0.0)
        drop = max((bottom - (f.center[2] + 0.5 * f.size[2]) for f in world.fluids), default=0.0)
        speeds.append(math.sqrt(2.0 * g * max(drop, 0.0)))
    return max(speeds)


def _fills(fluid: Fluid, world: World) -> bool:
    if fluid.volume is not None:
        return True
    box = next((c for c in world.containers if c.prim == fluid.container), None)
    return box is not None and all(
        math.isclose(fluid.size[k], box.inner_size[k], abs_tol=fluid.spacing) for k in (0, 1)
    )


def mesh_depths(builder: Any, world: World) -> dict[str, list[Depth]]:
    """How deep points are inside each mesh that collides, by the prim of its body or fixed object, in that one's frame.

    As the solver samples them: of a mesh it may be the convex hull, or the parts, that are there.
    """
    owners = {body.prim for body in world.bodies} | {static.prim for static in world.statics}
    filled = {fluid.container for fluid in world.fluids if fluid.volume is not None}
    found: dict[str, list[Depth]] = {}
    for k, kind in enumerate(builder.shape_type):
        owner = str(builder.shape_label[k])
        while owner and owner not in owners:
            owner = owner.rpartition("/")[0]
        if not builder.shape_flags[k] & ShapeFlags.COLLIDE_SHAPES or kind not in (GeoType.MESH, GeoType.CONVEX_MESH):
            continue
        source, pose = builder.shape_source[k], np.array(builder.shape_transform[k])
        vertices = np.asarray(source.vertices, dtype=float).reshape(-1, 3) * np.array(builder.shape_scale[k])
        vertices = rotate(pose[3:], vertices) + pose[:3]
        triangles = np.asarray(source.indices).reshape(-1, 3)
        if owner in filled and kind == GeoType.MESH and is_open(vertices, triangles):
            continue  # a vessel that is a sheet: nothing is inside
        solid = solid_of(vertices, triangles, kind == GeoType.CONVEX_MESH)
        found.setdefault(owner, []).append(depth_in(solid))
    return found


def seed(fluid: Fluid, world: World, config: ConfigSPH, meshes: dict[str, list[Depth]]) -> Seeded:
    """Particles of a fluid: of its box, and those that wait for its taps.

    The mass of each is the fluid's density times its cell, so that the fluid's mass is right whatever the spacing.
    The pressure is hydrostatic, under what stands on it too.

    Args:
        fluid: The box, or what fills a vessel; a box of no height holds nothing yet.
        world: For gravity, taps, and the bodies and fixed objects that stand in the fluid.
        config: Settings of the method.
        meshes: What `mesh_depths` found of those.

    Raises:
        UserError: If there is no room for it.
    """
    position = _standing(fluid, world, config, meshes) if fluid.size[2] > 0.0 else np.zeros((0, 3))
    depth = 0.5 * fluid.size[2] + fluid.center[2] - position[:, 2]
    over = sum(_over(fluid, other, position) for other in world.fluids if other is not fluid)
    pressure = abs(world.gravity[2]) * (fluid.density * np.maximum(depth, 0.0) + over)
    there, count = len(position), waiting(fluid, world, config, fluid.cell)
    return Seeded(
        prim=fluid.prim,
        position=np.concatenate([position, np.zeros((count, 3))]),
        velocity=np.repeat([fluid.velocity, (0.0, 0.0, 0.0)], [there, count], axis=0),
        mass=np.full(there + count, fluid.density * fluid.cell),
        pressure=np.append(pressure, np.zeros(count)),
        flags=np.repeat(np.array([int(ParticleFlags.ACTIVE), 0], dtype=np.int32), [there, count]),
        liquid={
            "liquid_density": fluid.density,
            "liquid_viscosity": fluid.viscosity,
            "yield_stress": fluid.yield_stress,
            "flow_index": fluid.flow_index,
        },
    )


def _over(fluid: Fluid, other: Fluid, position: Array) -> Array:
    """Mass over each place of a fluid of another that stands on it in the same container, per area (n,) [kg/m^2]."""
    if other.container != fluid.container or other.center[2] < fluid.center[2]:
        return np.zeros(len(position))
    off = np.abs(position[:, :2] - np.array(other.center[:2])) <= 0.5 * np.array(other.size[:2])
    return np.where(off.all(axis=1), other.density * other.size[2], 0.0)


def _standing(fluid: Fluid, world: World, config: ConfigSPH, meshes: dict[str, list[Depth]]) -> Array:
    """Where particles of a fluid are: not where a solid or the pipe of a tap already is, (n, 3) [m]."""
    position = places_in(fluid, world) if fluid.volume is not None else _in_box(fluid, world)
    free = np.ones(len(position), dtype=bool)
    margin = 0.4 * fluid.spacing
    for body in world.bodies:
        if body.prim != fluid.container:
            local = rotate(conjugate(np.array(body.rotation)), position - np.array(body.position))
            free &= ~_inside(body.shapes, local, margin, meshes.get(body.prim, []))
    for static in world.statics:
        if static.prim != fluid.container:  # to whose walls the fluid is cut
            free &= ~_inside(static.shapes, position, margin, meshes.get(static.prim, []))
    for tap in taps_of(world):
        free &= ~in_pipe(tap, config, fluid.cell, position, margin)
    if not free.any():
        raise UserError(f"{fluid.prim}: bodies leave no room for fluid of spacing {fluid.spacing} m in {fluid.size} m")
    return position[free]


def _in_box(fluid: Fluid, world: World) -> Array:
    """Places on a lattice in the fluid's box, turned as its container is (n, 3) [m]."""
    cells = box_lattice(np.array(fluid.size), fluid.spacing)
    rotation = next((c.rotation for c in world.containers if c.prim == fluid.container), (0.0, 0.0, 0.0, 1.0))
    return rotate(np.array(rotation), cells.position) + np.array(fluid.center)


@dataclass(frozen=True)
class Filled:
    """What `add_seeded` has put in: of each world the range of each fluid's particles there, by prim; and numbers of
    all particles (n,), by the solver's names."""

    ranges: list[dict[str, slice]]
    numbers: dict[str, Array]


def add_seeded(builder: Any, worlds: Sequence[World], config: ConfigSPH) -> Filled:
    """Fill the worlds of a builder that has no particles with fluid, as arrays."""
    parts, ranges = [], []
    for world in worlds:
        seeded = [seed(fluid, world, config, {}) for fluid in world.fluids]
        ends = np.cumsum([0, *(len(each.mass) for each in seeded)]).tolist()
        ranges.append({each.prim: slice(*ends[k : k + 2]) for k, each in enumerate(seeded)})
        parts += seeded
    counts = [sum(part.stop - part.start for part in own.values()) for own in ranges]
    builder.particle_q = np.concatenate([part.position for part in parts]).astype(np.float32)
    builder.particle_qd = np.concatenate([part.velocity for part in parts]).astype(np.float32)
    builder.particle_mass = np.concatenate([part.mass for part in parts]).astype(np.float32)
    radii = [0.5 * fluid.spacing for world in worlds for fluid in world.fluids]
    lengths = [len(part.mass) for part in parts]
    builder.particle_radius = np.repeat(np.array(radii, dtype=np.float32), lengths)
    builder.particle_flags = np.concatenate([part.flags for part in parts])
    builder.particle_world = np.repeat(np.arange(len(worlds), dtype=np.int32), counts)
    numbers = {"pressure": np.concatenate([part.pressure for part in parts]).astype(np.float32)}
    if several_liquids(worlds):
        for name in parts[0].liquid:
            own = np.array([part.liquid[name] for part in parts], dtype=np.float32)
            numbers[name] = np.repeat(own, lengths)
    return Filled(ranges, numbers)


def _inside(shapes: list[Shape], points: Array, margin: float, meshes: list[Depth]) -> Array:
    """Which points lie in an object's shapes, or within `margin` [m] of them, all in its frame."""
    inside = np.zeros(len(points), dtype=bool)
    for shape in shapes:
        if shape.collides and shape.kind == "plane":
            inside |= kind_of(shape).depth(into(shape, points)) > -margin
        elif shape.collides and shape.kind != "mesh":
            inside |= np.maximum.reduce(kind_of(shape).beyond(into(shape, points))) < margin
    for depth in meshes:
        inside |= depth(points) > -margin
    return inside
