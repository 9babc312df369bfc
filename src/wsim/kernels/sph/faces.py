"""Faces of what stands still, which no fluid gets behind however thin or far from the tank it is."""

import warp as wp


@wp.func
def _crossed(half: wp.vec3, before: wp.vec3, now: wp.vec3) -> wp.vec3:
    """The outward normal of the face of a box through which a point came in, from the frame of the box.

    The one that it was farthest beyond; of a point that was inside already, the nearest.
    """
    best = float(-1.0e30)
    normal = wp.vec3(0.0, 0.0, 0.0)
    outside = bool(False)
    for axis in range(3):
        if wp.abs(before[axis]) > half[axis]:
            outside = True
    for axis in range(3):
        at = wp.where(outside, before[axis], now[axis])
        beyond = wp.abs(at) - half[axis]
        if beyond > best:
            best = beyond
            normal = wp.vec3(0.0, 0.0, 0.0)
            normal[axis] = wp.where(at < 0.0, -1.0, 1.0)
    return normal


@wp.kernel(enable_backward=False)
def keep_out(
    # Data in:
    particle_world: wp.array(dtype=int),
    mass: wp.array(dtype=float),
    plane_first: wp.array(dtype=int),  # (W + 1,): where each world's planes begin
    plane: wp.array(dtype=wp.vec4),  # outward unit normal n, and n.x on it [m]
    box_first: wp.array(dtype=int),  # (W + 1,): where each world's boxes begin
    box_pose: wp.array(dtype=wp.transform),
    box_half: wp.array(dtype=wp.vec3),  # [m]
    box_low: wp.array(dtype=wp.vec3),  # corners of what is upright around each [m]
    box_high: wp.array(dtype=wp.vec3),
    dt: float,
    # Data in and out:
    position: wp.array(dtype=wp.vec3),
    velocity: wp.array(dtype=wp.vec3),
    on_walls: wp.array(dtype=wp.vec3),
):
    """Put fluid that has come through a face in this step back to it, and stop it there: v.n >= 0, as at a wall.

    Particles of walls push with their pressure, and are laid where water is expected and as deep as a kernel reaches:
    not on ground that water spills on, nor outside of a tank, whose rim is too thin for them to carry a drop.
    """
    i = wp.tid()
    world = particle_world[i]
    x = position[i]
    v = velocity[i]
    before = x - dt * v
    stop = wp.vec3(0.0, 0.0, 0.0)
    for k in range(box_first[world], box_first[world + 1]):
        low = box_low[k]
        high = box_high[k]
        if x[0] > low[0] and x[0] < high[0] and x[1] > low[1] and x[1] < high[1] and x[2] > low[2] and x[2] < high[2]:
            into = wp.transform_inverse(box_pose[k])
            own = wp.transform_point(into, x)
            half = box_half[k]
            if wp.abs(own[0]) < half[0] and wp.abs(own[1]) < half[1] and wp.abs(own[2]) < half[2]:
                side = _crossed(half, wp.transform_point(into, before), own)
                n = wp.transform_vector(box_pose[k], side)
                x += (wp.dot(wp.abs(side), half) - wp.dot(side, own)) * n
                stop -= wp.min(wp.dot(v + stop, n), 0.0) * n
    for k in range(plane_first[world], plane_first[world + 1]):
        n = wp.vec3(plane[k][0], plane[k][1], plane[k][2])
        deep = plane[k][3] - wp.dot(n, x)
        if deep > 0.0:
            x += deep * n
            stop -= wp.min(wp.dot(v + stop, n), 0.0) * n
    position[i] = x
    velocity[i] = v + stop
    on_walls[i] = on_walls[i] - mass[i] / dt * stop
