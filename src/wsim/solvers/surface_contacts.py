"""Contacts of moving shapes with surfaces of triangles that stand still, put among MuJoCo's own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import warp as wp
from newton import BodyFlags, GeoType, ShapeFlags
from scipy.spatial import ConvexHull

from wsim.kernels.convex import BOX, CAPSULE, CYLINDER, HULL, SPHERE, Convex
from wsim.kernels.own_rows import add_found
from wsim.kernels.surface import Found, touch
from wsim.solvers.own_contacts import put_in_c, rows_of
from wsim.solvers.packed import Packed
from wsim.solvers.surface_mesh import Part, make_surface

Array = np.ndarray

SLOTS = 24  # contacts of a shape with all that is a surface
_KINDS = {GeoType.SPHERE: SPHERE, GeoType.CAPSULE: CAPSULE, GeoType.BOX: BOX, GeoType.CYLINDER: CYLINDER}
_CONE_SIDES = 32


@dataclass(frozen=True)
class SurfaceParts:
    """What is a surface, and what does not touch it.

    `shapes[k]` is the model's shape of part k in its first world; `spared` its pairs of shapes that do not touch.
    """

    parts: Sequence[Part]
    shapes: Sequence[int]
    spared: frozenset[tuple[int, int]]


class SurfaceContacts:
    """Finds the contacts of all moving shapes of a model with its surfaces.

    Args:
        model: The Newton model.
        surfaces: What is a surface in its first world; all worlds have the same.
        reach: Gap at which a contact is one [m].
    """

    def __init__(self, model: Any, surfaces: SurfaceParts, reach: float) -> None:
        self.model, self.surfaces, self.reach = model, surfaces, reach
        self._packed = Packed(model.device)
        self.surface, self._mesh = make_surface(surfaces.parts, model.device)
        shapes = _moving(model)
        self.shapes = np.array(shapes, dtype=np.int64)
        a_world = model.shape_count // max(1, model.world_count)
        self.worlds = self.shapes // max(1, a_world)
        corners, planes, probes, poses, bounds = [np.zeros((0, 3))], [np.zeros((0, 4))], [], [], []
        for shape in shapes:
            probe, pose, box, points, sides = _probe(model, shape)
            probe.corner_first, probe.plane_first = sum(map(len, corners)), sum(map(len, planes))
            corners.append(points)
            planes.append(sides)
            probes.append(probe)
            poses.append(pose)
            bounds.append(box)
        rows = self.shapes % max(1, a_world)
        spared = np.zeros((max(1, a_world), len(surfaces.shapes)), dtype=np.int32)
        for k, part in enumerate(surfaces.shapes):
            for row in set(rows.tolist()):
                spared[row, k] = (min(row, part), max(row, part)) in surfaces.spared
        bodies = model.shape_body.numpy()[self.shapes]
        self.found = Found()
        with wp.ScopedDevice(model.device):
            self._inputs = [
                self.surface,
                wp.array(probes, dtype=Convex),
                wp.array(bodies, dtype=int),
                wp.array(np.array(poses).reshape(-1, 7), dtype=wp.transform),
                wp.array(np.array(bounds).reshape(-1, 2, 3), dtype=wp.vec3),
                wp.array(rows, dtype=int),
                wp.array(spared),
                wp.array(np.concatenate(corners), dtype=wp.vec3),
                wp.array(np.concatenate(planes), dtype=wp.vec4),
            ]
            size = (len(shapes), SLOTS)
            self.found.count = wp.zeros(len(shapes), dtype=int)
            self.found.position, self.found.normal = wp.zeros(size, dtype=wp.vec3), wp.zeros(size, dtype=wp.vec3)
            self.found.distance, self.found.bend = wp.zeros(size, dtype=float), wp.zeros(size, dtype=float)
            self.found.part = wp.zeros(size, dtype=int)
        if self.model.device.is_cpu:
            found = self.found
            arrays = (found.count, found.position, found.normal, found.distance, found.bend, found.part)
            self._seen = [array.numpy() for array in arrays]  # the same memory

    def find(self, state: Any, ahead: Any, h: float) -> None:
        """Find what touches at a state, for a step of `h` [s]; at its end velocities are `ahead` of the state's."""
        self._packed.launch(
            touch,
            dim=len(self.shapes),
            inputs=[*self._inputs, state.body_q, state.body_qd, ahead, self.model.body_com, self.reach, h],
            outputs=[self.found],
            changing=(state.body_q, state.body_qd, ahead, h),
        )

    def bind_geoms(self, geom_shapes: Array) -> None:
        """Learn MuJoCo's geoms, from Newton's shape of each in each world, (worlds, geoms)."""
        geom = {int(shape): k for row in geom_shapes for k, shape in enumerate(row) if shape >= 0}
        self.geoms = np.array([geom[int(shape)] for shape in self.shapes], dtype=np.int32)
        self.part_geoms = np.array([geom[int(shape)] for shape in self.surfaces.shapes], dtype=np.int32)
        with wp.ScopedDevice(self.model.device):
            self._geom, self._part_geom = wp.array(self.geoms), wp.array(self.part_geoms)
            self._world = wp.array(self.worlds, dtype=int)

    def add_to_c(self, mujoco: Any, model: Any, data: Any) -> Array:
        """Add what was found to MuJoCo's contacts; what each of all of them loses to curvature, (contacts,) [m/s]."""
        own, (counts, position, normal, distance, bend, part) = data.ncon, self._seen
        bends = np.zeros(own + int(counts.sum()))
        probe, slot = np.nonzero(np.arange(position.shape[1]) < counts[:, None])
        bends[own:] = bend[probe, slot]
        geoms = np.stack([self.part_geoms[part[probe, slot]], self.geoms[probe]], axis=1)
        at = probe, slot
        put_in_c(mujoco, model, data, geoms, position[at], normal[at], distance[at], self.reach)
        return bends

    def add_to_warp(self, model: Any, data: Any, bend: Any) -> None:
        """The same for MuJoCo Warp's; `bend` is one number for each of its contacts."""
        bend.zero_()
        wp.launch(
            add_found,
            dim=(len(self.shapes), SLOTS),
            inputs=[self.found, self._world, self._geom, self._part_geom],
            outputs=[rows_of(model, data, self.reach), bend],
            device=self.model.device,
        )


def _moving(model: Any) -> list[int]:
    """Shapes that collide and that forces move."""
    flags, bodies, kinds = model.shape_flags.numpy(), model.shape_body.numpy(), model.shape_type.numpy()
    driven = (model.body_flags.numpy() & int(BodyFlags.KINEMATIC)) != 0
    return [
        k
        for k in range(model.shape_count)
        if flags[k] & int(ShapeFlags.COLLIDE_SHAPES)
        and bodies[k] >= 0
        and not driven[bodies[k]]
        and kinds[k] != int(GeoType.PLANE)
    ]


def _probe(model: Any, shape: int) -> tuple[Any, Array, Array, Array, Array]:
    """A shape as the kernel takes it: itself, its pose in its body, its box, corners and planes."""
    kind, scale = GeoType(int(model.shape_type.numpy()[shape])), model.shape_scale.numpy()[shape].astype(float)
    pose = model.shape_transform.numpy()[shape].astype(float)
    probe = Convex()
    none = np.zeros((0, 3)), np.zeros((0, 4))
    if kind in _KINDS:
        probe.kind, probe.size = int(_KINDS[kind]), wp.vec3(*scale)
        r, half = scale[0], scale[1]
        edges = {SPHERE: (r, r, r), CAPSULE: (r, r, half + r), CYLINDER: (r, r, half)}.get(_KINDS[kind], tuple(scale))
        return probe, pose, np.array([(0.0, 0.0, 0.0), edges]), *none
    if kind == GeoType.CONE:
        angle = np.linspace(0.0, 2.0 * np.pi, _CONE_SIDES, endpoint=False)
        ring = np.column_stack([scale[0] * np.cos(angle), scale[0] * np.sin(angle), np.full(len(angle), -scale[1])])
        points = np.concatenate([ring, [[0.0, 0.0, scale[1]]]])
    else:
        points = np.asarray(model.shape_source[shape].vertices, dtype=float).reshape(-1, 3) * scale
    hull = ConvexHull(points)
    corners = points[hull.vertices]
    low, high = corners.min(axis=0), corners.max(axis=0)
    sides = np.unique(np.round(hull.equations, 6), axis=0)
    planes = np.column_stack([sides[:, :3], -sides[:, 3]])
    probe.kind, probe.size = int(HULL), wp.vec3(*(0.5 * (high - low)))
    probe.corner_count, probe.plane_count = len(corners), len(planes)
    return probe, pose, np.array([0.5 * (low + high), 0.5 * (high - low)]), corners, planes
