"""The solids that an SPH fluid meets, read from a Newton model and sampled with particles."""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from newton import GeoType, ShapeFlags
from scipy.spatial import cKDTree

from wsim.geometry.filled import Samples, box_lattice, capsule_layers, cylinder_layers, sphere_layers
from wsim.geometry.rotations import rotate
from wsim.limits import LEAST_ACROSS
from wsim.solvers.layers import mesh_layers
from wsim.solvers.sampling import container_walls
from wsim.solvers.sph_config import ConfigSPH
from wsim.solvers.vessels import Vessel

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


def sample_bodies(model: Any, config: ConfigSPH, vessels: Sequence[Vessel] = ()) -> Boundary:
    """Sample every colliding shape of a model's bodies, and the walls of those that are vessels.

    Args:
        model: The `newton.Model`.
        config: For the spacing and the dimensions.
        vessels: What holds fluid beside tanks; the shapes of one are its walls.
    """
    bodies, poses, kinds = model.shape_body.numpy(), model.shape_transform.numpy(), model.shape_type.numpy()
    scales, flags = model.shape_scale.numpy(), model.shape_flags.numpy()
    walls = frozenset().union(*(vessel.shapes for vessel in vessels))
    moving: list[list[tuple[Array, Array]]] = [[] for _ in range(model.body_count)]
    for shape in range(model.shape_count):
        if bodies[shape] < 0 or not flags[shape] & ShapeFlags.COLLIDE_SHAPES or model.shape_label[shape] in walls:
            continue
        kind, source = int(kinds[shape]), model.shape_source[shape]
        found = sample_shape(kind, scales[shape], source, config.spacing, config.dimensions == 2)
        if found is None:
            name = GeoType(kind).name
            warnings.warn(f"SolverSPH: the fluid does not see {model.shape_label[shape]}, a {name}", stacklevel=3)
            continue
        position = rotate(poses[shape][3:], found.position) + poses[shape][:3]
        moving[bodies[shape]].append((position, found.volume))
    _add_vessels(model, config.spacing, vessels, moving)
    return _join(moving, model.body_world.numpy() if model.body_count else np.zeros(0, int))


def _add_vessels(
    model: Any, spacing: float, vessels: Sequence[Vessel], moving: list[list[tuple[Array, Array]]]
) -> None:
    """Add the walls of vessels that are bodies to those of their bodies."""
    labels, worlds = [str(label) for label in model.body_label], model.body_world.numpy()
    for vessel in vessels:
        if vessel.body is None:
            continue
        found = vessel.walls(spacing)
        for body, label in enumerate(labels):
            if label == vessel.body and vessel.world in (-1, int(worlds[body])):
                moving[body].append((found.position, found.volume))


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


def _join(moving: list, body_world: Array) -> Boundary:
    """The particles of each body after those of the one before."""
    pieces = [(p, v, body) for body, own in enumerate(moving) for p, v in own]
    sizes = [len(p) for p, _, _ in pieces]
    owner = np.repeat([body for _, _, body in pieces], sizes).astype(np.int32)
    return Boundary(
        local=np.concatenate([p for p, _, _ in pieces]) if pieces else np.zeros((0, 3)),
        volume=np.concatenate([v for _, v, _ in pieces]) if pieces else np.zeros(0),
        owner=owner,
        world=np.maximum(body_world[owner], 0).astype(np.int32),
        first=np.searchsorted(owner, np.arange(len(moving) + 1)).astype(np.int32),
    )
