"""The pipes of taps: water around them stays out, and what runs in them has the pressure that is around it.

What is in a pipe goes at the flow's speed, whatever pushes on it (`openings`), so its pressure is no sum over time of
what comes near. It is that of the free water about it, as a wall's is (Adami et al. 2012): at the mouth what the
inlet's is to be (Tafuni et al. 2018), and along a pipe that lies in water what holds that water off.
"""

import warp as wp

from wsim.kernels.sph.density import Method
from wsim.kernels.sph.grid import Grid
from wsim.kernels.sph.openings import FREE, Taps, within
from wsim.kernels.sph.pair_sums import PairSums
from wsim.kernels.sph.records import load_record
from wsim.kernels.sph.species import Species


def make_fill(sums: PairSums) -> wp.Kernel:
    """The kernel that gives what is in pipes the pressure of the free water near it."""
    of_free = sums.free

    @wp.kernel(**sums.options)
    def fill(
        # Data in:
        first: int,
        grid: Grid,
        method: Method,
        rest_density: wp.array(dtype=float),
        gravity: wp.array(dtype=wp.vec3),
        fluid: Species,
        # Data out:
        pressure: wp.array(dtype=float),
        full: wp.array(dtype=float),
    ):
        """p = sum p_f + rho_0 g.(x - x_f) W / sum W over free water f; 0 where there is none. In sorted order.

        No void is beside it: a pipe goes on.
        """
        s = first + wp.tid()
        i = fluid.order[s]
        if fluid.stage[i] <= FREE:
            return
        p = load_record(fluid.point, s)
        world = fluid.world[i]
        weight = rest_density[world] * gravity[world]
        x, at_rest = wp.vec3(p[0], p[1], p[2]), wp.vec3(0.0, 0.0, 0.0)
        total = of_free(grid, fluid, fluid, s, world, method.shape, x, at_rest, 0.0, weight)
        full[i] = 1.0
        pressure[s] = 0.0
        if total[0] > 0.0:
            pressure[s] = wp.max(total[1] / total[0], -method.background_pressure)

    return fill


@wp.func
def _side_of(half: wp.vec2, is_round: int, x: wp.vec3) -> wp.vec4:
    """The way out through the nearest side of a pipe, from its frame, and how far that is [m]."""
    if is_round != 0:
        aside = wp.vec3(x[0], x[1], 0.0)
        out = wp.normalize(aside)
        return wp.vec4(out[0], out[1], 0.0, half[0] - wp.length(aside))
    beyond = wp.vec2(half[0] - wp.abs(x[0]), half[1] - wp.abs(x[1]))
    if beyond[0] < beyond[1]:
        return wp.vec4(wp.where(x[0] < 0.0, -1.0, 1.0), 0.0, 0.0, beyond[0])
    return wp.vec4(0.0, wp.where(x[1] < 0.0, -1.0, 1.0), 0.0, beyond[1])


@wp.func
def _out_of_pipe(half: wp.vec2, is_round: int, depth: float, before: wp.vec3, now: wp.vec3) -> wp.vec4:
    """The way out of a pipe through the face by which a point came in, and how far that is [m], in its frame.

    The pipe is behind the mouth, at z = 0. What was in it before goes by the nearest face.
    """
    side = _side_of(half, is_round, now)
    mouth = wp.vec4(0.0, 0.0, 1.0, -now[2])
    back = wp.vec4(0.0, 0.0, -1.0, depth + now[2])
    if before[2] >= 0.0 and within(half, is_round, before):
        return mouth
    if before[2] <= -depth and within(half, is_round, before):
        return back
    if not within(half, is_round, before):
        return side
    if side[3] <= mouth[3] and side[3] <= back[3]:
        return side
    return wp.where(mouth[3] <= back[3], mouth, back)


@wp.func
def _supplied(taps: Taps, t: int, method: Method, own: wp.vec3) -> float:
    """Sum of W over where a pipe's particles begin, from its frame [1/m^3]."""
    total = float(0.0)
    begin = 0.5 * float(taps.layer[t]) - taps.depth[t]
    if wp.abs(own[2] - begin) * method.shape[0] < 1.0:
        norm = -0.2 * method.shape[1] * method.h * method.h  # shape holds -5 norm / h^2
        for q in range(taps.place_first[t], taps.place_first[t + 1]):
            place = taps.place[q]
            u = wp.length(own - wp.vec3(place[0], place[1], begin)) * method.shape[0]
            w = wp.max(1.0 - u, 0.0)
            total += norm * w * w * w * w * (1.0 + 4.0 * u)
    return total


@wp.kernel(enable_backward=False)
def press_walls(
    # Data in:
    method: Method,
    taps: Taps,
    travel: wp.array(dtype=wp.float64),
    dt: float,
    walls: Species,
    # Data in and out:
    motion: wp.array(dtype=wp.vec4),
):
    """Count the layers that begin in pipes into what walls near them give back (`boundary.compress`).

    As of the water behind a pipe's end (`keep_out_of_pipes`): what runs draws away from the wall there, and what
    follows is there at once. Left out, walls would take that back from the free water for as long as the tap runs.
    """
    s = wp.tid()
    m = motion[s]
    around = walls.facing[s][3]  # sum W, of the last step
    if m[3] == 0.0 or around <= 0.0:
        return
    p = walls.point[s]
    world = walls.world[walls.order[s]]
    pressed = float(0.0)
    for t in range(taps.tap_first[world], taps.tap_first[world + 1]):
        if taps.depth[t] > 0.0:
            own = wp.transform_point(wp.transform_inverse(taps.pose[t]), wp.vec3(p[0], p[1], p[2]))
            volume = float(taps.layer[t] * taps.area[t]) / float(taps.place_first[t + 1] - taps.place_first[t])
            pressed += volume * float(travel[t] / taps.layer[t]) / dt * _supplied(taps, t, method, own)
    motion[s] = wp.vec4(m[0], m[1], m[2], m[3] + p[3] * pressed / around)


@wp.kernel(enable_backward=False)
def keep_out_of_pipes(
    # Data in:
    particle_world: wp.array(dtype=int),
    particle_mass: wp.array(dtype=float),
    stage: wp.array(dtype=int),
    method: Method,
    taps: Taps,
    travel: wp.array(dtype=wp.float64),
    dt: float,
    # Data in and out:
    position: wp.array(dtype=wp.vec3),
    velocity: wp.array(dtype=wp.vec3),
    pressure: wp.array(dtype=float),
    given: wp.array(dtype=wp.vec3),
):
    """Put free water that has come into a pipe in this step back to its wall, its end or its mouth, and stop it there.

    A pipe has a wall: water around it pushes on what is in it, and stays out; at the mouth it goes on at least as fast
    as the flow behind it.

    What runs in the pipe draws away from the water behind its end, which so loses density: rho' = sum m v_ij.grad W.
    The layers that follow appear there at once, which no velocity tells of. Each is m W, spread over the time of a
    layer; without it water about the end is pressed into less and less room.
    """
    i = wp.tid()
    if stage[i] != FREE:
        return
    world = particle_world[i]
    x = position[i]
    v = velocity[i]
    stop = wp.vec3(0.0, 0.0, 0.0)
    for t in range(taps.tap_first[world], taps.tap_first[world + 1]):
        depth = taps.depth[t]
        into = wp.transform_inverse(taps.pose[t])
        own = wp.transform_point(into, x)
        if depth > 0.0 and own[2] < 0.0 and own[2] * method.shape[0] > -depth * method.shape[0] - 1.0:
            layers = float(travel[t] / taps.layer[t])
            if layers > 0.0:
                gained = taps.mass[t] * layers * _supplied(taps, t, method, own)
                pressure[i] += method.speed_of_sound * method.speed_of_sound * gained
            if own[2] > -depth and within(taps.half[t], taps.round[t], own):
                before = wp.transform_point(into, x - dt * v)
                out = _out_of_pipe(taps.half[t], taps.round[t], depth, before, own)
                n = wp.transform_vector(taps.pose[t], wp.vec3(out[0], out[1], out[2]))
                speed = wp.where(out[2] > 0.5, float(travel[t]) / dt, 0.0)
                x += out[3] * n
                stop -= wp.min(wp.dot(v + stop, n) - speed, 0.0) * n
    position[i] = x
    velocity[i] = v + stop
    given[i] = given[i] + particle_mass[i] / dt * stop
