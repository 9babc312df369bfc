"""What schedules set, step by step, and the events that start their clocks, of all worlds at once.

A step of length h is given the mean of a quantity over it, so that impulses and ways are those of the key frames.
"""

import warp as wp

POSITION = wp.constant(0)  # what each schedule sets
VELOCITY = wp.constant(1)
EFFORT = wp.constant(2)
RELEASE = wp.constant(3)
FORCE = wp.constant(4)
TORQUE = wp.constant(5)
GOES = wp.constant(6)
TURNS = wp.constant(7)
SURFACE = wp.constant(8)
FRICTION = wp.constant(9)

NONE = wp.constant(0)  # what starts its clock
TOUCH = wp.constant(1)
PLACE = wp.constant(2)
JOINT = wp.constant(3)
START = wp.constant(4)
END = wp.constant(5)

WAITS = wp.constant(wp.float64(-1.0))  # of a clock that no event has started yet
HAIR = wp.constant(wp.float64(1.0e-9))  # [s]: rounding of a time


@wp.struct
class Keys:
    """Key frames of S schedules in N worlds, K at most."""

    times: wp.array3d(dtype=wp.float64)  # (N, S, K) [s]
    values: wp.array3d(dtype=wp.vec3d)
    count: wp.array2d(dtype=int)  # of the keys of each
    linear: wp.array2d(dtype=int)
    base: wp.array2d(dtype=wp.vec3d)  # what is stated, before the first key


@wp.struct
class Targets:
    """What each of S schedules sets."""

    kind: wp.array(dtype=int)
    index: wp.array2d(dtype=int)  # (W, S): a body, a degree of freedom or a target of the model; -1 for none
    second: wp.array2d(dtype=int)  # (W, S): where the free joint of a kinematic body stands in joint_qd; of a position
    arm: wp.array2d(dtype=wp.vec3)  # (N, S): from the centre of mass to where a force acts, in the body's axes [m]


@wp.func
def sum_between(keys: Keys, n: int, s: int, start: wp.float64, end: wp.float64) -> wp.vec3d:
    """The integral of a schedule between two times of its own clock; before its first key it is as stated."""
    total = keys.base[n, s] * wp.clamp(keys.times[n, s, 0] - start, wp.float64(0.0), end - start)
    for k in range(keys.count[n, s]):
        key = keys.times[n, s, k]
        if end <= key:
            break
        since, until, value = wp.max(start, key), wp.float64(end), wp.vec3d(keys.values[n, s, k])
        if k + 1 < keys.count[n, s]:
            after = keys.times[n, s, k + 1]
            until = wp.min(end, after)
            if keys.linear[n, s] != 0:  # a straight line's mean is its value in the middle
                share = (wp.float64(0.5) * (since + until) - key) / (after - key)
                value += (keys.values[n, s, k + 1] - value) * share
        total += value * wp.max(until - since, wp.float64(0.0))
    return total


@wp.kernel(enable_backward=False)
def find_means(
    # Data in:
    step: wp.array(dtype=int),
    h: wp.float64,
    keys: Keys,
    begin: wp.array2d(dtype=wp.float64),
    # Data out:
    acts: wp.array2d(dtype=int),
    mean: wp.array2d(dtype=wp.vec3d),
):
    """Which schedules act in a step of `h` [s], and the mean of each over it, (W, S)."""
    w, s = wp.tid()
    n = w % keys.times.shape[0]
    acts[w, s] = 0
    mean[w, s] = wp.vec3d()
    if begin[w, s] < wp.float64(0.0):
        return
    start = wp.float64(step[0]) * h - begin[w, s]
    if start + h <= keys.times[n, s, 0] + HAIR:
        return
    acts[w, s] = 1
    mean[w, s] = sum_between(keys, n, s, start, start + h) / h


@wp.kernel(enable_backward=False)
def push_bodies(
    # Data in:
    acts: wp.array2d(dtype=int),
    mean: wp.array2d(dtype=wp.vec3d),
    targets: Targets,
    body_q: wp.array(dtype=wp.transform),
    # Data out:
    given: wp.array(dtype=wp.spatial_vector),
    body_f: wp.array(dtype=wp.spatial_vector),
):
    """Add the forces and torques of a step to what acts at centres of mass."""
    w, s = wp.tid()
    if acts[w, s] == 0 or (targets.kind[s] != FORCE and targets.kind[s] != TORQUE):
        return
    body = targets.index[w, s]
    push = wp.vec3(mean[w, s])
    wrench = wp.spatial_vector(wp.vec3(), push)
    if targets.kind[s] == FORCE:
        arm = wp.quat_rotate(wp.transform_get_rotation(body_q[body]), targets.arm[w % targets.arm.shape[0], s])
        wrench = wp.spatial_vector(push, wp.cross(arm, push))
    wp.atomic_add(given, body, wrench)
    wp.atomic_add(body_f, body, wrench)


@wp.kernel(enable_backward=False)
def set_joints(
    # Data in:
    acts: wp.array2d(dtype=int),
    mean: wp.array2d(dtype=wp.vec3d),
    targets: Targets,
    stiffness: wp.array(dtype=float),  # of each degree of freedom
    damping: wp.array(dtype=float),
    strength: wp.array(dtype=float),
    # Data out:
    target_q: wp.array(dtype=float),
    target_qd: wp.array(dtype=float),
    joint_f: wp.array(dtype=float),
    last: wp.array(dtype=float),  # efforts that drives' next changes are from
):
    """Set where servos go, how fast motors turn, and what pushes joints beside them."""
    w, s = wp.tid()
    kind = targets.kind[s]
    if acts[w, s] == 0 or kind > EFFORT:
        return
    dof = targets.index[w, s]
    value = float(mean[w, s][0])
    jump = float(0.0)
    if kind == POSITION:
        at = targets.second[w, s]
        jump = stiffness[dof] * (value - target_q[at])
        target_q[at] = value
    elif kind == VELOCITY:
        jump = damping[dof] * (value - target_qd[dof])
        target_qd[dof] = value
    else:
        joint_f[dof] = value
    if jump != 0.0:
        wp.atomic_add(last, dof, jump)
        last[dof] = wp.clamp(last[dof], -strength[dof], strength[dof])


@wp.kernel(enable_backward=False)
def lead_bodies(
    # Data in:
    acts: wp.array2d(dtype=int),
    mean: wp.array2d(dtype=wp.vec3d),
    targets: Targets,
    # Data out:
    body_qd: wp.array(dtype=wp.spatial_vector),
    joint_qd: wp.array(dtype=float),
):
    """Give kinematic bodies their velocities."""
    w, s = wp.tid()
    kind = targets.kind[s]
    if acts[w, s] == 0 or (kind != GOES and kind != TURNS):
        return
    body, free, value = targets.index[w, s], targets.second[w, s], wp.vec3(mean[w, s])
    offset = int(0)
    if kind == TURNS:
        offset = 3
    for i in range(3):
        body_qd[body][offset + i] = value[i]
        joint_qd[free + offset + i] = value[i]


@wp.kernel(enable_backward=False)
def run_surfaces(
    # Data in:
    acts: wp.array2d(dtype=int),
    mean: wp.array2d(dtype=wp.vec3d),
    schedule: wp.array(dtype=int),  # of each geom that runs
    geom: wp.array(dtype=int),
    turn: wp.array2d(dtype=wp.quat),  # (N, geoms that run): from the object's axes to the geom's
    # Data out:
    speed: wp.array2d(dtype=wp.spatial_vector),  # (W, geoms), in each one's own axes
):
    """Let the surfaces of what never moves run as belts do."""
    w, k = wp.tid()
    s = schedule[k]
    if acts[w, s] != 0:
        value = wp.quat_rotate(turn[w % turn.shape[0], k], wp.vec3(mean[w, s]))
        speed[w, geom[k]] = wp.spatial_vector(value, wp.vec3())


@wp.kernel(enable_backward=False)
def rub_pairs(
    # Data in:
    acts: wp.array2d(dtype=int),
    mean: wp.array2d(dtype=wp.vec3d),
    schedule: wp.array(dtype=int),
    classes: wp.array2d(dtype=int),  # (pairs of classes, 2)
    least: float,
    # Data out:
    law: wp.array3d(dtype=wp.vec3),  # (W, classes, classes)
):
    """Set the friction of pairs of surfaces."""
    w, k = wp.tid()
    s = schedule[k]
    if acts[w, s] != 0:
        one, two, value = classes[k, 0], classes[k, 1], wp.max(float(mean[w, s][0]), least)
        law[w, one, two][0] = value
        law[w, two, one][0] = value


@wp.kernel(enable_backward=False)
def release_joints(
    # Data in:
    step: wp.array(dtype=int),
    h: wp.float64,
    keys: Keys,
    begin: wp.array2d(dtype=wp.float64),
    schedule: wp.array(dtype=int),
    joint: wp.array(dtype=int),  # among those that may break
    constraint: wp.array2d(dtype=int),  # of each of those, the second -1 where there is one alone
    # Data out:
    broken: wp.array2d(dtype=int),
    active: wp.array2d(dtype=bool),
):
    """Let joints go in the first step that begins when their time has come, or after."""
    w, k = wp.tid()
    s, own = schedule[k], joint[k]
    due = begin[w, s] + keys.times[w % keys.times.shape[0], s, 0]
    if begin[w, s] < wp.float64(0.0) or wp.float64(step[0]) * h < due - HAIR or broken[w, own] != 0:
        return
    broken[w, own] = 1
    active[w, constraint[own, 0]] = False
    if constraint[own, 1] >= 0:
        active[w, constraint[own, 1]] = False


@wp.struct
class Events:
    """What starts the clocks of S schedules."""

    kind: wp.array(dtype=int)
    index: wp.array2d(dtype=int)  # (W, S): a body, a coordinate; of a touch and a schedule its number
    axis: wp.array(dtype=int)
    value: wp.array2d(dtype=float)  # (N, S)
    side: wp.array(dtype=float)  # 1: above, -1: below
    delay: wp.array2d(dtype=wp.float64)  # (N, S) [s]


@wp.kernel(enable_backward=False)
def watch(
    # Data in:
    first: int,  # 1 at the start of the run, 0 at the end of a step
    h: wp.float64,
    keys: Keys,
    events: Events,
    body_q: wp.array(dtype=wp.transform),
    joint_q: wp.array(dtype=float),
    met: wp.array2d(dtype=int),  # (W, touches)
    # Data out:
    step: wp.array(dtype=int),
    before: wp.array2d(dtype=float),  # how far beyond its value each was a step ago
    begin: wp.array2d(dtype=wp.float64),
):
    """Start the clocks whose events have come, in the order of the schedules, and count the step.

    No clock starts before the end of the step in which its event came, less its delay.
    """
    w = wp.tid()
    n = w % keys.times.shape[0]
    end = wp.float64(step[w] + 1 - first) * h
    for s in range(events.kind.shape[0]):
        kind = events.kind[s]
        if kind == NONE or begin[w, s] >= wp.float64(0.0):
            continue
        came = WAITS
        at = events.index[w, s]
        if kind == TOUCH:
            if met[w, at] != 0:
                came = end
        elif kind == START or kind == END:  # noqa: SIM109 - Warp has no tuples
            if begin[w, at] >= wp.float64(0.0):
                key = int(0)
                if kind == END:
                    key = keys.count[n, at] - 1
                came = begin[w, at] + keys.times[n, at, key]
        else:
            place = float(0.0)
            if kind == PLACE:
                place = wp.transform_get_translation(body_q[at])[events.axis[s]]
            else:
                place = joint_q[at]
            beyond = events.side[s] * (place - events.value[n, s])
            if beyond >= 0.0:
                came = end
                if first == 0 and before[w, s] < 0.0:
                    came = end - h * wp.float64(beyond / (beyond - before[w, s]))
            before[w, s] = beyond
        if came >= wp.float64(0.0):
            begin[w, s] = wp.max(came + events.delay[n, s], end)
    step[w] = step[w] + 1 - first


@wp.kernel(enable_backward=False)
def note_meetings(
    # Data in:
    contacts: wp.array(dtype=int),  # how many there are
    world: wp.array(dtype=int),
    geom: wp.array(dtype=wp.vec2i),
    rows: wp.array2d(dtype=int),
    force: wp.array2d(dtype=float),
    side: wp.array2d(dtype=int),  # (touches, geoms): bit 1 of the first object's, bit 2 of the second's
    # Data out:
    met: wp.array2d(dtype=int),
):
    """Note which pairs of objects press on each other."""
    k = wp.tid()
    if k >= contacts[0] or rows[k, 0] < 0:
        return
    w = world[k]
    if force[w, rows[k, 0]] <= 0.0:
        return
    for e in range(side.shape[0]):
        one, two = side[e, geom[k][0]], side[e, geom[k][1]]
        if ((one & 1) != 0 and (two & 2) != 0) or ((one & 2) != 0 and (two & 1) != 0):
            met[w, e] = 1
