"""Continuity equation with density diffusion, and the equation of state."""

import warp as wp

from wsim.kernels.sph.grid import Grid, in_plane
from wsim.kernels.sph.pair_sums import PairSums
from wsim.kernels.sph.records import load_record
from wsim.kernels.sph.species import BODIES, WALLS, Species, is_near

# Water that is pulled apart leaves a void; it does not stretch. Below this share of the rest density a particle is one
# drop of spray, and its density says nothing more. Without the bound a few drops that hold each other in orbit by
# tension stretch without end. To forbid tension altogether is worse: it opens voids in the bulk that slam shut.
LOWEST_DENSITY = wp.constant(0.9)
# Where a void is beside it water tears before it pulls. What is left, in smoothing lengths of its own weight, is what
# the pressure at a surface at rest swings by: cut to nothing it would carry a light body up by what is left of it.
HELD_AT_SURFACE = wp.constant(4.0)
# Of what is around a particle the share that is filled: at a level surface 0.6, one layer further down 0.9.
OPEN = wp.constant(0.7)
CLOSED = wp.constant(0.9)
# Beside a void is the air, whose pressure is 0: what is above a share of that leaves in the time in which sound crosses
# the kernel's support. All of it would leave a surface at rest without its own weight.
VENT_ABOVE = wp.constant(0.25)
VENTED = wp.constant(0.5)  # [c / h]
# Of what is around a particle in a gap the share of fluid from which on it needs none of what is handed on there.
ALONE = wp.constant(0.25)
# One body particle half a smoothing length inside the support, or several further out, and walls give nothing back.
FADE = wp.constant(4.0)


@wp.struct
class Method:
    """What a step's sums share: `SolverSPH.Config` in the form that kernels take."""

    h: float  # smoothing length [m]
    shape: wp.vec3  # (1 / 2h, -5 norm / h^2, (2h)^2)
    speed_of_sound: float  # [m/s]
    diffusion: float  # delta
    artificial_viscosity: float  # alpha
    laminar_factor: float  # about 2 (d + 2) in d dimensions
    background_pressure: float  # [Pa]


@wp.func
def dimensions(grid: Grid) -> float:
    """2 in a plane, else 3."""
    return wp.where(in_plane(grid), 2.0, 3.0)


@wp.func
def _enclosed(grid: Grid, filled: float) -> float:
    """1 of a particle with water or solids all around it, 0 of one with a void beside it.

    -sum V_j (x_i - x_j).grad W, the divergence of the position, is the number of dimensions where the kernel is full
    (Lee et al. 2008).
    """
    return wp.clamp((filled / dimensions(grid) - OPEN) / (CLOSED - OPEN), 0.0, 1.0)


def make_continuity(sums: PairSums, solids: tuple[int, ...]) -> wp.Kernel:
    """The kernel that advances pressure by the continuity equation, given the kinds of solids."""
    of_fluid, of_walls, of_bodies = sums.continuity, sums.continuity_at_walls, sums.continuity_at_bodies

    @wp.kernel(**sums.options)
    def continuity(
        # Data in:
        first: int,
        grid: Grid,
        method: Method,
        rest_density: wp.array(dtype=float),
        gravity: wp.array(dtype=wp.vec3),
        fluid: Species,
        walls: Species,
        bodies: Species,
        dt: float,
        # Data out:
        pressure: wp.array(dtype=float),
        full: wp.array(dtype=float),
    ):
        """Advance the pressure of each fluid particle by dt, in sorted order.

        d rho_i/dt = rho_i sum V_j (v_i - v_j).grad W
                   + 2 delta h c sum V_j (rho_j - rho_i - rho^H_ij) (x_j - x_i).grad W / r^2

        with p = c^2 (rho - rho_0), the linear equation of state (Antuono et al. 2010). Tait's equation with exponent 7
        is the same to first order, but its sound quickens with compression: where a cavity closes over a sinking body
        the density rises by 15 %, the sound by half, and the step that was chosen for the still fluid is too long.

        The second sum is the density diffusion of Fourtakas et al. (2019, Computers & Fluids 190): the hydrostatic
        part rho^H_ij of the difference is left out of Molteni & Colagrossi's (2009) term, so that a tank at rest keeps
        its pressure. It spans fluid alone, and so neither makes nor destroys volume in sum, but for single particles in
        a gap of bodies, which take on the pressure there (`push.make_push`).

        Water that meets again, drops of a tap or a splash, has the density of water with voids between, and continuity
        has it press on the rest as soon as that is within reach: the heap would stand up to twice as high as its
        volume, and what splashes swell. So what is beside a void is vented.

        `full` is how far each is from any void, in original order, for the next step's `boundary.compress`.
        """
        s = first + wp.tid()
        p = load_record(fluid.point, s)
        m = load_record(fluid.motion, s)
        x = wp.vec3(p[0], p[1], p[2])
        v = wp.vec3(m[0], m[1], m[2])
        world = fluid.world[fluid.order[s]]
        rho0 = rest_density[world]
        if wp.static(sums.several):
            rho0 = fluid.liquid[s][0]
        # p^H_j - p^H_i = rho_0 g.(x_j - x_i): the incompressible column, within the 1 % of compression.
        weight = rho0 * gravity[world]
        total = of_fluid(grid, fluid, fluid, s, world, method.shape, x, v, m[3], weight)
        divergence, smoothing, filled = total[0], total[1], total[2]
        given_back = float(0.0)
        if wp.static(WALLS in solids):
            if is_near(grid, walls, world, x):
                at_walls = of_walls(grid, fluid, walls, s, world, method.shape, x, v, m[3], weight)
                divergence += at_walls[0]
                filled += at_walls[2]
                given_back = at_walls[1]
        if wp.static(BODIES in solids):
            if is_near(grid, bodies, world, x):
                at_bodies = of_bodies(grid, fluid, bodies, s, world, method.shape, x, v, m[3], weight)
                divergence += at_bodies[0]
                filled += at_bodies[2]
                smoothing += wp.max(1.0 - total[2] / (ALONE * dimensions(grid)), 0.0) * at_bodies[3]
                # What walls give back fades as a body comes within reach: see `boundary.compress`.
                given_back *= wp.max(1.0 - FADE * at_bodies[1], 0.0)
        enclosed = _enclosed(grid, filled)
        full[fluid.order[s]] = enclosed
        divergence += enclosed * given_back / p[3]
        c2 = method.speed_of_sound * method.speed_of_sound
        vent = VENTED * method.speed_of_sound / method.h
        rate = (c2 * rho0 + m[3]) * divergence + 2.0 * method.diffusion * method.h * method.speed_of_sound * smoothing
        held = HELD_AT_SURFACE * wp.length(weight) * method.h
        # What has no water around it hangs on to nothing: in a corner, solids alone are all around a drop.
        torn = enclosed * wp.min(total[2] / (ALONE * dimensions(grid)), 1.0)
        now = wp.max(m[3] + dt * rate, torn * (LOWEST_DENSITY - 1.0) * rho0 * c2 - held)
        if now > VENT_ABOVE * held:
            now = VENT_ABOVE * held + (now - VENT_ABOVE * held) * wp.exp(-dt * vent * (1.0 - enclosed))
        pressure[s] = now

    return continuity


@wp.kernel(enable_backward=False)
def set_pressure(
    # Data in:
    order: wp.array(dtype=int),
    pressure: wp.array(dtype=float),
    # Data out:
    motion: wp.array(dtype=wp.vec4),
    fluid_pressure: wp.array(dtype=float),
):
    """Put the new pressures of the fluid in the records and in the state."""
    s = wp.tid()
    m = motion[s]
    motion[s] = wp.vec4(m[0], m[1], m[2], pressure[s])
    fluid_pressure[order[s]] = pressure[s]
