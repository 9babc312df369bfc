"""Who is near whom: particles sorted by cell, and the neighbour lists of a CPU."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import newton
import numpy as np
import warp as wp

from wsim.kernels.sph import grid as grid_kernels
from wsim.kernels.sph import neighbors as neighbor_kernels
from wsim.kernels.sph.programs import Programs
from wsim.solvers.launch import launch_shared
from wsim.solvers.sph_config import ConfigSPH
from wsim.solvers.sph_domain import cells_of, make_grid

MANY_NEIGHBORS = 1.6  # smoothing ratio from which a GPU does better to pass over what lies beyond the support


class ParticleSearch:
    """The order of the particles, fluid and boundary, and what the sums over neighbours read.

    A GPU sorts in every step and walks the cells in every sum. A CPU keeps lists with a skin, world by world: a world
    is sorted and listed anew once one of its own particles has moved half the skin, so that it goes the same way alone
    and in a batch.

    Args:
        config: Settings of the method.
        domain: Lower and upper corner [m].
        particle_world: World of each particle, fluid first; its device is where all arrays are made.
        fluid_count: How many of them are fluid.
        world_count: Number of worlds.
        bodies: Some boundary particles are of moving bodies.

    Attributes:
        order: Original index of each sorted one, shape (n,).
        neighborhood: What the kernels take.
        programs: The kernels that fit this way of searching.
    """

    def __init__(
        self,
        config: ConfigSPH,
        domain: tuple[np.ndarray, np.ndarray],
        particle_world: wp.array,
        fluid_count: int,
        world_count: int,
        bodies: bool,
    ) -> None:
        self.cuda = particle_world.device.is_cuda
        self.skin = 0.0 if self.cuda else config.skin * config.support
        self.grid = make_grid(config, *domain, config.support + self.skin, self.cuda, world_count)
        self.programs = Programs.make(
            lists=not self.cuda,
            periodic=tuple(map(bool, config.periodic)),
            branch=self.cuda and config.smoothing_ratio > MANY_NEIGHBORS,
            reach=(int(self.grid.reach[1]), int(self.grid.reach[2])),
            bodies=bodies,
        )
        self.fluid_count, self.world_count, self.count = fluid_count, world_count, particle_world.shape[0]
        self.particle_world = particle_world
        self.cells_per_world = cells_of(self.grid)
        self.stale = True
        worlds = particle_world.numpy()
        self.world_first = np.append(0, np.cumsum(np.bincount(worlds, minlength=world_count))).tolist()
        self._allocate(np.argsort(worlds, kind="stable").astype(np.int32))
        self._allocate_lists(config)

    def _allocate(self, by_world: np.ndarray) -> None:
        n, cells = self.count, self.cells_per_world * self.world_count
        self.key_bits = max(1, cells.bit_length())
        self.key = wp.empty(2 * n, dtype=int)
        self.value = wp.empty(2 * n, dtype=int)
        self.order = wp.array(by_world, dtype=int)
        self.cell_count = wp.zeros(cells + 1, dtype=int)
        self.cell_start = wp.zeros(cells + 1, dtype=int)
        self.fluid_before = wp.zeros(n + 1 if self.cuda else 0, dtype=int)
        # A CPU loses nothing by passing over the fluid: there the slots are all.
        self.boundary_slot = wp.array(np.arange(n - self.fluid_count if self.cuda else n, dtype=np.int32), dtype=int)
        self.neighborhood = neighbor_kernels.Neighborhood()
        self.neighborhood.grid = self.grid
        self.neighborhood.cell_start = self.cell_start
        self.neighborhood.fluid_before = self.fluid_before
        self.neighborhood.order = self.order
        self.neighborhood.particle_world = self.particle_world
        self.neighborhood.fluid_count = self.fluid_count

    def _allocate_lists(self, config: ConfigSPH) -> None:
        """Room for half as many neighbours again as stand around a particle at rest; a GPU keeps no lists."""
        n, reach = 0 if self.cuda else self.count, self.grid.support / config.spacing
        at_rest = 4.0 / 3.0 * math.pi * reach**3 if config.dimensions == 3 else math.pi * reach**2
        self.neighborhood.capacity = int(1.5 * at_rest) + 16
        self.neighborhood.entry = wp.empty(n * self.neighborhood.capacity, dtype=int)
        self.neighborhood.entry_count = wp.zeros(n, dtype=int)
        self.overflow = wp.zeros(1, dtype=int)
        self.point_at_build = wp.zeros(n, dtype=wp.vec4)
        self.move2 = wp.zeros(self.world_count, dtype=float)

    def check(self) -> None:
        """Raise RuntimeError if a neighbour list has overflowed: the fluid was compressed beyond sense."""
        most = int(self.overflow.numpy()[0])
        if most:
            raise RuntimeError(
                f"SolverSPH: {most} neighbours where {self.neighborhood.capacity} fit: the fluid has collapsed; "
                "use a smaller time step or a higher speed of sound"
            )

    def update(
        self, state: newton.State, boundary_position: wp.array, point: wp.array, gather: Callable[[], None]
    ) -> None:
        """Bring the particles into order.

        Args:
            state: Positions of the fluid.
            boundary_position: Positions of the boundary [m].
            point: The sorted records, which `gather` writes.
            gather: Copies what the sums need into the present order.
        """
        if self.cuda:
            self._sort(state, boundary_position, 0, self.world_count)
            gather()
            wp.utils.array_scan(self.fluid_before, self.fluid_before, inclusive=False)
            wp.launch(
                neighbor_kernels.find_boundary, dim=self.count, inputs=[self.fluid_before], outputs=[self.boundary_slot]
            )
            return
        if not self.stale:
            gather()
        stale = self._stale_worlds(point)
        for world in stale:
            self._sort(state, boundary_position, world, world + 1)
        if stale:
            gather()
        for world in stale:
            self._list(point, world)
        self.stale = False

    def _stale_worlds(self, point: wp.array) -> list[int]:
        """Worlds where a particle may have come within reach unseen: two that approach each other share the skin."""
        if self.stale or self.skin == 0.0:
            return list(range(self.world_count))
        self.move2.zero_()
        wp.launch(
            neighbor_kernels.largest_move,
            dim=self.count,
            inputs=[self.neighborhood, point, self.point_at_build],
            outputs=[self.move2],
        )
        return np.flatnonzero(self.move2.numpy() >= (0.5 * self.skin) ** 2).tolist()

    def _sort(self, state: Any, boundary_position: wp.array, first_world: int, last_world: int) -> None:
        """Sort the particles of some worlds by cell; the sort is stable, so that a run repeats bit for bit."""
        first, last = self.world_first[first_world], self.world_first[last_world]
        low, high = first_world * self.cells_per_world, last_world * self.cells_per_world
        if first == last:
            return
        counted, start = self.cell_count[low : high + 1], self.cell_start[low : high + 1]
        counted.zero_()
        wp.launch(
            grid_kernels.assign_cells,
            dim=last - first,
            inputs=[
                first,
                self.grid,
                self.fluid_count,
                self.order,
                state.particle_q,
                boundary_position,
                self.particle_world,
            ],
            outputs=[self.key, self.value, self.cell_count],
        )
        wp.utils.array_scan(counted, start, inclusive=False)
        if first:
            wp.launch(grid_kernels.shift, dim=high - low + 1, inputs=[first], outputs=[start])
        wp.utils.radix_sort_pairs(self.key, self.value, last - first, 0, self.key_bits)
        wp.copy(self.order, self.value, dest_offset=first, count=last - first)

    def _list(self, point: wp.array, world: int) -> None:
        """Find the neighbours of one world's particles."""
        first, last = self.world_first[world], self.world_first[world + 1]
        nb = self.neighborhood
        launch_shared(
            self.programs.find_neighbors,
            dim=last - first,
            first=first,
            inputs=[nb, point],
            outputs=[nb.entry, nb.entry_count, self.overflow],
        )
        wp.copy(self.point_at_build, point, dest_offset=first, src_offset=first, count=last - first)
