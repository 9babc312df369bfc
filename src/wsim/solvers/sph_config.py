"""Settings of `SolverSPH`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

STAGES = 15  # of a step of what yields: as many in every world, so that one goes alone as in a batch
STIFF = 50.0  # times nu / h^2: the fastest rate of the viscosity, of its sums over pairs with walls beside
OVER_CONSISTENCY = 100.0  # times that what has not yielded is to be as viscous as what flows, at least

Period = tuple[float, float] | None


@dataclass
class ConfigSPH:
    """Settings of `SolverSPH`."""

    spacing: float = 0.02
    """Distance between particles at rest [m]."""
    smoothing_ratio: float = 0.0
    """Smoothing length over spacing; the kernel's support is twice the smoothing length. 0 takes 1.3 in space (80
    neighbours) and 2 in a plane (44), where 1.3 leaves 20 neighbours and gravity waves 4 % too quick."""
    rest_density: float = 1000.0
    """Density at zero pressure [kg/m^3]; a world's own `sph:rest_density` comes first."""
    speed_of_sound: float = 0.0
    """Numerical speed of sound [m/s]; ten times the largest expected speed keeps the density within 1 %."""
    viscosity: float = 1.0e-3
    """Dynamic viscosity [Pa s]; a world's own `sph:viscosity` comes first."""
    largest_viscosity: float = 0.0
    """Viscosity at rest of liquids that yield or thin, in place of an infinite one [Pa s]; 0 takes what 15 stages of an
    acoustic step hold, or 100 times the consistency where that is more. See `yielding_time_step`."""
    artificial_viscosity: float = 0.01
    """Monaghan's alpha, between particles that approach each other. Walls and bodies take part: where they do not, a
    still tank excites itself at its walls."""
    density_diffusion: float = 0.1
    """delta of the density diffusion term."""
    background_pressure: float = 0.0
    """Pressure added everywhere [Pa]. Where the fluid fills its domain it keeps particles from clumping under tension;
    with a free surface it must be 0."""
    dimensions: int = 3
    """3, or 2: a flow in the x-z plane. In two dimensions particles stand at y = 0, and masses and forces are those
    of one metre of depth."""
    periodic: tuple[Period, Period, Period] = (None, None, None)
    """Lower and upper end [m] of each periodic axis, None where the domain is open."""
    cfl: float = 0.5
    """Courant number: dt <= cfl * smoothing length / speed of sound. A dam break is stable up to 1.25."""
    cells_per_support: int = 0
    """Grid cells that the search radius spans along y and z (along x four times as many); 0 takes 2 on a GPU, where
    finer cells trim the search closer to the sphere, and 1 on a CPU, where looking up the rows costs more than that
    saves."""
    skin: float = 0.1
    """How much further than the support the neighbour lists reach, as a share of it. Lists are a CPU's: they are kept
    until a particle has moved half the skin. A GPU walks the cells anew in each sum."""

    def __post_init__(self) -> None:
        """Choose what was left open, and reject settings that cannot work."""
        if self.smoothing_ratio == 0.0:
            self.smoothing_ratio = 1.3 if self.dimensions == 3 else 2.0
        for name in ("spacing", "smoothing_ratio", "rest_density", "speed_of_sound", "cfl"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise ValueError(f"SolverSPH.Config: {name} = {value} must be > 0")
        for name in (
            "viscosity",
            "largest_viscosity",
            "artificial_viscosity",
            "density_diffusion",
            "background_pressure",
            "skin",
        ):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                raise ValueError(f"SolverSPH.Config: {name} = {value} must be >= 0")
        if self.dimensions not in (2, 3):
            raise ValueError(f"SolverSPH.Config: dimensions = {self.dimensions} must be 2 or 3")
        if not 0 <= self.cells_per_support <= 8:
            raise ValueError(f"SolverSPH.Config: cells_per_support = {self.cells_per_support} must be in 0..8")
        for axis, ends in zip("xyz", self.periodic, strict=True):
            if ends is not None and not ends[1] - ends[0] > 3.0 * (1.0 + self.skin) * self.support:
                raise ValueError(
                    f"SolverSPH.Config: periodic {axis} = {ends} is {ends[1] - ends[0]} m long; it must span more than "
                    f"three search radii, {3.0 * (1.0 + self.skin) * self.support:.4g} m"
                )
        if self.dimensions == 2 and self.periodic[1] is not None:
            raise ValueError("SolverSPH.Config: periodic y has no meaning in a flow in the x-z plane")

    @property
    def smoothing_length(self) -> float:
        """Smoothing length h [m]."""
        return self.smoothing_ratio * self.spacing

    @property
    def support(self) -> float:
        """Radius of the kernel's support, 2h [m]."""
        return 2.0 * self.smoothing_length

    @property
    def kernel_norm(self) -> float:
        """Factor that makes Wendland's C2 kernel integrate to one [1/m^3], or [1/m^2] in a plane."""
        h = self.smoothing_length
        return 21.0 / (16.0 * math.pi * h**3) if self.dimensions == 3 else 7.0 / (4.0 * math.pi * h**2)

    @property
    def laminar_factor(self) -> float:
        """K of the laminar viscosity: 2 (d + 2) over what the sum gives of a sheared layer's exact viscosity.

        The sum is not its integral: it misses what a few neighbours miss, the same at every spacing. On layers dp
        apart that slide over each other, with any offset as likely as another, it gives 0.87 of the exact value at
        h/dp = 1.3 in a plane and 0.97 at 2. The Laplacian of Morris et al. (1997) needs no such factor, but pushes
        across x_ij and so makes angular momentum.
        """
        d, s = self.dimensions, self.support / self.spacing
        along = (np.arange(400) + 0.5) / 400 * s  # [spacings], from the axis out
        share = 0.0
        for z in range(1, math.ceil(s)):
            r = np.sqrt(along**2 + z * z)
            slope = (
                5.0 * self.kernel_norm * self.spacing**d / self.smoothing_ratio**2 * np.maximum(1.0 - r / s, 0.0) ** 3
            )
            # Two layers at +z and -z; the mean of x^2 around the axis is r^2 / 2 in space.
            measure = 2.0 if d == 2 else 2.0 * np.pi * along * 0.5
            of_pair = 0.5 * z**2 * along**2 / (r**2 + 1.0e-4 * self.smoothing_ratio**2)
            share += float(2.0 * (of_pair * slope * measure).sum() * s / 400)
        return 1.0 / share

    def largest_viscosity_of(self, density: Any, consistency: Any) -> Any:
        """Viscosity at rest of liquids that yield [Pa s], of densities [kg/m^3] and consistencies [Pa s^n]."""
        if self.largest_viscosity > 0.0:
            return np.full_like(density, self.largest_viscosity)
        held = density * (STAGES**2 + STAGES) / STIFF * self.smoothing_length * self.speed_of_sound / self.cfl
        return np.maximum(held, OVER_CONSISTENCY * consistency)

    def yielding_time_step(self, kinematic: float) -> float:
        """Largest step of a liquid that yields [s], of a kinematic viscosity at rest [m^2/s]."""
        h = self.smoothing_length
        staged = (STAGES**2 + STAGES) / STIFF * h * h / kinematic
        return min(self.cfl * h / self.speed_of_sound, staged)

    @property
    def max_time_step(self) -> float:
        """Largest stable step [s]: of the acoustic Courant condition and of viscous diffusion (Morris et al. 1997).

        The rates add up: at the edge of both, a channel that keeps to either alone blows up.
        """
        h = self.smoothing_length
        acoustic = self.cfl * h / self.speed_of_sound
        viscous = 0.125 * h * h * self.rest_density / max(self.viscosity, 1e-30)
        return 1.0 / (1.0 / acoustic + 1.0 / viscous)
