"""The solids that an SPH fluid meets, read from a Newton model and sampled with particles."""

from __future__ import annotations

import itertools
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from newton import GeoType, ShapeFlags
from scipy.spatial import cKDTree

from wsim.geometry.filled import Samples, box_lattice, capsule_layers, cylinder_layers, sphere_layers
from wsim.geometry.rotations import rotate
from wsim.solvers.layers import mesh_layers
from wsim.solvers.sampling import container_walls, plane_patch
from wsim.solvers.sph_config import ConfigSPH
from wsim.solvers.vessels import Vessel, own_label

Array = np.ndarray
Piece = tuple[Array, Array]  # positions (n, 3) [m] and volumes (n,) [m^3]
CLEAR = 0.9  # spacings between what is a vessel's wall and what is not


@dataclass(frozen=True)
class OpenBox:
    """The hollow of a tank.

    Its walls are sampled outward as deep as the kernel reaches, however thin the glass is: a thin wall's own volume
    would leave the kernel of a particle beside it half empty, and the fluid would leak.
    """

    center: tuple[float, float, float]
    """Centre of the hollow [m]."""
    size: tuple[float, float, float]
    """Inner edge lengths [m]."""
    rotation: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)
    """Orientation, xyzw."""
    shapes: frozenset[str] = frozenset()
    """Labels of the model's shapes that are its walls; they are not sampled again."""
    closed: bool = False
    """Whether it has a lid."""
    world: int = -1
    """The world that it stands in; -1 is every world."""

    @property
    def floor(self) -> float:
        """Height of the lowest point of the hollow [m]."""
        corners = np.array(np.meshgrid(*[[-0.5, 0.5]] * 3)).reshape(3, -1).T * np.array(self.size)
        return float((rotate(np.array(self.rotation), corners) + np.array(self.center))[:, 2].min())


@dataclass(frozen=True)
class Boundary:
    """Boundary particles of all worlds, those of one body next to each other, fixed ones first.

    `local` is in the owner's frame (the world's where owner is -1) [m]; `body_first[b]` is the first particle of
    body b, and `body_first[-1]` the number of particles.
    """

    local: Array  # (n, 3)
    volume: Array  # (n,)
    owner: Array  # (n,) body, or -1
    world: Array  # (n,)
    body_first: Array  # (body_count + 1,)

    def crowd(self, reach: float) -> int:
        """Most particles of one body within `reach` [m] of any of its own: many, where its shapes overlap."""
        most = 0
        for first, last in itertools.pairwise(self.body_first.tolist()):
            if last > first:
                own = self.local[first:last]
                most = max(most, int(cKDTree(own).query_ball_point(own, reach, return_length=True).max()))
        return most


def sample_shape(kind: int, scale: Array, source: Any, spacing: float, plane: bool = False) -> Samples | None:
    """Fill one Newton shape with particles in its own frame; None for kinds that have no inside.

    Args:
        kind: A `newton.GeoType`.
        scale: Newton's shape scale: half extents of a box [m], radius and half height of a cylinder [m], …
        source: The `newton.Mesh` of a mesh.
        spacing: Particle spacing [m].
        plane: One layer at y = 0, for a flow in the x-z plane.

    Raises:
        ValueError: If a shape other than a box is met in a plane.
    """
    if kind == GeoType.BOX:
        return box_lattice(2.0 * scale, spacing, plane)
    if plane:
        raise ValueError(f"SolverSPH: a {GeoType(kind).name} in a flow of 2 dimensions; only boxes stand in a plane")
    if kind == GeoType.SPHERE:
        return sphere_layers(float(scale[0]), spacing)
    if kind == GeoType.CYLINDER:
        return cylinder_layers(float(scale[0]), float(scale[1]), spacing)
    if kind == GeoType.CAPSULE:
        return capsule_layers(float(scale[0]), float(scale[1]), spacing)
    if kind in (GeoType.MESH, GeoType.CONVEX_MESH):
        vertices = np.asarray(source.vertices, dtype=float).reshape(-1, 3) * scale
        triangles = np.asarray(source.indices).reshape(-1, 3)
        return mesh_layers(vertices, triangles, spacing, convex=kind == GeoType.CONVEX_MESH)
    return None


def near_fluid(position: Array, fluid: Array, support: float) -> Array:
    """Which samples of a fixed shape the fluid may reach: those within one fluid's length of it, seen from above."""
    low, high = fluid.min(axis=0), fluid.max(axis=0)
    reach = max(float((high - low).max()), support)
    return ((position[:, :2] >= low[:2] - reach) & (position[:, :2] <= high[:2] + reach)).all(axis=1)


def sample_boundary(
    model: Any,
    config: ConfigSPH,
    containers: tuple[OpenBox, ...],
    fluid: Array,
    fluid_world: Array,
    vessels: tuple[Vessel, ...] = (),
) -> Boundary:
    """Sample every colliding shape of a model.

    Ground planes are sampled under fluid that no container holds, out to one fluid's length around it.

    Args:
        model: The `newton.Model`.
        config: For the spacing, the kernel's support, dimensions and periodic axes.
        containers: Tanks.
        fluid: Fluid positions [m], shape (n, 3).
        fluid_world: World of each fluid particle, shape (n,).
        vessels: What else holds fluid.

    Raises:
        ValueError: If a container is too narrow for the spacing.
    """
    walls = frozenset().union(*(box.shapes for box in containers), *(vessel.shapes for vessel in vessels))
    bodies, poses, kinds = model.shape_body.numpy(), model.shape_transform.numpy(), model.shape_type.numpy()
    scales, flags, worlds = model.shape_scale.numpy(), model.shape_flags.numpy(), model.shape_world.numpy()
    world_count = max(1, model.world_count)
    fixed: list[list[Piece]] = [[] for _ in range(world_count)]
    moving: list[list[Piece]] = [[] for _ in range(model.body_count)]
    plane = config.dimensions == 2

    for box in containers:
        piece = _sample_container(box, config)
        for world in range(world_count) if box.world < 0 else (box.world,):
            fixed[world].append(piece)
    behind = _vessels(model, config.spacing, vessels)

    for shape in range(model.shape_count):
        if not flags[shape] & ShapeFlags.COLLIDE_SHAPES or own_label(str(model.shape_label[shape])) in walls:
            continue
        homes = range(world_count) if worlds[shape] < 0 else [int(worlds[shape])]
        if kinds[shape] == GeoType.PLANE:
            for world in homes:
                here = fluid[fluid_world == world]
                if len(here) and not containers:
                    reach = float((here.max(axis=0) - here.min(axis=0)).max())
                    low, high = here.min(axis=0)[:2] - reach, here.max(axis=0)[:2] + reach
                    for axis in (0, 1):
                        ends = config.periodic[axis]
                        low[axis], high[axis] = ends or (low[axis], high[axis])
                    samples = plane_patch(low, high, config.spacing, config.support, plane)
                    height = np.array([0.0, 0.0, poses[shape][2]])
                    fixed[world].append((samples.position + height, samples.volume))
            continue
        found = sample_shape(int(kinds[shape]), scales[shape], model.shape_source[shape], config.spacing, plane)
        if found is None:
            kind = GeoType(int(kinds[shape])).name
            warnings.warn(f"SolverSPH: the fluid does not see {model.shape_label[shape]}, a {kind}", stacklevel=3)
            continue
        position = rotate(poses[shape][3:], found.position) + poses[shape][:3]
        if bodies[shape] >= 0:
            moving[bodies[shape]].append((position, found.volume))
            continue
        for world in homes:
            here = fluid[fluid_world == world]
            if len(here):
                keep = near_fluid(position, here, config.support) & _in_period(position, config)
                fixed[world].append((position[keep], found.volume[keep]))
    _put_before(model, behind, fixed, moving, config.spacing)
    return _join(fixed, moving, model.body_world.numpy() if model.body_count else np.zeros(0, int))


def _vessels(model: Any, spacing: float, vessels: tuple[Vessel, ...]) -> list[tuple[int, int, Piece]]:
    """World, body (-1: it stands still) and walls in its frame of each."""
    found = []
    for vessel in vessels:
        walls = vessel.walls(spacing)
        found += [(world, body, (walls.position, walls.volume)) for world, body in vessel.homes(model)]
    return found


def _put_before(
    model: Any,
    vessels: list[tuple[int, int, Piece]],
    fixed: list[list[Piece]],
    moving: list[list[Piece]],
    spacing: float,
) -> None:
    """Add vessels' walls; what of anything else is in them at the start would count twice through a thin floor."""
    poses = model.body_q.numpy().astype(float) if model.body_count else np.zeros((0, 7))
    worlds = model.body_world.numpy() if model.body_count else np.zeros(0, int)
    for world, body, (position, _) in vessels:
        tree = cKDTree(position if body < 0 else rotate(poses[body, 3:], position) + poses[body, :3])
        fixed[world] = [_clear_of(tree, piece, None, spacing) for piece in fixed[world]]
        for k in np.flatnonzero(np.maximum(worlds, 0) == world).tolist():
            if k != body:
                moving[k] = [_clear_of(tree, piece, poses[k], spacing) for piece in moving[k]]
    for world, body, piece in vessels:
        (fixed[world] if body < 0 else moving[body]).append(piece)


def _clear_of(tree: cKDTree, piece: Piece, pose: Array | None, spacing: float) -> Piece:
    position, volume = piece
    place = position if pose is None else rotate(pose[3:], position) + pose[:3]
    keep = tree.query(place)[0] > CLEAR * spacing
    return position[keep], volume[keep]


def _in_period(position: Array, config: ConfigSPH) -> Array:
    """Which positions are in the periodic box; what a fixed shape has beyond it is its own image."""
    keep = np.ones(len(position), dtype=bool)
    for axis, ends in enumerate(config.periodic):
        if ends is not None:
            keep &= (position[:, axis] >= ends[0]) & (position[:, axis] < ends[1])
    return keep


def _sample_container(box: OpenBox, config: ConfigSPH) -> tuple[Array, Array]:
    """Walls of one tank, none along periodic axes and none across a plane."""
    plane = config.dimensions == 2
    open_axes = np.array([ends is not None for ends in config.periodic]) | np.array([False, plane, False])
    narrowest = min(length for axis, length in enumerate(box.size) if not open_axes[axis])
    if narrowest < 4.0 * config.spacing:
        raise ValueError(
            f"SolverSPH: spacing = {config.spacing} m is too coarse for a container of inner size {box.size} m: its "
            f"narrowest side holds {narrowest / config.spacing:.1f} particles and needs 4; "
            f"use spacing <= {narrowest / 4.0:.4g}"
        )
    sides = np.array([[True, True], [True, True], [True, box.closed]]) & ~open_axes[:, None]
    samples = container_walls(np.array(box.size), config.spacing, config.support, sides, plane)
    return rotate(np.array(box.rotation), samples.position) + np.array(box.center), samples.volume


def _join(fixed: list, moving: list, body_world: Array) -> Boundary:
    """Fixed particles world by world, then those of each body."""
    groups = [(p, v, -1, w) for w, pieces in enumerate(fixed) for p, v in pieces]
    first = sum(len(p) for p, _, _, _ in groups)
    body_first = [first]
    for body, pieces in enumerate(moving):
        groups += [(p, v, body, max(0, int(body_world[body]))) for p, v in pieces]
        body_first.append(body_first[-1] + sum(len(p) for p, _ in pieces))
    sizes = [len(p) for p, _, _, _ in groups]
    return Boundary(
        local=np.concatenate([p for p, _, _, _ in groups]) if groups else np.zeros((0, 3)),
        volume=np.concatenate([v for _, v, _, _ in groups]) if groups else np.zeros(0),
        owner=np.repeat([o for _, _, o, _ in groups], sizes).astype(np.int32) if groups else np.zeros(0, np.int32),
        world=np.repeat([w for _, _, _, w in groups], sizes).astype(np.int32) if groups else np.zeros(0, np.int32),
        body_first=np.array(body_first, dtype=np.int32),
    )
