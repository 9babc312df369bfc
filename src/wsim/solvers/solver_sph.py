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
from wsim.kernels.sph.status import inspect
from wsim.solvers.launch import launch_shared
from wsim.solvers.shapes import OpenBox, sample_boundary
from wsim.solvers.sph_config import ConfigSPH
from wsim.solvers.sph_domain import domain_of
from wsim.solvers.sph_search import ParticleSearch

LEAST_LANES = 32


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
        light = np.flatnonzero(~(model.particle_mass.numpy() > 0.0))
        if len(light):
            raise ValueError(
                f"SolverSPH: particle {light[0]} has mass {model.particle_mass.numpy()[light[0]]}; it must be > 0"
            )
        self.config = config
        self.fluid_count = model.particle_count
        self.world_count = max(1, model.world_count)
        with wp.ScopedDevice(model.device):
            self._read_worlds()
            self._sample_solids(containers)
            self.domain = domain_of(model.particle_q.numpy(), containers)
            self.search = ParticleSearch(
                config, self.domain, self.particle_world, self.fluid_count, self.world_count, self.has_bodies
            )
            self.programs = self.search.programs
            self._allocate()
            self.method = self._method()

    def _method(self) -> density_kernels.Method:
        c = self.config
        method = density_kernels.Method()
        h = c.smoothing_length
        method.h, method.shape = h, wp.vec3(1.0 / c.support, -5.0 * c.kernel_norm / h**2, c.support**2)
        method.speed_of_sound, method.diffusion = c.speed_of_sound, c.density_diffusion
        method.artificial_viscosity, method.laminar_factor = c.artificial_viscosity, c.laminar_factor
        method.background_pressure = c.background_pressure
        return method

    def _read_worlds(self) -> None:
        """Rest density and viscosity of each world."""
        own = getattr(self.model, "sph", None)
        for name in ("rest_density", "viscosity"):
            values = np.full(self.world_count, getattr(self.config, name), dtype=np.float32)
            given = getattr(own, name, None)
            if given is not None:
                given = given.numpy()
                if len(given) not in (1, self.world_count):
                    raise ValueError(f"SolverSPH: {len(given)} values of sph:{name} for {self.world_count} worlds")
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

    def _allocate(self) -> None:
        n = self.count
        self.point = wp.empty(n, dtype=wp.vec4)
        self.motion = wp.empty(n, dtype=wp.vec4)
        self.pressure = wp.empty(n, dtype=float)
        self.boundary_force = wp.zeros(max(1, self.boundary_count - self.fixed_count), dtype=wp.vec3)
        # As many lanes as each has particles of the largest body to add up, and add_body_wrench lanes.
        largest = int(np.diff(self.body_first.numpy()).max(initial=0))
        self.lanes = max(LEAST_LANES, math.isqrt(largest))
        self.lane_wrench = wp.zeros((self.model.body_count, self.lanes), dtype=wp.spatial_vector)
        self.body_wrench = wp.zeros(self.model.body_count, dtype=wp.spatial_vector)

    def reset_search(self) -> None:
        """Forget the neighbour lists; for a state that did not come from the last step."""
        self.search.stale = True

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
                inputs=[self.search.grid, state.particle_q, state.particle_qd, state.sph.pressure],
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
        self.search.check()
        return int(outside.numpy()[0])

    def bodies_outside(self, state: newton.State) -> list[int]:
        """Bodies whose origin is beside or below the domain, which spans the fluid's start and its tanks."""
        if not self.has_bodies:
            return []
        low, high = self.domain
        place = state.body_q.numpy()[:, :3]
        sampled = np.diff(self.body_first.numpy()) > 0
        beside = ((place < low) | (place > high))[:, :2].any(axis=1)
        return np.flatnonzero(sampled & (beside | (place[:, 2] < low[2]))).tolist()

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
            self.search.update(state_in, self.boundary_position, self.point, lambda: self._gather(state_in))
            self._update_pressure(state_out, dt)
            self._move_fluid(state_out, dt)
            self._return_wrenches(state_in, state_out)

    def _move_solids(self, state: newton.State) -> None:
        if self.has_bodies:
            wp.launch(
                boundary_kernels.move_boundary,
                dim=self.boundary_count,
                inputs=[
                    self.search.grid,
                    self.boundary_local,
                    self.boundary_owner,
                    state.body_q,
                    state.body_qd,
                    self.model.body_com,
                ],
                outputs=[self.boundary_position, self.boundary_velocity],
            )

    def _gather(self, state: newton.State) -> None:
        """Copy what the sums need into sorted order."""
        wp.launch(
            grid_kernels.gather,
            dim=self.count,
            inputs=[
                self.fluid_count,
                self.search.order,
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
            outputs=[self.point, self.motion, self.search.fluid_before],
        )

    def _update_pressure(self, state_out: newton.State, dt: float) -> None:
        """Continuity with the walls' share, and the equation of state; then the walls take over the pressure."""
        fluid = [self.search.neighborhood, self.method, self.rest_density]
        walls, gravity = self.search.boundary_slot, self.model.gravity
        if self.boundary_count:
            launch_shared(
                self.programs.compress,
                dim=len(walls),
                inputs=[walls, *fluid, gravity, self.point, self.fixed_count],
                outputs=[self.motion],
            )
        launch_shared(
            self.programs.continuity,
            dim=self.count,
            inputs=[*fluid, gravity, self.point, self.motion, dt],
            outputs=[self.pressure],
        )
        wp.launch(
            density_kernels.set_pressure,
            dim=self.count,
            inputs=[self.fluid_count, self.search.order, self.pressure],
            outputs=[self.motion, state_out.sph.pressure],
        )
        if self.boundary_count:
            launch_shared(
                self.programs.extrapolate,
                dim=len(walls),
                inputs=[walls, *fluid, self.viscosity, gravity, self.point],
                outputs=[self.motion],
            )

    def _move_fluid(self, state_out: newton.State, dt: float) -> None:
        """Momentum: the fluid moves, and its push on the bodies is kept."""
        launch_shared(
            self.programs.momentum,
            dim=self.count,
            inputs=[
                self.search.neighborhood,
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
            dim=(self.model.body_count, self.lanes),
            inputs=[
                self.search.grid,
                self.body_first,
                self.boundary_force,
                self.boundary_local,
                state_in.body_q,
                self.model.body_com,
            ],
            outputs=[self.lane_wrench],
        )
        wp.launch(
            boundary_kernels.add_body_wrench,
            dim=self.model.body_count,
            inputs=[self.lane_wrench],
            outputs=[self.body_wrench, state_out.body_f],
        )
