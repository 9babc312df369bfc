"""Planes and boxes that stand still, as faces that no fluid gets behind (`wsim.kernels.sph.faces`)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp
from newton import GeoType, ShapeFlags

from wsim.geometry.rotations import rotate
from wsim.kernels.sph.faces import keep_out
from wsim.solvers.shapes import OpenBox

Array = np.ndarray
SUNK = 1e-4  # [m] under a plane, at least, of the floor of a tank that is sunk into it
CORNERS = np.stack(np.meshgrid(*[[-1.0, 1.0]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)


class FixedFaces:
    """The faces of each world.

    A plane that a tank is sunk into is none: its water would stand behind it.

    Args:
        model: The `newton.Model`, whose planes and boxes that collide and belong to no body are taken.
        world_count: W.
        containers: Tanks of all worlds.
        spared: Labels of shapes that have skins instead (`wsim.solvers.sph_skins`): their faces meet at edges.
    """

    def __init__(
        self, model: Any, world_count: int, containers: Sequence[OpenBox], spared: frozenset[str] = frozenset()
    ) -> None:
        self._model, self._world_count = model, world_count
        floors = np.full(world_count, np.inf)  # of the lowest hollow in each
        for box in containers:
            some = slice(None) if box.world < 0 else box.world
            floors[some] = np.minimum(floors[some], box.floor)
        kinds, poses = model.shape_type.numpy(), model.shape_transform.numpy().astype(float)
        halves = model.shape_scale.numpy().astype(float)
        collides = (model.shape_flags.numpy() & ShapeFlags.COLLIDE_SHAPES) != 0
        fixed = collides & (model.shape_body.numpy() < 0)
        fixed &= np.array([str(label) not in spared for label in model.shape_label], dtype=bool)
        normals = rotate(poses[:, 3:], np.array([[0.0, 0.0, 1.0]])) if len(poses) else np.zeros((0, 3))
        heights = (normals * poses[:, :3]).sum(axis=1)
        endless = (kinds == GeoType.PLANE) & (halves[:, :2] == 0.0).all(axis=1)
        sunk = (normals[:, 2] > 0.99)[None] & (floors[:, None] < heights[None] - SUNK)
        planes = [(w, k) for w, k in self._homes(fixed & endless) if not sunk[w, k]]
        boxes = self._homes(fixed & (kinds == GeoType.BOX))
        self._planes = (
            self._first(planes),
            wp.array(np.array([[*normals[k], heights[k]] for _, k in planes]).reshape(-1, 4), dtype=wp.vec4),
        )
        which = [k for _, k in boxes]
        corners = np.array([rotate(poses[k, 3:], CORNERS * halves[k]) + poses[k, :3] for k in which]).reshape(-1, 8, 3)
        self._boxes = (
            self._first(boxes),
            wp.array(poses[which].reshape(-1, 7), dtype=wp.transform),
            wp.array(halves[which].reshape(-1, 3), dtype=wp.vec3),
            wp.array(corners.min(axis=1, initial=np.inf), dtype=wp.vec3),
            wp.array(corners.max(axis=1, initial=-np.inf), dtype=wp.vec3),
        )
        self.count = len(planes) + len(boxes)

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
            inputs=[worlds, self._model.particle_mass, *self._planes, *self._boxes, dt],
            outputs=[position, velocity, on_walls],
        )
