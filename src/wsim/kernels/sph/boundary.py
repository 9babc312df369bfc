"""Solids: walls and bodies, made of particles that take the fluid's pressure and push back (Adami, Hu & Adams 2012)."""

import warp as wp

from wsim.kernels.sph.density import Method
from wsim.kernels.sph.grid import Grid, in_plane, wrap
from wsim.kernels.sph.pair_sums import PairSums
from wsim.kernels.sph.records import load_record
from wsim.kernels.sph.species import DRY, Species

TINY = wp.constant(1.0e-30)


@wp.kernel(enable_backward=False)
def move_bodies(
    # Data in:
    grid: Grid,
    local_position: wp.array(dtype=wp.vec3),
    owner: wp.array(dtype=int),
    body_q: wp.array(dtype=wp.transform),
    body_qd: wp.array(dtype=wp.spatial_vector),
    body_com: wp.array(dtype=wp.vec3),
    # Data out:
    position: wp.array(dtype=wp.vec3),
    velocity: wp.array(dtype=wp.vec3),
):
    """Carry the particles of bodies with them; body_qd is (velocity of the centre of mass, angular velocity).

    In a plane they stay at y = 0, however a body may have rolled: one particle out of it and all the water follows.
    """
    b = wp.tid()
    body = owner[b]
    pose = body_q[body]
    x = wp.transform_point(pose, local_position[b])
    twist = body_qd[body]
    arm = x - wp.transform_point(pose, body_com[body])
    v = wp.spatial_top(twist) + wp.cross(wp.spatial_bottom(twist), arm)
    if in_plane(grid):
        x[1] = 0.0
        v[1] = 0.0
    position[b] = wrap(grid, x)
    velocity[b] = v


def make_compress(sums: PairSums) -> wp.Kernel:
    """The kernel that finds how fast the fluid is pressed into each particle of a wall."""
    of_fluid = sums.flux

    @wp.kernel(**sums.options)
    def compress(
        # Data in:
        first: int,
        grid: Grid,
        method: Method,
        rest_density: wp.array(dtype=float),
        gravity: wp.array(dtype=wp.vec3),
        fluid: Species,
        walls: Species,
        # Data out:
        motion: wp.array(dtype=wp.vec4),
    ):
        """What each particle of a wall adds to the compression of the fluid near it [m^3/s], per sum of W.

        The momentum equation lets a wall push with pressure extrapolated from the fluid, p_b = sum p_f W / sum W. The
        work of that push on fluid that moves, V_b p_b sum V_f v_f.grad W, must be found again in the fluid's
        compression, or walls pump energy into sound: a still tank excites its slowest tone. So the same sum is given
        back to the same fluid with the same weights: continuity is the adjoint of the push, as it is between fluid
        particles (Bonet & Lok 1999, section 3). Where the wall does not push, it gives nothing back.

        Fixed walls alone do, to water that has neither a void beside it (`Species.full`) nor a body near it. Water that
        comes to a dry wall would be compressed twice on its way, and stand off: the front of a dam break came 0.06 s
        late to the far wall, and hit it with up to five times the pressure. A body that falls into a tank would float
        a fifth of a spacing too high, and drive the water under it into the floor. A surface that takes nothing back
        costs the slowest tone of a tank, where walls are near to all its water, 1.3 % of its strength in a period.

        `motion` is that of the walls: at rest, and what they give back.
        """
        s = first + wp.tid()
        p = load_record(walls.point, s)
        world = walls.world[walls.order[s]]
        x, at_rest = wp.vec3(p[0], p[1], p[2]), wp.vec3(0.0, 0.0, 0.0)
        weight_of_water = rest_density[world] * gravity[world]
        if wp.static(sums.several):
            weight_of_water = gravity[world]
        total = of_fluid(grid, walls, fluid, s, world, method.shape, x, at_rest, 0.0, weight_of_water)
        given_back = float(0.0)
        if total[0] > 0.0 and total[1] > -method.background_pressure * total[0]:
            given_back = p[3] * total[2] / total[0]
        motion[s] = wp.vec4(0.0, 0.0, 0.0, given_back)

    return compress


def make_extrapolate(sums: PairSums) -> wp.Kernel:
    """The kernel that gives solid particles the fluid's pressure and the opposite of its velocity."""
    of_fluid = sums.extrapolation

    @wp.kernel(**sums.options)
    def extrapolate(
        # Data in:
        first: int,
        grid: Grid,
        method: Method,
        rest_density: wp.array(dtype=float),
        viscosity: wp.array(dtype=float),
        gravity: wp.array(dtype=wp.vec3),
        fluid: Species,
        solid: Species,
        # Data in and out:
        motion: wp.array(dtype=wp.vec4),
        # Data out:
        facing: wp.array(dtype=wp.vec4),
        liquid: wp.array(dtype=wp.vec2),
    ):
        """Pressure and velocity of each solid particle from the fluid near it (Adami et al. 2012, eqs. 23, 27).

        p_b = sum (p_f + rho_0 g.(x_b - x_f)) W / sum W, never below what the background pressure holds, so that a wall
        does not hold the fluid back. The wall's own acceleration, which Adami et al. subtract from g, is left out:
        taken from the last step it makes a light body unstable. That leaves an error of the order of a spacing where
        a body accelerates.

        The velocity is the fluid's, v_f = sum v W / sum W, mirrored in two ways. For the laminar viscosity
        v_b = 2 v_wall - v_f: no slip. For the artificial one v_b = v_f - 2 n n.(v_f - v_wall), which mirrors the way
        into the wall alone: a boundary layer of that viscosity, centimetres thick, would drag on bodies and load
        them with water. Both forms are linear in v_b, so that its mean, weighted with the viscosities, serves both.

        `motion` is that of the solid: its own velocity comes in, the mirrored one and the pressure go out; `DRY` where
        no fluid is near. `facing` gets the way to the fluid, and sum W; `liquid`, of several, what is near in the mean,
        where nothing is the world's.
        """
        s = first + wp.tid()
        p = load_record(solid.point, s)
        world = solid.world[solid.order[s]]
        weight_of_water = rest_density[world] * gravity[world]
        if wp.static(sums.several):
            weight_of_water = gravity[world]
        x, at_rest = wp.vec3(p[0], p[1], p[2]), wp.vec3(0.0, 0.0, 0.0)
        total = of_fluid(grid, solid, fluid, s, world, method.shape, x, at_rest, 0.0, weight_of_water)
        near = wp.vec2(rest_density[world], viscosity[world])
        if wp.static(sums.several):
            if total[0] > 0.0:
                near = wp.vec2(total[8], total[9]) / total[0]
            liquid[s] = near
        artificial = method.artificial_viscosity * method.h * method.speed_of_sound * near[0]
        laminar = method.laminar_factor * near[1]
        if wp.static(sums.yields):
            laminar = 0.0 * laminar  # it does not ask for this velocity (`yielding`)
        m = motion[s]
        if total[0] <= 0.0:
            motion[s] = wp.vec4(m[0], m[1], m[2], DRY)
            facing[s] = wp.vec4(0.0, 0.0, 0.0, 0.0)
        else:
            pressure = wp.max(total[1] / total[0], -method.background_pressure)
            own = wp.vec3(m[0], m[1], m[2])
            past = wp.vec3(total[2], total[3], total[4]) / total[0] - own
            normal = wp.normalize(wp.vec3(total[5], total[6], total[7]))
            slip = past - 2.0 * wp.dot(past, normal) * normal
            share = artificial / wp.max(artificial + laminar, TINY)
            v = own + share * slip - (1.0 - share) * past
            motion[s] = wp.vec4(v[0], v[1], v[2], pressure)
            facing[s] = wp.vec4(normal[0], normal[1], normal[2], total[0])

    return extrapolate


@wp.kernel(enable_backward=False)
def sum_body_lanes(
    # Data in:
    grid: Grid,
    body_first: wp.array(dtype=int),
    particle_force: wp.array(dtype=wp.vec3),
    local_position: wp.array(dtype=wp.vec3),
    body_q: wp.array(dtype=wp.transform),
    body_com: wp.array(dtype=wp.vec3),
    # Data out:
    lane_wrench: wp.array2d(dtype=wp.spatial_vector),
):
    """Each lane adds up every n-th particle of a body: in a fixed order, so that the sum is the same each time."""
    body, lane = wp.tid()
    pose = body_q[body]
    force = wp.vec3(0.0, 0.0, 0.0)
    torque = wp.vec3(0.0, 0.0, 0.0)
    first = body_first[body]
    for b in range(first + lane, body_first[body + 1], lane_wrench.shape[1]):
        f = particle_force[b]
        force += f
        arm = wp.transform_vector(pose, local_position[b] - body_com[body])
        if in_plane(grid):
            arm[1] = 0.0
        torque += wp.cross(arm, f)
    lane_wrench[body, lane] = wp.spatial_vector(force, torque)


@wp.kernel(enable_backward=False)
def sum_wall_lanes(
    # Data in:
    force: wp.array(dtype=wp.vec3),
    world_first: wp.array(dtype=int),  # first particle of each world, and past the last one's
    lanes: wp.array(dtype=int),  # that each world has
    # Data out:
    lane_force: wp.array2d(dtype=wp.vec3d),
):
    """Each of a world's n lanes adds up every n-th of its particles' forces on the walls.

    In double precision: what presses on the walls of a tank is many times what is left of it in sum.
    """
    world, lane = wp.tid()
    total = wp.vec3d()
    if lane < lanes[world]:
        for i in range(world_first[world] + lane, world_first[world + 1], lanes[world]):
            total += wp.vec3d(force[i])
    lane_force[world, lane] = total


@wp.kernel(enable_backward=False)
def add_wall_impulse(
    # Data in:
    lane_force: wp.array2d(dtype=wp.vec3d),
    dt: float,
    # Data out:
    impulse: wp.array(dtype=wp.vec3d),
):
    """Add the lanes' force over a step to the impulse on each world's walls [N s]."""
    world = wp.tid()
    total = wp.vec3d()
    for lane in range(lane_force.shape[1]):
        total += lane_force[world, lane]
    impulse[world] = impulse[world] + wp.float64(dt) * total


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
