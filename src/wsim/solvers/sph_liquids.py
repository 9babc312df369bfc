"""The liquids of a world that has several, or one that yields: what each particle of an SPH fluid is of."""

from __future__ import annotations

from typing import Any

import newton
import numpy as np
import warp as wp

from wsim.kernels.sph.liquids import gather_liquids
from wsim.kernels.sph.species import Species
from wsim.solvers.launch import launch_shared
from wsim.solvers.sph_config import STAGES, ConfigSPH
from wsim.solvers.sph_particles import SortedParticles
from wsim.solvers.sph_search import ParticleSearch

Array = np.ndarray
NUMBERS = ("liquid_density", "liquid_viscosity", "yield_stress", "flow_index")


def register_liquids(builder: newton.ModelBuilder) -> None:
    """Let each particle have its own liquid: `sph:liquid_density` [kg/m^3], `sph:liquid_viscosity` [Pa s],
    `sph:yield_stress` [Pa] and `sph:flow_index`, 0 for 1."""
    of, model = newton.Model.AttributeFrequency.PARTICLE, newton.Model.AttributeAssignment.MODEL
    for name in NUMBERS:
        builder.add_custom_attribute(
            newton.ModelBuilder.CustomAttribute(
                name=name, frequency=of, assignment=model, dtype=wp.float32, default=0.0, namespace="sph"
            )
        )


def has_liquids(model: Any) -> bool:
    """Whether a model's particles have their own liquids."""
    own = getattr(model, "sph", None)
    return all(getattr(own, name, None) is not None for name in NUMBERS)


class Liquids:
    """Rest density and viscosity of each particle.

    Args:
        model: With what `register_liquids` has put there; a density of 0 takes the world's density and viscosity.
        config: For the largest viscosity of what yields.
        world: Of each particle, (n,).
        rest_density: Of each world [kg/m^3], (W,).
        viscosity: Of each world [Pa s], (W,).

    Attributes:
        numbers: Density and viscosity of each (n,), in original order; the viscosity of what yields is the last step's.
        density: The densities, (n,) [kg/m^3].
        yields: Whether any is not Newtonian.

    Raises:
        ValueError: If a number is negative or not finite.
    """

    def __init__(self, model: Any, config: ConfigSPH, world: Array, rest_density: Array, viscosity: Array) -> None:
        density, own, stress, index = (getattr(model.sph, name).numpy().astype(np.float32) for name in NUMBERS)
        for name, values in zip(NUMBERS, (density, own, stress, index), strict=True):
            wrong = np.flatnonzero(~(np.isfinite(values) & (values >= 0.0)))
            if len(wrong):
                raise ValueError(
                    f"SolverSPH: sph:{name} of particle {wrong[0]} = {values[wrong[0]]} must be finite and >= 0"
                )
        given = density > 0.0
        density, own = np.where(given, density, rest_density[world]), np.where(given, own, viscosity[world])
        index = np.where(index > 0.0, index, 1.0)
        plain = (stress == 0.0) & (index == 1.0)
        self.yields, self.density = not plain.all(), density.astype(np.float32)
        largest = np.where(plain, own, config.largest_viscosity_of(density, own))
        at_rest = np.where(plain, own, largest)
        self.law = wp.array(np.stack([own, stress, index, largest], axis=1).astype(np.float32), dtype=wp.vec4)
        self.numbers = wp.array(np.stack([density, at_rest], axis=1).astype(np.float32), dtype=wp.vec2)
        self._start = wp.clone(self.numbers)
        buffers = len(density) if self.yields else 0
        self._others = wp.zeros(buffers, dtype=wp.vec4)
        self._y, self._z = ([wp.zeros(buffers, dtype=wp.vec4) for _ in range(3)] for _ in range(2))

    def forget(self) -> None:
        """Be as viscous as at rest."""
        wp.copy(self.numbers, self._start)

    def gather(self, fluid: SortedParticles, mass: wp.array, speed_of_sound: float) -> None:
        """Bring them into the particles' present order, whose positions and pressures are there, with the volumes."""
        wp.launch(
            gather_liquids,
            dim=fluid.count,
            inputs=[fluid.order, self.numbers, mass, speed_of_sound],
            outputs=[fluid.motion, fluid.point, fluid.liquid],
        )

    def shear(self, search: ParticleSearch, method: Any) -> None:
        """Find the viscosity of each particle at the rate that it is sheared with, between solids as they move."""
        fluid, walls, bodies = (kind.species for kind in (search.fluid, search.walls, search.bodies))
        launch_shared(
            search.programs.yields,
            dim=search.fluid.count,
            inputs=[search.grid, method, self.law, fluid, walls, bodies],
            outputs=[self.numbers, search.fluid.liquid],
        )

    def creep(self, search: ParticleSearch, method: Any, model: Any, dt: float) -> None:
        """Find the velocities that the laminar viscosity of this step takes, in stages (`wsim.kernels.sph.yielding`).

        Args:
            search: Of the particles; `fluid.creep` has their velocities, and gets those.
            method: Settings, as kernels take them.
            model: For gravity and masses.
            dt: Length of the step [s].
        """
        walls, bodies, count = search.walls.species, search.bodies.species, search.fluid.count
        accelerate, stage = search.programs.stages
        shared = [search.grid, method]
        launch_shared(
            accelerate,
            dim=count,
            inputs=[*shared, model.gravity, model.particle_mass, search.fluid.species, walls, bodies],
            outputs=[self._others],
        )
        y, z = self._y, self._z
        wp.copy(y[0], search.fluid.creep)
        z[0].zero_()
        for j in range(1, STAGES + 1):
            last, before, now = (j - 1) % 3, (j - 2) % 3, j % 3
            weights = wp.vec3((2.0 * j - 1.0) / j, (1.0 - j) / j, 2.0 * (2.0 * j - 1.0) / j / (STAGES**2 + STAGES))
            fluid = _with_creep(search.fluid, y[last])
            launch_shared(
                stage,
                dim=count,
                inputs=[
                    *(*shared, model.particle_mass, self._others, fluid, walls, bodies),
                    *(y[before], z[last], z[before], weights, dt),
                ],
                outputs=[y[now], z[now]],
            )
        wp.copy(search.fluid.creep, z[STAGES % 3])


def _with_creep(particles: SortedParticles, creep: wp.array) -> Any:
    """The species with other velocities for the laminar viscosity."""
    found: Any = Species()
    found.assign(particles.species)
    found.creep = creep
    return found
