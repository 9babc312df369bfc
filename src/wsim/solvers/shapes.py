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
from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.limits import LEAST_ACROSS
from wsim.solvers.layers import mesh_layers
from wsim.solvers.plane_sections import fill_section
from wsim.solvers.sampling import container_walls
from wsim.solvers.sph_config import ConfigSPH
from wsim.solvers.vessel_walls import VesselWalls

Array = np.ndarray
ROUNDED = 1e-6  # of a length: a model holds single precision


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
    """Particles of the bodies of all worlds, those of one body next to each other.

    `local` is in the body's frame [m]; `first[b]` is the first particle of body b, and `first[-1]` their number.
    """

    local: Array  # (n, 3)
    volume: Array  # (n,)
    owner: Array  # (n,) body
    world: Array  # (n,)
    first: Array  # (body_count + 1,)

    def crowd(self, reach: float) -> int:
        """Most particles of one body within `reach` [m] of any of its own: many, where its shapes overlap."""
        most = 0
        for first, last in itertools.pairwise(self.first.tolist()):
            if last > first:
                own = self.local[first:last]
                most = max(most, int(cKDTree(own).query_ball_point(own, reach, return_length=True).max()))
        return most


def sample_shape(kind: int, scale: Array, source: Any, spacing: float) -> Samples | None:
    """Fill one Newton shape with particles in its own frame; None for kinds that have no inside.

    Args:
        kind: A `newton.GeoType`.
        scale: Newton's shape scale: half extents of a box [m], radius and half height of a cylinder [m], …
        source: The `newton.Mesh` of a mesh.
        spacing: Particle spacing [m].
    """
    if kind == GeoType.BOX:
        return box_lattice(2.0 * scale, spacing)
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


def sample_bodies(model: Any, config: ConfigSPH, vessels: VesselWalls) -> Boundary:
    """Sample every colliding shape of a model's bodies, and the walls of those that are vessels.

    In a plane it is what y = 0 cuts out of them as the model has them at its start.

    Args:
        model: The `newton.Model`.
        config: For the spacing and the dimensions.
        vessels: The walls of vessels, which the shapes of those stand for.
    """
    bodies, poses, kinds = model.shape_body.numpy(), model.shape_transform.numpy(), model.shape_type.numpy()
    scales, flags = model.shape_scale.numpy(), model.shape_flags.numpy()
    starts = model.body_q.numpy().astype(float) if model.body_count else np.zeros((0, 7))
    worlds = np.maximum(model.body_world.numpy(), 0) if model.body_count else np.zeros(0, int)
    moving = [vessels.of(world, body) for body, world in enumerate(worlds.tolist())]
    for shape in range(model.shape_count):
        body, label = int(bodies[shape]), model.shape_label[shape]
        if body < 0 or not flags[shape] & ShapeFlags.COLLIDE_SHAPES or vessels.made_of(label):
            continue
        form = int(kinds[shape]), poses[shape].astype(float), scales[shape].astype(float), model.shape_source[shape]
        found = _of_body(*form, starts[body], config)
        if found is None:
            name = GeoType(form[0]).name
            warnings.warn(f"SolverSPH: the fluid does not see {label}, a {name}", stacklevel=3)
            continue
        moving[body].append(vessels.beside(found, int(worlds[body]), body, starts[body]))
    return _join(moving, worlds)


def _of_body(kind: int, pose: Array, scale: Array, source: Any, body: Array, config: ConfigSPH) -> Samples | None:
    """Particles of a body's shape, or in a plane of its section, in the body's frame; poses (7,) of both."""
    if config.dimensions == 2:
        stands = np.concatenate([rotate(body[3:], pose[:3]) + body[:3], multiply(body[3:], pose[3:])])
        found = fill_section(kind, stands, scale, source, config.spacing)
        return found and Samples(rotate(conjugate(body[3:]), found.position - body[:3]), found.volume)
    found = sample_shape(kind, scale, source, config.spacing)
    return found and Samples(rotate(pose[3:], found.position) + pose[:3], found.volume)


def sample_container(box: OpenBox, config: ConfigSPH) -> tuple[Array, Array]:
    """Walls of one tank, none along periodic axes and none across a plane."""
    plane = config.dimensions == 2
    open_axes = np.array([ends is not None for ends in config.periodic]) | np.array([False, plane, False])
    narrowest = min(length for axis, length in enumerate(box.size) if not open_axes[axis])
    if narrowest < LEAST_ACROSS * config.spacing * (1.0 - ROUNDED):
        raise ValueError(
            f"SolverSPH: spacing = {config.spacing} m is too coarse for a container of inner size {box.size} m: its "
            f"narrowest side holds {narrowest / config.spacing:.1f} particles and needs "
            f"{LEAST_ACROSS}; use spacing <= {narrowest / LEAST_ACROSS:.4g}"
        )
    sides = np.array([[True, True], [True, True], [True, box.closed]]) & ~open_axes[:, None]
    samples = container_walls(np.array(box.size), config.spacing, config.support, sides, plane)
    return rotate(np.array(box.rotation), samples.position) + np.array(box.center), samples.volume


def _join(moving: list[list[Samples]], body_world: Array) -> Boundary:
    """The particles of each body after those of the one before."""
    pieces = [samples for own in moving for samples in own]
    sizes = [sum(len(samples.volume) for samples in own) for own in moving]
    owner = np.repeat(np.arange(len(moving)), sizes).astype(np.int32)
    return Boundary(
        local=np.concatenate([p.position for p in pieces]) if pieces else np.zeros((0, 3)),
        volume=np.concatenate([p.volume for p in pieces]) if pieces else np.zeros(0),
        owner=owner,
        world=body_world[owner].astype(np.int32),
        first=np.searchsorted(owner, np.arange(len(moving) + 1)).astype(np.int32),
    )
