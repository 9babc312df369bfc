"""The fluid's push on the particles of bodies, and what the water in gaps keeps from step to step."""

from __future__ import annotations

from typing import Any

import numpy as np
import warp as wp

from wsim.kernels.sph import push as push_kernels
from wsim.kernels.sph.species import DRY
from wsim.solvers.launch import launch_shared
from wsim.solvers.sph_search import ParticleSearch


class BodyPush:
    """Forces on the particles of bodies, made anew in each step.

    Args:
        search: Of the particles.
        owner: Body of each particle of one, shape (n,).
        vessels: Bodies that are vessels.

    Attributes:
        force: On each particle [N], shape (n,).
        on_walls: What each gives to walls across a gap [N], shape (n,); empty where there are none.
        world_first: First particle of each world, and past the last one's.
        handed: What each hands on to the next step, shape (n,): see `wsim.kernels.sph.push`.
    """

    def __init__(self, search: ParticleSearch, owner: wp.array, vessels: frozenset[int] = frozenset()) -> None:
        self._owner = owner
        self._of_vessel = wp.array(np.isin(owner.numpy(), sorted(vessels)).astype(np.int32), dtype=int)
        self._spares = bool(vessels)
        self.force = wp.zeros(len(owner), dtype=wp.vec3)
        self.world_first = wp.array(search.bodies.world_first, dtype=int)
        self.handed = wp.full(len(owner), wp.vec3(DRY, 0.0, 1.0), dtype=wp.vec3)
        self.look_among(search)

    def look_among(self, search: ParticleSearch) -> None:
        """Take another search for the same bodies, among other walls; gaps stay as wet as they are."""
        self._search = search
        self.on_walls = wp.zeros(len(self._owner) if search.walls.count else 0, dtype=wp.vec3)

    def forget(self) -> None:
        """Let the gaps be dry, until water gets there."""
        self.handed.fill_(wp.vec3(DRY, 0.0, 1.0))

    def gather(self) -> None:
        """Copy what the sums need into sorted order."""
        bodies = self._search.bodies
        if bodies.count:
            wp.launch(
                push_kernels.gather_bodies,
                dim=bodies.count,
                inputs=[bodies.order, self._owner, self.handed],
                outputs=[bodies.handed],
            )

    def sum(self, method: Any, rest_density: wp.array, viscosity: wp.array, gravity: wp.array) -> None:
        """Sum the forces, of pressures as they are.

        Args:
            method: Settings, as kernels take them.
            rest_density: Of each world [kg/m^3].
            viscosity: Of each world [Pa s].
            gravity: Of each world [m/s^2].
        """
        search = self._search
        fluid, walls, bodies = (kind.species for kind in (search.fluid, search.walls, search.bodies))
        if not search.bodies.count:
            return
        launch_shared(
            search.programs.look_across,
            dim=search.bodies.count,
            inputs=[search.grid, method, walls, bodies],
            outputs=[search.bodies.across],
        )
        if self._spares:
            wp.launch(
                push_kernels.spare_vessels,
                dim=search.bodies.count,
                inputs=[search.bodies.order, self._of_vessel],
                outputs=[search.bodies.across],
            )
        launch_shared(
            search.programs.push,
            dim=search.bodies.count,
            inputs=[search.grid, method, rest_density, viscosity, gravity, fluid, walls, bodies],
            outputs=[self.force, self.on_walls, self.handed],
        )
