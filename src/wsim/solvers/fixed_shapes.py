"""One thing that stands still, as particles near its surface: those in a part of space, when they are asked for."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from newton import GeoType

from wsim.geometry.filled import Samples, capsule_layers, cylinder_layers, lattice_axis, sphere_layers
from wsim.geometry.rotations import conjugate, rotate
from wsim.solvers.inside import depth_in, solid_of
from wsim.solvers.layers import mesh_layers, mesh_part
from wsim.solvers.plane_sections import fill_outline, section_of, upright_box
from wsim.solvers.sampling import layers_within
from wsim.solvers.sph_config import ConfigSPH

Array = np.ndarray
CORNERS = np.stack(np.meshgrid(*[[0.0, 1.0]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
MOST_WHOLE = 2**15  # cells of a lattice that fills a mesh; a larger mesh is filled part by part
ENDLESS = 1e4  # [m]: a plane's edges, where it has none
EMPTY = Samples(np.zeros((0, 3)), np.zeros(0))


class FixedShape(Protocol):
    """A shape in the world's frame."""

    low: Array  # (3,) corners of what is upright around it [m]
    high: Array

    def near(self, low: Array, high: Array) -> Samples:
        """Its particles between two corners [m], and perhaps some beside them; always the same ones."""

    def depth(self, points: Array) -> Array:
        """How deep points (n, 3) are inside of it, (n,) [m]; negative outside."""


class FixedLattice:
    """A box, or the ground under a plane, on a lattice; only what is less than `shell` below its faces.

    Args:
        pose: Position and rotation of its frame, (7,).
        lower: Lower corner in that frame [m]; -`ENDLESS` where it has no end.
        upper: Upper corner.
        spacing: Between particles [m].
        shell: How deep a fluid sees into it [m].
        flat: One layer at y = 0, for a flow in the x-z plane.
        bottomless: Whether it goes on below its lower face, without particles.
    """

    def __init__(
        self,
        pose: Array,
        lower: Array,
        upper: Array,
        spacing: float,
        shell: float,
        flat: bool = False,
        bottomless: bool = False,
    ) -> None:
        self._under = np.array([0.0, 0.0, np.inf if bottomless else 0.0])
        self._turn, self._at = np.asarray(pose[3:], dtype=float), np.asarray(pose[:3], dtype=float)
        self._lower, self._upper, self._shell = lower, upper, shell
        self._origin, self._edge = np.zeros(3), np.full(3, spacing)
        self._first, self._last = np.zeros(3, dtype=np.int64), np.zeros(3, dtype=np.int64)
        for k in range(3):
            length = float(upper[k] - lower[k])
            if length < ENDLESS:
                self._last[k], self._edge[k] = lattice_axis(length, spacing)
                self._origin[k] = lower[k]
            else:  # counted from where it ends, or from its middle
                self._origin[k] = upper[k] if upper[k] < ENDLESS else 0.0
                self._first[k] = round((lower[k] - self._origin[k]) / spacing)
                self._last[k] = round((upper[k] - self._origin[k]) / spacing)
            if flat and k == 1:
                self._origin[k], self._edge[k] = -0.5, 1.0
                self._first[k], self._last[k] = 0, 1
        corners = rotate(self._turn, lower + CORNERS * (upper - lower)) + self._at
        self.low, self.high = corners.min(axis=0), corners.max(axis=0)

    def near(self, low: Array, high: Array) -> Samples:
        """Its particles between two corners [m], and perhaps some beside them."""
        low, high = np.maximum(low, self.low), np.minimum(high, self.high)
        if (low > high).any():
            return EMPTY
        corners = rotate(conjugate(self._turn), low + CORNERS * (high - low) - self._at)
        first = np.floor((corners.min(axis=0) - self._origin) / self._edge).astype(np.int64)
        last = np.ceil((corners.max(axis=0) - self._origin) / self._edge).astype(np.int64)
        first, last = np.maximum(first, self._first), np.minimum(last, self._last)
        if (first >= last).any():
            return EMPTY
        ticks = [self._origin[k] + (np.arange(first[k], last[k]) + 0.5) * self._edge[k] for k in range(3)]
        # How deep a place is goes by its axes, one by one.
        below = [np.minimum(t - self._lower[k], self._upper[k] - t) for k, t in enumerate(ticks)]
        shell = (below[0] < self._shell)[:, None, None] | (below[1] < self._shell)[:, None]
        at = np.argwhere(shell | (below[2] < self._shell))
        own = np.stack([ticks[k][at[:, k]] for k in range(3)], axis=1)
        return Samples(rotate(self._turn, own) + self._at, np.full(len(own), float(np.prod(self._edge))))

    def depth(self, points: Array) -> Array:
        """How deep points (n, 3) are inside of it, (n,) [m]; negative outside."""
        own = rotate(conjugate(self._turn), points - self._at)
        deep: Array = np.minimum(own - self._lower + self._under, self._upper - own).min(axis=1)
        return deep


class FixedWhole:
    """A round shape or a small mesh, filled at once.

    Args:
        pose: Position and rotation of its frame, (7,).
        fill: All its particles in that frame.
        depth: How deep points are inside of it, in that frame.
        half: Half of the edges of a box about the frame's origin that has all of it [m].
        shell: How deep a fluid sees into it [m].
    """

    def __init__(
        self, pose: Array, fill: Callable[[], Samples], depth: Callable[[Array], Array], half: Array, shell: float
    ) -> None:
        self._turn, self._at = np.asarray(pose[3:], dtype=float), np.asarray(pose[:3], dtype=float)
        self._fill, self._depth, self._shell = fill, depth, shell
        corners = rotate(self._turn, (2.0 * CORNERS - 1.0) * half) + self._at
        self.low, self.high = corners.min(axis=0), corners.max(axis=0)

    @cached_property
    def _samples(self) -> Samples:
        found = self._fill()
        outer = self._depth(found.position) < self._shell
        return Samples(rotate(self._turn, found.position[outer]) + self._at, found.volume[outer])

    def near(self, low: Array, high: Array) -> Samples:
        """Its particles between two corners [m]."""
        if (low > self.high).any() or (high < self.low).any():
            return EMPTY
        own = self._samples
        keep = ((own.position >= low) & (own.position <= high)).all(axis=1)
        return Samples(own.position[keep], own.volume[keep])

    def depth(self, points: Array) -> Array:
        """How deep points (n, 3) are inside of it, (n,) [m]; negative outside."""
        return self._depth(rotate(conjugate(self._turn), points - self._at))


class FixedNothing:
    """What the plane of a flow does not meet."""

    low, high = np.full(3, np.inf), np.full(3, -np.inf)

    def near(self, low: Array, high: Array) -> Samples:
        """No particles, wherever they are asked for."""
        return EMPTY

    def depth(self, points: Array) -> Array:
        """All points (n, 3) are outside."""
        return np.full(len(points), -np.inf)


class FixedMesh:
    """A large mesh, such as terrain, filled part by part: each part for itself, so that the parts join."""

    def __init__(self, vertices: Array, triangles: Array, convex: bool, spacing: float, shell: float) -> None:
        """Take vertices of the world's frame, (n, 3) [m]; the rest is as in `mesh_layers`."""
        solid = solid_of(vertices, triangles, convex)
        self.low, self.high = (np.asarray(corner) for corner in solid.bounds)
        self.depth, self._spacing, self._shell = depth_in(solid), spacing, shell

    def near(self, low: Array, high: Array) -> Samples:
        """Its particles between two corners [m]."""
        if (low > self.high).any() or (high < self.low).any():
            return EMPTY
        low, high = np.where(np.isfinite(low), low, self.low), np.where(np.isfinite(high), high, self.high)
        return mesh_part(self.depth, low, high, self._spacing, self._shell)


def fixed_shape(kind: int, pose: Array, scale: Array, source: Any, config: ConfigSPH) -> FixedShape | None:
    """A Newton shape that stands still, as what a fluid meets; None of a kind that it does not see.

    Args:
        kind: A `newton.GeoType`.
        pose: Position and rotation, (7,).
        scale: Newton's shape scale.
        source: The `newton.Mesh` of a mesh.
        config: For the spacing, the kernel's support, dimensions and periodic axes.

    In a flow in a plane it is what the plane cuts out of the shape, and may be nothing.
    """
    spacing = config.spacing
    shell = layers_within(config.support, spacing) * spacing
    if kind == GeoType.PLANE:
        return _fixed_plane(pose, scale, config)
    if config.dimensions == 2:
        return _fixed_section(kind, pose, scale, source, spacing, shell)
    if kind == GeoType.BOX:
        return FixedLattice(pose, -scale, scale, spacing, shell)
    if kind in (GeoType.MESH, GeoType.CONVEX_MESH):
        vertices = np.asarray(source.vertices, dtype=float).reshape(-1, 3) * scale
        return _fixed_mesh(pose, vertices, source, kind == GeoType.CONVEX_MESH, spacing, shell)
    return _fixed_round(kind, pose, scale, spacing, shell)


def _fixed_plane(pose: Array, scale: Array, config: ConfigSPH) -> FixedShape:
    """As many layers below it as a kernel reaches; along a periodic axis as long as the period."""
    half = np.where(scale[:2] > 0.0, 0.5 * scale[:2], ENDLESS)
    shell = layers_within(config.support, config.spacing) * config.spacing
    lower, upper = np.array([*-half, -shell]), np.array([*half, 0.0])
    for axis, ends in enumerate(config.periodic[:2]):
        if ends is not None:
            lower[axis], upper[axis] = (end - pose[axis] for end in ends)
    flat, bottomless = config.dimensions == 2, bool((scale[:2] == 0.0).all())
    return FixedLattice(pose, lower, upper, config.spacing, shell, flat, bottomless)


def _fixed_section(
    kind: int, pose: Array, scale: Array, source: Any, spacing: float, shell: float
) -> FixedShape | None:
    """What the plane y = 0 cuts out of a shape, on its lattice if it is an upright box, else in layers."""
    box = upright_box(pose, scale) if kind == GeoType.BOX else None
    if box is not None:
        return FixedLattice(box[0], -box[1], box[1], spacing, shell, flat=True)
    outline = section_of(kind, pose, scale, source)
    if outline is None or len(outline.segments) == 0:
        return None if outline is None else FixedNothing()
    low, high = outline.bounds
    own = outline.moved(-0.5 * (low + high))
    middle = np.array([0.5 * (low[0] + high[0]), 0.0, 0.5 * (low[1] + high[1]), 0.0, 0.0, 0.0, 1.0])
    half = 0.5 * np.array([high[0] - low[0], 1.0, high[1] - low[1]])
    return FixedWhole(middle, lambda: fill_outline(own, spacing), lambda at: own.depth(at[:, [0, 2]]), half, shell)


def _fixed_mesh(pose: Array, vertices: Array, source: Any, convex: bool, spacing: float, shell: float) -> FixedShape:
    triangles = np.asarray(source.indices).reshape(-1, 3)
    extent = vertices.max(axis=0) - vertices.min(axis=0)
    if np.prod(extent / spacing) > MOST_WHOLE:
        return FixedMesh(rotate(pose[3:], vertices) + pose[:3], triangles, convex, spacing, shell)
    depth = depth_in(solid_of(vertices, triangles, convex))
    half = np.abs(vertices).max(axis=0)
    return FixedWhole(pose, lambda: mesh_layers(vertices, triangles, spacing, convex), depth, half, shell)


def _fixed_round(kind: int, pose: Array, scale: Array, spacing: float, shell: float) -> FixedShape | None:
    radius, height = float(scale[0]), float(scale[1])  # a cylinder's half

    def in_capsule(points: Array) -> Array:
        beyond = np.maximum(np.abs(points[:, 2]) - (height if kind == GeoType.CAPSULE else 0.0), 0.0)
        return radius - np.sqrt(points[:, 0] ** 2 + points[:, 1] ** 2 + beyond**2)

    def in_cylinder(points: Array) -> Array:
        return np.minimum(radius - np.hypot(points[:, 0], points[:, 1]), height - np.abs(points[:, 2]))

    wide = np.full(2, radius)
    if kind == GeoType.SPHERE:
        return FixedWhole(pose, lambda: sphere_layers(radius, spacing), in_capsule, np.full(3, radius), shell)
    if kind == GeoType.CAPSULE:
        half = np.array([*wide, height + radius])
        return FixedWhole(pose, lambda: capsule_layers(radius, height, spacing), in_capsule, half, shell)
    if kind == GeoType.CYLINDER:
        half = np.array([*wide, height])
        return FixedWhole(pose, lambda: cylinder_layers(radius, height, spacing), in_cylinder, half, shell)
    return None
