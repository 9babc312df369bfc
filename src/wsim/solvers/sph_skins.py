"""The triangles of shapes that no fluid passes (`wsim.kernels.sph.skins`)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import trimesh
import warp as wp
from newton import GeoType, ShapeFlags

from wsim.geometry.kinds import KINDS
from wsim.geometry.surfaces import Surface
from wsim.kernels.sph.skins import add_blows, keep_out_of_skins
from wsim.solvers.vessels import Vessel, own_label

Array = np.ndarray
ROUND = (GeoType.SPHERE, GeoType.CYLINDER, GeoType.CAPSULE)
MESHES = (GeoType.MESH, GeoType.CONVEX_MESH)
NOWHERE = wp.vec3(math.nan, math.nan, math.nan)
OVERLAP = 0.02  # spacings that the parts of a vessel reach into each other: staves that are rounded leave cracks
STEEP = 0.3  # of a corner's normal along a face's, at least, or a needle would grow without bound
QUANTUM = 1e-9  # of the heaviest particle's mass times the spacing per step


def surface_of_shape(kind: int, scale: Array, source: Any) -> Surface:
    """A Newton shape as a mesh in its own frame; of a convex mesh its hull."""
    if kind in MESHES:
        mesh = source.compute_convex_hull() if kind == GeoType.CONVEX_MESH else source
        vertices = np.asarray(mesh.vertices, dtype=float).reshape(-1, 3) * scale
        return Surface(vertices, np.asarray(mesh.indices, dtype=np.intp).reshape(-1, 3))
    if kind == GeoType.SPHERE:
        return KINDS["sphere"](float(scale[0])).surface()
    name = "cylinder" if kind == GeoType.CYLINDER else "capsule"
    return KINDS[name](float(scale[0]), 2.0 * float(scale[1])).surface()


def thickened(surface: Surface, by: float) -> Surface:
    """A surface whose faces lie farther out by a length [m]: of parts that meet no crack is left between them."""
    mesh = trimesh.Trimesh(surface.vertices, surface.triangles, process=False)
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    if not mesh.is_watertight:
        return surface
    normals, faces = np.asarray(mesh.vertex_normals), np.asarray(mesh.faces)
    along = np.full(len(normals), 1.0)
    np.minimum.at(along, faces, (normals[faces] * np.asarray(mesh.face_normals)[:, None]).sum(axis=2))
    outward = np.sign(surface.volume) * by / np.maximum(along, STEEP)
    return Surface(np.asarray(mesh.vertices) + outward[:, None] * normals, faces.astype(np.intp))


class Skins:
    """The skins of each world: of what stands still together, and of each vessel that moves.

    Args:
        model: The `newton.Model`.
        world_count: W.
        spacing: Between particles [m].
        vessels: Which all have one, each of its own; of what else stands still all meshes and round shapes, together.

    Attributes:
        count: Number of skins.
    """

    def __init__(self, model: Any, world_count: int, spacing: float, vessels: Sequence[Vessel] = ()) -> None:
        self._model, self._spacing = model, spacing
        self._meshes: dict[bytes, wp.Mesh] = {}
        groups = self._still(world_count, frozenset().union(*(vessel.shapes for vessel in vessels)))
        groups += [
            (world, body, [thickened(each, OVERLAP * spacing) for each in vessel.surfaces] if len(vessel.surfaces) > 1
             else list(vessel.surfaces))
            for vessel in vessels
            for world, body in vessel.homes(model)
        ]  # fmt: skip
        keys = sorted(((world, body) for world, body, _ in groups), key=lambda key: key[0])
        groups.sort(key=lambda group: group[0])
        made = [self._skin(surfaces) for _, _, surfaces in groups]
        first = np.concatenate([[0], np.cumsum(np.bincount([w for w, _ in keys], minlength=world_count))])
        self.count = len(keys)
        self._skins = (
            wp.array(first.astype(np.int32), dtype=int),
            wp.array(np.array([mesh.id for mesh, _ in made], dtype=np.uint64), dtype=wp.uint64),
            wp.array(np.array([body for _, body in keys], dtype=np.int32), dtype=int),
            wp.array(np.array([ball for _, ball in made], dtype=np.float32).reshape(-1, 4), dtype=wp.vec4),
        )
        self._kept = wp.full(model.particle_count if self.count else 0, NOWHERE, dtype=wp.vec3)
        self._moving = any(body >= 0 for _, body in keys)
        self._pose_before = wp.zeros(model.body_count if self._moving else 0, dtype=wp.transform)
        self._impulse = wp.zeros((model.body_count if self._moving else 0, 6), dtype=wp.int64)
        heaviest = float(model.particle_mass.numpy().max(initial=0.0))
        self._least = QUANTUM * heaviest * spacing  # [kg m]

    def _still(self, world_count: int, spared: frozenset[str]) -> list[tuple[int, int, list[Surface]]]:
        """World, -1, and the surfaces of what stands still in it, but for some."""
        model = self._model
        found: dict[int, list[Surface]] = {}
        poses, own = model.shape_transform.numpy().astype(float), model.shape_world.numpy()
        scales, kinds = model.shape_scale.numpy().astype(float), model.shape_type.numpy()
        seen = (model.shape_flags.numpy() & ShapeFlags.COLLIDE_SHAPES) != 0
        seen &= (model.shape_body.numpy() < 0) & np.isin(kinds, (*ROUND, *MESHES))
        for k in np.flatnonzero(seen).tolist():
            if own_label(str(model.shape_label[k])) not in spared:
                surface = surface_of_shape(int(kinds[k]), scales[k], model.shape_source[k])
                placed = surface.turned(poses[k, 3:], poses[k, :3])
                for w in range(world_count) if own[k] < 0 else (int(own[k]),):
                    found.setdefault(w, []).append(placed)
        return [(w, -1, surfaces) for w, surfaces in found.items()]

    def _skin(self, surfaces: Sequence[Surface]) -> tuple[wp.Mesh, Array]:
        """One mesh of some surfaces, the same for bodies that are alike, and a ball around it."""
        first = np.cumsum([0, *(len(surface.vertices) for surface in surfaces)])
        points = np.concatenate([surface.vertices for surface in surfaces]).astype(np.float32)
        faces = np.concatenate([surface.triangles + k for surface, k in zip(surfaces, first[:-1], strict=True)])
        faces = faces.astype(np.int32)
        key = points.tobytes() + faces.tobytes()
        if key not in self._meshes:
            self._meshes[key] = wp.Mesh(wp.array(points, dtype=wp.vec3), wp.array(faces.reshape(-1), dtype=wp.int32))
        center = 0.5 * (points.min(axis=0) + points.max(axis=0))
        return self._meshes[key], np.array([*center, float(np.linalg.norm(points - center, axis=1).max())])

    def forget(self) -> None:
        """Forget where the particles were: they are where the next step finds them."""
        self._kept.fill_(NOWHERE)

    def keep_out(self, worlds: wp.array, dt: float, moved: Any, state: Any, on_walls: wp.array) -> None:
        """Stop what has come through since the last step.

        Args:
            worlds: Of each particle.
            dt: Time since then [s].
            moved: The state whose particles have moved, and are put back.
            state: The one that poses and velocities of the bodies are of.
            on_walls: Force on what stands still [N], added to; empty where nobody asks.
        """
        if not self.count:
            return
        model = self._model
        bodies = (state.body_q, state.body_qd, model.body_com) if self._moving else (None, None, None)
        wp.launch(
            keep_out_of_skins,
            dim=model.particle_count,
            inputs=[
                *(worlds, model.particle_mass, *self._skins, *bodies, self._pose_before),
                *(self._spacing, self._least / dt, dt),
            ],
            outputs=[self._kept, moved.particle_q, moved.particle_qd, on_walls, self._impulse],
        )
        if self._moving:
            wp.copy(self._pose_before, state.body_q)

    def give_back(self, dt: float, body_wrench: wp.array, body_f: wp.array) -> None:
        """Add what bodies were given since the last call to the wrenches on them, as a force over a step of dt [s]."""
        if self._moving:
            wp.launch(
                add_blows,
                dim=len(self._impulse),
                inputs=[self._least / dt, self._spacing, dt],
                outputs=[self._impulse, body_wrench, body_f],
            )
