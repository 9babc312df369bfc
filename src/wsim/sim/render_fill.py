"""Points inside solid shapes that close the gap between a fluid's surface and what floats in it.

Particles keep half a spacing off a body, and a surface around particles alone shows a trough around it. With these
points the surface closes over the body's skin, where the body itself hides it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import newton
import numpy as np
import warp as wp

from wsim.kernels.render import surface as kernels
from wsim.sim.render_materials import OPAQUE, mesh_of, shapes_by_label
from wsim.solvers.inside import mesh_depth

if TYPE_CHECKING:
    from wsim.scene.world import World

INSET = 0.7  # spacings between a shape's skin and its outermost points: a film on it stays hidden
SHEET = 0.85  # spacings that a single layer of points must lie deep: its surface stands off farther
SHELL = 2.0  # spacings: points deeper than this change nothing
MOST_POINTS = 20_000  # in one shape; a larger one goes without


class SolidFill:
    """Points that ride inside a model's opaque shapes.

    Args:
        model: Newton model.
        world: What the stage says.
        spacing: Particle spacing of the fluid [m].
        world_index: Which of the model's worlds is drawn.
    """

    def __init__(self, model: Any, world: World, spacing: float, world_index: int) -> None:
        points, owners = [np.zeros((0, 3))], [np.zeros(0, dtype=np.int32)]
        for index, shape, is_ground in shapes_by_label(model, world, world_index):
            if is_ground or shape.opacity < OPAQUE or not shape.collides or shape.kind == "plane":
                continue
            inner = _points_inside(model, index, spacing)
            points.append(inner)
            owners.append(np.full(len(inner), index, dtype=np.int32))
        self._points = wp.array(np.concatenate(points).astype(np.float32), dtype=wp.vec3f, device=model.device)
        self._owners = wp.array(np.concatenate(owners), dtype=wp.int32, device=model.device)
        self._model = model

    @property
    def count(self) -> int:
        """Number of points."""
        return int(self._points.shape[0])

    def write(self, positions: wp.array, flags: wp.array, start: int, farthest: float) -> None:
        """Write the points' places in the world [m] from index `start` on; shape poses must be up to date."""
        if self.count == 0:
            return
        wp.launch(
            kernels.place_points,
            dim=self.count,
            inputs=[self._points, self._owners, self._model.bvh_shape_world_transforms, farthest, start],
            outputs=[positions, flags],
            device=self._model.device,
        )


def _points_inside(model: Any, index: int, spacing: float) -> np.ndarray:
    """A lattice in the shape's frame, between INSET and SHELL spacings under its skin, (N, 3) [m]."""
    kind = int(model.shape_type.numpy()[index])
    size = np.asarray(model.shape_scale.numpy()[index], dtype=np.float64)
    deep, shell = INSET * spacing, SHELL * spacing
    if kind == int(newton.GeoType.BOX):
        lattice = _lattice(-size, size, spacing)
        depth = (size - np.abs(lattice)).min(axis=1)
    elif kind == int(newton.GeoType.SPHERE):
        lattice = _lattice(np.full(3, -size[0]), np.full(3, size[0]), spacing)
        depth = size[0] - np.linalg.norm(lattice, axis=1)
    elif kind in (int(newton.GeoType.PLANE), int(newton.GeoType.HFIELD)):
        return np.zeros((0, 3))
    else:
        mesh = mesh_of(model, index)
        corners = mesh.points.numpy()
        lattice = _lattice(corners.min(axis=0), corners.max(axis=0), spacing)
        # A point farther from the skin than asked for counts as deep inside or outside alike: none is needed there.
        depth = mesh_depth(mesh, lattice, 2.0 * shell)
    return lattice[(depth < shell) & (depth >= 0.95 * deep)]


def _lattice(low: np.ndarray, high: np.ndarray, spacing: float) -> np.ndarray:
    """Points about a spacing apart in a box, INSET off its faces; none in a box too thin to hide their surface."""
    axes = []
    for a, b in zip(low + INSET * spacing, high - INSET * spacing, strict=True):
        if b - a >= 0.75 * spacing:
            axes.append(np.linspace(a, b, int(np.ceil((b - a) / spacing)) + 1))
        elif 0.5 * (b - a) + INSET * spacing >= SHEET * spacing:
            axes.append(np.array([0.5 * (a + b)]))
        else:
            return np.zeros((0, 3))
    if np.prod([len(axis) for axis in axes]) > MOST_POINTS:
        return np.zeros((0, 3))
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
