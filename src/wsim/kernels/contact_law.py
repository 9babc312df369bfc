"""The law of contact on MuJoCo Warp's constraint rows: what the solver should reach, and how the contacts slip.

A row's reference acceleration is (target - velocity) / h: the velocity that the step should end with, if a force that
the contact can exert reaches it. See `wsim.solvers.contact_law` for the law and its sources.
"""

import warp as wp

ELLIPTIC = wp.constant(7)  # mjtConstraint: mjCNSTR_CONTACT_ELLIPTIC
FRICTIONLESS = wp.constant(5)  # mjCNSTR_CONTACT_FRICTIONLESS
RUBBING = wp.constant(1)  # mjCNSTR_FRICTION_DOF
LIMIT = wp.constant(3)  # mjCNSTR_LIMIT_JOINT
TAUT = wp.constant(4)  # mjCNSTR_LIMIT_TENDON
CYLINDER = wp.constant(5)  # mjtGeom: mjGEOM_CYLINDER
ON_END = wp.constant(0.70710678)  # of a cylinder, as wsim.solvers.contact_law has it
LATER = wp.constant(1.0e3)  # [m/s], far below what any contact is asked for: it takes no part
NEVER = wp.constant(2**30)  # steps
OPEN = wp.constant(0)  # of a world's search for the slip: whether it goes on,
TURNS = wp.constant(1)  # solutions with a guess so far, -1 before one without friction,
NEARER = wp.constant(2)  # whether the last of them is the nearest,
BLOWS = wp.constant(3)  # whether surfaces meet that bounce,
HITS = wp.constant(4)  # whether this round of blows is one of the world's, and
ROUNDS = wp.constant(5)  # how many it has had in this step,
ENDED = wp.constant(6)  # and whether the last of them ended all approaches
vec5 = wp.types.vector(length=5, dtype=float)


@wp.func
def settling(distance: float, h: float, settle_time: float, settle_speed: float) -> float:
    """Speed at which a contact may close, or must open, without a bounce [m/s]."""
    if distance > 0.0:
        return -distance / h
    return wp.min(-distance / settle_time, settle_speed)


@wp.func
def meets(distance: float, speed: float, restitution: float, h: float, threshold: float) -> bool:
    """Whether two surfaces meet in this step, nearer to its start than to its end."""
    after = distance + speed * h
    return restitution > 0.0 and speed < -threshold and after < 0.0 and -after > distance


@wp.func
def stops(goal: float, speed: float, threshold: float) -> bool:
    """Whether a step ends an approach that a step of falling does not make."""
    return speed < -threshold and goal - speed > threshold


@wp.func
def rebound(distance: float, speed: float, free: float, restitution: float, h: float, smooth: bool) -> float:
    """Speed right after surfaces meet, for which the energy of the fall comes back e^2 times [m/s].

    Steps of the first order follow the parabola on which the speed is v + a h / 2, others that of v: see `rebounds` of
    `wsim.solvers.targets`.
    """
    half = wp.where(smooth, 0.0, 0.5 * free * h)
    fall = 2.0 * wp.max(distance, speed * h) * free  # no deeper than this approach has brought it
    before = speed + half
    squared = restitution * restitution * (before * before - fall) + fall
    return wp.max(wp.sqrt(wp.max(squared, 0.0)) - half, 0.0)


@wp.func
def target_speed(
    distance: float, speed: float, restitution: float, h: float, threshold: float, settle_time: float,
    settle_speed: float,
) -> float:  # fmt: skip
    """Normal speed that a contact should end the step with after its blows: see `targets` of `wsim.solvers.targets`."""
    goal = settling(distance, h, settle_time, settle_speed)
    waits = restitution > 0.0 and distance > 0.0 and speed < -threshold
    if waits and not meets(distance, speed, restitution, h, threshold):
        return wp.min(goal, 4.0 * speed)
    return goal


@wp.func
def whole(goal: float, speed: float, least: float) -> float:
    """The same where no blow is shared with the next step: see `at_once` of `wsim.solvers.targets`."""
    if speed < -least and goal - speed > least:
        return 0.0
    return goal


@wp.func
def along(
    world: int,
    row: int,
    sparse: bool,
    nv: int,
    jacobian: wp.array3d(dtype=float),
    row_nnz: wp.array2d(dtype=int),
    row_start: wp.array2d(dtype=int),
    column: wp.array3d(dtype=int),
    vector: wp.array2d(dtype=float),
) -> float:
    """A row of the constraints' Jacobian times a vector over the degrees of freedom."""
    total = float(0.0)
    if sparse:
        first = row_start[world, row]
        for k in range(row_nnz[world, row]):
            total += jacobian[world, 0, first + k] * vector[world, column[world, 0, first + k]]
    else:
        for k in range(nv):
            total += jacobian[world, row, k] * vector[world, k]
    return total


@wp.func
def bent(turn: wp.mat33, frame: wp.mat33, curvature: float, kind: int) -> float:
    """Curvature of a surface where it touches [1/m]: none of a cylinder that stands on its end."""
    if kind == CYLINDER and wp.abs(wp.dot(wp.vec3(turn[0, 2], turn[1, 2], turn[2, 2]), frame[0])) > ON_END:
        return 0.0
    return curvature


@wp.func
def since_exact(since: wp.array2d(dtype=int), world: int, loose: int) -> int:
    """Steps of the first order since a body of a row among the loose ones went exactly; -1 goes as stated."""
    if loose >= 0:
        return since[world, loose]
    return wp.where(loose == -1, 0, NEVER)


@wp.func
def coefficients(pair: wp.vec3, bend: float, smallest: float) -> vec5:
    """Of the rows of friction: two of sliding, one of spinning [m], two of rolling [m]; `bend` is 1/R1 + 1/R2 [1/m]."""
    roll = float(0.0)
    if pair[2] > 0.0 and bend > 0.0:
        roll = pair[2] / bend
    slide = wp.max(pair[0], smallest)
    least = smallest / wp.max(bend, 1.0)  # of the radius: what is small rolls as freely
    rolling = wp.max(roll, least)
    return vec5(slide, slide, wp.max(wp.pi * pair[0] * roll, least), rolling, rolling)


@wp.kernel(enable_backward=False)
def look(
    # Data in:
    count: wp.array(dtype=int),
    contact_world: wp.array(dtype=int),
    contact_geom: wp.array(dtype=wp.vec2i),
    contact_dist: wp.array(dtype=float),
    contact_row: wp.array2d(dtype=int),
    velocity: wp.array2d(dtype=float),
    timestep: wp.array(dtype=float),
    bow: wp.array(dtype=float),
    geom_class: wp.array2d(dtype=int),  # of all worlds alike, or of each; so the law and the curvature
    law: wp.array3d(dtype=wp.vec3),
    instant: bool,
    most_rounds: int,
    steady: float,
    threshold: float,
    settle_time: float,
    settle_speed: float,
    # Data out:
    state: wp.array2d(dtype=int),
    seeking: wp.array(dtype=int),
):
    """Note which worlds have contacts in the step, or blows in this instant, and whether something hits."""
    k = wp.tid()
    if k >= count[0]:
        return
    row = contact_row[k, 0]
    if row < 0:
        return
    world, geom = contact_world[k], contact_geom[k]
    own = world % law.shape[0]
    restitution = law[own, geom_class[own, geom[0]], geom_class[own, geom[1]]][1]
    h = timestep[world % timestep.shape[0]]
    distance, speed, least = contact_dist[k], velocity[world, row] + bow[k], threshold * h
    bounces = instant and meets(distance, speed, restitution, h, least)
    goal = target_speed(distance, speed, restitution, h, least, settle_time, settle_speed)
    done = state[world, ROUNDS] >= most_rounds or (
        not bounces and (state[world, ENDED] > 0 or goal - speed < steady * h)
    )
    if instant and done:
        return
    state[world, OPEN] = 1
    seeking[0] = 1
    if instant:
        state[world, HITS] = 1
        if bounces:
            state[world, BLOWS] = 1
        if bounces or stops(goal, speed, least):
            state[world, TURNS] = -1


@wp.kernel(enable_backward=False)
def aim(
    # Data in:
    count: wp.array(dtype=int),
    contact_world: wp.array(dtype=int),
    contact_geom: wp.array(dtype=wp.vec2i),
    contact_dist: wp.array(dtype=float),
    contact_row: wp.array2d(dtype=int),
    contact_dim: wp.array(dtype=int),
    velocity: wp.array2d(dtype=float),
    timestep: wp.array(dtype=float),
    bow: wp.array(dtype=float),  # speed that the gap loses in a step to curvature
    geom_class: wp.array2d(dtype=int),  # of all worlds alike, or of each; so the law and the curvature
    geom_body: wp.array(dtype=int),
    law: wp.array3d(dtype=wp.vec3),
    geom_kind: wp.array(dtype=int),
    curvature: wp.array2d(dtype=float),
    geom_turn: wp.array2d(dtype=wp.mat33),
    contact_frame: wp.array(dtype=wp.mat33),
    state: wp.array2d(dtype=int),
    instant: bool,  # the blows of an instant, or the step after them
    at_once: bool,  # whether no blow is shared with the next step
    steady: float,
    free: wp.array2d(dtype=float),  # acceleration without constraints
    body_mechanism: wp.array(dtype=int),
    touched_for: wp.array2d(dtype=int),  # a mechanism's steps of the first order since its last smooth one
    loose: wp.array(dtype=int),  # which of the loose bodies a body is; -1 goes as stated
    since: wp.array2d(dtype=int),  # a loose body's steps of the first order since its last exact one
    sparse: bool,
    nv: int,
    jacobian: wp.array3d(dtype=float),
    row_nnz: wp.array2d(dtype=int),
    row_start: wp.array2d(dtype=int),
    column: wp.array3d(dtype=int),
    threshold: float,
    settle_time: float,
    settle_speed: float,
    smallest: float,
    # Data out:
    pair_friction: wp.array(dtype=vec5),
    contact_friction: wp.array(dtype=vec5),
    target: wp.array(dtype=float),
    blow: wp.array(dtype=float),  # 1 where surfaces meet
    slip: wp.array(dtype=float),
    weight: wp.array2d(dtype=float),
    aref: wp.array2d(dtype=float),
):
    """Give each contact its pair's law, and its rows what they should reach."""
    k = wp.tid()
    if k >= count[0]:
        return
    row = contact_row[k, 0]
    if row < 0:
        return
    world, geom = contact_world[k], contact_geom[k]
    own = world % law.shape[0]
    pair = law[own, geom_class[own, geom[0]], geom_class[own, geom[1]]]
    h = timestep[world % timestep.shape[0]]
    distance, speed = contact_dist[k], velocity[world, row] + bow[k]
    blow[k] = 0.0
    goal = target_speed(distance, speed, pair[1], h, threshold * h, settle_time, settle_speed)
    if instant and state[world, HITS] == 0:
        return
    if at_once:
        goal = whole(goal, speed, steady * h)
    if instant and meets(distance, speed, pair[1], h, threshold * h):
        pull = along(world, row, sparse, nv, jacobian, row_nnz, row_start, column, free)
        rough = int(0)
        for side in range(2):
            body = geom_body[geom[side]]
            own_since = since_exact(since, world, loose[body])
            rough = wp.max(rough, wp.min(touched_for[world, body_mechanism[body]], own_since))
        smooth = float(rough) * wp.abs(pull) * h < wp.abs(speed)
        goal = rebound(distance, speed, pull, pair[1], h, smooth)
        blow[k] = 1.0
    elif instant and pair[1] > 0.0 and state[world, BLOWS] > 0:  # it takes no part: it is met in the next round
        goal = -LATER
    goal += bow[k]
    target[k] = goal

    bend = float(0.0)
    for side in range(2):
        round = curvature[own, geom[side]]
        bend += bent(geom_turn[world, geom[side]], contact_frame[k], round, geom_kind[geom[side]])
    friction = coefficients(pair, bend, smallest)
    pair_friction[k] = friction
    contact_friction[k] = friction
    for j in range(2, contact_dim[k] - 1):
        share = friction[j] / friction[0]
        weight[world, contact_row[k, j + 1]] = weight[world, contact_row[k, 1]] * share * share
    slipped = float(0.0)
    for j in range(contact_dim[k] - 1):
        r = contact_row[k, j + 1]
        v = velocity[world, r]
        aref[world, r] = -v / h
        slipped += friction[j] * friction[j] * v * v
    slip[k] = wp.sqrt(slipped)
    if state[world, TURNS] < 0:  # the slip before says little of that after: the first solution is without friction
        slip[k] = 0.0
        for j in range(5):
            friction[j] = smallest
        contact_friction[k] = friction
    aref[world, row] = (goal - slip[k] - velocity[world, row]) / h


@wp.func
def bend_of(
    world: int,
    row: int,
    kind: wp.array2d(dtype=int),
    which: wp.array2d(dtype=int),
    velocity: wp.array2d(dtype=float),
    h: float,
    length: wp.array2d(dtype=float),
    back: wp.array2d(dtype=float),
) -> float:
    """What a rope's way grows by in a step beyond what its speed makes of it, over the step [m/s]; none of a stop's."""
    if kind[world, row] != TAUT:
        return 0.0
    k = which[world, row]
    return (back[world, k] - length[world, k]) / h - velocity[world, row]


@wp.kernel(enable_backward=False)
def look_at_stops(
    # Data in:
    rows: wp.array(dtype=int),
    kind: wp.array2d(dtype=int),
    position: wp.array2d(dtype=float),
    velocity: wp.array2d(dtype=float),
    timestep: wp.array(dtype=float),
    which: wp.array2d(dtype=int),  # stop or tendon
    length: wp.array2d(dtype=float),
    back: wp.array2d(dtype=float),
    most_rounds: int,
    steady: float,
    settle_time: float,
    settle_speed: float,
    # Data out:
    state: wp.array2d(dtype=int),
    seeking: wp.array(dtype=int),
):
    """Note in which worlds a joint comes to its stop, or a rope is drawn taut."""
    world, row = wp.tid()
    if row >= rows[world] or (kind[world, row] != LIMIT and kind[world, row] != TAUT):
        return
    if state[world, ROUNDS] >= most_rounds or state[world, ENDED] > 0:
        return
    h = timestep[world % timestep.shape[0]]
    excess = settling(position[world, row], h, settle_time, settle_speed) - velocity[world, row]
    if excess - 2.0 * wp.abs(bend_of(world, row, kind, which, velocity, h, length, back)) >= steady * h:
        state[world, OPEN] = 1
        state[world, HITS] = 1
        seeking[0] = 1


@wp.kernel(enable_backward=False)
def stop(
    # Data in:
    rows: wp.array(dtype=int),
    kind: wp.array2d(dtype=int),
    position: wp.array2d(dtype=float),
    velocity: wp.array2d(dtype=float),
    timestep: wp.array(dtype=float),
    which: wp.array2d(dtype=int),  # stop or tendon
    length: wp.array2d(dtype=float),  # of tendons
    back: wp.array2d(dtype=float),  # the same where a step at the present speeds would have come from
    at_once: bool,  # whether no blow is shared with the next step
    steady: float,
    settle_time: float,
    settle_speed: float,
    # Data out:
    aref: wp.array2d(dtype=float),
):
    """Joints end at their stops, ropes where they are taut, without a bounce; dry friction would end motion."""
    world, row = wp.tid()
    what = kind[world, row]
    if row >= rows[world] or (what != LIMIT and what != TAUT and what != RUBBING):
        return
    h = timestep[world % timestep.shape[0]]
    goal = float(0.0)
    if what != RUBBING:
        goal = settling(position[world, row], h, settle_time, settle_speed)
        bend = bend_of(world, row, kind, which, velocity, h, length, back)
        if at_once and goal - velocity[world, row] - 2.0 * wp.abs(bend) >= steady * h:
            goal = 0.0
        else:
            goal += bend
    aref[world, row] = (goal - velocity[world, row]) / h
