"""Weakly compressible SPH as a Newton solver, two-way coupled to rigid bodies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import newton
import numpy as np
import warp as wp
from newton.solvers import SolverBase

from wsim.kernels.sph import density as density_kernels
from wsim.kernels.sph import grid as grid_kernels
from wsim.solvers.launch import launch_shared
from wsim.solvers.shapes import OpenBox, sample_bodies
from wsim.solvers.sph_blows import Blows
from wsim.solvers.sph_bodies import BodyParticles
from wsim.solvers.sph_config import ConfigSPH
from wsim.solvers.sph_domain import domain_of
from wsim.solvers.sph_faces import FixedFaces
from wsim.solvers.sph_faults import in_words, inspected
from wsim.solvers.sph_led_faces import LedFaces
from wsim.solvers.sph_liquids import Liquids, has_liquids, register_liquids
from wsim.solvers.sph_mouths import Drain, Tap
from wsim.solvers.sph_openings import ROOM, Openings
from wsim.solvers.sph_particles import SortedParticles
from wsim.solvers.sph_push import BodyPush
from wsim.solvers.sph_search import ParticleSearch
from wsim.solvers.sph_skins import Skins
from wsim.solvers.sph_solids import FixedSolids
from wsim.solvers.sph_wall_impulse import WallImpulse
from wsim.solvers.vessel_walls import VesselWalls
from wsim.solvers.vessels import Vessel


class SolverSPH(SolverBase):
    """Weakly compressible SPH (Monaghan 1994) with density diffusion, walls and two-way coupled bodies.

    The model's particles are the fluid. Colliding shapes, fixed and moving, are filled with boundary particles that
    take the fluid's pressure and push back (Adami et al. 2012). A step adds the fluid's force and torque on every body
    to `state_out.body_f`, Newton's external wrench, and leaves it to a rigid-body solver to move the bodies:

        state.clear_forces()
        sph.step(state, state, control, None, dt)
        rigid.step(state, state, control, contacts, dt)

    Where fluid may get to solids far from its start, call `follow(state, seconds)` between steps, once in a while.

    Order of a step: density and pressure at the present positions and velocities, forces, then velocity, then position
    with the new velocity. Call `register_custom_attributes` on the builder first; the state then has `sph.pressure`.

    Args:
        model: The model to simulate; its particles are the fluid of every world.
        config: Settings of the method.
        containers: Tanks that hold the fluid.
        taps: Where water comes in; the model's particles that are not `ParticleFlags.ACTIVE` wait for it. Make states
            after the solver: it puts the first of them into the taps' pipes.
        drains: Where water leaves.
        vessels: What else holds the fluid.

    Attributes:
        openings: The taps and drains; None without any.
        body_wrench: Of the fluid on each body in the last step: force [N], torque about its centre of mass [N m].
        liquids: What each particle is of, where worlds have several liquids; else None.

    Raises:
        ValueError: If the model has no particles, the settings are out of range, a container is too narrow, too few
            particles wait for the taps, or there are vessels in a plane.
    """

    Config = ConfigSPH

    @classmethod
    def register_custom_attributes(cls, builder: newton.ModelBuilder, several_liquids: bool = False) -> None:
        """Register what the solver reads beside Newton's own particle arrays.

        `sph:pressure` [Pa] is a state variable of each particle, p = c^2 (rho - rho_0). `sph:rest_density` [kg/m^3]
        and `sph:viscosity` [Pa s] belong to a world; 0 takes the `Config`'s. With `several_liquids` each particle has
        `sph:liquid_density` and `sph:liquid_viscosity`, too; where its density is 0 it is of the world's. With
        `sph:yield_stress` [Pa] or `sph:flow_index` it yields, and the viscosity is its consistency [Pa s^n].
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
        if several_liquids:
            register_liquids(builder)

    def __init__(
        self,
        model: newton.Model,
        config: ConfigSPH,
        containers: tuple[OpenBox, ...] = (),
        taps: Sequence[Tap] = (),
        drains: Sequence[Drain] = (),
        vessels: Sequence[Vessel] = (),
    ) -> None:
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
        if vessels and config.dimensions == 2:
            raise ValueError("SolverSPH: vessels in a flow of 2 dimensions; there a cup is shapes, or a tank")
        with wp.ScopedDevice(model.device):
            self._read_worlds()
            world = self._fluid_world = np.maximum(model.particle_world.numpy(), 0)
            self._read_liquids()
            self.openings = (
                Openings(model, config, world, self.rest_density.numpy(), taps, drains) if taps or drains else None
            )
            self._sample_solids(containers, vessels, world)
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

    def _read_liquids(self) -> None:
        """What each particle is of, where a world has several liquids."""
        worlds = self.rest_density.numpy(), self.viscosity.numpy()
        self.liquids = Liquids(self.model, self.config, self._fluid_world, *worlds) if has_liquids(self.model) else None

    def at_rest(self, world: int) -> np.ndarray:
        """Density at rest [kg/m^3]: a world's, (), or where it has several liquids that of each particle, (n,)."""
        return self.liquids.density if self.liquids else np.asarray(self.rest_density.numpy()[world])

    def notify_model_changed(self, flags: newton.ModelFlags | int) -> None:
        """Read the liquids' densities and viscosities again; gravity and masses are read in every step."""
        if flags & newton.ModelFlags.MODEL_PROPERTIES:
            with wp.ScopedDevice(self.model.device):
                self._read_worlds()
                self._read_liquids()

    def _sample_solids(self, containers: tuple[OpenBox, ...], vessels: Sequence[Vessel], world: np.ndarray) -> None:
        """Fill the solids with particles: bodies, and what stands still where the fluid is or comes to."""
        model = self.model
        place, home = model.particle_q.numpy(), world
        if self.openings:
            place, home = self.openings.known(place, world)
        self.vessels = VesselWalls(model, vessels, self.config.spacing)
        self.fixed = FixedSolids(model, self.config, containers, self.vessels)
        self.fixed.start(place, home)
        self.bodies = BodyParticles(model, sample_bodies(model, self.config, self.vessels))
        self.body_wrench = self.bodies.wrench
        self.domain = domain_of(place, containers, vessels)
        if self.openings:
            self.domain = self.domain[0], self.domain[1] + ROOM * self.config.support
        plane = self.config.dimensions == 2
        self.faces = FixedFaces(model, self.world_count, containers, self.config.support, self.vessels.made_of, plane)
        self.skins = Skins(model, self.world_count, self.config.spacing, vessels)
        self.led = LedFaces(model, self.world_count, self.config.support, self.vessels.made_of)
        self.blows = Blows(model, self.config.spacing, self.skins.moving or self.led.count > 0)
        self._bring_into_order()

    def _bring_into_order(self) -> None:
        """Take the walls' particles, and search among all."""
        position, volume, world = self.fixed.particles()
        if self.openings:
            keep = self.openings.outside(position, world)
            position, volume, world = position[keep], volume[keep], world[keep]
            self.openings.park_below(self.domain[0])
        self.wall_count = len(position)
        self.boundary_count = self.wall_count + self.bodies.count
        self.count = self.fluid_count + self.boundary_count
        self.wall_position, self.wall_volume = wp.array(position, dtype=wp.vec3), wp.array(volume, dtype=float)
        self.search = ParticleSearch(
            self.config,
            self.domain,
            self._fluid_world,
            world,
            self.bodies.sampled.world,
            self.wall_position,
            self.world_count,
            self.bodies.sampled.crowd((1.0 + self.config.skin) * self.config.support),
            self.openings.stage if self.openings else None,
            self.liquids is not None,
            self.liquids is not None and self.liquids.yields,
        )
        self.programs = self.search.programs
        still = wp.zeros(self.wall_count, dtype=wp.vec3)
        self._gather_solid(self.search.walls, self.wall_position, still, self.wall_volume)
        self._on_walls = wp.zeros(self.fluid_count if self.wall_count or self.faces.count else 0, dtype=wp.vec3)

    def _allocate(self) -> None:
        self.pressure = wp.empty(self.fluid_count, dtype=float)
        self.full = wp.zeros(self.fluid_count, dtype=float)
        self.push = BodyPush(self.search, self.bodies.owner, self.vessels.bodies)
        self._wall_impulse = WallImpulse(self.search.fluid.world_first)

    def follow(self, state: newton.State, seconds: float) -> bool:
        """Lay particles of what stands still where the fluid may get within a time; call it as often, between steps.

        Args:
            state: The present state.
            seconds: Until the next call [s].

        Returns:
            Whether there was anything to lay: graphs that captured a step are of no use any more.
        """
        if not self.fixed.anywhere:
            return False
        with wp.ScopedDevice(self.model.device):
            self.search.restart()  # so that a world's sums do not go by when it, or another, was followed
            if not self.fixed.ahead(state, seconds):
                return False
            place = self.fixed.particles()[0]
            self.domain = np.minimum(self.domain[0], place.min(axis=0)), np.maximum(self.domain[1], place.max(axis=0))
            self._bring_into_order()
            self.push.look_among(self.search)
        return True

    def reset_search(self) -> None:
        """Forget the neighbour lists, and the water in gaps; for a state that did not come from the last step."""
        self.search.stale = True
        self.push.forget()
        self.full.zero_()
        self.skins.forget()
        if self.liquids:
            self.liquids.forget()

    def restart(self) -> None:
        """Begin anew, with a state from before the first step: what waits for taps waits again."""
        self.reset_search()
        self.take_wall_impulse()
        if self.openings:
            self.openings.restart()

    def take_wall_impulse(self) -> np.ndarray:
        """Impulse that each world's fluid gave to all that stands still since the last call, (W, 3) [N s]."""
        return self._wall_impulse.take()

    def check(self, state: newton.State) -> int:
        """Look for what makes the fluid's state worthless; call it once in a while, as often as once a frame.

        Args:
            state: The state after a step.

        Returns:
            How many particles have left the domain: spilled, or leaked.

        Raises:
            RuntimeError: If a value is not finite, a particle is faster than sound, or a neighbour list overflowed.
        """
        broken, speeds, outside = inspected(self.search, state)
        fault = next(filter(None, self._faults(broken, speeds)), None)
        if fault:
            raise RuntimeError(fault)
        return int(outside.sum())

    def faults(self, state: newton.State) -> list[str]:
        """What makes each world's fluid worthless, (W,) texts; empty where it is sound. The others are as they are."""
        broken, speeds, _ = inspected(self.search, state)
        return self._faults(broken, speeds)

    def _faults(self, broken: np.ndarray, speeds: np.ndarray) -> list[str]:
        found = zip(broken.tolist(), speeds.tolist(), self.search.crowd(), strict=True)
        return in_words(found, self.fluid_count, self.config.speed_of_sound, self.search.fluid.species.capacity)

    def bodies_outside(self, state: newton.State) -> list[int]:
        """Bodies whose origin is beside or below the domain, which spans the fluid's start and its tanks."""
        if not self.bodies.count:
            return []
        low, high = self.domain
        place = state.body_q.numpy()[:, :3]
        sampled = np.diff(self.bodies.sampled.first) > 0
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
            self.bodies.move(self.search.grid, state_in)
            self.search.update(state_in.particle_q, self.bodies.position, lambda: self._gather(state_in))
            self._update_pressure(state_out, dt)
            self._move_fluid(state_in, state_out, dt)
            self.bodies.push(self.search.grid, self.push.force, state_in.body_q, state_out.body_f)
            self.blows.give_back(dt, self.body_wrench, state_out.body_f)

    def _gather(self, state: newton.State) -> None:
        """Copy what the sums need into sorted order; walls stay as they are."""
        fluid = self.search.fluid
        wp.launch(
            grid_kernels.gather_fluid,
            dim=fluid.count,
            inputs=[
                fluid.order,
                state.particle_q,
                state.particle_qd,
                state.sph.pressure,
                self.model.particle_mass,
                fluid.world,
                self.rest_density,
                self.full,
                self.config.speed_of_sound,
            ],
            outputs=[fluid.point, fluid.motion, fluid.full],
        )
        if self.liquids:
            self.liquids.gather(fluid, self.model.particle_mass, self.config.speed_of_sound)
        self._gather_solid(self.search.bodies, self.bodies.position, self.bodies.velocity, self.bodies.volume)
        self.push.gather()
        if self.liquids and self.liquids.yields:
            wp.copy(fluid.creep, fluid.motion)
            wp.copy(self.search.bodies.creep, self.search.bodies.motion)

    def _gather_solid(self, solid: SortedParticles, *arrays: wp.array) -> None:
        if solid.count:
            wp.launch(
                grid_kernels.gather_solid,
                dim=solid.count,
                inputs=[solid.order, *arrays],
                outputs=[solid.point, solid.motion],
            )

    def _update_pressure(self, state_out: newton.State, dt: float) -> None:
        """Continuity with the walls' share, and the equation of state; then the solids take over the pressure."""
        search, gravity = self.search, self.model.gravity
        fluid, walls, bodies = (kind.species for kind in (search.fluid, search.walls, search.bodies))
        method = [search.grid, self.method, self.rest_density]
        if self.wall_count:
            launch_shared(
                self.programs.compress,
                dim=self.wall_count,
                inputs=[*method, gravity, fluid, walls],
                outputs=[search.walls.motion],
            )
            if self.openings:
                self.openings.press_walls(self.method, search.walls, dt)
        launch_shared(
            self.programs.continuity,
            dim=self.fluid_count,
            inputs=[*method, gravity, fluid, walls, bodies, dt],
            outputs=[self.pressure, self.full],
        )
        if self.openings and self.openings.pipes:
            launch_shared(
                self.programs.fill,
                dim=self.fluid_count,
                inputs=[*method, gravity, fluid],
                outputs=[self.pressure, self.full],
            )
        wp.launch(
            density_kernels.set_pressure,
            dim=self.fluid_count,
            inputs=[search.fluid.order, self.pressure],
            outputs=[search.fluid.motion, state_out.sph.pressure],
        )
        for solid in search.solid:
            launch_shared(
                self.programs.extrapolate,
                dim=solid.count,
                inputs=[*method, self.viscosity, gravity, fluid, solid.species],
                outputs=[solid.motion, solid.facing, solid.liquid],
            )

    def _move_fluid(self, state_in: newton.State, state_out: newton.State, dt: float) -> None:
        """Momentum: the fluid moves, and its push on the bodies is kept."""
        search = self.search
        fluid, walls, bodies = (kind.species for kind in (search.fluid, search.walls, search.bodies))
        method = [search.grid, self.method, self.rest_density, self.viscosity]
        if self.liquids and self.liquids.yields:
            self.liquids.shear(search, self.method)
            self.liquids.creep(search, self.method, self.model, dt)
        self.push.sum(self.method, self.rest_density, self.viscosity, self.model.gravity)
        launch_shared(
            self.programs.momentum,
            dim=self.fluid_count,
            inputs=[*method, self.model.gravity, fluid, walls, bodies, self.model.particle_mass, dt],
            outputs=[state_out.particle_q, state_out.particle_qd, self._on_walls],
        )
        worlds = search.fluid.world
        if self.openings:
            self.openings.take_in(worlds, state_out.particle_q)
        if len(self._on_walls) and self.faces.count:
            self.faces.keep_out(worlds, dt, state_out.particle_q, state_out.particle_qd, self._on_walls)
        if self.skins.count:
            self.skins.keep_out(search.fluid, dt, state_out, state_in, self._on_walls, self.blows)
        if self.led.count and self.config.dimensions == 3:
            self.led.keep_out(search.fluid, dt, state_out, state_in, self.blows)
        if self.openings:
            self.openings.lead(self.method, search.fluid, state_out, self._on_walls, dt)
        if len(self._on_walls):
            self._wall_impulse.add(self._on_walls, dt)
            if len(self.push.on_walls):
                self._wall_impulse.add(self.push.on_walls, dt, self.push.world_first)
