"""Particles of one kind in the order of their cells."""

from __future__ import annotations

from typing import Any

import numpy as np
import warp as wp

from wsim.kernels.sph import grid as grid_kernels
from wsim.kernels.sph.species import BODIES, FLUID, Species, mark_near
from wsim.solvers.sph_domain import blocks_of, cells_of


class SortedParticles:
    """Particles of one kind, sorted by world and cell, and the records that sums over neighbours read.

    Args:
        world: World of each particle, shape (n,).
        grid: The cells.
        world_count: Number of worlds.
        capacity: Neighbours that a list has room for; 0 where cells are walked.
        kind: `FLUID`, `WALLS` or `BODIES`.
        stage: Of each, where some may be parked (`wsim.kernels.sph.openings`).
        several: Whether each particle of fluid has its own liquid.
        yields: Whether any of these yields.

    Attributes:
        count: Number of particles n.
        world: World of each in original order, shape (n,).
        order: Original index of each sorted one, shape (n,).
        point: Position [m] and volume [m^3] of each sorted one, shape (n,).
        motion: Velocity [m/s] and pressure [Pa] of each sorted one, shape (n,).
        liquid: Rest density [kg/m^3] and viscosity [Pa s] of each, of solids what is near; empty with one liquid.
        facing: Of solids, as `across` and `handed` of bodies: see `Species`.
        species: What kernels take.
    """

    def __init__(
        self,
        world: np.ndarray,
        grid: Any,
        world_count: int,
        capacity: int,
        kind: int,
        stage: wp.array | None = None,
        several: bool = False,
        yields: bool = False,
    ) -> None:
        n = self.count = len(world)
        cells = cells_of(grid) * world_count if n else 0
        self.grid, self.cells_per_world = grid, cells_of(grid)
        self.key_bits = max(1, cells.bit_length())
        self.world_first = np.append(0, np.cumsum(np.bincount(world, minlength=world_count))).tolist()
        self.world = wp.array(world.astype(np.int32), dtype=int)
        self.stage = wp.empty(0, dtype=int) if stage is None else stage
        self.key, self.value = wp.empty(2 * n, dtype=int), wp.empty(2 * n, dtype=int)
        # Where all worlds are sorted together the sort works on the order itself.
        apart = world_count > 1 and capacity > 0
        self.order = wp.empty(n, dtype=int) if apart or n == 0 else self.value[:n]
        self._own_order = wp.array(np.argsort(world, kind="stable").astype(np.int32), dtype=int)
        self.restart()
        self.cell_count, self.cell_start = wp.zeros(cells + 1, dtype=int), wp.zeros(cells + 1, dtype=int)
        self.point, self.motion = wp.zeros(n, dtype=wp.vec4), wp.zeros(n, dtype=wp.vec4)
        # Made here: a first step may be captured in a CUDA graph, which would keep what is made in it to itself.
        self.near = wp.zeros(0 if capacity or n == 0 else blocks_of(grid) * world_count, dtype=wp.uint8)
        self.species: Any = Species()
        self.species.order, self.species.world = self.order, self.world
        self.species.point, self.species.motion = self.point, self.motion
        self.species.liquid = self.liquid = wp.zeros(n if several else 0, dtype=wp.vec2)
        self.species.creep = self.creep = wp.zeros(n if yields else 0, dtype=wp.vec4)
        self.species.stage = self.stage
        self.species.full = self.full = wp.zeros(n if kind == FLUID else 0, dtype=float)
        self.species.facing = self.facing = wp.zeros(0 if kind == FLUID else n, dtype=wp.vec4)
        self.species.across = self.across = wp.zeros(n if kind == BODIES else 0, dtype=wp.vec4)
        self.species.handed = self.handed = wp.zeros(n if kind == BODIES else 0, dtype=wp.vec4)
        self.species.cell_start, self.species.near = self.cell_start, self.near
        self.species.entry, self.species.capacity = wp.empty(n * capacity, dtype=int), capacity
        self.species.entry_count = wp.zeros(n if capacity else 0, dtype=wp.vec3i)

    def restart(self) -> None:
        """Forget how they were sorted: the next sort starts from their own order, world by world."""
        wp.copy(self.order, self._own_order)

    def sort(self, position: wp.array, first_world: int, last_world: int) -> None:
        """Sort the particles of some worlds by cell; the sort is stable, so that a run repeats bit for bit.

        Args:
            position: Of all particles, in original order [m].
            first_world: First of the worlds.
            last_world: Past the last of them.
        """
        first, last = self.world_first[first_world], self.world_first[last_world]
        low, high = first_world * self.cells_per_world, last_world * self.cells_per_world
        if first == last:
            return
        counted, start = self.cell_count[low : high + 1], self.cell_start[low : high + 1]
        counted.zero_()
        wp.launch(
            grid_kernels.assign_cells,
            dim=last - first,
            inputs=[first, self.grid, self.order, position, self.world, self.stage],
            outputs=[self.key, self.value, self.cell_count],
        )
        wp.utils.array_scan(counted, start, inclusive=False)
        if first:
            wp.launch(grid_kernels.shift, dim=high - low + 1, inputs=[first], outputs=[start])
        wp.utils.radix_sort_pairs(self.key, self.value, last - first, 0, self.key_bits)
        if self.order.ptr != self.value.ptr:
            wp.copy(self.order, self.value, dest_offset=first, count=last - first)

    def mark(self, position: wp.array) -> None:
        """Mark the blocks that are near; walks of others pass over the rest."""
        if not self.count:
            return
        self.near.zero_()
        wp.launch(mark_near, dim=(self.count, 27), inputs=[self.grid, position, self.world], outputs=[self.near])
