"""Continuity equation with density diffusion, and the equation of state."""

import warp as wp

from wsim.kernels.sph.wendland import wendland_slope

# Water that is pulled apart leaves a void; it does not stretch. Below this share of the rest density a particle is one
# drop of spray, and its density says nothing more. Without the bound a few drops that hold each other in orbit by
# tension stretch without end. To forbid tension altogether is worse: it opens voids in the bulk that slam shut.
LOWEST_DENSITY = wp.constant(0.9)


@wp.func
def pressure_of(rho: float, rest_density: float, speed_of_sound: float) -> float:
    """Pressure [Pa] of the linear equation of state, p = c^2 (rho - rho_0) (Antuono et al. 2010).

    Tait's equation with exponent 7 is the same to first order, but its sound quickens with compression: where a cavity
    closes over a sinking body the density rises by 15 %, the sound by half, and the step that was chosen for the
    still fluid is too long.
    """
    return speed_of_sound * speed_of_sound * (rho - rest_density)


@wp.func
def density_at(pressure: float, rest_density: float, speed_of_sound: float) -> float:
    """Density [kg/m^3] at a pressure: the inverse of `pressure_of`."""
    return rest_density + pressure / (speed_of_sound * speed_of_sound)


@wp.kernel(enable_backward=False)
def continuity(
    # Data in:
    first: int,
    neighbor: wp.array(dtype=int),
    neighbor_count: wp.array(dtype=int),
    stride: wp.vec2i,
    order: wp.array(dtype=int),
    particle_world: wp.array(dtype=int),
    gravity: wp.array(dtype=wp.vec3),
    point: wp.array(dtype=wp.vec4),
    motion: wp.array(dtype=wp.vec4),
    mass: wp.array(dtype=float),
    kind: wp.array(dtype=int),
    h: float,
    norm: float,
    rest_density: float,
    speed_of_sound: float,
    diffusion: float,
    dt: float,
    # Data out:
    density: wp.array(dtype=float),
):
    """Advance the density of each fluid particle by dt, in sorted order.

    d rho_i/dt = rho_i sum V_j (v_i - v_j).grad W
               + 2 delta h c sum V_j (rho_j - rho_i - rho^H_ij) (x_j - x_i).grad W / r^2

    The second sum is the density diffusion of Fourtakas et al. (2019, Computers & Fluids 190): the hydrostatic part
    rho^H_ij of the difference is left out of Molteni & Colagrossi's (2009) term, so that a tank at rest keeps its
    pressure.
    """
    s = first + wp.tid()
    m = motion[s]
    density[s] = m[3]
    if kind[s] != 0:
        return
    world = particle_world[order[s]]
    p = point[s]
    x = wp.vec3(p[0], p[1], p[2])
    v = wp.vec3(m[0], m[1], m[2])
    rho = m[3]
    # rho^H_j - rho^H_i = rho_0 g.(x_j - x_i) / c^2: the incompressible column, within the 1 % of compression.
    hydrostatic = rest_density / (speed_of_sound * speed_of_sound) * gravity[world]
    divergence = float(0.0)
    smoothing = float(0.0)
    base = s * stride[0]
    for k in range(neighbor_count[s]):
        entry = neighbor[base + k * stride[1]]
        j = wp.where(entry < 0, ~entry, entry)
        q = point[j]
        d = wp.vec3(x[0] - q[0], x[1] - q[1], x[2] - q[2])
        n = motion[j]
        term = mass[j] / n[3] * wendland_slope(wp.length(d), h, norm)
        divergence += term * wp.dot(v - wp.vec3(n[0], n[1], n[2]), d)
        smoothing -= wp.where(entry < 0, 0.0, term) * (n[3] - rho + wp.dot(hydrostatic, d))
    rate = rho * divergence + 2.0 * diffusion * h * speed_of_sound * smoothing
    density[s] = wp.max(rho + dt * rate, LOWEST_DENSITY * rest_density)


@wp.kernel(enable_backward=False)
def equation_of_state(
    # Data in:
    kind: wp.array(dtype=int),
    density: wp.array(dtype=float),
    rest_density: float,
    speed_of_sound: float,
    # Data out:
    point: wp.array(dtype=wp.vec4),
    motion: wp.array(dtype=wp.vec4),
):
    """Write the new density of fluid particles into the records, with p/rho^2."""
    s = wp.tid()
    if kind[s] != 0:
        return
    rho = density[s]
    p = point[s]
    m = motion[s]
    point[s] = wp.vec4(p[0], p[1], p[2], pressure_of(rho, rest_density, speed_of_sound) / (rho * rho))
    motion[s] = wp.vec4(m[0], m[1], m[2], rho)
