"""Momentum equation, and the step of velocity and position."""

import warp as wp

from wsim.kernels.sph.wendland import wendland_slope


@wp.func
def pair_force(
    d: wp.vec3,
    dv: wp.vec3,
    pressure_i: float,
    pressure_j: float,
    rho_i: float,
    rho_j: float,
    h: float,
    norm: float,
    speed_of_sound: float,
    artificial_viscosity: float,
    viscosity: float,
) -> wp.vec3:
    """Acceleration of i by a unit mass j [m/s^2 per kg]; antisymmetric in i and j, so momentum is conserved.

    Pressure as in Monaghan (1992); artificial viscosity of Monaghan (1992) with alpha; laminar viscosity of Morris,
    Fox & Zhu (1997). pressure_* = p/rho^2.
    """
    r2 = wp.dot(d, d)
    slope = wendland_slope(wp.sqrt(r2), h, norm)
    spread = slope / (r2 + 0.01 * h * h)
    approach = wp.min(wp.dot(dv, d), 0.0)
    damping = 2.0 * artificial_viscosity * speed_of_sound * h / (rho_i + rho_j) * approach * spread
    laminar = 2.0 * viscosity / (rho_i * rho_j) * r2 * spread
    return (damping - (pressure_i + pressure_j) * slope) * d + laminar * dv


@wp.kernel(enable_backward=False)
def momentum(
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
    fluid_count: int,
    h: float,
    norm: float,
    speed_of_sound: float,
    artificial_viscosity: float,
    viscosity: float,
    # Data out:
    acceleration: wp.array(dtype=wp.vec3),
    boundary_force: wp.array(dtype=wp.vec3),
):
    """Acceleration of each fluid particle, and the fluid's force on each particle of a body, in original order."""
    s = first + wp.tid()
    owner = kind[s]
    if owner == 1:
        return
    i = order[s]
    world = particle_world[i]
    p = point[s]
    m = motion[s]
    x = wp.vec3(p[0], p[1], p[2])
    v = wp.vec3(m[0], m[1], m[2])
    total = wp.vec3(0.0, 0.0, 0.0)
    base = s * stride[0]
    for k in range(neighbor_count[s]):
        entry = neighbor[base + k * stride[1]]
        j = wp.where(entry < 0, ~entry, entry)
        q = point[j]
        d = wp.vec3(x[0] - q[0], x[1] - q[1], x[2] - q[2])
        n = motion[j]
        dv = v - wp.vec3(n[0], n[1], n[2])
        total += mass[j] * pair_force(
            d, dv, p[3], q[3], m[3], n[3], h, norm, speed_of_sound, artificial_viscosity, viscosity
        )
    if owner == 0:
        acceleration[i] = total + gravity[world]
    else:
        boundary_force[i - fluid_count] = mass[s] * total


@wp.kernel(enable_backward=False)
def scatter_density(
    # Data in:
    fluid_count: int,
    order: wp.array(dtype=int),
    density: wp.array(dtype=float),
    # Data out:
    fluid_density: wp.array(dtype=float),
):
    """Copy the fluid's new densities back to the original order."""
    s = wp.tid()
    i = order[s]
    if i < fluid_count:
        fluid_density[i] = density[s]


@wp.kernel(enable_backward=False)
def kick_drift(
    # Data in:
    position: wp.array(dtype=wp.vec3),
    velocity: wp.array(dtype=wp.vec3),
    acceleration: wp.array(dtype=wp.vec3),
    dt: float,
    # Data out:
    position_out: wp.array(dtype=wp.vec3),
    velocity_out: wp.array(dtype=wp.vec3),
):
    """Symplectic Euler: the new velocity moves the particle."""
    i = wp.tid()
    v = velocity[i] + dt * acceleration[i]
    velocity_out[i] = v
    position_out[i] = position[i] + dt * v
