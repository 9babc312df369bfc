"""What policies see of robots, and the targets that they set: one robot in W worlds, all at once."""

import warp as wp

# What an entry of an observation is of; the first four are vectors of the base.
LINEAR = wp.constant(0)
ANGULAR = wp.constant(1)
GRAVITY = wp.constant(2)
COMMAND = wp.constant(3)
POSITION = wp.constant(4)
VELOCITY = wp.constant(5)
ACTION = wp.constant(6)


@wp.kernel(enable_backward=False)
def feel_base(
    # Data in:
    body_q: wp.array(dtype=wp.transform),
    body_qd: wp.array(dtype=wp.spatial_vector),  # velocity of the centre of mass first
    base: wp.array(dtype=int),
    com: wp.array(dtype=wp.vec3),  # of each base, in its own frame
    # Data out:
    felt: wp.array2d(dtype=wp.vec3),  # velocity of its origin, spin, and the way of gravity, in its own frame
    measured: wp.array(dtype=wp.vec3),  # velocity along its heading and to the left [m/s], yaw rate [rad/s]
    where: wp.array(dtype=wp.vec3),  # x, y [m], heading [rad]
):
    """Look at how each base moves and where it is."""
    world = wp.tid()
    pose = body_q[base[world]]
    motion = body_qd[base[world]]
    turn = wp.transform_get_rotation(pose)
    spin = wp.spatial_bottom(motion)
    velocity = wp.spatial_top(motion) - wp.cross(spin, wp.quat_rotate(turn, com[world]))
    felt[world, LINEAR] = wp.quat_rotate_inv(turn, velocity)
    felt[world, ANGULAR] = wp.quat_rotate_inv(turn, spin)
    felt[world, GRAVITY] = -wp.quat_rotate_inv(turn, wp.vec3(0.0, 0.0, 1.0))
    forward = wp.quat_rotate(turn, wp.vec3(1.0, 0.0, 0.0))
    level = wp.max(wp.sqrt(forward[0] * forward[0] + forward[1] * forward[1]), 1.0e-9)  # 0 where it stands on end
    c = forward[0] / level
    s = forward[1] / level
    measured[world] = wp.vec3(c * velocity[0] + s * velocity[1], c * velocity[1] - s * velocity[0], spin[2])
    at = wp.transform_get_translation(pose)
    where[world] = wp.vec3(at[0], at[1], wp.atan2(forward[1], forward[0]))


@wp.func
def cut(x: float, limit: float) -> float:
    """A number cut off at a limit, either way; what is none stays none, so that the run is seen to have failed."""
    if wp.isnan(x):
        return x
    return wp.clamp(x, -limit, limit)


@wp.kernel(enable_backward=False)
def observe(
    # Data in:
    kind: wp.array(dtype=int),  # of each entry, one of the above
    index: wp.array(dtype=int),  # its axis, or its joint among the policy's
    scale: wp.array(dtype=float),
    offset: wp.array(dtype=float),
    limit: float,
    felt: wp.array2d(dtype=wp.vec3),
    joint_q: wp.array(dtype=float),
    joint_qd: wp.array(dtype=float),
    coordinate: wp.array2d(dtype=int),  # of each joint of each world
    dof: wp.array2d(dtype=int),
    action: wp.array2d(dtype=float),  # of the last turn
    # Data out:
    seen: wp.array2d(dtype=float),
):
    """Write each entry of what a network sees: scale (value - offset), cut off at the limit."""
    world, entry = wp.tid()
    of = kind[entry]
    at = index[entry]
    value = float(0.0)
    if of <= COMMAND:
        value = felt[world, of][at]
    elif of == POSITION:
        value = joint_q[coordinate[world, at]]
    elif of == VELOCITY:
        value = joint_qd[dof[world, at]]
    else:
        value = action[world, at]
    seen[world, entry] = cut(scale[entry] * (value - offset[entry]), limit)


@wp.kernel(enable_backward=False)
def set_targets(
    # Data in:
    made: wp.array2d(dtype=float),  # by the network
    limit: float,
    scale: wp.array(dtype=float),
    offset: wp.array(dtype=float),
    place: wp.array2d(dtype=int),  # of each joint's target
    # Data out:
    action: wp.array2d(dtype=float),
    target: wp.array(dtype=float),
    moved: wp.array2d(dtype=float),  # by how much each target did
):
    """Set the servos to offset + scale action."""
    world, joint = wp.tid()
    own = cut(made[world, joint], limit)
    action[world, joint] = own
    goal = offset[joint] + scale[joint] * own
    at = place[world, joint]
    moved[world, joint] = goal - target[at]
    target[at] = goal
