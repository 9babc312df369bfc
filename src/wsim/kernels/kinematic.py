"""Kinematic bodies go where their velocity takes them, whatever they meet."""

import warp as wp


@wp.kernel(enable_backward=False)
def carry(
    # Data in:
    body: wp.array(dtype=int),
    coordinate: wp.array(dtype=int),  # where the free joint of each stands in joint_q
    body_com: wp.array(dtype=wp.vec3),
    body_qd: wp.array(dtype=wp.spatial_vector),  # velocity of the centre of mass, and spin, in the world
    dt: float,
    # Data out:
    body_q: wp.array(dtype=wp.transform),
    joint_q: wp.array(dtype=float),
):
    """Move each body by its velocity over `dt` [s]; the centre of mass goes straight, the body turns about it."""
    k = wp.tid()
    index = body[k]
    pose, twist = body_q[index], body_qd[index]
    spin = wp.spatial_bottom(twist)
    center = wp.transform_point(pose, body_com[index]) + wp.spatial_top(twist) * dt
    turn = wp.transform_get_rotation(pose)
    speed = wp.length(spin)
    if speed > 0.0:
        turn = wp.normalize(wp.quat_from_axis_angle(spin / speed, speed * dt) * turn)
    place = center - wp.quat_rotate(turn, body_com[index])
    body_q[index] = wp.transform(place, turn)
    first = coordinate[k]
    for i in range(3):
        joint_q[first + i] = place[i]
    for i in range(4):
        joint_q[first + 3 + i] = turn[i]
