"""Weakly compressible SPH as a Newton solver, two-way coupled to rigid bodies."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import newton
import numpy as np
import warp as wp
from newton.solvers import SolverBase

from wsim.kernels.sph import boundary as boundary_kernels
from wsim.kernels.sph import density as density_kernels
from wsim.kernels.sph import grid as grid_kernels
from wsim.kernels.sph import momentum as momentum_kernels
from wsim.kernels.sph import neighbors as neighbor_kernels
from wsim.solvers.launch import launch_shared
from wsim.solvers.shapes import OpenBox, sample_boundary

LANES = 32
MAX_CELLS = 2**28


class SolverSPH(SolverBase):
    """Weakly compressible SPH (Monaghan 1994) with density diffusion, walls and two-way coupled bodies.

    The model's particles are the fluid. Colliding shapes, fixed and moving, are filled with boundary particles that
    take the fluid's pressure and push back (Adami et al. 2012). A step adds the fluid's force and torque on every body
    to `state_out.body_f`, Newton's external wrench, and leaves it to a rigid-body solver to move the bodies:

        state.clear_forces()
        sph.step(state, state, control, None, dt)
        rigid.step(state, state, control, contacts, dt)

    Order of a step: density and pressure at the present positions and velocities, forces, then velocity, then position
    with the new velocity. Call `register_custom_attributes` on the builder first; the state then has `sph.density`.

    Args:
        model: The model to simulate; its particles are the fluid of every world.
        config: Settings of the method.
        containers: Tanks that hold the fluid, in every world.

    Raises:
        ValueError: If the model has no particles, or the settings are out of range.
    """

    @dataclass
    class Config:
        """Settings of `SolverSPH`."""

        spacing: float = 0.02
        """Distance between particles at rest [m]."""
        smoothing_ratio: float = 1.3
        """Smoothing length over spacing; the kernel's support is twice the smoothing length."""
        rest_density: float = 1000.0
        """Density at zero pressure [kg/m^3]."""
        speed_of_sound: float = 0.0
        """Numerical speed of sound [m/s]; ten times the largest expected speed keeps the density within 1 %."""
        viscosity: float = 1.0e-3
        """Dynamic viscosity [Pa s]."""
        artificial_viscosity: float = 0.02
        """Monaghan's alpha."""
        density_diffusion: float = 0.1
        """delta of the density diffusion term."""
        cfl: float = 0.5
        """Courant number: dt <= cfl * smoothing length / speed of sound."""
        cells_per_support: int = 0
        """Grid cells that the search radius spans; 0 takes 3 on a GPU, where finer cells trim the search closer to the
        sphere, and 1 on a CPU, where looking up the rows costs more than that saves."""
        skin: float = 0.1
        """How much further than the support the neighbour lists reach, as a share of it. On a CPU the lists are kept
        until a particle has moved half the skin; on a GPU they are made anew each step, with no skin, so that the step
        has no branch and can be captured in a graph."""

        def __post_init__(self) -> None:
            """Reject settings that cannot work."""
            for name in ("spacing", "smoothing_ratio", "rest_density", "speed_of_sound", "cfl"):
                value = getattr(self, name)
                if not (math.isfinite(value) and value > 0.0):
                    raise ValueError(f"SolverSPH.Config: {name} = {value} must be > 0")
            for name in ("viscosity", "artificial_viscosity", "density_diffusion", "skin"):
                value = getattr(self, name)
                if not (math.isfinite(value) and value >= 0.0):
                    raise ValueError(f"SolverSPH.Config: {name} = {value} must be >= 0")
            if not 0 <= self.cells_per_support <= 8:
                raise ValueError(f"SolverSPH.Config: cells_per_support = {self.cells_per_support} must be in 0..8")

        @property
        def smoothing_length(self) -> float:
            """Smoothing length h [m]."""
            return self.smoothing_ratio * self.spacing

        @property
        def support(self) -> float:
            """Radius of the kernel's support, 2h [m]."""
            return 2.0 * self.smoothing_length

        @property
        def max_time_step(self) -> float:
            """Largest stable step by the acoustic Courant condition [s]."""
            return self.cfl * self.smoothing_length / self.speed_of_sound

    @classmethod
    def register_custom_attributes(cls, builder: newton.ModelBuilder) -> None:
        """Register `sph:density` [kg/m^3], a state variable of each particle; 0 starts at the rest density."""
        builder.add_custom_attribute(
            newton.ModelBuilder.CustomAttribute(
                name="density",
                frequency=newton.Model.AttributeFrequency.PARTICLE,
                assignment=newton.Model.AttributeAssignment.STATE,
                dtype=wp.float32,
                default=0.0,
                namespace="sph",
            )
        )

    def __init__(self, model: newton.Model, config: Config, containers: tuple[OpenBox, ...] = ()) -> None:
        super().__init__(model)
        if model.particle_count == 0:
            raise ValueError("SolverSPH: the model has no particles; add the fluid to the builder first")
        self.config = config
        h = config.smoothing_length
        self.kernel_norm = 21.0 / (16.0 * math.pi * h**3)
        self.fluid_count = model.particle_count
        with wp.ScopedDevice(model.device):
            self._sample_solids(containers)
            self._lay_grid(containers)
            self._allocate()

    def _sample_solids(self, containers: tuple[OpenBox, ...]) -> None:
        model = self.model
        fluid = model.particle_q.numpy()
        world = np.maximum(model.particle_world.numpy(), 0)
        solids = sample_boundary(model, self.config.spacing, self.config.support, containers, fluid, world)
        self.boundary_count = len(solids.local)
        self.count = self.fluid_count + self.boundary_count
        self.boundary_local = wp.array(solids.local, dtype=wp.vec3)
        self.boundary_position = wp.array(solids.local, dtype=wp.vec3)
        self.boundary_velocity = wp.zeros(self.boundary_count, dtype=wp.vec3)
        self.boundary_volume = wp.array(solids.volume, dtype=float)
        self.boundary_owner = wp.array(solids.owner, dtype=int)
        self.body_first = wp.array(solids.body_first, dtype=int)
        self.has_bodies = bool(solids.body_first[-1] > solids.body_first[0])
        self.particle_world = wp.array(np.concatenate([world, solids.world]).astype(np.int32), dtype=int)

    def _lay_grid(self, containers: tuple[OpenBox, ...]) -> None:
        """Cells over the fluid and its tanks; a free fluid gets as much room again on each side."""
        fluid = self.model.particle_q.numpy()
        low, high = fluid.min(axis=0), fluid.max(axis=0)
        if containers:
            for box in containers:
                diagonal = np.full(3, float(np.linalg.norm(box.size)))
                half = 0.5 * (np.array(box.size) if box.rotation[3] == 1.0 else diagonal)
                low, high = np.minimum(low, np.array(box.center) - half), np.maximum(high, np.array(box.center) + half)
        else:
            room = np.full(3, float((high - low).max()))
            low, high = low - room, high + room
        grid = grid_kernels.Grid()
        self.skin = 0.0 if self.model.device.is_cuda else self.config.skin * self.config.support
        grid.support = self.config.support + self.skin
        grid.reach = self.config.cells_per_support or (3 if self.model.device.is_cuda else 1)
        grid.cell = grid.support / grid.reach
        grid.inv_cell = 1.0 / grid.cell
        low, high = low - grid.support, high + grid.support
        grid.origin = wp.vec3(*low.tolist())
        grid.nx, grid.ny, grid.nz = (math.ceil(c) for c in ((high - low) / grid.cell).tolist())
        self.grid = grid
        self.cell_count = grid.nx * grid.ny * grid.nz * max(1, self.model.world_count)
        if self.cell_count > MAX_CELLS:
            raise ValueError(f"SolverSPH: {self.cell_count} grid cells; use a coarser spacing or a smaller domain")

    def _allocate(self) -> None:
        n = self.count
        self.key = wp.empty(2 * n, dtype=int)
        self.order = wp.empty(2 * n, dtype=int)
        self.cell_histogram = wp.zeros(self.cell_count + 1, dtype=int)
        self.cell_start = wp.zeros(self.cell_count + 1, dtype=int)
        self.point = wp.empty(n, dtype=wp.vec4)
        self.motion = wp.empty(n, dtype=wp.vec4)
        self.mass = wp.empty(n, dtype=float)
        self.kind = wp.empty(n, dtype=int)
        self.sorted_density = wp.empty(n, dtype=float)
        self.acceleration = wp.zeros(self.fluid_count, dtype=wp.vec3)
        self.boundary_force = wp.zeros(self.boundary_count, dtype=wp.vec3)
        self.lane_wrench = wp.zeros((self.model.body_count, LANES), dtype=wp.spatial_vector)
        self.body_wrench = wp.zeros(self.model.body_count, dtype=wp.spatial_vector)
        self.point_at_build = wp.zeros(n, dtype=wp.vec4)
        self.move2 = wp.zeros(1, dtype=float)
        self.neighbor_capacity = self._list_capacity()
        self.neighbor = wp.empty(n * self.neighbor_capacity, dtype=int)
        self.neighbor_count = wp.zeros(n, dtype=int)
        self.neighbor_overflow = wp.zeros(1, dtype=int)
        self.stride = wp.vec2i(1, n) if self.model.device.is_cuda else wp.vec2i(self.neighbor_capacity, 1)
        self.lists_stale = True
        self.key_bits = max(1, int(self.cell_count).bit_length())

    def _list_capacity(self) -> int:
        """Room for half as many neighbours again as stand around a particle at rest."""
        at_rest = 4.0 / 3.0 * math.pi * (self.grid.support / self.config.spacing) ** 3
        return int(1.5 * at_rest) + 16

    def check(self) -> None:
        """Raise RuntimeError if a neighbour list has overflowed: the fluid was compressed beyond sense."""
        most = int(self.neighbor_overflow.numpy()[0])
        if most:
            raise RuntimeError(
                f"SolverSPH: {most} neighbours where {self.neighbor_capacity} fit: the fluid has collapsed; "
                "use a smaller time step or a higher speed of sound"
            )

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
            state_in: Positions, velocities and densities of the fluid, poses and velocities of the bodies.
            state_out: Receives the fluid and the wrenches; may be `state_in`.
            control: Not used.
            contacts: Not used.
            dt: Time step [s]; no larger than `config.max_time_step`.
        """
        with wp.ScopedDevice(self.model.device):
            self._move_solids(state_in)
            self._gather(state_in)
            if self._lists_are_stale():
                self._sort(state_in)
                self._find_neighbors()
            self._update_density(state_out, dt)
            self._push()
            self._return_wrenches(state_in, state_out)
            self._advance(state_in, state_out, dt)

    def _move_solids(self, state: newton.State) -> None:
        if self.has_bodies:
            wp.launch(
                boundary_kernels.move_boundary,
                dim=self.boundary_count,
                inputs=[self.boundary_local, self.boundary_owner, state.body_q, state.body_qd, self.model.body_com],
                outputs=[self.boundary_position, self.boundary_velocity],
            )

    def _gather(self, state: newton.State) -> None:
        """Bring positions, velocities and densities into sorted order."""
        if self.lists_stale:
            return  # There is no order yet.
        wp.launch(
            grid_kernels.gather,
            dim=self.count,
            inputs=[
                self.fluid_count,
                self.order,
                state.particle_q,
                state.particle_qd,
                state.sph.density,
                self.boundary_position,
                self.boundary_velocity,
                self.config.rest_density,
            ],
            outputs=[self.point, self.motion],
        )

    def _lists_are_stale(self) -> bool:
        """Whether a particle may have come within reach unseen: two that approach each other share the skin."""
        if self.lists_stale or self.skin == 0.0:
            return True
        self.move2.zero_()
        wp.launch(
            neighbor_kernels.largest_move,
            dim=self.count,
            inputs=[self.point, self.point_at_build],
            outputs=[self.move2],
        )
        # Written as "not less" so that a NaN, which compares false, also rebuilds.
        return not float(self.move2.numpy()[0]) < (0.5 * self.skin) ** 2

    def _sort(self, state: newton.State) -> None:
        """Sort all particles by cell; the sort is stable, so that a run repeats bit for bit."""
        self.cell_histogram.zero_()
        wp.launch(
            grid_kernels.assign_cells,
            dim=self.count,
            inputs=[self.grid, self.fluid_count, state.particle_q, self.boundary_position, self.particle_world],
            outputs=[self.key, self.order, self.cell_histogram],
        )
        wp.utils.array_scan(self.cell_histogram, self.cell_start, inclusive=False)
        wp.utils.radix_sort_pairs(self.key, self.order, self.count, 0, self.key_bits)
        wp.launch(
            grid_kernels.gather_constants,
            dim=self.count,
            inputs=[
                self.fluid_count,
                self.order,
                self.model.particle_mass,
                self.boundary_volume,
                self.boundary_owner,
                self.config.rest_density,
            ],
            outputs=[self.mass, self.kind],
        )
        self.lists_stale = False
        self._gather(state)

    def _find_neighbors(self) -> None:
        launch_shared(
            neighbor_kernels.find_neighbors,
            dim=self.count,
            inputs=[
                self.grid,
                self.cell_start,
                self.order,
                self.particle_world,
                self.point,
                self.kind,
                self.neighbor_capacity,
                self.stride,
            ],
            outputs=[self.neighbor, self.neighbor_count, self.neighbor_overflow],
        )
        if self.skin > 0.0:
            wp.copy(self.point_at_build, self.point)

    def _neighborhood(self) -> list[Any]:
        return [
            self.neighbor,
            self.neighbor_count,
            self.stride,
            self.order,
            self.particle_world,
            self.model.gravity,
        ]

    def _update_density(self, state_out: newton.State, dt: float) -> None:
        c = self.config
        fluid = [c.rest_density, c.speed_of_sound]
        kernel = [c.smoothing_length, self.kernel_norm]
        records = [self.point, self.motion]
        launch_shared(
            density_kernels.continuity,
            dim=self.count,
            inputs=[
                *self._neighborhood(),
                *records,
                self.mass,
                self.kind,
                *kernel,
                *fluid,
                c.density_diffusion,
                dt,
            ],
            outputs=[self.sorted_density],
        )
        wp.launch(
            density_kernels.equation_of_state,
            dim=self.count,
            inputs=[self.kind, self.sorted_density, *fluid],
            outputs=records,
        )
        wp.launch(
            momentum_kernels.scatter_density,
            dim=self.count,
            inputs=[self.fluid_count, self.order, self.sorted_density],
            outputs=[state_out.sph.density],
        )

    def _push(self) -> None:
        c = self.config
        kernel = [c.smoothing_length, self.kernel_norm]
        launch_shared(
            boundary_kernels.extrapolate_pressure,
            dim=self.count,
            inputs=[*self._neighborhood(), self.kind, *kernel, c.rest_density, c.speed_of_sound],
            outputs=[self.point, self.motion],
        )
        launch_shared(
            momentum_kernels.momentum,
            dim=self.count,
            inputs=[
                *self._neighborhood(),
                self.point,
                self.motion,
                self.mass,
                self.kind,
                self.fluid_count,
                *kernel,
                c.speed_of_sound,
                c.artificial_viscosity,
                c.viscosity,
            ],
            outputs=[self.acceleration, self.boundary_force],
        )

    def _return_wrenches(self, state_in: newton.State, state_out: newton.State) -> None:
        if not self.has_bodies:
            return
        wp.launch(
            boundary_kernels.sum_body_lanes,
            dim=(self.model.body_count, LANES),
            inputs=[self.body_first, self.boundary_force, self.boundary_position, state_in.body_q, self.model.body_com],
            outputs=[self.lane_wrench],
        )
        wp.launch(
            boundary_kernels.add_body_wrench,
            dim=self.model.body_count,
            inputs=[self.lane_wrench],
            outputs=[self.body_wrench, state_out.body_f],
        )

    def _advance(self, state_in: newton.State, state_out: newton.State, dt: float) -> None:
        wp.launch(
            momentum_kernels.kick_drift,
            dim=self.fluid_count,
            inputs=[state_in.particle_q, state_in.particle_qd, self.acceleration, dt],
            outputs=[state_out.particle_q, state_out.particle_qd],
        )
