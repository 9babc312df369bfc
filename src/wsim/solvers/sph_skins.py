"""The triangles of vessels, which no fluid passes (`wsim.kernels.sph.skins`)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import trimesh
import warp as wp

from wsim.geometry.surfaces import Surface
from wsim.kernels.sph.skins import keep_out_of_skins
from wsim.solvers.sph_blows import Blows
from wsim.solvers.vessels import Vessel

Array = np.ndarray
NOWHERE = wp.vec3(math.nan, math.nan, math.nan)
OVERLAP = 0.02  # spacings that the parts of a vessel reach into each other: staves that are rounded leave cracks
STEEP = 0.3  # of a corner's normal along a face's, at least, or a needle would grow without bound


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
    """The skins of each world, one of each vessel.

    Args:
        model: The `newton.Model`.
        world_count: W.
        spacing: Between particles [m].
        vessels: What has one; those that are bodies move.

    Attributes:
        count: Number of skins.
        moving: Whether any is a body's.
    """

    def __init__(self, model: Any, world_count: int, spacing: float, vessels: Sequence[Vessel] = ()) -> None:
        self._model, self._spacing = model, spacing
        self._meshes: dict[bytes, wp.Mesh] = {}
        homes = [(world, body, vessel) for vessel in vessels for world, body in vessel.homes(model)]
        homes.sort(key=lambda home: home[0])
        made = [self._skin(vessel) for _, _, vessel in homes]
        keys = [(world, body) for world, body, _ in homes]
        first = np.concatenate([[0], np.cumsum(np.bincount([w for w, _ in keys], minlength=world_count))])
        self.count = len(keys)
        self._skins = (
            wp.array(first.astype(np.int32), dtype=int),
            wp.array(np.array([mesh.id for mesh, _ in made], dtype=np.uint64), dtype=wp.uint64),
            wp.array(np.array([body for _, body in keys], dtype=np.int32), dtype=int),
            wp.array(np.array([ball for _, ball in made], dtype=np.float32).reshape(-1, 4), dtype=wp.vec4),
        )
        self._kept = wp.full(model.particle_count if self.count else 0, NOWHERE, dtype=wp.vec3)
        self.moving = any(body >= 0 for _, body in keys)
        self._pose_before = wp.zeros(model.body_count if self.moving else 0, dtype=wp.transform)

    def _skin(self, vessel: Vessel) -> tuple[wp.Mesh, Array]:
        """One mesh of a vessel, the same for vessels that are alike, and a ball around it."""
        surfaces = list(vessel.surfaces)
        if len(surfaces) > 1:
            surfaces = [thickened(surface, OVERLAP * self._spacing) for surface in surfaces]
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

    def keep_out(self, fluid: Any, dt: float, moved: Any, state: Any, on_walls: wp.array, blows: Blows) -> None:
        """Stop what has come through since the last step.

        Args:
            fluid: The particles, as `SortedParticles`; what is in pipes of taps and drains goes where it is led.
            dt: Time since then [s].
            moved: The state whose particles have moved, and are put back.
            state: The one that poses and velocities of the bodies are of.
            on_walls: Force on what stands still [N], added to; empty where nobody asks.
            blows: On bodies, added to.
        """
        if not self.count:
            return
        model = self._model
        bodies = (state.body_q, state.body_qd, model.body_com) if self.moving else (None, None, None)
        wp.launch(
            keep_out_of_skins,
            dim=model.particle_count,
            inputs=[
                *(fluid.world, fluid.stage, model.particle_mass, *self._skins, *bodies, self._pose_before),
                *(self._spacing, blows.quantum(dt), dt),
            ],
            outputs=[self._kept, moved.particle_q, moved.particle_qd, on_walls, blows.impulse],
        )
        if self.moving:
            wp.copy(self._pose_before, state.body_q)
