"""Continuity equation with density diffusion, and the equation of state."""

import warp as wp

from wsim.kernels.sph.wendland import wendland_slope


@wp.func
def tait_pressure(rho: float, rest_density: float, speed_of_sound: float) -> float:
    """Pressure [Pa] of Tait's equation of state with exponent 7 (Monaghan 1994)."""
    x = rho / rest_density
    x3 = x * x * x
    return rest_density * speed_of_sound * speed_of_sound / 7.0 * (x3 * x3 * x - 1.0)


@wp.func
def tait_density(pressure: float, rest_density: float, speed_of_sound: float) -> float:
    """Density [kg/m^3] at a pressure: the inverse of `tait_pressure`."""
    b = rest_density * speed_of_sound * speed_of_sound / 7.0
    return rest_density * wp.pow(wp.max(pressure / b + 1.0, 0.0), 1.0 / 7.0)


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
    # Linearised: rho^H_j - rho^H_i = rho_0 g.(x_j - x_i) / c^2, exact to the 1 % that the fluid is compressed.
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
    density[s] = rho + dt * rate


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
    point[s] = wp.vec4(p[0], p[1], p[2], tait_pressure(rho, rest_density, speed_of_sound) / (rho * rho))
    motion[s] = wp.vec4(m[0], m[1], m[2], rho)
