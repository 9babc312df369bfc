"""How loose bodies turn in a step, and where they are: in double precision, whatever MuJoCo's own."""

from typing import Any

import warp as wp

from wsim.kernels.free_turns import free_turn, in_axes, spin_after, spin_of

NO_FORCE = wp.constant(wp.float64(2.0**-126))  # [N] or [N m]: below single precision, where GPUs flush what is left
ALWAYS = wp.constant(2**30)  # steps, of what has been even since the start
SOON = wp.constant(2)  # steps, within which what ends came of its own beginning


@wp.struct
class Loose:
    """What the loose bodies are, in all worlds alike or in each."""

    place: wp.array(dtype=int)  # of each, in qpos
    freedom: wp.array(dtype=int)
    body: wp.array2d(dtype=int)  # Newton's, in each world
    center: wp.array2d(dtype=wp.vec3d)  # of mass, in its axes
    principal: wp.array2d(dtype=wp.quatd)
    moments: wp.array2d(dtype=wp.vec3d)
    arm: wp.array2d(dtype=wp.float64)  # by which a turn counts beside a way: its greatest radius of gyration [m]
    tied: wp.array(dtype=int)  # 1 where a rope or a loop may hold it, -1 where bodies are fixed to it, else 0


@wp.struct
class Noted:
    """What is known of how they went so far: of ways and turnings, in the world's axes."""

    known: wp.array3d(dtype=wp.vec3d)  # acceleration and turning when it was free, or began
    gain: wp.array3d(dtype=wp.vec3d)  # of velocity and angular momentum in half of the last step
    trend: wp.array3d(dtype=wp.vec3d)  # by which that has grown since the step before
    calm: wp.array2d(dtype=int)  # steps since the last jolt, or up to where a start is over
    behind: wp.array2d(dtype=int)  # for how many steps velocities lack that gain, -1 where they are not to
    shift: wp.array3d(dtype=wp.vec3d)  # what they were given so far without an impulse
    since: wp.array2d(dtype=int)  # the last exact step: steps of the first order
    ahead: wp.array(dtype=wp.spatial_vector)  # of Newton's bodies: what the step that comes adds to told velocities


@wp.func
def gained_along(gain: wp.vec3d, way: wp.vec3d, least: wp.float64) -> wp.vec3d:
    """What half a step gains along the velocity that it ends with: across it a contact turns that by itself.

    Where the body turns back within the step, all of it: a velocity that is nearly gone has no direction. Below `least`
    it does not turn back, but rests, and what it gains and loses is rounding of its contacts' forces.
    """
    square, gains = wp.dot(way, way), wp.dot(gain, gain)
    if square <= wp.float64(4.0) * gains and gains > least * least:
        return gain
    if square > wp.float64(0.0):
        return wp.dot(gain, way) / square * way
    return wp.vec3d()


@wp.func
def three(values: wp.array2d(dtype=Any), world: int, first: int) -> wp.vec3d:
    """Three numbers of a row."""
    return wp.vec3d(
        wp.float64(values[world, first]), wp.float64(values[world, first + 1]), wp.float64(values[world, first + 2])
    )


@wp.func
def no_force(forces: wp.array2d(dtype=Any), world: int, first: int) -> bool:
    """Whether none of a body's six is one."""
    none = bool(True)
    for i in range(6):
        none = none and forces[world, first + i] == forces.dtype(0.0)
    return none


@wp.func
def weighs_only(pushed: wp.array2d(dtype=Any), bias: wp.array2d(dtype=Any), world: int, first: int) -> bool:
    """Whether nothing but gravity and constraints acts on a body: `bias` has gravity, and its own turning."""
    only = bool(True)
    for i in range(6):
        only = only and wp.abs(wp.float64(pushed[world, first + i] + bias[world, first + i])) < NO_FORCE
    return only


@wp.func
def turn_of(true_q: wp.array2d(dtype=wp.float64), world: int, p: int) -> wp.quatd:
    """How a body that stands from `p` on in qpos is turned, xyzw."""
    return wp.quatd(true_q[world, p + 4], true_q[world, p + 5], true_q[world, p + 6], true_q[world, p + 3])


@wp.func
def catch_up(world: int, k: int, noted: Noted) -> bool:
    """Count what the velocities of a body lack as theirs; whether they do lack it."""
    if noted.behind[world, k] <= 0:
        return False
    noted.behind[world, k] = 0
    for i in range(2):
        noted.shift[world, k, i] = noted.shift[world, k, i] + noted.gain[world, k, i]
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
    loose: Loose,
    # Data out:
    noted: Noted,
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
        catch_up(world, row[k], noted)
        noted.since[world, row[k]] = 0
        noted.ahead[loose.body[world, row[k]]] = wp.spatial_vector()


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
    loose: Loose,
    noted: Noted,
    true_q: wp.array2d(dtype=wp.float64),
    true_qd: wp.array2d(dtype=wp.float64),
    centred: int,
    # Data out:
    qvel: wp.array2d(dtype=Any),
):
    """Give MuJoCo the velocities of where bodies are, or those that their steps go on from."""
    world, k = wp.tid()
    own, f = world % loose.moments.shape[0], loose.freedom[k]
    way, spin = wp.vec3d(), wp.vec3d()
    if centred * noted.behind[world, k] > 0:
        q = turn_of(true_q, world, loose.place[k])
        turning = wp.quat_rotate_inv(q, noted.gain[world, k, 1])
        spin = spin_of(loose.principal[own, k], loose.moments[own, k], turning)
        way = noted.gain[world, k, 0] - wp.quat_rotate(q, wp.cross(spin, loose.center[own, k]))
    for i in range(3):
        qvel[world, f + i] = qvel.dtype(true_qd[world, f + i] + way[i])
        qvel[world, f + 3 + i] = qvel.dtype(true_qd[world, f + 3 + i] + spin[i])


@wp.func
def goes_evenly(
    world: int,
    k: int,
    pull: wp.vec3d,
    spun: wp.vec3d,
    free: bool,
    alone: bool,
    even: wp.float64,
    loose: Loose,
    noted: Noted,
) -> bool:
    """Whether a body goes by the mean of its velocities before and after the step, and count the steps since it did.

    In free fall, and while a contact changes nothing, it does, and is where it should be. Of a force that changes with
    the place, as that of a gutter in which a ball rolls to and fro at w [rad/s] does, that would add w^2 h / 2 of the
    energy a second. There steps are the leapfrog's, v' = v + a h, x' = x + v' h, symplectic: v is the velocity of half
    a step before (Hairer, Lubich, Wanner 2003). So a velocity loses a h / 2 where such steps begin, and has it back, of
    the last a, where they end. A contact turns the velocity by itself, and only what is along the way counts; where it
    jolts, its impulses stand as they are.
    """
    arm = loose.arm[world % loose.moments.shape[0], k]
    off = wp.length(pull - noted.known[world, k, 0]) + arm * wp.length(spun - noted.known[world, k, 1])
    begins = noted.calm[world, k] < 0  # it may close a gap of rounding
    as_known = loose.tied[k] <= 0 and noted.since[world, k] == 0 and (begins or not (off > even))
    evenly = alone and (free or as_known)
    if evenly and (free or begins):
        noted.known[world, k, 0] = pull
        noted.known[world, k, 1] = spun
    noted.since[world, k] = wp.where(evenly, 0, noted.since[world, k] + 1)
    return evenly


@wp.func
def look_ahead(world: int, k: int, gained: wp.vec3d, spun_up: wp.vec3d, loose: Loose, noted: Noted):
    """Note by how much the velocity of the next step's end is ahead of the one told, if forces stay.

    By that velocity a body goes on, and so far a curved surface turns away from under it meanwhile. Of the velocity at
    the step's start what goes down would be turned too little and what goes up too much, by a h / v: the one is in the
    surface then, and is let out slowly, the other off it, and is back at once. A ball that slides to and fro at
    47 rad/s gained 2 % by that in 3 s.
    """
    share = wp.where(noted.behind[world, k] > 0, wp.float64(1.0), wp.float64(2.0))
    way, spin = share * gained, share * spun_up
    noted.ahead[loose.body[world, k]] = wp.spatial_vector(wp.vec3(way), wp.vec3(spin))


@wp.func
def calm_for(
    world: int, k: int, gained: wp.vec3d, spun_up: wp.vec3d, q: wp.quatd, most: wp.float64, loose: Loose, noted: Noted
) -> int:
    """Count the steps since the last jolt, where what half a step gives went on otherwise than in the step before.

    Before a start nothing is known; what goes on evenly at its end was calm before.
    """
    own, calm = world % loose.moments.shape[0], int(noted.calm[world, k])
    turning = wp.quat_rotate_inv(q, noted.gain[world, k, 1] + noted.trend[world, k, 1])
    spin = spin_of(loose.principal[own, k], loose.moments[own, k], turning)
    off = wp.length(gained - noted.gain[world, k, 0] - noted.trend[world, k, 0])
    if off + loose.arm[own, k] * wp.length(spun_up - spin) > most:
        calm = 0
    else:
        calm = wp.where(calm == -1, ALWAYS, wp.min(calm + 1, ALWAYS))
    noted.calm[world, k] = calm
    return calm


@wp.func
def change_order(world: int, k: int, lags: bool, free: bool, gained: wp.vec3d, turning: wp.vec3d, noted: Noted) -> int:
    """Note what half a step gains, and whether velocities lack it from now on; 1 where no longer, -1 where anew.

    What a body touches may go on by steps of another order, as a ram on its rail does. That they part then by a h / 2
    is a jolt itself, which ends it at once; until the body is free again it is not tried another time.
    """
    changes, steps = int(0), int(noted.behind[world, k])
    if not lags:
        if catch_up(world, k, noted):
            changes = 1
            if steps <= SOON:
                noted.behind[world, k] = -1
        if free:
            noted.behind[world, k] = 0
    elif steps > 0:
        noted.behind[world, k] = wp.min(steps + 1, SOON + 1)
    elif steps == 0:
        changes = -1
        noted.behind[world, k] = 1
        noted.shift[world, k, 0] = noted.shift[world, k, 0] - gained
        noted.shift[world, k, 1] = noted.shift[world, k, 1] - turning
    noted.trend[world, k, 0] = gained - noted.gain[world, k, 0]
    noted.trend[world, k, 1] = turning - noted.gain[world, k, 1]
    noted.gain[world, k, 0] = gained
    noted.gain[world, k, 1] = turning
    return changes


@wp.kernel(enable_backward=False)
def tumble(
    # Data in:
    loose: Loose,
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
    first, own = loose.freedom[k] + 3, world % loose.moments.shape[0]
    spin, axes, inertia = three(true_qd, world, first), loose.principal[own, k], loose.moments[own, k]
    turn = free_turn(axes, inertia, spin, h)
    gain = (wp.quat_rotate(turn, spin_after(axes, inertia, spin, turn)) - spin) / h
    change[world, k] = gain
    torque = in_axes(axes, inertia, gain) + wp.cross(spin, in_axes(axes, inertia, spin))
    for i in range(3):
        bias[world, first + i] = bias[world, first + i] - bias.dtype(torque[i])


@wp.func
def put(
    world: int,
    p: int,
    f: int,
    x: wp.vec3d,
    turn: wp.quatd,
    v: wp.vec3d,
    w: wp.vec3d,
    true_q: wp.array2d(dtype=wp.float64),
    true_qd: wp.array2d(dtype=wp.float64),
    qpos: wp.array2d(dtype=Any),
    qvel: wp.array2d(dtype=Any),
):
    """Write where a body is and how it goes."""
    for i in range(3):
        true_q[world, p + i] = x[i]
        true_q[world, p + 4 + i] = turn[i]
        true_qd[world, f + i] = v[i]
        true_qd[world, f + 3 + i] = w[i]
    true_q[world, p + 3] = turn[3]
    for i in range(7):
        qpos[world, p + i] = qpos.dtype(true_q[world, p + i])
    for i in range(6):
        qvel[world, f + i] = qvel.dtype(true_qd[world, f + i])


@wp.kernel(enable_backward=False)
def fly(
    # Data in:
    loose: Loose,
    h: wp.float64,
    change: wp.array2d(dtype=wp.vec3d),
    qacc: wp.array2d(dtype=Any),
    held: wp.array2d(dtype=Any),  # what constraints push with
    pushed: wp.array2d(dtype=Any),  # what all else pushes with
    bias: wp.array2d(dtype=Any),  # gravity's part of that, and the spin's own, the other way
    even: wp.float64,  # change of an acceleration that is none [m/s^2]
    patience: wp.float64,  # without a jolt, for which it is even [s]
    rough: wp.float64,  # by which an acceleration changes otherwise than in the step before, where it jolts [m/s^2]
    # Data out:
    noted: Noted,
    true_q: wp.array2d(dtype=wp.float64),
    true_qd: wp.array2d(dtype=wp.float64),
    qpos: wp.array2d(dtype=Any),
    qvel: wp.array2d(dtype=Any),
):
    """Advance the loose bodies: what pushes them changes their spin at the step's start, then they turn freely.

    Its centre of mass goes straight, or the body would not keep its momentum as it turns; only where a rope or a loop
    holds a body its origin does, whose velocity those have seen.
    """
    world, k = wp.tid()
    own = world % loose.moments.shape[0]
    p, f, c = loose.place[k], loose.freedom[k], loose.center[own, k]
    axes, inertia = loose.principal[own, k], loose.moments[own, k]
    v, w, x = three(true_qd, world, f), three(true_qd, world, f + 3), three(true_q, world, p)
    q = wp.normalize(turn_of(true_q, world, p))
    push, twist = three(qacc, world, f), three(qacc, world, f + 3)
    kick = twist - change[world, k]
    pull = push + wp.quat_rotate(q, wp.cross(twist, c) + wp.cross(w, wp.cross(w, c)))
    free, alone = no_force(held, world, f), weighs_only(pushed, bias, world, f)
    half, late = wp.float64(0.5) * h, wp.float64(0.0)
    if goes_evenly(world, k, pull, wp.quat_rotate(q, kick), free, alone, even, loose, noted):
        late = half
    gained, spun_up = half * pull, half * kick
    if not free:
        jolt = half * rough
        gained = gained_along(gained, v + wp.quat_rotate(q, wp.cross(w, c)) + h * pull, jolt)
        spun_up = gained_along(spun_up, w + h * kick, jolt / wp.max(loose.arm[own, k], wp.float64(1e-12)))
    calm = calm_for(world, k, gained, spun_up, q, half * rough, loose, noted)
    lags = late == wp.float64(0.0) and alone and loose.tied[k] == 0 and wp.float64(calm) * h >= patience
    before = wp.vec3d(noted.gain[world, k, 0])
    spun_before = spin_of(axes, inertia, wp.quat_rotate_inv(q, noted.gain[world, k, 1]))
    changes = change_order(world, k, lags, free, gained, wp.quat_rotate(q, in_axes(axes, inertia, spun_up)), noted)
    way = v + wp.quat_rotate(q, wp.cross(w, c)) + h * pull
    if changes > 0:
        way += before
        w += spun_before
    elif changes < 0:
        way -= gained
        w -= spun_up
    kicked = w + h * kick
    turn = free_turn(axes, inertia, kicked - late * kick, h)
    after = spin_after(axes, inertia, kicked, turn)
    end = wp.normalize(q * turn)
    if free or loose.tied[k] <= 0:
        x += wp.quat_rotate(q, c) + h * (way - late * pull) - wp.quat_rotate(end, c)
        v = way - wp.quat_rotate(end, wp.cross(after, c))
    else:
        v += h * push
        x += h * (v - late * push)
    put(world, p, f, x, end, v, after, true_q, true_qd, qpos, qvel)
    look_ahead(world, k, gained, wp.quat_rotate(q, spun_up), loose, noted)


# MuJoCo's numbers are double in C and single in Warp. Each kernel is made for both at once: Warp compiles a module anew
# whenever a kernel of it is launched with a type that it has not had, three to six times in a first run.
for _number in (float, wp.float64):
    _rows: Any = wp.array2d(dtype=_number)
    wp.overload(recall, {"qpos": _rows, "qvel": _rows})
    wp.overload(say, {"qvel": _rows})
    wp.overload(keep, {"values": _rows})
    wp.overload(tumble, {"bias": _rows})
    wp.overload(fly, dict.fromkeys(("qacc", "held", "pushed", "bias", "qpos", "qvel"), _rows))
