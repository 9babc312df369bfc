"""All that stands still, as faces that no fluid gets behind (`wsim.kernels.sph.faces`)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import warp as wp
from newton import GeoType, ShapeFlags

from wsim.geometry.outlines import Outline
from wsim.geometry.rotations import rotate
from wsim.kernels.sph.faces import Faces, keep_out
from wsim.solvers.inside import solid_of
from wsim.solvers.plane_sections import section_of
from wsim.solvers.shapes import OpenBox

Array = np.ndarray
SUNK = 1e-4  # [m] under a plane, at least, of the floor of a tank that is sunk into it
CORNERS = np.stack(np.meshgrid(*[[-1.0, 1.0]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
ROUNDS = (GeoType.SPHERE, GeoType.CAPSULE, GeoType.CYLINDER)
MESHES = (GeoType.MESH, GeoType.CONVEX_MESH)


class FixedFaces:
    """The faces of each world.

    A plane that a tank is sunk into is none: its water would stand behind it.

    Args:
        model: The `newton.Model`, whose shapes that collide and belong to no body are taken.
        world_count: W.
        containers: Tanks of all worlds.
        reach: How deep in a mesh a particle is still put back [m]; more than it goes in a step.
        spared: Whether the shape of a label has a skin instead (`wsim.solvers.sph_skins`).
        plane: Whether the flow is in the x-z plane, where a shape is the prism over what the plane cuts out of it.
    """

    def __init__(
        self,
        model: Any,
        world_count: int,
        containers: Sequence[OpenBox],
        reach: float,
        spared: Callable[[Any], bool] = lambda _: False,
        plane: bool = False,
    ) -> None:
        self._model, self._world_count = model, world_count
        kinds, scales = model.shape_type.numpy(), model.shape_scale.numpy().astype(float)
        self._poses = model.shape_transform.numpy().astype(float)
        fixed = ((model.shape_flags.numpy() & ShapeFlags.COLLIDE_SHAPES) != 0) & (model.shape_body.numpy() < 0)
        fixed &= np.array([not spared(label) for label in model.shape_label], dtype=bool)
        self._faces: Any = Faces()
        self._faces.reach, self._faces.plane_flow = reach, plane
        self._meshes: dict[tuple[Any, ...], wp.Mesh] = {}  # by what they are made of: worlds share them
        solid = fixed & ~plane  # in a plane all shapes are prisms
        self.count = (
            self._take_planes(fixed & (kinds == GeoType.PLANE) & (scales[:, :2] == 0.0).all(axis=1), containers)
            + self._take_boxes(self._homes(solid & (kinds == GeoType.BOX)), scales)
            + self._take_rounds(self._homes(solid & np.isin(kinds, ROUNDS)), kinds, scales)
            + self._take_meshes(self._homes(solid & np.isin(kinds, MESHES)), kinds, scales)
        )
        if plane:
            self.count += self._take_sections(np.flatnonzero(fixed & (kinds != GeoType.PLANE)), kinds, scales)

    def _take_planes(self, endless: Array, containers: Sequence[OpenBox]) -> int:
        floors = np.full(self._world_count, np.inf)  # of the lowest hollow in each
        for box in containers:
            some = slice(None) if box.world < 0 else box.world
            floors[some] = np.minimum(floors[some], box.floor)
        normals = rotate(self._poses[:, 3:], np.array([[0.0, 0.0, 1.0]])) if len(self._poses) else np.zeros((0, 3))
        heights = (normals * self._poses[:, :3]).sum(axis=1)
        sunk = (normals[:, 2] > 0.99)[None] & (floors[:, None] < heights[None] - SUNK)
        planes = [(w, k) for w, k in self._homes(endless) if not sunk[w, k]]
        self._faces.plane_first = self._first(planes)
        levels = np.array([[*normals[k], heights[k]] for _, k in planes]).reshape(-1, 4)
        self._faces.plane = wp.array(levels, dtype=wp.vec4)
        return len(planes)

    def _take_boxes(self, boxes: list[tuple[int, int]], halves: Array) -> int:
        which = [k for _, k in boxes]
        corners = np.array([self._placed(k, CORNERS * halves[k]) for k in which]).reshape(-1, 8, 3)
        self._faces.box_first, self._faces.box = self._first(boxes), self._poses_of(which)
        self._faces.box_half = wp.array(halves[which].reshape(-1, 3), dtype=wp.vec3)
        self._faces.box_low = wp.array(corners.min(axis=1, initial=np.inf), dtype=wp.vec3)
        self._faces.box_high = wp.array(corners.max(axis=1, initial=-np.inf), dtype=wp.vec3)
        return len(boxes)

    def _take_rounds(self, rounds: list[tuple[int, int]], kinds: Array, scales: Array) -> int:
        which = [k for _, k in rounds]
        sizes = np.array([round_size(int(kinds[k]), scales[k]) for k in which])
        self._faces.round_first, self._faces.round = self._first(rounds), self._poses_of(which)
        self._faces.round_size = wp.array(sizes.reshape(-1, 3), dtype=wp.vec3)
        return len(rounds)

    def _take_meshes(self, meshes: list[tuple[int, int]], kinds: Array, scales: Array) -> int:
        ids, ends = [], []
        for _, k in meshes:
            source, convex = self._model.shape_source[k], kinds[k] == GeoType.CONVEX_MESH
            vertices = np.asarray(source.vertices, dtype=float).reshape(-1, 3) * scales[k]
            key = id(source), convex, *scales[k].tolist()
            if key not in self._meshes:
                self._meshes[key] = closed_mesh(vertices, np.asarray(source.indices).reshape(-1, 3), bool(convex))
            ids.append(self._meshes[key].id)
            placed = self._placed(k, vertices)
            ends.append((placed.min(axis=0), placed.max(axis=0)))
        self._faces.mesh_first, self._faces.mesh_pose = self._first(meshes), self._poses_of([k for _, k in meshes])
        self._faces.mesh = wp.array(np.array(ids, dtype=np.uint64), dtype=wp.uint64)
        self._faces.mesh_low = wp.array(np.array([low for low, _ in ends]).reshape(-1, 3), dtype=wp.vec3)
        self._faces.mesh_high = wp.array(np.array([high for _, high in ends]).reshape(-1, 3), dtype=wp.vec3)
        return len(meshes)

    def _take_sections(self, which: Array, kinds: Array, scales: Array) -> int:
        """Take what the plane cuts out of some shapes."""
        prisms: dict[int, tuple[wp.Mesh, Array, Array]] = {}
        for k in which.tolist():
            outline = section_of(int(kinds[k]), self._poses[k], scales[k], self._model.shape_source[k])
            if outline is not None and len(outline.segments):
                prisms[k] = _prism(outline)
        homes = self._homes(np.isin(np.arange(len(kinds)), list(prisms)))
        each = [prisms[k] for _, k in homes]
        self._prisms = prisms  # kept: the kernel has their ids alone
        self._faces.mesh_first = self._first(homes)
        upright = np.tile([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], (len(each), 1))
        self._faces.mesh_pose = wp.array(upright, dtype=wp.transform)
        self._faces.mesh = wp.array(np.array([mesh.id for mesh, _, _ in each], dtype=np.uint64), dtype=wp.uint64)
        self._faces.mesh_low = wp.array(np.array([low for _, low, _ in each]).reshape(-1, 3), dtype=wp.vec3)
        self._faces.mesh_high = wp.array(np.array([high for _, _, high in each]).reshape(-1, 3), dtype=wp.vec3)
        return len(each)

    def _placed(self, k: int, points: Array) -> Array:
        """Points of a shape in the world."""
        return np.asarray(rotate(self._poses[k, 3:], points) + self._poses[k, :3])

    def _poses_of(self, which: list[int]) -> wp.array:
        return wp.array(self._poses[which].reshape(-1, 7), dtype=wp.transform)

    def _homes(self, wanted: Array) -> list[tuple[int, int]]:
        """World and shape of each that is wanted, world by world; what has none of its own stands in all."""
        own = self._model.shape_world.numpy()
        each = [(w, k) for k in np.flatnonzero(wanted).tolist() for w in self._worlds_of(int(own[k]))]
        return sorted(each)

    def _worlds_of(self, world: int) -> range:
        return range(self._world_count) if world < 0 else range(world, world + 1)

    def _first(self, homes: list[tuple[int, int]]) -> wp.array:
        counts = np.bincount([w for w, _ in homes], minlength=self._world_count) if homes else [0] * self._world_count
        return wp.array(np.concatenate([[0], np.cumsum(counts)]), dtype=int)

    def keep_out(self, worlds: wp.array, dt: float, position: wp.array, velocity: wp.array, on_walls: wp.array) -> None:
        """Put back what came through a face in the step that ends; arguments as the kernel's."""
        if not self.count:
            return
        wp.launch(
            keep_out,
            dim=len(position),
            inputs=[worlds, self._model.particle_mass, self._faces, dt],
            outputs=[position, velocity, on_walls],
        )


def closed_mesh(vertices: Array, triangles: Array, convex: bool) -> wp.Mesh:
    """The solid that a mesh stands for, for the kernel to ask."""
    solid = solid_of(vertices, triangles, convex)
    corners = wp.array(np.asarray(solid.vertices), dtype=wp.vec3)
    return wp.Mesh(corners, wp.array(np.asarray(solid.faces).reshape(-1), dtype=int), support_winding_number=True)


def _prism(outline: Outline) -> tuple[wp.Mesh, Array, Array]:
    """The sides of the prism over an outline, and the corners of what is upright around it [m].

    It has no ends: a flow is far from them.
    """
    (x0, z0), (x1, z1) = outline.bounds
    far = max(x1 - x0, z1 - z0)
    flat = outline.segments
    ends = [np.insert(flat, 1, y, axis=2).reshape(-1, 3) for y in (-far, far)]  # of each segment its start, its end
    start = 2 * np.arange(len(flat))
    back = start + 2 * len(flat)
    quads = [np.stack(corners, axis=1) for corners in ((start, back + 1, start + 1), (start, back, back + 1))]
    corners, triangles = np.concatenate(ends), np.concatenate(quads)
    mesh = wp.Mesh(wp.array(corners, dtype=wp.vec3), wp.array(triangles.reshape(-1), dtype=int))
    return mesh, np.array([x0, -far, z0]), np.array([x1, far, z1])


def round_size(kind: int, scale: Array) -> Array:
    """Radius, half the height of the straight part [m], and 1 where the ends are flat, of a round shape (3,)."""
    straight = 0.0 if kind == GeoType.SPHERE else scale[1]
    return np.array([scale[0], straight, float(kind == GeoType.CYLINDER)])
