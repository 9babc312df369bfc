"""Boundary particles: walls and bodies that take the fluid's pressure and push back (Adami, Hu & Adams 2012)."""

import warp as wp

from wsim.kernels.sph.density import density_at
from wsim.kernels.sph.wendland import wendland


@wp.kernel(enable_backward=False)
def move_boundary(
    # Data in:
    local_position: wp.array(dtype=wp.vec3),
    owner: wp.array(dtype=int),
    body_q: wp.array(dtype=wp.transform),
    body_qd: wp.array(dtype=wp.spatial_vector),
    body_com: wp.array(dtype=wp.vec3),
    # Data out:
    position: wp.array(dtype=wp.vec3),
    velocity: wp.array(dtype=wp.vec3),
):
    """Carry the particles of moving bodies with them; body_qd is (velocity of the centre of mass, angular velocity)."""
    b = wp.tid()
    body = owner[b]
    if body < 0:
        return
    pose = body_q[body]
    x = wp.transform_point(pose, local_position[b])
    twist = body_qd[body]
    arm = x - wp.transform_point(pose, body_com[body])
    position[b] = x
    velocity[b] = wp.spatial_top(twist) + wp.cross(wp.spatial_bottom(twist), arm)


@wp.kernel(enable_backward=False)
def extrapolate_pressure(
    # Data in:
    first: int,
    neighbor: wp.array(dtype=int),
    neighbor_count: wp.array(dtype=int),
    stride: wp.vec2i,
    order: wp.array(dtype=int),
    particle_world: wp.array(dtype=int),
    gravity: wp.array(dtype=wp.vec3),
    kind: wp.array(dtype=int),
    h: float,
    norm: float,
    rest_density: float,
    speed_of_sound: float,
    # Data in and out (boundary entries are written, fluid entries read):
    point: wp.array(dtype=wp.vec4),
    motion: wp.array(dtype=wp.vec4),
):
    """Pressure of each boundary particle from the fluid around it (Adami et al. 2012, eq. 27).

    p_b = sum (p_f + rho_f g.(x_b - x_f)) W / sum W; never below zero, so that a wall does not hold the fluid back.
    """
    s = first + wp.tid()
    if kind[s] == 0:
        return
    world = particle_world[order[s]]
    g = gravity[world]
    p = point[s]
    x = wp.vec3(p[0], p[1], p[2])
    weight = float(0.0)
    total = float(0.0)
    base = s * stride[0]
    for k in range(neighbor_count[s]):
        j = neighbor[base + k * stride[1]]
        q = point[j]
        d = wp.vec3(x[0] - q[0], x[1] - q[1], x[2] - q[2])
        w = wendland(wp.length(d), h, norm)
        rho = motion[j][3]
        weight += w
        total += w * (q[3] * rho * rho + rho * wp.dot(g, d))
    pressure = float(0.0)
    if weight > 0.0:
        pressure = wp.max(total / weight, 0.0)
    rho = density_at(pressure, rest_density, speed_of_sound)
    m = motion[s]
    point[s] = wp.vec4(p[0], p[1], p[2], pressure / (rho * rho))
    motion[s] = wp.vec4(m[0], m[1], m[2], rho)


@wp.kernel(enable_backward=False)
def sum_body_lanes(
    # Data in:
    body_first: wp.array(dtype=int),
    boundary_force: wp.array(dtype=wp.vec3),
    boundary_position: wp.array(dtype=wp.vec3),
    body_q: wp.array(dtype=wp.transform),
    body_com: wp.array(dtype=wp.vec3),
    # Data out:
    lane_wrench: wp.array2d(dtype=wp.spatial_vector),
):
    """Each lane adds up every n-th particle of a body: in a fixed order, so that the sum is the same each time."""
    body, lane = wp.tid()
    center = wp.transform_point(body_q[body], body_com[body])
    force = wp.vec3(0.0, 0.0, 0.0)
    torque = wp.vec3(0.0, 0.0, 0.0)
    for b in range(body_first[body] + lane, body_first[body + 1], lane_wrench.shape[1]):
        f = boundary_force[b]
        force += f
        torque += wp.cross(boundary_position[b] - center, f)
    lane_wrench[body, lane] = wp.spatial_vector(force, torque)


@wp.kernel(enable_backward=False)
def add_body_wrench(
    # Data in:
    lane_wrench: wp.array2d(dtype=wp.spatial_vector),
    # Data out:
    body_wrench: wp.array(dtype=wp.spatial_vector),
    body_f: wp.array(dtype=wp.spatial_vector),
):
    """Add the lanes' wrenches to Newton's external wrench on each body (about its centre of mass, world frame)."""
    body = wp.tid()
    total = wp.spatial_vector()
    for lane in range(lane_wrench.shape[1]):
        total += lane_wrench[body, lane]
    body_wrench[body] = total
    body_f[body] = body_f[body] + total
