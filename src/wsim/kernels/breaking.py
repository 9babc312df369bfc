"""What the constraints that stand for joints bear, and that they give way where it is too much."""

import warp as wp

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
def break_joints(
    # Data in:
    constraint: wp.array2d(dtype=int),  # of each joint, the second -1 where there is one alone
    strength: wp.array2d(dtype=float),  # force [N] and torque [N m]
    first: wp.array2d(dtype=int),
    kind: wp.array(dtype=int),
    parameters: wp.array2d(dtype=wp.types.vector(length=12, dtype=float)),
    body: wp.array(dtype=int),
    turn: wp.array2d(dtype=wp.mat33),
    force: wp.array2d(dtype=float),
    # Data out:
    broken: wp.array2d(dtype=int),
    load: wp.array2d(dtype=wp.vec2),
    weight: wp.array2d(dtype=float),
    active: wp.array2d(dtype=bool),
):
    """Note what each joint bears, and take the rows of those that bear too much out of the step and of all later."""
    world, k = wp.tid()
    one, two = constraint[k, 0], constraint[k, 1]
    row = first[world, one]
    if broken[world, k] != 0 or row < 0:
        return
    push = three(force, world, row)
    torque = float(0.0)
    count = int(3)
    other = int(-1)
    data = parameters[world % parameters.shape[0], one]
    if kind[one] == WELD:
        torque = 0.5 * data[10] * wp.length(three(force, world, row + 3))
        count = 6
    elif two >= 0:
        other = first[world, two]
        far = parameters[world % parameters.shape[0], two]
        arm = turn[world, body[one]] * (0.5 * wp.vec3(far[0] - data[0], far[1] - data[1], far[2] - data[2]))
        second = three(force, world, other)
        torque = wp.length(wp.cross(arm, second - push))
        push += second
    bears = wp.vec2(wp.length(push), torque)
    load[world, k] = wp.max(load[world, k], bears)
    if bears[0] > strength[k, 0] or bears[1] > strength[k, 1]:
        broken[world, k] = 1
        active[world, one] = False
        for j in range(count):
            weight[world, row + j] = 0.0
        if other >= 0:
            active[world, two] = False
            for j in range(3):
                weight[world, other + j] = 0.0
