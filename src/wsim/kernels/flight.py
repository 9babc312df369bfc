"""How loose bodies turn in a step, and where they are: in double precision, whatever MuJoCo's own."""

from typing import Any

import warp as wp

LARGEST_TURN = wp.constant(wp.float64(0.05))  # [rad] of a part of a step
MOST_PARTS = wp.constant(1000)
NO_FORCE = wp.constant(wp.float64(2.0**-126))  # [N] or [N m]: below single precision, where GPUs flush what is left


@wp.func
def about(axis: wp.vec3d, angle: wp.float64) -> wp.quatd:
    """The turn about a unit vector."""
    half = wp.float64(0.5) * angle
    return wp.quatd(axis * wp.sin(half), wp.cos(half))


@wp.func
def turned_by(vector: wp.vec3d) -> wp.quatd:
    """The turn about a vector by its length [rad]."""
    angle = wp.length(vector)
    if angle > wp.float64(0.0):
        return about(vector / angle, angle)
    return wp.quatd(wp.float64(0.0), wp.float64(0.0), wp.float64(0.0), wp.float64(1.0))


@wp.func
def free_turn(principal: wp.quatd, moments: wp.vec3d, spin: wp.vec3d, h: wp.float64) -> wp.quatd:
    """How a rigid body turns in `h` [s] if nothing acts on it, from its spin, in its own axes.

    The energy is |L|^2 / 2 I_2 plus a part of L_1 and one of L_3 alone, the moments in rising order. Each part turns
    the body about one axis, that of the first about L itself; these turns, put together symmetrically (Touma and Wisdom
    1994), keep the momentum and add no energy over time, and of a body with two equal moments they are the motion.
    """
    momentum = wp.cw_mul(moments, wp.quat_rotate_inv(principal, spin))
    turning = wp.length(spin) * h / LARGEST_TURN
    parts = MOST_PARTS
    if turning < wp.float64(MOST_PARTS):
        parts = wp.max(1, int(wp.ceil(turning)))
    s = h / wp.float64(parts)
    none = wp.float64(0.0)
    one = wp.float64(1.0)
    first, third = wp.vec3d(one, none, none), wp.vec3d(none, none, one)
    k1 = wp.float64(0.5) * s * (one / moments[0] - one / moments[1])
    k3 = s * (one / moments[2] - one / moments[1])
    turn = wp.quatd(none, none, none, one)
    for _ in range(parts):
        a = about(first, k1 * momentum[0])
        momentum = wp.quat_rotate_inv(a, momentum)
        b = about(third, k3 * momentum[2])
        momentum = wp.quat_rotate_inv(b, momentum)
        c = about(first, k1 * momentum[0])
        momentum = wp.quat_rotate_inv(c, momentum)
        turn = turn * a * b * c
    turn = turn * turned_by(momentum * (h / moments[1]))
    return principal * turn * wp.quat_inverse(principal)


ALWAYS = wp.constant(2**30)  # steps, of what has been even since the start
SETTLING = wp.constant(3)  # steps that a start takes


@wp.func
def in_axes(principal: wp.quatd, moments: wp.vec3d, spin: wp.vec3d) -> wp.vec3d:
    """Angular momentum about the centre of mass, in the body's axes."""
    return wp.quat_rotate(principal, wp.cw_mul(moments, wp.quat_rotate_inv(principal, spin)))


@wp.func
def spin_after(principal: wp.quatd, moments: wp.vec3d, spin: wp.vec3d, turn: wp.quatd) -> wp.vec3d:
    """Spin with which a free body ends its turn, in its own axes."""
    own = wp.quat_rotate_inv(principal, wp.quat_rotate_inv(turn, in_axes(principal, moments, spin)))
    return wp.quat_rotate(principal, wp.cw_div(own, moments))


@wp.func
def three(values: wp.array2d(dtype=wp.float64), world: int, first: int) -> wp.vec3d:
    """Three numbers of a row."""
    return wp.vec3d(values[world, first], values[world, first + 1], values[world, first + 2])


@wp.kernel(enable_backward=False)
def recall(
    # Data in:
    joint_q: wp.array(dtype=float),
    joint_qd: wp.array(dtype=float),
    told_q: wp.array(dtype=float),
    told_qd: wp.array(dtype=float),
    joints: int,  # of a world
    q_start: wp.array(dtype=int),
    qd_start: wp.array(dtype=int),
    place: wp.array(dtype=int),  # where a joint of MuJoCo's stands in qpos, -1 where its state is not ours
    freedom: wp.array(dtype=int),
    # Data out:
    true_q: wp.array2d(dtype=wp.float64),
    true_qd: wp.array2d(dtype=wp.float64),
    qpos: wp.array2d(dtype=Any),
    qvel: wp.array2d(dtype=Any),
):
    """Go on from the numbers of the last step's end, unless the state is no longer what was told of them."""
    world, k = wp.tid()
    if place[k] < 0:
        return
    joint = world * joints + k
    same = bool(True)
    for i in range(q_start[joint], q_start[joint + 1]):
        same = same and joint_q[i] == told_q[i]
    for i in range(q_start[joint + 1] - q_start[joint]):
        n = place[k] + i
        if same:
            qpos[world, n] = qpos.dtype(true_q[world, n])
        else:
            true_q[world, n] = wp.float64(qpos[world, n])
    for i in range(qd_start[joint], qd_start[joint + 1]):
        same = same and joint_qd[i] == told_qd[i]
    for i in range(qd_start[joint + 1] - qd_start[joint]):
        n = freedom[k] + i
        if same:
            qvel[world, n] = qvel.dtype(true_qd[world, n])
        else:
            true_qd[world, n] = wp.float64(qvel[world, n])


@wp.kernel(enable_backward=False)
def keep(
    # Data in:
    values: wp.array2d(dtype=Any),
    # Data out:
    kept: wp.array2d(dtype=wp.float64),
):
    """Keep MuJoCo's numbers, and better ones where they round to those."""
    world, k = wp.tid()
    if values.dtype(kept[world, k]) != values[world, k]:
        kept[world, k] = wp.float64(values[world, k])


@wp.kernel(enable_backward=False)
def tumble(
    # Data in:
    freedom: wp.array(dtype=int),  # of each loose body
    principal: wp.array2d(dtype=wp.quatd),  # in all worlds alike, or in each
    moments: wp.array2d(dtype=wp.vec3d),
    h: wp.float64,
    true_qd: wp.array2d(dtype=wp.float64),
    # Data out:
    change: wp.array2d(dtype=wp.vec3d),  # of the spin, by its own turning [rad/s^2]
    bias: wp.array2d(dtype=Any),
):
    """Put in place of the gyroscopic torque at a step's start that which gives the spin of its end.

    Both spins are along the body's axes as they are at the start: that is where contacts see them.
    """
    world, k = wp.tid()
    first, own = freedom[k] + 3, world % moments.shape[0]
    spin, axes, inertia = three(true_qd, world, first), principal[own, k], moments[own, k]
    turn = free_turn(axes, inertia, spin, h)
    gain = (wp.quat_rotate(turn, spin_after(axes, inertia, spin, turn)) - spin) / h
    change[world, k] = gain
    torque = in_axes(axes, inertia, gain) + wp.cross(spin, in_axes(axes, inertia, spin))
    for i in range(3):
        bias[world, first + i] = bias[world, first + i] - bias.dtype(torque[i])


@wp.kernel(enable_backward=False)
def fly(
    # Data in:
    place: wp.array(dtype=int),  # of each loose body, in qpos
    freedom: wp.array(dtype=int),
    center: wp.array2d(dtype=wp.vec3d),  # of mass, in its axes
    principal: wp.array2d(dtype=wp.quatd),  # in all worlds alike, or in each
    moments: wp.array2d(dtype=wp.vec3d),
    h: wp.float64,
    change: wp.array2d(dtype=wp.vec3d),
    qacc: wp.array2d(dtype=Any),
    held: wp.array2d(dtype=Any),  # what constraints push with
    pushed: wp.array2d(dtype=Any),  # what all else pushes with
    bias: wp.array2d(dtype=Any),  # gravity's part of that, and the spin's own, the other way
    tied: wp.array(dtype=int),  # whether a rope or a loop may hold it
    arm: wp.array2d(dtype=wp.float64),  # by which a turn counts beside a way: its greatest radius of gyration [m]
    even: wp.float64,  # change of an acceleration that is none [m/s^2]
    patience: wp.float64,  # for which it must have been even [s]
    # Data out:
    known: wp.array3d(dtype=wp.vec3d),  # acceleration and turning since when it is even, along the world's axes
    calm: wp.array2d(dtype=int),  # steps since then
    since: wp.array2d(dtype=int),  # the last exact step: steps of the first order
    true_q: wp.array2d(dtype=wp.float64),
    true_qd: wp.array2d(dtype=wp.float64),
    qpos: wp.array2d(dtype=Any),
    qvel: wp.array2d(dtype=Any),
):
    """Advance the loose bodies: what pushes them changes their spin at the step's start, then they turn freely.

    Its centre of mass goes straight, or the body would not keep its momentum as it turns; only where a rope or a loop
    holds a body its origin does, whose velocity those have seen.
    Under gravity and contacts alone, which jolt nothing after the step's blows, it goes by the mean of the velocities
    before and after, where it accelerates evenly: then it is where it should be. Of a force that changes with the
    place, a spring's, or that of a gutter in which a ball rolls to and fro at w [rad/s], that would add w^2 h / 2 of
    the energy a second; steps of the first order are symplectic and keep it.
    """
    world, k = wp.tid()
    own = world % moments.shape[0]
    p, f, c, axes, inertia = place[k], freedom[k], center[own, k], principal[own, k], moments[own, k]
    v, w, x = three(true_qd, world, f), three(true_qd, world, f + 3), three(true_q, world, p)
    q = wp.normalize(wp.quatd(true_q[world, p + 4], true_q[world, p + 5], true_q[world, p + 6], true_q[world, p + 3]))
    push, twist = wp.vec3d(), wp.vec3d()
    free, alone = bool(True), bool(True)
    for i in range(3):
        push[i] = wp.float64(qacc[world, f + i])
        twist[i] = wp.float64(qacc[world, f + 3 + i])
        free = free and held[world, f + i] == held.dtype(0.0) and held[world, f + 3 + i] == held.dtype(0.0)
        alone = alone and wp.abs(wp.float64(pushed[world, f + i] + bias[world, f + i])) < NO_FORCE
        alone = alone and wp.abs(wp.float64(pushed[world, f + 3 + i] + bias[world, f + 3 + i])) < NO_FORCE
    kick = twist - change[world, k]
    pull = push + wp.quat_rotate(q, wp.cross(twist, c) + wp.cross(w, wp.cross(w, c)))
    spun = wp.quat_rotate(q, kick)
    off = wp.length(pull - known[world, k, 0]) + arm[own, k] * wp.length(spun - known[world, k, 1])
    steps = calm[world, k]
    begins = steps >= ALWAYS - SETTLING and steps < ALWAYS  # it may close a gap of rounding
    if not (off <= even):
        known[world, k, 0] = pull
        known[world, k, 1] = spun
        steps = wp.where(begins, steps, -1)
    calm[world, k] = wp.where(wp.isnan(off), ALWAYS - SETTLING, wp.min(steps + 1, ALWAYS))
    late = wp.float64(0.0)  # how much of the step's change of velocity its way lacks
    if alone and (free or (tied[k] == 0 and wp.float64(calm[world, k]) * h >= patience)):
        late = wp.float64(0.5) * h
    since[world, k] = wp.where(late > wp.float64(0.0), 0, since[world, k] + 1)
    kicked = w + h * kick
    turn = free_turn(axes, inertia, kicked - late * kick, h)
    after = spin_after(axes, inertia, kicked, turn)
    end = wp.normalize(q * turn)
    if free or tied[k] == 0:
        way = v + wp.quat_rotate(q, wp.cross(w, c)) + h * pull
        x += wp.quat_rotate(q, c) + h * (way - late * pull) - wp.quat_rotate(end, c)
        v = way - wp.quat_rotate(end, wp.cross(after, c))
    else:
        v += h * push
        x += h * (v - late * push)
    for i in range(3):
        true_q[world, p + i] = x[i]
        true_q[world, p + 4 + i] = end[i]
        true_qd[world, f + i] = v[i]
        true_qd[world, f + 3 + i] = after[i]
    true_q[world, p + 3] = end[3]
    for i in range(7):
        qpos[world, p + i] = qpos.dtype(true_q[world, p + i])
    for i in range(6):
        qvel[world, f + i] = qvel.dtype(true_qd[world, f + i])


# MuJoCo's numbers are double in C and single in Warp. Each kernel is made for both at once: Warp compiles a module anew
# whenever a kernel of it is launched with a type that it has not had, three to six times in a first run.
for _number in (float, wp.float64):
    _rows: Any = wp.array2d(dtype=_number)
    wp.overload(recall, {"qpos": _rows, "qvel": _rows})
    wp.overload(keep, {"values": _rows})
    wp.overload(tumble, {"bias": _rows})
    wp.overload(fly, dict.fromkeys(("qacc", "held", "pushed", "bias", "qpos", "qvel"), _rows))
