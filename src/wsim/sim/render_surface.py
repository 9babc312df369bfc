"""From fluid particles to the smooth surface that the camera sees."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import warp as wp
from newton.geometry import ParticleSurface

from wsim.kernels.render import surface as kernels
from wsim.sim.render_drops import Drops, Mesh
from wsim.sim.render_fill import SolidFill

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsim.scene.world import Container, Fluid, World

FARTHEST = 1.0e4  # [m] from the origin: particles beyond it are not drawn
VOXEL = 0.7  # voxel edge over particle spacing: the coarsest that still gives a flat top
KERNEL = 2.0  # kernel radius over particle spacing
THRESHOLD = 0.42  # puts a wall of particles' surface half a spacing outside their centres
SMOOTHING = 4  # passes over the mesh


class FluidSurface:
    """Reusable surface of one fluid's particles.

    Args:
        fluid: The fluid as the stage states it.
        container: The container it fills; its surface is brought up to the walls.
        fill: Points inside what floats in it.
        device: Warp device.
    """

    def __init__(self, fluid: Fluid, container: Container | None, fill: SolidFill, device: wp.Device) -> None:
        self.fluid = fluid
        self._container = container
        self._fill = fill
        self._device = device
        self._extractor = ParticleSurface(
            voxel_size=VOXEL * fluid.spacing,
            kernel_radius=KERNEL * fluid.spacing,
            threshold=THRESHOLD,
            mesh_smooth_iterations=SMOOTHING,
            mesh_smooth_lambda=0.5,
            device=device,
        )
        self._positions = wp.empty(0, dtype=wp.vec3f, device=device)
        self._flags = wp.empty(0, dtype=wp.int32, device=device)
        self._drops = Drops(fluid.spacing, device)

    def extract(self, positions: Any) -> Mesh | None:
        """Vertices, triangle indices and vertex normals of the surface and of single drops; None where there is none.

        Args:
            positions: Particle centres [m], (N, 3), a Warp array of vec3 or an array of numbers.
        """
        given = _as_vec3(positions, self.fluid.prim, self._device)
        count = given.shape[0]
        if count == 0:
            return None
        total = count + self._fill.count
        if self._positions.shape[0] != total:
            self._positions = wp.empty(total, dtype=wp.vec3f, device=self._device)
            self._flags = wp.empty(total, dtype=wp.int32, device=self._device)
        wp.launch(
            kernels.keep_finite,
            dim=count,
            inputs=[given, FARTHEST],
            outputs=[self._positions, self._flags],
            device=self._device,
        )
        self._fill.write(self._positions, self._flags, count, FARTHEST)
        self._drops.part(self._positions, self._flags, count)
        mesh = self._extractor.extract(self._positions, self._drops.radii, particle_flags=self._drops.flags)
        vertices, indices, normals = mesh.to_arrays()
        if vertices is None or indices is None or normals is None:
            return self._drops.joined(None)
        self._fit(vertices)
        return self._drops.joined((vertices, indices, normals))

    def _fit(self, vertices: wp.array) -> None:
        box = self._container
        if box is None:
            return
        wp.launch(
            kernels.fit_container,
            dim=vertices.shape[0],
            inputs=[
                wp.vec3f(*box.inner_center),
                wp.quatf(*box.rotation),
                wp.vec3f(*(0.5 * s for s in box.inner_size)),
                1.2 * self.fluid.spacing,
                # A hair into the wall, so that no film of air lies between water and glass.
                1.0e-3 * max(box.inner_size),
            ],
            outputs=[vertices],
            device=self._device,
        )


class FluidMesh:
    """The surfaces of all fluids as one mesh that rays can be cast at."""

    def __init__(self, model: Any, world: World, world_index: int = 0) -> None:
        containers = {c.prim: c for c in world.containers}
        self._device = device = model.device
        fills = {f.spacing: SolidFill(model, world, f.spacing, world_index) for f in world.fluids}
        self._surfaces = {
            f.prim: FluidSurface(f, containers.get(f.container or ""), fills[f.spacing], device) for f in world.fluids
        }
        self._order = {prim: i for i, prim in enumerate(self._surfaces)}
        self._mesh: wp.Mesh | None = None
        self.normals = wp.empty(0, dtype=wp.vec3f, device=device)
        self.fluid_of_vertex = wp.empty(0, dtype=wp.int32, device=device)

    @property
    def id(self) -> int:
        """Warp's handle of the mesh; 0 where no fluid is to be seen."""
        return int(self._mesh.id) if self._mesh is not None else 0

    def points(self) -> np.ndarray:
        """The mesh's vertices [m], (V, 3)."""
        return self._mesh.points.numpy() if self._mesh is not None else np.zeros((0, 3), dtype=np.float32)

    def triangles(self) -> np.ndarray:
        """The vertices' indices of each triangle, (T, 3)."""
        return self._mesh.indices.numpy().reshape(-1, 3) if self._mesh is not None else np.zeros((0, 3), dtype=np.int32)

    def update(self, fluids: Mapping[str, Any]) -> None:
        """Rebuild from particle positions by fluid prim; KeyError naming the known fluids.

        The shapes' poses (`model.bvh_refit_shapes`) must be up to date.
        """
        parts = []
        for prim, positions in fluids.items():
            if prim not in self._surfaces:
                raise KeyError(f"no fluid {prim!r}; the world has {list(self._surfaces)}")
            surface = self._surfaces[prim].extract(positions)
            if surface is not None:
                parts.append((self._order[prim], *surface))
        self._mesh = None
        if not parts:
            return
        if len(parts) == 1:
            order, vertices, indices, self.normals = parts[0]
            self.fluid_of_vertex = wp.full(vertices.shape[0], order, dtype=wp.int32, device=self._device)
        else:
            vertices, indices = self._join(parts)
        self._mesh = wp.Mesh(points=vertices, indices=indices)

    def _join(self, parts: list[tuple[int, wp.array, wp.array, wp.array]]) -> tuple[wp.array, wp.array]:
        counts = [part[1].shape[0] for part in parts]
        starts = np.concatenate(([0], np.cumsum(counts)[:-1]))
        vertices = np.concatenate([part[1].numpy() for part in parts])
        indices = np.concatenate([part[2].numpy() + start for part, start in zip(parts, starts, strict=True)])
        normals = np.concatenate([part[3].numpy() for part in parts])
        owner = np.repeat([part[0] for part in parts], counts)
        self.normals = wp.array(normals, dtype=wp.vec3f, device=self._device)
        self.fluid_of_vertex = wp.array(owner, dtype=wp.int32, device=self._device)
        return (
            wp.array(vertices, dtype=wp.vec3f, device=self._device),
            wp.array(indices, dtype=wp.int32, device=self._device),
        )


def _as_vec3(positions: Any, prim: str, device: wp.Device) -> wp.array:
    if isinstance(positions, wp.array):
        if positions.dtype != wp.vec3f or positions.ndim != 1:
            raise ValueError(
                f"fluids[{prim!r}]: a Warp array must be (N,) of vec3, not {positions.shape} of {positions.dtype}"
            )
        return positions if positions.device == device else positions.to(device)
    values = np.asarray(positions, dtype=np.float32)
    if values.ndim != 2 or values.shape[1] != 3:
        raise ValueError(f"fluids[{prim!r}]: positions must be (N, 3), not {values.shape}")
    return wp.array(values, dtype=wp.vec3f, device=device)
