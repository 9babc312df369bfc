"""What policies are told, in all worlds at once: by time, or the way along a route; brought on slowly, and trimmed.

The laws are those of `wsim.sim.commands`.
"""

import warp as wp

from wsim.kernels.policy import COMMAND


@wp.func
def bounded(x: wp.vec3, most: wp.vec3) -> wp.vec3:
    """Each entry cut off at its own most, either way."""
    return wp.max(-most, wp.min(x, most))


@wp.kernel(enable_backward=False)
def state_commands(
    # Data in:
    clock: wp.array(dtype=wp.float64),  # [s]
    times: wp.array2d(dtype=wp.float64),  # from when on each command holds; infinite beyond the last
    commands: wp.array2d(dtype=wp.vec3),
    # Data out:
    wanted: wp.array(dtype=wp.vec3),
):
    """The command that holds now: the last one whose time has come."""
    world = wp.tid()
    row = int(0)
    while row + 1 < times.shape[1] and times[world, row + 1] <= clock[0] + wp.float64(1.0e-9):
        row += 1
    wanted[world] = commands[world, row]


@wp.kernel(enable_backward=False)
def follow_routes(
    # Data in:
    where: wp.array(dtype=wp.vec3),  # x, y [m], heading [rad]
    route: wp.array2d(dtype=wp.vec3),  # likewise, of each world's points
    points: wp.array(dtype=int),  # how many there are
    speed: wp.array(dtype=float),  # [m/s]
    near: float,  # [m] to a point, where the next one is gone for
    approach: float,  # [1/s] towards the last one
    turn: float,  # [1/s] towards a heading
    # Data out:
    next: wp.array(dtype=int),
    wanted: wp.array(dtype=wp.vec3),
):
    """Straight to the next point, turning to its heading on the way by the shorter way round."""
    world = wp.tid()
    own = where[world]
    here = wp.vec2(own[0], own[1])
    last = points[world] - 1
    at = next[world]
    goal = route[world, at]
    while at < last and wp.length(wp.vec2(goal[0], goal[1]) - here) < near:
        at += 1
        goal = route[world, at]
    next[world] = at
    way = wp.vec2(goal[0], goal[1]) - here
    left = wp.length(way)
    fast = speed[world]
    if at == last:
        fast = wp.min(fast, approach * left)
    velocity = way * (fast / wp.max(left, 1.0e-9))
    c = wp.cos(own[2])
    s = wp.sin(own[2])
    off = goal[2] - own[2]
    off = wp.atan2(wp.sin(off), wp.cos(off))
    wanted[world] = wp.vec3(c * velocity[0] + s * velocity[1], c * velocity[1] - s * velocity[0], turn * off)


@wp.kernel(enable_backward=False)
def bring_on(
    # Data in:
    wanted: wp.array(dtype=wp.vec3),
    measured: wp.array(dtype=wp.vec3),
    limit: wp.vec3,
    most: wp.vec3,  # change in a turn
    share: float,  # of what is new in the smoothed velocity
    rate: wp.vec3,  # at which what is lacking is summed, times the time between two turns
    sum_limit: wp.vec3,
    # Data out:
    now: wp.array(dtype=wp.vec3),
    smoothed: wp.array(dtype=wp.vec3),
    sum: wp.array(dtype=wp.vec3),
    felt: wp.array2d(dtype=wp.vec3),
):
    """Change a command by no more than it may, and add the integral of what the robot lacks of it."""
    world = wp.tid()
    told = now[world] + bounded(bounded(wanted[world], limit) - now[world], most)
    now[world] = told
    is_ = smoothed[world] + share * (measured[world] - smoothed[world])
    smoothed[world] = is_
    more = bounded(sum[world] + wp.cw_mul(rate, told - is_), sum_limit)
    sum[world] = more
    felt[world, COMMAND] = told + more
