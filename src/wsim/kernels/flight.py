"""How loose bodies turn in a step, and where they are: in double precision, whatever MuJoCo's own."""

from typing import Any

import warp as wp

from wsim.kernels.free_turns import free_turn, in_axes, spin_after, spin_of

NO_FORCE = wp.constant(wp.float64(2.0**-126))  # [N] or [N m]: below single precision, where GPUs flush what is left
ALWAYS = wp.constant(2**30)  # steps, of what has been even since the start


@wp.func
def along(vector: wp.vec3d, way: wp.vec3d) -> wp.vec3d:
    """The part of a vector along a way."""
    square = wp.dot(way, way)
    if square > wp.float64(0.0):
        return wp.dot(vector, way) / square * way
    return wp.vec3d()


@wp.func
def three(values: wp.array2d(dtype=wp.float64), world: int, first: int) -> wp.vec3d:
    """Three numbers of a row."""
    return wp.vec3d(values[world, first], values[world, first + 1], values[world, first + 2])


@wp.func
def catch_up(
    world: int,
    k: int,
    gain: wp.array3d(dtype=wp.vec3d),
    behind: wp.array2d(dtype=int),
    shift: wp.array3d(dtype=wp.vec3d),
) -> bool:
    """Count what the velocities of a body lack as theirs; whether they do lack it."""
    if behind[world, k] == 0:
        return False
    behind[world, k] = 0
    for i in range(2):
        shift[world, k, i] = shift[world, k, i] + gain[world, k, i]
    return True


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
    row: wp.array(dtype=int),  # of its body among the loose ones, or below 0
    gain: wp.array3d(dtype=wp.vec3d),
    # Data out:
    behind: wp.array2d(dtype=int),
    shift: wp.array3d(dtype=wp.vec3d),
    since: wp.array2d(dtype=int),
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
    if not same and row[k] >= 0:
        catch_up(world, row[k], gain, behind, shift)
        since[world, row[k]] = 0


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
def say(
    # Data in:
    place: wp.array(dtype=int),  # of each loose body, in qpos
    freedom: wp.array(dtype=int),
    center: wp.array2d(dtype=wp.vec3d),
    principal: wp.array2d(dtype=wp.quatd),
    moments: wp.array2d(dtype=wp.vec3d),
    true_q: wp.array2d(dtype=wp.float64),
    true_qd: wp.array2d(dtype=wp.float64),
    gain: wp.array3d(dtype=wp.vec3d),
    behind: wp.array2d(dtype=int),
    centred: int,
    # Data out:
    qvel: wp.array2d(dtype=Any),
):
    """Give MuJoCo the velocities of where bodies are, or those that their steps go on from."""
    world, k = wp.tid()
    own = world % moments.shape[0]
    p, f = place[k], freedom[k]
    q = wp.quatd(true_q[world, p + 4], true_q[world, p + 5], true_q[world, p + 6], true_q[world, p + 3])
    way, spin = wp.vec3d(), wp.vec3d()
    if centred * behind[world, k] > 0:
        spin = spin_of(principal[own, k], moments[own, k], wp.quat_rotate_inv(q, gain[world, k, 1]))
        way = gain[world, k, 0] - wp.quat_rotate(q, wp.cross(spin, center[own, k]))
    for i in range(3):
        qvel[world, f + i] = qvel.dtype(true_qd[world, f + i] + way[i])
        qvel[world, f + 3 + i] = qvel.dtype(true_qd[world, f + 3 + i] + spin[i])


@wp.func
def change_order(
    world: int,
    k: int,
    lags: bool,
    gained: wp.vec3d,
    turning: wp.vec3d,
    # Data out:
    gain: wp.array3d(dtype=wp.vec3d),
    behind: wp.array2d(dtype=int),
    shift: wp.array3d(dtype=wp.vec3d),
) -> int:
    """Note what half a step gains, and whether velocities lack it from now on; 1 where no longer, -1 where anew."""
    changes = int(0)
    if not lags:
        if catch_up(world, k, gain, behind, shift):
            changes = 1
    elif behind[world, k] == 0:
        changes = -1
        behind[world, k] = 1
        shift[world, k, 0] = shift[world, k, 0] - gained
        shift[world, k, 1] = shift[world, k, 1] - turning
    gain[world, k, 0] = gained
    gain[world, k, 1] = turning
    return changes


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
    tied: wp.array(dtype=int),  # 1 where a rope or a loop may hold it, -1 where bodies are fixed to it, else 0
    arm: wp.array2d(dtype=wp.float64),  # by which a turn counts beside a way: its greatest radius of gyration [m]
    even: wp.float64,  # change of an acceleration that is none [m/s^2]
    patience: wp.float64,  # without a jolt, for which it is even [s]
    rough: wp.float64,  # change of an acceleration in a step, from which on it is a jolt [m/s^2]
    # Data out:
    known: wp.array3d(dtype=wp.vec3d),  # acceleration and turning when it was free, or began, in the world's axes
    gain: wp.array3d(dtype=wp.vec3d),  # of velocity and angular momentum in half of the last step, likewise
    calm: wp.array2d(dtype=int),  # steps since the last jolt, or up to where a start is over
    behind: wp.array2d(dtype=int),  # whether velocities lack that
    shift: wp.array3d(dtype=wp.vec3d),  # what they were given so far without an impulse
    since: wp.array2d(dtype=int),  # the last exact step: steps of the first order
    true_q: wp.array2d(dtype=wp.float64),
    true_qd: wp.array2d(dtype=wp.float64),
    qpos: wp.array2d(dtype=Any),
    qvel: wp.array2d(dtype=Any),
):
    """Advance the loose bodies: what pushes them changes their spin at the step's start, then they turn freely.

    Its centre of mass goes straight, or the body would not keep its momentum as it turns; only where a rope or a loop
    holds a body its origin does, whose velocity those have seen.
    In free fall, and while a contact changes nothing, it goes by the mean of the velocities before and after, and is
    where it should be. Of a force that changes with the place, as that of a gutter in which a ball rolls to and fro at
    w [rad/s] does, that would add w^2 h / 2 of the energy a second. There steps are the leapfrog's, v' = v + a h,
    x' = x + v' h, symplectic: v is the velocity of half a step before (Hairer, Lubich, Wanner 2003). So a velocity
    loses a h / 2 where such steps begin, and has it back, of the last a, where they end. A contact turns the velocity
    by itself, and only what is along the way counts; where it jolts, its impulses stand as they are.
    """
    world, k = wp.tid()
    own = world % moments.shape[0]
    p, f, c, axes, inertia = place[k], freedom[k], center[own, k], principal[own, k], moments[own, k]
    v, w, x = three(true_qd, world, f), three(true_qd, world, f + 3), three(true_q, world, p)
    start = w
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
    late = wp.float64(0.0)  # how much of the step's change of velocity its way lacks
    begins = calm[world, k] < 0  # it may close a gap of rounding
    if alone and (free or (tied[k] <= 0 and since[world, k] == 0 and (begins or not (off > even)))):
        late = wp.float64(0.5) * h
        if free or begins:
            known[world, k, 0] = pull
            known[world, k, 1] = spun
    centred = free or tied[k] <= 0
    gained, spun_up = wp.float64(0.5) * h * pull, wp.float64(0.5) * h * kick
    if not free:
        gained = along(gained, v + wp.quat_rotate(q, wp.cross(w, c)) + h * pull)
        spun_up = along(spun_up, w + h * kick)
    turning = wp.quat_rotate(q, in_axes(axes, inertia, spun_up))
    before = wp.vec3d(gain[world, k, 0])
    spun_before = spin_of(axes, inertia, wp.quat_rotate_inv(q, gain[world, k, 1]))
    jolt = wp.length(gained - before) + arm[own, k] * wp.length(spun_up - spun_before)
    rests = begins or not (jolt > wp.float64(0.5) * h * rough)
    calm[world, k] = wp.where(rests, wp.min(calm[world, k] + 1, ALWAYS), 0)
    lasts = wp.float64(calm[world, k]) * h >= patience
    lags = late == wp.float64(0.0) and alone and tied[k] == 0 and lasts
    lacks = wp.vec3d()
    changes = change_order(world, k, lags, gained, turning, gain, behind, shift)
    if changes > 0:
        lacks = before
        w = w + spun_before
    elif changes < 0:
        lacks = -gained
        w = w - spun_up
    since[world, k] = wp.where(late > wp.float64(0.0), 0, since[world, k] + 1)
    kicked = w + h * kick
    turn = free_turn(axes, inertia, kicked - late * kick, h)
    after = spin_after(axes, inertia, kicked, turn)
    end = wp.normalize(q * turn)
    if centred:
        way = lacks + v + wp.quat_rotate(q, wp.cross(start, c)) + h * pull
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
    wp.overload(say, {"qvel": _rows})
    wp.overload(keep, {"values": _rows})
    wp.overload(tumble, {"bias": _rows})
    wp.overload(fly, dict.fromkeys(("qacc", "held", "pushed", "bias", "qpos", "qvel"), _rows))
