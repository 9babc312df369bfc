"""What the constraints that stand for joints bear, and that they give way where it is too much."""

import warp as wp

from wsim.kernels.contact_law import ROUNDS

EQUALITY = wp.constant(0)  # mjtConstraint: mjCNSTR_EQUALITY
WELD = wp.constant(1)  # mjtEq: mjEQ_WELD


@wp.kernel(enable_backward=False)
def find_rows(
    # Data in:
    rows: wp.array(dtype=int),
    kind: wp.array2d(dtype=int),
    owner: wp.array2d(dtype=int),
    # Data out:
    first: wp.array2d(dtype=int),  # row of each equality constraint, -1 where it has none
):
    """Note the first row of each equality constraint; its rows follow each other."""
    world, row = wp.tid()
    if row >= rows[world] or kind[world, row] != EQUALITY:
        return
    id = owner[world, row]
    if row > 0:
        if kind[world, row - 1] == EQUALITY and owner[world, row - 1] == id:
            return
    first[world, id] = row


@wp.func
def three(values: wp.array2d(dtype=float), world: int, row: int) -> wp.vec3:
    """Three rows that follow each other."""
    return wp.vec3(values[world, row], values[world, row + 1], values[world, row + 2])


@wp.kernel(enable_backward=False)
def bear(
    # Data in:
    constraint: wp.array2d(dtype=int),  # of each joint, the second -1 where there is one alone
    first: wp.array2d(dtype=int),
    kind: wp.array(dtype=int),
    parameters: wp.array2d(dtype=wp.types.vector(length=12, dtype=float)),
    body: wp.array(dtype=int),
    turn: wp.array2d(dtype=wp.mat33),
    force: wp.array2d(dtype=float),
    # Data out:
    now: wp.array2d(dtype=wp.spatial_vector),
):
    """The force [N] and the torque about its anchor [N m] that each joint bears."""
    world, k = wp.tid()
    one, two = constraint[k, 0], constraint[k, 1]
    row = first[world, one]
    now[world, k] = wp.spatial_vector()
    if row < 0:
        return
    push = three(force, world, row)
    torque = wp.vec3()
    data = parameters[world % parameters.shape[0], one]
    if kind[one] == WELD:
        # The last rows are the vector part of a quaternion, half the angle.
        torque = 0.5 * data[10] * three(force, world, row + 3)
    elif two >= 0:
        far = parameters[world % parameters.shape[0], two]
        arm = turn[world, body[one]] * (0.5 * wp.vec3(far[0] - data[0], far[1] - data[1], far[2] - data[2]))
        second = three(force, world, first[world, two])
        torque = wp.cross(arm, second - push)
        push += second
    now[world, k] = wp.spatial_vector(push, torque)


@wp.kernel(enable_backward=False)
def sum_up(
    # Data in:
    now: wp.array2d(dtype=wp.spatial_vector),
    share: float,
    # Data out:
    total: wp.array2d(dtype=wp.spatial_vector),
):
    """Add what each joint bears for a share of the time that a blow lasts."""
    world, k = wp.tid()
    total[world, k] += share * now[world, k]


@wp.kernel(enable_backward=False)
def note_struck(
    # Data in:
    state: wp.array2d(dtype=int),
    # Data out:
    struck: wp.array(dtype=int),
):
    """Note which worlds have had a round of blows."""
    world = wp.tid()
    struck[world] = wp.where(state[world, ROUNDS] > 0, 1, 0)


@wp.func
def size(load: wp.spatial_vector) -> wp.vec2:
    """Force and torque of a load [N], [N m]."""
    return wp.vec2(wp.length(wp.spatial_top(load)), wp.length(wp.spatial_bottom(load)))


@wp.func
def let_go(
    world: int,
    id: int,
    count: int,
    first: wp.array2d(dtype=int),
    weight: wp.array2d(dtype=float),
    active: wp.array2d(dtype=bool),
):
    """Take a constraint's rows out of this step and of all later."""
    active[world, id] = False
    for j in range(count):
        weight[world, first[world, id] + j] = 0.0


@wp.kernel(enable_backward=False)
def break_worst(
    # Data in:
    constraint: wp.array2d(dtype=int),
    strength: wp.array3d(dtype=float),  # force [N] and torque [N m], in all worlds alike or in each
    first: wp.array2d(dtype=int),
    kind: wp.array(dtype=int),
    now: wp.array2d(dtype=wp.spatial_vector),
    share: float,
    blown: wp.array2d(dtype=wp.spatial_vector),  # what each joint bears besides `share` of that
    judged: wp.array(dtype=int),
    which: int,  # worlds, by what is noted of them
    # Data out:
    again: wp.array(dtype=int),
    anew: wp.array(dtype=int),
    broken: wp.array2d(dtype=int),
    load: wp.array2d(dtype=wp.vec2),
    weight: wp.array2d(dtype=float),
    active: wp.array2d(dtype=bool),
):
    """Break the joint that bears most by its strength, if that is too much; else note what all bear."""
    world = wp.tid()
    if judged[world] != which:
        return
    own = world % strength.shape[0]
    worst = int(-1)
    most = float(1.0)
    for k in range(constraint.shape[0]):
        borne = size(blown[world, k] + share * now[world, k])
        part = wp.max(borne[0] / strength[own, k, 0], borne[1] / strength[own, k, 1])
        if broken[world, k] == 0 and part > most:
            worst = k
            most = part
    if worst < 0:
        for k in range(constraint.shape[0]):
            load[world, k] = wp.max(load[world, k], size(blown[world, k] + share * now[world, k]))
        return
    again[0] = 1
    anew[world] = 1
    broken[world, worst] = 1
    load[world, worst] = wp.max(load[world, worst], size(blown[world, worst] + share * now[world, worst]))
    one, two = constraint[worst, 0], constraint[worst, 1]
    count = int(3)
    if kind[one] == WELD:
        count = 6
    let_go(world, one, count, first, weight, active)
    if two >= 0:
        let_go(world, two, 3, first, weight, active)
