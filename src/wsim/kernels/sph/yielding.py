"""Liquids that yield, thin or thicken: Herschel and Bulkley's law, and steps that hold what is so viscous.

What has not yielded is so viscous that forward Euler would need a hundredth of the acoustic step. So the laminar
viscosity takes its velocities from s stages within a step, Legendre polynomials of Runge and Kutta that are stable to
(s^2 + s) / 2 times as long a one (RKL1; Meyer, Balsara & Aslam 2014):

    Y_j = mu_j Y_(j-1) + nu_j Y_(j-2) + w_j dt (f + L Y_(j-1)),   mu_j = (2 j - 1) / j,  nu_j = (1 - j) / j,
    w_j = 2 mu_j / (s^2 + s),   Y_0 = v

f being all other forces over mass, L the viscosity. As L is linear, Y_s = v + dt (f + L Z) with Z_j of the same
recursion, Z_j = mu_j Z_(j-1) + nu_j Z_(j-2) + w_j Y_(j-1): the momentum equation takes Z for its laminar viscosity,
and so keeps momentum pair by pair, bodies and walls with it. Where all forces are balanced they are so in Y too.
"""

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
    of_fluid, of_walls, of_bodies = (sums.shear[kind] for kind in (FLUID, WALLS, BODIES))

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
        (Violeau & Issa 2007). What turns as a whole has none. Solids are mirrored for no slip.
        """
        s = first + wp.tid()
        i = fluid.order[s]
        p = load_record(fluid.point, s)
        m = load_record(fluid.creep, s)
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


def make_stages(sums: PairSums, solids: tuple[int, ...]) -> tuple[wp.Kernel, wp.Kernel]:
    """The kernels that find f, and that make a stage of the next, given the kinds of solids."""
    of_fluid, of_walls, of_bodies = sums.force[FLUID], sums.force_at_walls, sums.force[BODIES]
    creep_in_fluid, creep_at_walls, creep_at_bodies = (sums.creep[kind] for kind in (FLUID, WALLS, BODIES))

    @wp.kernel(**sums.options)
    def accelerate(
        # Data in:
        first: int,
        grid: Grid,
        method: Method,
        gravity: wp.array(dtype=wp.vec3),
        mass: wp.array(dtype=float),
        fluid: Species,
        walls: Species,
        bodies: Species,
        # Data out:
        others: wp.array(dtype=wp.vec4),
    ):
        """Acceleration of each particle by all but the laminar viscosity, in sorted order."""
        s = first + wp.tid()
        i = fluid.order[s]
        p = load_record(fluid.point, s)
        m = load_record(fluid.motion, s)
        x, v = wp.vec3(p[0], p[1], p[2]), wp.vec3(m[0], m[1], m[2])
        world = fluid.world[i]
        viscous, own = viscosities(method, 1.0, 0.0), m[3] + 2.0 * method.background_pressure
        total = of_fluid(grid, fluid, fluid, s, world, method.shape, x, v, own, viscous)
        if wp.static(WALLS in solids):
            if is_near(grid, walls, world, x):
                at_walls = of_walls(grid, fluid, walls, s, world, method.shape, x, v, own, viscous)
                total += wp.vec3(at_walls[0], at_walls[1], at_walls[2])
        if wp.static(BODIES in solids):
            if is_near(grid, bodies, world, x):
                total += of_bodies(grid, fluid, bodies, s, world, method.shape, x, v, own, viscous)
        f = p[3] / mass[i] * total + gravity[world]
        others[s] = wp.vec4(f[0], f[1], f[2], 0.0)

    @wp.kernel(**sums.options)
    def stage(
        # Data in:
        first: int,
        grid: Grid,
        method: Method,
        mass: wp.array(dtype=float),
        others: wp.array(dtype=wp.vec4),
        fluid: Species,  # with Y_(j-1) as `creep`
        walls: Species,
        bodies: Species,
        y_before: wp.array(dtype=wp.vec4),  # Y_(j-2)
        z_last: wp.array(dtype=wp.vec4),
        z_before: wp.array(dtype=wp.vec4),
        weights: wp.vec3,  # mu_j, nu_j, w_j
        dt: float,
        # Data out:
        y: wp.array(dtype=wp.vec4),
        z: wp.array(dtype=wp.vec4),
    ):
        """Y_j and Z_j, in sorted order."""
        s = first + wp.tid()
        i = fluid.order[s]
        p = load_record(fluid.point, s)
        last = load_record(fluid.creep, s)
        x, u = wp.vec3(p[0], p[1], p[2]), wp.vec3(last[0], last[1], last[2])
        world = fluid.world[i]
        viscous = viscosities(method, 0.0, 1.0)
        total = creep_in_fluid(grid, fluid, fluid, s, world, method.shape, x, u, 0.0, viscous)
        if wp.static(WALLS in solids):
            if is_near(grid, walls, world, x):
                total += creep_at_walls(grid, fluid, walls, s, world, method.shape, x, u, 0.0, viscous)
        if wp.static(BODIES in solids):
            if is_near(grid, bodies, world, x):
                total += creep_at_bodies(grid, fluid, bodies, s, world, method.shape, x, u, 0.0, viscous)
        f = p[3] / mass[i] * total
        rate = others[s] + wp.vec4(f[0], f[1], f[2], 0.0)
        y[s] = weights[0] * last + weights[1] * y_before[s] + weights[2] * dt * rate
        z[s] = weights[0] * z_last[s] + weights[1] * z_before[s] + weights[2] * last

    return accelerate, stage
