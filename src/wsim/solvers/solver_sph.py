"""Weakly compressible SPH as a Newton solver, two-way coupled to rigid bodies."""

from __future__ import annotations

import math
from typing import Any

import newton
import numpy as np
import warp as wp
from newton.solvers import SolverBase

from wsim.kernels.sph import boundary as boundary_kernels
from wsim.kernels.sph import density as density_kernels
from wsim.kernels.sph import grid as grid_kernels
from wsim.kernels.sph import neighbors as neighbor_kernels
from wsim.kernels.sph.programs import Programs
from wsim.kernels.sph.status import inspect
from wsim.solvers.launch import launch_shared
from wsim.solvers.shapes import OpenBox, sample_boundary
from wsim.solvers.sph_config import ConfigSPH
from wsim.solvers.sph_domain import cells_of, domain_of, make_grid

LANES = 32
MANY_NEIGHBORS = 1.6  # smoothing ratio from which a GPU does better to pass over what lies beyond the support


class SolverSPH(SolverBase):
    """Weakly compressible SPH (Monaghan 1994) with density diffusion, walls and two-way coupled bodies.

    The model's particles are the fluid. Colliding shapes, fixed and moving, are filled with boundary particles that
    take the fluid's pressure and push back (Adami et al. 2012). A step adds the fluid's force and torque on every body
    to `state_out.body_f`, Newton's external wrench, and leaves it to a rigid-body solver to move the bodies:

        state.clear_forces()
        sph.step(state, state, control, None, dt)
        rigid.step(state, state, control, contacts, dt)

    Order of a step: density and pressure at the present positions and velocities, forces, then velocity, then position
    with the new velocity. Call `register_custom_attributes` on the builder first; the state then has `sph.pressure`.

    Args:
        model: The model to simulate; its particles are the fluid of every world.
        config: Settings of the method.
        containers: Tanks that hold the fluid.

    Raises:
        ValueError: If the model has no particles, the settings are out of range, or a container is too narrow.
    """

    Config = ConfigSPH

    @classmethod
    def register_custom_attributes(cls, builder: newton.ModelBuilder) -> None:
        """Register what the solver reads beside Newton's own particle arrays.

        `sph:pressure` [Pa] is a state variable of each particle, p = c^2 (rho - rho_0). `sph:rest_density` [kg/m^3]
        and `sph:viscosity` [Pa s] belong to a world; 0 takes the `Config`'s.
        """
        frequency, assignment = newton.Model.AttributeFrequency, newton.Model.AttributeAssignment
        for name, of, where in (
            ("pressure", frequency.PARTICLE, assignment.STATE),
            ("rest_density", frequency.WORLD, assignment.MODEL),
            ("viscosity", frequency.WORLD, assignment.MODEL),
        ):
            builder.add_custom_attribute(
                newton.ModelBuilder.CustomAttribute(
                    name=name, frequency=of, assignment=where, dtype=wp.float32, default=0.0, namespace="sph"
                )
            )

    def __init__(self, model: newton.Model, config: ConfigSPH, containers: tuple[OpenBox, ...] = ()) -> None:
        super().__init__(model)
        if model.particle_count == 0:
            raise ValueError("SolverSPH: the model has no particles; add the fluid to the builder first")
        self.config = config
        self.fluid_count = model.particle_count
        self.world_count = max(1, model.world_count)
        # A CPU keeps neighbour lists, with a skin; a GPU walks the cells in every sum.
        self.skin = 0.0 if model.device.is_cuda else config.skin * config.support
        with wp.ScopedDevice(model.device):
            self._read_worlds()
            self._sample_solids(containers)
            low, high = domain_of(model.particle_q.numpy(), containers)
            self.grid = make_grid(config, low, high, config.support + self.skin, model.device.is_cuda, self.world_count)
            self._allocate()
            self.programs = Programs.make(
                lists=not model.device.is_cuda,
                periodic=tuple(map(bool, config.periodic)),
                branch=model.device.is_cuda and config.smoothing_ratio > MANY_NEIGHBORS,
            )
            self.method = self._method()

    def _method(self) -> density_kernels.Method:
        c = self.config
        method = density_kernels.Method()
        h = c.smoothing_length
        method.h, method.shape = h, wp.vec4(1.0 / c.support, -5.0 * c.kernel_norm / h**2, c.support**2, h)
        method.speed_of_sound, method.diffusion = c.speed_of_sound, c.density_diffusion
        method.artificial_viscosity, method.laminar_factor = c.artificial_viscosity, 2.0 * (c.dimensions + 2.0)
        method.background_pressure = c.background_pressure
        return method

    def _read_worlds(self) -> None:
        """Rest density and viscosity of each world."""
        own = getattr(self.model, "sph", None)
        for name in ("rest_density", "viscosity"):
            values = np.full(self.world_count, getattr(self.config, name), dtype=np.float32)
            given = getattr(own, name, None)
            if given is not None and given.shape[0] == self.world_count:
                given = given.numpy()
                if not (np.isfinite(given).all() and (given >= 0.0).all()):
                    raise ValueError(f"SolverSPH: sph:{name} = {given} must be finite and >= 0")
                values = np.where(given > 0.0, given, values)
            setattr(self, name, wp.array(values, dtype=float))

    def notify_model_changed(self, flags: newton.ModelFlags | int) -> None:
        """Read the worlds' densities and viscosities again; gravity and masses are read in every step."""
        if flags & newton.ModelFlags.MODEL_PROPERTIES:
            with wp.ScopedDevice(self.model.device):
                self._read_worlds()

    def _sample_solids(self, containers: tuple[OpenBox, ...]) -> None:
        model = self.model
        world = np.maximum(model.particle_world.numpy(), 0)
        solids = sample_boundary(model, self.config, containers, model.particle_q.numpy(), world)
        self.boundary_count = len(solids.local)
        self.fixed_count = int(solids.body_first[0])
        self.count = self.fluid_count + self.boundary_count
        self.boundary_local = wp.array(solids.local, dtype=wp.vec3)
        self.boundary_position = wp.array(solids.local, dtype=wp.vec3)
        self.boundary_velocity = wp.zeros(self.boundary_count, dtype=wp.vec3)
        self.boundary_volume = wp.array(solids.volume, dtype=float)
        self.boundary_owner = wp.array(solids.owner, dtype=int)
        self.body_first = wp.array(solids.body_first, dtype=int)
        self.has_bodies = self.boundary_count > self.fixed_count
        everywhere = np.concatenate([world, solids.world]).astype(np.int32)
        self.particle_world = wp.array(everywhere, dtype=int)
        self.world_first = np.append(0, np.cumsum(np.bincount(everywhere, minlength=self.world_count))).tolist()
        self.by_world = np.argsort(everywhere, kind="stable").astype(np.int32)

    def _allocate(self) -> None:
        n = self.count
        self.cells_per_world = cells_of(self.grid)
        self.key_bits = max(1, int(self.cells_per_world * self.world_count).bit_length())
        self.key = wp.empty(2 * n, dtype=int)
        self.value = wp.empty(2 * n, dtype=int)
        self.order = wp.array(self.by_world, dtype=int)
        self.cell_count = wp.zeros(self.cells_per_world * self.world_count + 1, dtype=int)
        self.cell_start = wp.zeros(self.cells_per_world * self.world_count + 1, dtype=int)
        self.point = wp.empty(n, dtype=wp.vec4)
        self.motion = wp.empty(n, dtype=wp.vec4)
        self.pressure = wp.empty(n, dtype=float)
        self.fluid_before = wp.zeros(n + 1 if self.model.device.is_cuda else 0, dtype=int)
        self.boundary_force = wp.zeros(max(1, self.boundary_count - self.fixed_count), dtype=wp.vec3)
        self.lane_wrench = wp.zeros((self.model.body_count, LANES), dtype=wp.spatial_vector)
        self.body_wrench = wp.zeros(self.model.body_count, dtype=wp.spatial_vector)
        self.neighborhood = neighbor_kernels.Neighborhood()
        self.neighborhood.grid = self.grid
        self.neighborhood.cell_start = self.cell_start
        self.neighborhood.order = self.order
        self.neighborhood.particle_world = self.particle_world
        self.neighborhood.fluid_count = self.fluid_count
        self.neighborhood.fluid_before = self.fluid_before
        self._allocate_lists(0 if self.model.device.is_cuda else n)
        self.lists_stale = True

    def _allocate_lists(self, n: int) -> None:
        """Room for half as many neighbours again as stand around a particle at rest."""
        reach = self.grid.support / self.config.spacing
        at_rest = 4.0 / 3.0 * math.pi * reach**3 if self.config.dimensions == 3 else math.pi * reach**2
        self.neighborhood.capacity = int(1.5 * at_rest) + 16
        self.neighborhood.entry = wp.empty(n * self.neighborhood.capacity, dtype=int)
        self.neighborhood.entry_count = wp.zeros(n, dtype=int)
        self.neighbor_overflow = wp.zeros(1, dtype=int)
        self.point_at_build = wp.zeros(n, dtype=wp.vec4)
        self.move2 = wp.zeros(self.world_count, dtype=float)

    def reset_lists(self) -> None:
        """Forget the neighbour lists; for a state that did not come from the last step."""
        self.lists_stale = True

    def check(self, state: newton.State) -> int:
        """Look for what makes the fluid's state worthless; call it once in a while, as often as once a frame.

        Args:
            state: The state after a step.

        Returns:
            How many particles have left the domain: spilled, or leaked.

        Raises:
            RuntimeError: If a value is not finite, a particle is faster than sound, or a neighbour list overflowed.
        """
        with wp.ScopedDevice(self.model.device):
            broken = wp.full(1, self.fluid_count, dtype=int)
            fastest2, outside = wp.zeros(1, dtype=float), wp.zeros(1, dtype=int)
            wp.launch(
                inspect,
                dim=self.fluid_count,
                inputs=[self.grid, state.particle_q, state.particle_qd, state.sph.pressure],
                outputs=[broken, fastest2, outside],
            )
        particle, speed = int(broken.numpy()[0]), math.sqrt(float(fastest2.numpy()[0]))
        if particle < self.fluid_count:
            world = int(self.particle_world.numpy()[particle])
            raise RuntimeError(
                f"SolverSPH: fluid particle {particle} of world {world} is not finite; "
                "use a smaller time step or a higher speed of sound"
            )
        if speed > self.config.speed_of_sound:
            raise RuntimeError(
                f"SolverSPH: a fluid particle moves at {speed:.4g} m/s, faster than sound at "
                f"speed_of_sound = {self.config.speed_of_sound:.4g} m/s: the fluid is not nearly incompressible; "
                "use a speed of sound ten times the largest expected speed"
            )
        most = int(self.neighbor_overflow.numpy()[0])
        if most:
            raise RuntimeError(
                f"SolverSPH: {most} neighbours where {self.neighborhood.capacity} fit: the fluid has collapsed; "
                "use a smaller time step or a higher speed of sound"
            )
        return int(outside.numpy()[0])

    def step(
        self,
        state_in: newton.State,
        state_out: newton.State,
        control: newton.Control | None,
        contacts: newton.Contacts | None,
        dt: float,
        **_: Any,
    ) -> None:
        """Advance the fluid by `dt` [s] and add its wrench on the bodies to `state_out.body_f`.

        Args:
            state_in: Positions, velocities and pressures of the fluid, poses and velocities of the bodies.
            state_out: Receives the fluid and the wrenches; may be `state_in`.
            control: Not used.
            contacts: Not used.
            dt: Time step [s]; no larger than `config.max_time_step`.
        """
        with wp.ScopedDevice(self.model.device):
            self._move_solids(state_in)
            self._sort(state_in)
            self._update_pressure(state_out, dt)
            self._move_fluid(state_out, dt)
            self._return_wrenches(state_in, state_out)

    def _move_solids(self, state: newton.State) -> None:
        if self.has_bodies:
            wp.launch(
                boundary_kernels.move_boundary,
                dim=self.boundary_count,
                inputs=[
                    self.grid,
                    self.boundary_local,
                    self.boundary_owner,
                    state.body_q,
                    state.body_qd,
                    self.model.body_com,
                ],
                outputs=[self.boundary_position, self.boundary_velocity],
            )

    def _sort(self, state: newton.State) -> None:
        """Bring all particles into the order of their cells, and find their neighbours where lists are kept."""
        if self.model.device.is_cuda:
            self._sort_range(state, 0, self.world_count)
            self._gather(state)
            return
        if not self.lists_stale:
            self._gather(state)
        stale = self._stale_worlds()
        for world in stale:
            self._sort_range(state, world, world + 1)
        if stale:
            self._gather(state)
        for world in stale:
            self._find_neighbors(world)
        self.lists_stale = False

    def _stale_worlds(self) -> list[int]:
        """Worlds where a particle may have come within reach unseen: two that approach each other share the skin.

        Each world is judged by its own particles, so that it goes the same way alone and in a batch.
        """
        if self.lists_stale or self.skin == 0.0:
            return list(range(self.world_count))
        self.move2.zero_()
        wp.launch(
            neighbor_kernels.largest_move,
            dim=self.count,
            inputs=[self.neighborhood, self.point, self.point_at_build],
            outputs=[self.move2],
        )
        return np.flatnonzero(self.move2.numpy() >= (0.5 * self.skin) ** 2).tolist()

    def _sort_range(self, state: newton.State, first_world: int, last_world: int) -> None:
        """Sort the particles of some worlds by cell; the sort is stable, so that a run repeats bit for bit."""
        first, last = self.world_first[first_world], self.world_first[last_world]
        low, high = first_world * self.cells_per_world, last_world * self.cells_per_world
        if first == last:
            return
        counted = self.cell_count[low : high + 1]
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
                self.boundary_position,
                self.particle_world,
            ],
            outputs=[self.key, self.value, self.cell_count],
        )
        start = self.cell_start[low : high + 1]
        wp.utils.array_scan(counted, start, inclusive=False)
        if first:
            wp.launch(grid_kernels.shift, dim=high - low + 1, inputs=[first], outputs=[start])
        wp.utils.radix_sort_pairs(self.key, self.value, last - first, 0, self.key_bits)
        wp.copy(self.order, self.value, dest_offset=first, count=last - first)

    def _gather(self, state: newton.State) -> None:
        """Copy what the sums need into sorted order."""
        wp.launch(
            grid_kernels.gather,
            dim=self.count,
            inputs=[
                self.fluid_count,
                self.order,
                state.particle_q,
                state.particle_qd,
                state.sph.pressure,
                self.model.particle_mass,
                self.boundary_position,
                self.boundary_velocity,
                self.boundary_volume,
                self.particle_world,
                self.rest_density,
                self.config.speed_of_sound,
            ],
            outputs=[self.point, self.motion, self.fluid_before],
        )
        if self.fluid_before.size:
            wp.utils.array_scan(self.fluid_before, self.fluid_before, inclusive=False)

    def _find_neighbors(self, world: int) -> None:
        first, last = self.world_first[world], self.world_first[world + 1]
        nb = self.neighborhood
        launch_shared(
            self.programs.find_neighbors,
            dim=last - first,
            first=first,
            inputs=[nb, self.point],
            outputs=[nb.entry, nb.entry_count, self.neighbor_overflow],
        )
        wp.copy(self.point_at_build, self.point, dest_offset=first, src_offset=first, count=last - first)

    def _update_pressure(self, state_out: newton.State, dt: float) -> None:
        """Continuity and the equation of state; then the walls take over the fluid's pressure."""
        fluid = [self.neighborhood, self.method, self.rest_density]
        launch_shared(
            self.programs.continuity,
            dim=self.count,
            inputs=[*fluid, self.model.gravity, self.point, self.motion, dt],
            outputs=[self.pressure],
        )
        wp.launch(
            density_kernels.set_pressure,
            dim=self.count,
            inputs=[self.fluid_count, self.order, self.pressure],
            outputs=[self.motion, state_out.sph.pressure],
        )
        if self.boundary_count:
            launch_shared(
                self.programs.extrapolate,
                dim=self.count,
                inputs=[*fluid, self.model.gravity, self.point],
                outputs=[self.motion],
            )

    def _move_fluid(self, state_out: newton.State, dt: float) -> None:
        """Momentum: the fluid moves, and its push on the bodies is kept."""
        launch_shared(
            self.programs.momentum,
            dim=self.count,
            inputs=[
                self.neighborhood,
                self.method,
                self.rest_density,
                self.viscosity,
                self.model.gravity,
                self.point,
                self.motion,
                self.model.particle_mass,
                self.fixed_count,
                dt,
            ],
            outputs=[state_out.particle_q, state_out.particle_qd, self.boundary_force],
        )

    def _return_wrenches(self, state_in: newton.State, state_out: newton.State) -> None:
        if not self.has_bodies:
            return
        wp.launch(
            boundary_kernels.sum_body_lanes,
            dim=(self.model.body_count, LANES),
            inputs=[self.body_first, self.boundary_force, self.boundary_local, state_in.body_q, self.model.body_com],
            outputs=[self.lane_wrench],
        )
        wp.launch(
            boundary_kernels.add_body_wrench,
            dim=self.model.body_count,
            inputs=[self.lane_wrench],
            outputs=[self.body_wrench, state_out.body_f],
        )
