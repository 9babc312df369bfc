"""Who is near whom: fluid, walls and bodies sorted by cell, and the neighbour lists of a CPU."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import warp as wp

from wsim.kernels.sph import neighbors as neighbor_kernels
from wsim.kernels.sph.programs import Programs
from wsim.kernels.sph.species import BODIES, FLUID, WALLS
from wsim.solvers.launch import launch_shared
from wsim.solvers.sph_config import ConfigSPH
from wsim.solvers.sph_domain import make_grid
from wsim.solvers.sph_particles import SortedParticles

MANY_NEIGHBORS = 1.6  # smoothing ratio from which a GPU does better to pass over what lies beyond the support


class ParticleSearch:
    """The particles in order, and what the sums over neighbours read.

    A GPU sorts in every step and walks the cells in every sum. A CPU keeps lists with a skin, world by world: a world
    is sorted and listed anew once one of its own particles has moved half the skin, so that it goes the same way alone
    and in a batch. Walls never move.

    Args:
        config: Settings of the method.
        domain: Lower and upper corner [m].
        fluid_world: World of each fluid particle, shape (n,).
        wall_world: World of each particle of a wall.
        body_world: World of each particle of a body.
        wall_position: Where the walls' particles are [m].
        world_count: Number of worlds.
        crowd: Most particles of its own body that any has within reach.
        stage: Of each fluid particle, where some may be parked.
        several: Whether each of them has its own liquid.
        yields: Whether any of these yields.

    Attributes:
        fluid, walls, bodies: The particles of each kind.
        programs: The kernels that fit this way of searching.
    """

    def __init__(
        self,
        config: ConfigSPH,
        domain: tuple[np.ndarray, np.ndarray],
        fluid_world: np.ndarray,
        wall_world: np.ndarray,
        body_world: np.ndarray,
        wall_position: wp.array,
        world_count: int,
        crowd: int,
        stage: wp.array | None = None,
        several: bool = False,
        yields: bool = False,
    ) -> None:
        self.cuda = wall_position.device.is_cuda
        self.skin = 0.0 if self.cuda else config.skin * config.support
        self.world_count = world_count
        self.grid = make_grid(config, *domain, config.support + self.skin, self.cuda, world_count)
        capacity = 0 if self.cuda else _capacity(config, self.grid.support)
        self.fluid, self.walls, self.bodies = (
            SortedParticles(world, self.grid, world_count, capacity and capacity + more, kind, own, several, yields)
            for world, more, kind, own in (
                (fluid_world, 0, FLUID, stage),
                (wall_world, 0, WALLS, None),
                (body_world, crowd, BODIES, None),
            )
        )
        self.moving = [kind for kind in (self.fluid, self.bodies) if kind.count]
        self.solid = [kind for kind in (self.walls, self.bodies) if kind.count]
        self.programs = Programs.make(
            lists=not self.cuda,
            periodic=tuple(map(bool, config.periodic)),
            branch=self.cuda and config.smoothing_ratio > MANY_NEIGHBORS,
            reach=(int(self.grid.reach[1]), int(self.grid.reach[2])),
            solids=tuple(kind for kind, there in ((WALLS, self.walls), (BODIES, self.bodies)) if there.count),
            several=several,
            yields=yields,
        )
        self.walls.sort(wall_position, 0, world_count)
        if self.cuda:
            self.walls.mark(wall_position)
        self.stale = True
        self.overflow = wp.zeros(world_count, dtype=int)
        self.point_at_build = [wp.zeros(0 if self.cuda else kind.count, dtype=wp.vec4) for kind in self.moving]
        self.move2 = wp.zeros(world_count, dtype=float)

    def restart(self) -> None:
        """Begin from the particles' own order, as a search that is made anew does."""
        for kind in self.moving:
            kind.restart()
        self.stale = True

    def crowd(self) -> np.ndarray:
        """The most neighbours that found no room in a list of each world, (W,): a fluid that collapsed."""
        most: np.ndarray = self.overflow.numpy()
        return most

    def update(self, fluid_position: wp.array, body_position: wp.array, gather: Callable[[], None]) -> None:
        """Bring the particles into order.

        Args:
            fluid_position: Positions of the fluid [m].
            body_position: Positions of the bodies' particles [m].
            gather: Copies what the sums need into the present order.
        """
        if self.cuda:
            self.fluid.sort(fluid_position, 0, self.world_count)
            self.bodies.sort(body_position, 0, self.world_count)
            self.bodies.mark(body_position)
            gather()
            return
        if not self.stale:
            gather()
        stale = self._stale_worlds()
        for world in stale:
            self.fluid.sort(fluid_position, world, world + 1)
            self.bodies.sort(body_position, world, world + 1)
        if stale:
            gather()
        for world in stale:
            self._list(world)
        self.stale = False

    def _stale_worlds(self) -> list[int]:
        """Worlds where a particle may have come within reach unseen: two that approach each other share the skin."""
        if self.stale or self.skin == 0.0:
            return list(range(self.world_count))
        self.move2.zero_()
        for kind, point_at_build in zip(self.moving, self.point_at_build, strict=True):
            wp.launch(
                neighbor_kernels.largest_move,
                dim=kind.count,
                inputs=[self.grid, kind.species, point_at_build],
                outputs=[self.move2],
            )
        return np.flatnonzero(self.move2.numpy() >= (0.5 * self.skin) ** 2).tolist()

    def _list(self, world: int) -> None:
        """Find the neighbours of one world's particles."""
        overflow = self.overflow[world : world + 1]
        fluid, walls, bodies = self.fluid.species, self.walls.species, self.bodies.species
        first, last = self.fluid.world_first[world : world + 2]
        launch_shared(
            self.programs.find.of_fluid,
            dim=last - first,
            first=first,
            inputs=[self.grid, walls, bodies],
            outputs=[fluid, overflow],
        )
        finders = self.programs.find
        for kind, find, others in (
            (self.walls, finders.of_walls, [fluid]),
            (self.bodies, finders.of_bodies, [fluid, walls]),
        ):
            first, last = kind.world_first[world : world + 2]
            if kind.count:
                launch_shared(
                    find,
                    dim=last - first,
                    first=first,
                    inputs=[self.grid, *others],
                    outputs=[kind.species, overflow],
                )
        for kind, point_at_build in zip(self.moving, self.point_at_build, strict=True):
            first, last = kind.world_first[world : world + 2]
            wp.copy(point_at_build, kind.point, dest_offset=first, src_offset=first, count=last - first)


def _capacity(config: ConfigSPH, support: float) -> int:
    """Room for half as many neighbours again as stand around a particle at rest."""
    reach = support / config.spacing
    at_rest = 4.0 / 3.0 * math.pi * reach**3 if config.dimensions == 3 else math.pi * reach**2
    return int(1.5 * at_rest) + 16
