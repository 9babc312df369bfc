"""Momentum equation, and the step of velocity and position."""

import warp as wp

from wsim.kernels.sph.density import Method
from wsim.kernels.sph.grid import Grid, wrap
from wsim.kernels.sph.pair_sums import AtWalls, PairSums
from wsim.kernels.sph.records import load_record
from wsim.kernels.sph.species import BODIES, FLUID, WALLS, Species, is_near

# Of h^2: keeps two particles at one place from dividing by zero. Monaghan's 0.01 would weaken viscosity by 1.5 %.
COINCIDENT = wp.constant(1.0e-4)
# Sum of V W over a wall, seen from its flat face: half of the kernel. In an edge of a tank it is reached 0.34 spacings
# off both faces, in a corner 0.52 off all three: they are a little round.
ON_FACE = wp.constant(0.5)


@wp.func
def viscosities(method: Method, rest_density: float, viscosity: float) -> wp.vec3:
    """Artificial and laminar factor of a pair's approach, and what is added to r^2."""
    artificial = method.artificial_viscosity * method.h * method.speed_of_sound * rest_density
    return wp.vec3(artificial, method.laminar_factor * viscosity, COINCIDENT * method.h * method.h)


@wp.func
def _stop_at_face(at_walls: AtWalls, v: wp.vec3) -> wp.vec3:
    """What a wall adds to the velocity of a particle that has come to its face, so that it goes no further.

    Pressure alone does not keep a particle out. It rises with sum V W, and of a particle that leaves the water the part
    over the fluid falls as that over the wall rises: one that a landing block pressed out went from 0.27 + 0.49 to
    0.04 + 0.81. The little that it gains is lost to its neighbours by the density diffusion, so that others creep into
    the edges of a tank at a hundredth of c; and stretched ones are drawn in. But no water passes a wall: v.n >= 0 on
    its face. The blow is inelastic.
    """
    stop = wp.vec3(0.0, 0.0, 0.0)
    if at_walls[3] > ON_FACE:
        out = wp.normalize(wp.vec3(at_walls[4], at_walls[5], at_walls[6]))
        stop = -wp.min(wp.dot(v, out), 0.0) * out
    return stop


def make_momentum(sums: PairSums, solids: tuple[int, ...]) -> wp.Kernel:
    """The kernel that sums forces and moves the fluid, given the kinds of solids."""
    of_fluid, of_walls, of_bodies = sums.force[FLUID], sums.force_at_walls, sums.force[BODIES]
    creep_in_fluid, creep_at_walls, creep_at_bodies = (sums.creep[kind] for kind in (FLUID, WALLS, BODIES))

    @wp.kernel(**sums.options)
    def momentum(
        # Data in:
        first: int,
        grid: Grid,
        method: Method,
        rest_density: wp.array(dtype=float),
        viscosity: wp.array(dtype=float),
        gravity: wp.array(dtype=wp.vec3),
        fluid: Species,
        walls: Species,
        bodies: Species,
        mass: wp.array(dtype=float),
        dt: float,
        # Data out:
        position: wp.array(dtype=wp.vec3),
        velocity: wp.array(dtype=wp.vec3),
        on_walls: wp.array(dtype=wp.vec3),
    ):
        """Move each fluid particle, and keep its force on the walls [N]; all are in original order.

        F_i = -V_i sum V_j (p_i + p_j) grad W                                (Colagrossi & Landrini 2003)
            + V_i sum V_j alpha h c rho_0 min(v_ij.x_ij, 0) / r^2 grad W      (Monaghan 1992)
            + V_i sum V_j K mu v_ij.x_ij / r^2 grad W                         (Monaghan & Gingold 1983)

        where r^2 stands for r^2 + 1e-4 h^2. The pressure term is the adjoint of the continuity equation's divergence,
        so that fluid pairs exchange no energy but by the viscous terms. Every pair's force is along x_ij and opposite
        for j: momentum and angular momentum are kept to rounding. K is 2(d + 2) where the sum is an integral (Violeau
        2012); `ConfigSPH.laminar_factor` has it for a sum. Velocity is kicked first, walls stop what is on their face,
        and the new velocity moves the particle (symplectic Euler).
        """
        s = first + wp.tid()
        i = fluid.order[s]
        p = load_record(fluid.point, s)
        m = load_record(fluid.motion, s)
        x = wp.vec3(p[0], p[1], p[2])
        v = wp.vec3(m[0], m[1], m[2])
        world = fluid.world[i]
        viscous = viscosities(method, rest_density[world], viscosity[world])
        if wp.static(sums.several):
            viscous = viscosities(method, 1.0, wp.static(0.0 if sums.yields else 1.0))
        own = m[3] + 2.0 * method.background_pressure
        total = of_fluid(grid, fluid, fluid, s, world, method.shape, x, v, own, viscous)
        at_walls = AtWalls()
        if wp.static(WALLS in solids):
            if is_near(grid, walls, world, x):
                at_walls = of_walls(grid, fluid, walls, s, world, method.shape, x, v, own, viscous)
                total += wp.vec3(at_walls[0], at_walls[1], at_walls[2])
        if wp.static(BODIES in solids):
            if is_near(grid, bodies, world, x):
                total += of_bodies(grid, fluid, bodies, s, world, method.shape, x, v, own, viscous)
        if wp.static(sums.yields):
            c = load_record(fluid.creep, s)
            u, creep = wp.vec3(c[0], c[1], c[2]), viscosities(method, 0.0, 1.0)
            total += creep_in_fluid(grid, fluid, fluid, s, world, method.shape, x, u, 0.0, creep)
            if wp.static(WALLS in solids):
                if is_near(grid, walls, world, x):
                    drag = creep_at_walls(grid, fluid, walls, s, world, method.shape, x, u, 0.0, creep)
                    total += drag
                    for axis in range(3):
                        at_walls[axis] += drag[axis]
            if wp.static(BODIES in solids):
                if is_near(grid, bodies, world, x):
                    total += creep_at_bodies(grid, fluid, bodies, s, world, method.shape, x, u, 0.0, creep)
        v = v + dt * (p[3] / mass[i] * total + gravity[world])
        if wp.static(WALLS in solids):
            stop = _stop_at_face(at_walls, v)
            v += stop
            on_walls[i] = -p[3] * wp.vec3(at_walls[0], at_walls[1], at_walls[2]) - mass[i] / dt * stop
        velocity[i] = v
        position[i] = wrap(grid, x + dt * v)

    return momentum
