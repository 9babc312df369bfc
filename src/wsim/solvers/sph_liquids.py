"""The liquids of a world that has several: what each particle of an SPH fluid is of."""

from __future__ import annotations

from typing import Any

import newton
import numpy as np
import warp as wp

from wsim.kernels.sph.liquids import gather_liquids
from wsim.solvers.sph_particles import SortedParticles

Array = np.ndarray
NUMBERS = ("liquid_density", "liquid_viscosity")


def register_liquids(builder: newton.ModelBuilder) -> None:
    """Let each particle have its own `sph:liquid_density` [kg/m^3] and `sph:liquid_viscosity` [Pa s]."""
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
        world: Of each particle, (n,).
        rest_density: Of each world [kg/m^3], (W,).
        viscosity: Of each world [Pa s], (W,).

    Attributes:
        numbers: Density and viscosity of each (n,), in original order.
        density: The densities, (n,) [kg/m^3].

    Raises:
        ValueError: If a number is negative or not finite.
    """

    def __init__(self, model: Any, world: Array, rest_density: Array, viscosity: Array) -> None:
        density, own = (getattr(model.sph, name).numpy().astype(np.float32) for name in NUMBERS)
        for name, values in zip(NUMBERS, (density, own), strict=True):
            wrong = np.flatnonzero(~(np.isfinite(values) & (values >= 0.0)))
            if len(wrong):
                raise ValueError(
                    f"SolverSPH: sph:{name} of particle {wrong[0]} = {values[wrong[0]]} must be finite and >= 0"
                )
        given = density > 0.0
        density, own = np.where(given, density, rest_density[world]), np.where(given, own, viscosity[world])
        self.density: Array = density.astype(np.float32)
        self.numbers = wp.array(np.stack([density, own], axis=1).astype(np.float32), dtype=wp.vec2)

    def gather(self, fluid: SortedParticles, mass: wp.array, speed_of_sound: float) -> None:
        """Bring them into the particles' present order, whose positions and pressures are there, with the volumes."""
        wp.launch(
            gather_liquids,
            dim=fluid.count,
            inputs=[fluid.order, self.numbers, mass, speed_of_sound],
            outputs=[fluid.motion, fluid.point, fluid.liquid],
        )
