"""Single drops: what a surface around particles leaves out, and what lies thin in it."""

from __future__ import annotations

import numpy as np
import trimesh
import warp as wp

from wsim.kernels.render import surface as kernels

ALONE = 0.05 / np.pi  # share of space that others fill in the middle of a particle that is a drop, at most
LEAST = (
    0.7  # share that particles of a surface fill there, at least: that of a sheet whose particles are a spacing apart
)

Mesh = tuple[wp.array, wp.array, wp.array]  # vertices [m], indices, normals


class Drops:
    """Parts drops from a fluid's particles and draws each as a ball of a particle's volume.

    Marching cubes see nothing of a single particle: in its middle it fills 1 / pi of space, less than what the surface
    is drawn at, and a mesh about it, two voxels wide, is smoothed away.

    Args:
        spacing: Between particles [m].
        device: Warp device.

    Attributes:
        flags: Which particles make the surface, (N,), after `part`.
        radii: Their radii [m], (N,).
    """

    def __init__(self, spacing: float, device: wp.Device) -> None:
        self._spacing, self._device = spacing, device
        ball = trimesh.creation.icosphere(subdivisions=1)
        corners = ball.vertices * spacing / ball.volume ** (1.0 / 3.0)
        self._ball = wp.array(corners.astype(np.float32), dtype=wp.vec3f, device=device)
        self._triangles = wp.array(ball.faces.reshape(-1).astype(np.int32), dtype=wp.int32, device=device)
        self._grid = wp.HashGrid(64, 64, 64, device=device)
        self._count = wp.zeros(1, dtype=wp.int32, device=device)
        self._resize(0)

    def _resize(self, count: int) -> None:
        self.flags = wp.empty(count, dtype=wp.int32, device=self._device)
        self.radii = wp.empty(count, dtype=wp.float32, device=self._device)
        self._drops = wp.empty(count, dtype=wp.vec3f, device=self._device)

    def part(self, positions: wp.array, flags: wp.array, fluid_count: int) -> None:
        """Find the drops among the first `fluid_count` positions [m], (N,), of those whose flag is not 0."""
        if self.flags.shape[0] != positions.shape[0]:
            self._resize(positions.shape[0])
        self._grid.build(positions, 2.0 * self._spacing)
        self._count.zero_()
        wp.launch(
            kernels.part_drops,
            dim=positions.shape[0],
            inputs=[self._grid.id, positions, flags, fluid_count, self._spacing, LEAST, ALONE],
            outputs=[self.radii, self.flags, self._drops, self._count],
            device=self._device,
        )

    def joined(self, surface: Mesh | None) -> Mesh | None:
        """A surface and the drops that were found, as one mesh; None where there is neither."""
        count = int(self._count.numpy()[0])
        if count == 0:
            return surface
        vertices, indices = (0, 0) if surface is None else (surface[0].shape[0], surface[1].shape[0])
        sizes = (
            vertices + count * self._ball.shape[0],
            indices + count * self._triangles.shape[0],
            vertices + count * self._ball.shape[0],
        )
        kinds = (wp.vec3f, wp.int32, wp.vec3f)
        made = [wp.empty(n, dtype=kind, device=self._device) for n, kind in zip(sizes, kinds, strict=True)]
        for whole, part in zip(made, surface or (), strict=surface is not None):
            wp.copy(whole, part, count=part.shape[0])
        wp.launch(
            kernels.place_drops,
            dim=count,
            inputs=[self._drops, self._ball, self._triangles, vertices, indices],
            outputs=made,
            device=self._device,
        )
        return made[0], made[1], made[2]
