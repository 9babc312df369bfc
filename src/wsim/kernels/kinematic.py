"""Kinematic bodies go where their velocity or their path takes them, whatever they meet."""

import warp as wp


@wp.func
def double(v: wp.vec3) -> wp.vec3d:
    """In double precision."""
    return wp.vec3d(wp.float64(v[0]), wp.float64(v[1]), wp.float64(v[2]))


@wp.func
def single(pose: wp.transformd) -> wp.transform:
    """In single precision."""
    p, q = wp.transform_get_translation(pose), wp.transform_get_rotation(pose)
    return wp.transform(
        wp.vec3(float(p[0]), float(p[1]), float(p[2])), wp.quat(float(q[0]), float(q[1]), float(q[2]), float(q[3]))
    )


@wp.kernel(enable_backward=False)
def carry(
    # Data in:
    body: wp.array(dtype=int),
    coordinate: wp.array(dtype=int),  # where the free joint of each stands in joint_q
    body_com: wp.array(dtype=wp.vec3),
    body_qd: wp.array(dtype=wp.spatial_vector),  # velocity of the centre of mass, and spin, in the world
    dt: wp.float64,
    # Data out:
    lost: wp.array(dtype=wp.transformd),  # what the state's single precision lacks of each pose, in its numbers
    body_q: wp.array(dtype=wp.transform),
    joint_q: wp.array(dtype=float),
):
    """Move each body by its velocity over `dt` [s]; the centre of mass goes straight, the body turns about it.

    Summed in single precision a place would be 2e-5 m off after 2 s, under what stands on it.
    """
    k = wp.tid()
    index = body[k]
    first = coordinate[k]
    pose, com, w = wp.transformd(), double(body_com[index]), double(wp.spatial_bottom(body_qd[index]))
    for i in range(7):
        pose[i] = wp.float64(joint_q[first + i]) + lost[k][i]
    turn = wp.normalize(wp.transform_get_rotation(pose))
    center = wp.transform_get_translation(pose) + wp.quat_rotate(turn, com)
    center += double(wp.spatial_top(body_qd[index])) * dt
    speed = wp.length(w)
    if speed > wp.float64(0.0):
        turn = wp.normalize(wp.quat_from_axis_angle(w / speed, speed * dt) * turn)
    true = wp.transformd(center - wp.quat_rotate(turn, com), turn)
    told = single(true)
    body_q[index] = told
    for i in range(7):
        joint_q[first + i] = told[i]
        pose[i] = true[i] - wp.float64(told[i])
    lost[k] = pose


@wp.func
def power_sum(coefficients: wp.array2d(dtype=wp.vec3d), piece: int, s: wp.float64) -> wp.vec3d:
    """A cubic of the time since a piece's key."""
    total = coefficients[piece, 2] + s * coefficients[piece, 3]
    total = coefficients[piece, 1] + s * total
    return coefficients[piece, 0] + s * total


@wp.func
def piece_at(times: wp.array(dtype=wp.float64), first: int, last: int, time: wp.float64) -> int:
    """The piece of a path, its key between `first` and `last`, that a time is in."""
    low = int(first)
    high = int(last)
    while high - low > 1:
        middle = (low + high) // 2
        if times[middle] <= time:
            low = middle
        else:
            high = middle
    return low


@wp.func
def place_at(
    path: int,
    time: wp.float64,
    start: wp.array(dtype=int),
    repeats: wp.array(dtype=int),
    times: wp.array(dtype=wp.float64),
    place: wp.array2d(dtype=wp.vec3d),
    base: wp.array(dtype=wp.quatd),
    turn: wp.array2d(dtype=wp.vec3d),
) -> wp.transformd:
    """Where a path is at a time; see `wsim.geometry.paths`."""
    first, last = start[path], start[path + 1] - 1
    begin, end = times[first], times[last]
    t = time
    if repeats[path] == 1 and t > end:
        t = begin + wp.mod(t - begin, end - begin)
    t = wp.min(wp.max(t, begin), end)
    k = piece_at(times, first, last, t)
    s = t - times[k]
    vector = power_sum(turn, k, s)
    angle = wp.length(vector)
    rotation = base[k]
    if angle > wp.float64(0.0):
        rotation = base[k] * wp.quat_from_axis_angle(vector / angle, angle)
    return wp.transformd(power_sum(place, k, s), rotation)


@wp.kernel(enable_backward=False)
def lead(
    # Data in:
    step: wp.array(dtype=int),  # steps taken so far
    dt: wp.float64,
    body: wp.array(dtype=int),
    path: wp.array(dtype=int),
    coordinate: wp.array(dtype=int),  # where the free joint of each stands in joint_q
    freedom: wp.array(dtype=int),  # and in joint_qd
    body_com: wp.array(dtype=wp.vec3),
    start: wp.array(dtype=int),
    repeats: wp.array(dtype=int),
    times: wp.array(dtype=wp.float64),
    place: wp.array2d(dtype=wp.vec3d),
    base: wp.array(dtype=wp.quatd),
    turn: wp.array2d(dtype=wp.vec3d),
    # Data out:
    body_q: wp.array(dtype=wp.transform),
    body_qd: wp.array(dtype=wp.spatial_vector),
    joint_q: wp.array(dtype=float),
    joint_qd: wp.array(dtype=float),
    target: wp.array(dtype=wp.transform),
):
    """Put each body where its path is, with the velocity that takes it in `dt` [s] to where its path is then."""
    k = wp.tid()
    index = body[k]
    now = wp.float64(step[0]) * dt
    here = place_at(path[k], now, start, repeats, times, place, base, turn)
    there = place_at(path[k], now + dt, start, repeats, times, place, base, turn)
    q0, q1 = wp.transform_get_rotation(here), wp.transform_get_rotation(there)
    com = double(body_com[index])
    way = (wp.transform_point(there, com) - wp.transform_point(here, com)) / dt
    between = q1 * wp.quat_inverse(q0)
    if between[3] < wp.float64(0.0):
        between = -between
    axis = wp.vec3d(between[0], between[1], between[2])
    sine = wp.length(axis)
    spin = wp.vec3d()
    if sine > wp.float64(0.0):
        spin = axis / sine * (wp.float64(2.0) * wp.atan2(sine, between[3]) / dt)
    v = wp.vec3(float(way[0]), float(way[1]), float(way[2]))
    w = wp.vec3(float(spin[0]), float(spin[1]), float(spin[2]))
    pose = single(here)
    body_q[index] = pose
    body_qd[index] = wp.spatial_vector(v, w)
    target[k] = single(there)
    first, free = coordinate[k], freedom[k]
    for i in range(7):
        joint_q[first + i] = pose[i]
    for i in range(3):
        joint_qd[free + i] = v[i]
        joint_qd[free + 3 + i] = w[i]


@wp.kernel(enable_backward=False)
def begin(
    # Data in:
    body: wp.array(dtype=int),
    path: wp.array(dtype=int),
    freedom: wp.array(dtype=int),  # where the free joint of each stands in joint_qd
    body_com: wp.array(dtype=wp.vec3),
    body_q: wp.array(dtype=wp.transform),
    speed: wp.array2d(dtype=wp.vec3),  # of each path at the start: of the body's origin, and its spin
    # Data out:
    body_qd: wp.array(dtype=wp.spatial_vector),
    joint_qd: wp.array(dtype=float),
):
    """Give each body the velocity that its path has at the start."""
    k = wp.tid()
    index = body[k]
    w = speed[path[k], 1]
    v = speed[path[k], 0] + wp.cross(w, wp.quat_rotate(wp.transform_get_rotation(body_q[index]), body_com[index]))
    body_qd[index] = wp.spatial_vector(v, w)
    for i in range(3):
        joint_qd[freedom[k] + i] = v[i]
        joint_qd[freedom[k] + 3 + i] = w[i]


@wp.kernel(enable_backward=False)
def arrive(
    # Data in:
    body: wp.array(dtype=int),
    coordinate: wp.array(dtype=int),
    target: wp.array(dtype=wp.transform),
    # Data out:
    body_q: wp.array(dtype=wp.transform),
    joint_q: wp.array(dtype=float),
    step: wp.array(dtype=int),
):
    """Put each body where its path is at the step's end, and count the step."""
    k = wp.tid()
    body_q[body[k]] = target[k]
    for i in range(7):
        joint_q[coordinate[k] + i] = target[k][i]
    if k == 0:
        step[0] = step[0] + 1


@wp.kernel(enable_backward=False)
def push(
    # Data in:
    freedom: wp.array(dtype=int),  # of kinematic bodies in qvel
    inertia: wp.array2d(dtype=float),  # of each, in all worlds alike or in each
    dt: float,
    # Data out:
    before: wp.array2d(dtype=float),  # the velocity of the step before, or not a number
    qvel: wp.array2d(dtype=float),
    qfrc_applied: wp.array2d(dtype=float),
):
    """Start with the velocity of the step before, with the force by which a step of `dt` [s] ends with that in qvel."""
    world, k = wp.tid()
    speed = qvel[world, freedom[k]]
    start = before[world, k]
    if wp.isnan(start):
        start = speed
    qfrc_applied[world, freedom[k]] = inertia[world % inertia.shape[0], k] * (speed - start) / dt
    qvel[world, freedom[k]] = start
    before[world, k] = speed
