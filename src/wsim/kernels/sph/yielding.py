"""Liquids that yield, thin or thicken: Herschel and Bulkley's law, and the rate of shear that it takes."""

import warp as wp

from wsim.kernels.sph.density import Method, dimensions
from wsim.kernels.sph.grid import Grid
from wsim.kernels.sph.momentum import viscosities
from wsim.kernels.sph.pair_sums import PairSums
from wsim.kernels.sph.records import load_record
from wsim.kernels.sph.species import BODIES, FLUID, WALLS, Species, is_near

TINY = wp.constant(1.0e-12)


@wp.func
def apparent_viscosity(law: wp.vec4, rate: float) -> float:
    """Stress over rate of shear of a liquid [Pa s]: K rate^(n - 1) + tau_y (1 - exp(-m rate)) / rate.

    `law` is (K, tau_y, n, largest): consistency [Pa s^n], yield stress [Pa], index, and the viscosity at rest [Pa s],
    in place of an infinite one: m = largest / tau_y (Papanastasiou 1987).
    """
    shear = wp.max(rate, TINY)
    viscosity = law[0] * wp.pow(shear, law[2] - 1.0)
    if law[1] > 0.0:
        # For small rates m itself: the difference would be lost to rounding.
        x = law[3] / law[1] * shear
        viscosity += wp.where(x < 1.0e-3, law[3] * (1.0 - 0.5 * x), law[1] / shear * (1.0 - wp.exp(-x)))
    return wp.min(viscosity, law[3])


def make_yield(sums: PairSums, solids: tuple[int, ...]) -> wp.Kernel:
    """The kernel that finds how fast a liquid is sheared, and how viscous it is then, given the kinds of solids."""
    of_fluid, of_walls, of_bodies = sums.shear[FLUID], sums.shear[WALLS], sums.shear[BODIES]

    @wp.kernel(**sums.options)
    def yields(
        # Data in:
        first: int,
        grid: Grid,
        method: Method,
        law: wp.array(dtype=wp.vec4),
        fluid: Species,
        walls: Species,
        bodies: Species,
        # Data in and out:
        numbers: wp.array(dtype=wp.vec2),
        # Data out:
        liquid: wp.array(dtype=wp.vec2),
    ):
        """Viscosity of each particle at its rate of shear, in original order and, in `liquid`, in sorted order.

        rate^2 = K / 2 sum V_j (v_ij.x_ij)^2 / r^2 |dW/dr| / r, times d / sum V_j r |dW/dr| where neighbours are
        missing: the rate whose dissipation, mu rate^2, is that of the momentum equation's pairs, with the same K
        (Violeau & Issa 2007). What turns as a whole has none. Solids have the velocities that they have for no slip.
        """
        s = first + wp.tid()
        i = fluid.order[s]
        p = load_record(fluid.point, s)
        m = load_record(fluid.motion, s)
        x = wp.vec3(p[0], p[1], p[2])
        v = wp.vec3(m[0], m[1], m[2])
        world = fluid.world[i]
        viscous = viscosities(method, 0.0, 1.0)
        total = of_fluid(grid, fluid, fluid, s, world, method.shape, x, v, 0.0, viscous)
        if wp.static(WALLS in solids):
            if is_near(grid, walls, world, x):
                total += of_walls(grid, fluid, walls, s, world, method.shape, x, v, 0.0, viscous)
        if wp.static(BODIES in solids):
            if is_near(grid, bodies, world, x):
                total += of_bodies(grid, fluid, bodies, s, world, method.shape, x, v, 0.0, viscous)
        rate = wp.sqrt(0.5 * viscous[1] * total[0] * dimensions(grid) / wp.max(total[1], TINY))
        now = wp.vec2(numbers[i][0], apparent_viscosity(law[i], rate))
        numbers[i] = now
        liquid[s] = now

    return yields
