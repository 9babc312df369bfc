"""Continuity equation with density diffusion, and the equation of state."""

import warp as wp

from wsim.kernels.sph.neighbors import Neighborhood, Search, pairs_of
from wsim.kernels.sph.pair_sums import OPTIONS, PairSums
from wsim.kernels.sph.records import load_record

# Water that is pulled apart leaves a void; it does not stretch. Below this share of the rest density a particle is one
# drop of spray, and its density says nothing more. Without the bound a few drops that hold each other in orbit by
# tension stretch without end. To forbid tension altogether is worse: it opens voids in the bulk that slam shut.
LOWEST_DENSITY = wp.constant(0.9)
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


def make_continuity(search: Search, sums: PairSums) -> wp.Kernel:
    """The kernel that advances pressure by the continuity equation."""
    runs, span_of, sum_run = search.runs, search.span, sums.continuity

    @wp.kernel(enable_backward=False, module="unique", module_options=OPTIONS)
    def continuity(
        # Data in:
        first: int,
        nb: Neighborhood,
        method: Method,
        rest_density: wp.array(dtype=float),
        gravity: wp.array(dtype=wp.vec3),
        point: wp.array(dtype=wp.vec4),
        motion: wp.array(dtype=wp.vec4),
        dt: float,
        # Data out:
        pressure: wp.array(dtype=float),
    ):
        """Advance the pressure of each fluid particle by dt, in sorted order.

        d rho_i/dt = rho_i sum V_j (v_i - v_j).grad W
                   + 2 delta h c sum V_j (rho_j - rho_i - rho^H_ij) (x_j - x_i).grad W / r^2

        with p = c^2 (rho - rho_0), the linear equation of state (Antuono et al. 2010). Tait's equation with exponent 7
        is the same to first order, but its sound quickens with compression: where a cavity closes over a sinking body
        the density rises by 15 %, the sound by half, and the step that was chosen for the still fluid is too long.

        The second sum is the density diffusion of Fourtakas et al. (2019, Computers & Fluids 190): the hydrostatic
        part rho^H_ij of the difference is left out of Molteni & Colagrossi's (2009) term, so that a tank at rest keeps
        its pressure. It spans fluid alone, and so neither
        makes nor destroys volume in sum.
        """
        s = first + wp.tid()
        p = load_record(point, s)
        if p[3] < 0.0:
            return
        m = load_record(motion, s)
        x = wp.vec3(p[0], p[1], p[2])
        v = wp.vec3(m[0], m[1], m[2])
        world = nb.particle_world[nb.order[s]]
        rho0 = rest_density[world]
        # p^H_j - p^H_i = rho_0 g.(x_j - x_i): the incompressible column, within the 1 % of compression.
        weight = rho0 * gravity[world]
        pairs = pairs_of(nb, point, motion, method.shape)
        total = wp.vec4(0.0, 0.0, 0.0, 0.0)
        for run in range(runs(nb, x)):
            span = span_of(nb, s, world, x, run)
            total += sum_run(pairs, span[0], span[1], x, v, m[3], weight)
        # What walls give back fades as a body comes within reach: see `boundary.compress`.
        given_back = wp.max(1.0 - FADE * total[3], 0.0) * total[2]
        divergence, smoothing = total[0] + given_back / p[3], total[1]
        c2 = method.speed_of_sound * method.speed_of_sound
        rate = (c2 * rho0 + m[3]) * divergence + 2.0 * method.diffusion * method.h * method.speed_of_sound * smoothing
        pressure[s] = wp.max(m[3] + dt * rate, (LOWEST_DENSITY - 1.0) * rho0 * c2)

    return continuity


@wp.kernel(enable_backward=False)
def set_pressure(
    # Data in:
    fluid_count: int,
    order: wp.array(dtype=int),
    pressure: wp.array(dtype=float),
    # Data out:
    motion: wp.array(dtype=wp.vec4),
    fluid_pressure: wp.array(dtype=float),
):
    """Put the new pressures of the fluid in the records and in the state."""
    s = wp.tid()
    i = order[s]
    if i < fluid_count:
        m = motion[s]
        motion[s] = wp.vec4(m[0], m[1], m[2], pressure[s])
        fluid_pressure[i] = pressure[s]
