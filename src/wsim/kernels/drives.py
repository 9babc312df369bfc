"""Drives as constraint rows of MuJoCo Warp: the effort at the end of a step, up to the largest that a motor has."""

import warp as wp

DRIVE = wp.constant(2)  # mjtConstraint: mjCNSTR_FRICTION_TENDON; no other row is of that kind
BEYOND = wp.constant(100.0)  # times what a drive and all else accelerate its joint by, which none exceeds in a step


@wp.kernel(enable_backward=False)
def take_over(
    # Data in:
    dof: wp.array(dtype=int),
    tendon: wp.array(dtype=int),
    actuator: wp.array2d(dtype=int),  # of a drive, two at most; -1 for none
    force: wp.array2d(dtype=float),  # of each actuator, without bound
    # Data out:
    effort: wp.array2d(dtype=float),
    applied: wp.array2d(dtype=float),
):
    """Note what each drive would give at the speed of the step's start, and take it out of what is applied."""
    world, k = wp.tid()
    total = float(0.0)
    for side in range(2):
        if actuator[k, side] >= 0:
            total += force[world, actuator[k, side]]
    effort[world, tendon[k]] = total
    applied[world, dof[k]] = 0.0


@wp.kernel(enable_backward=False)
def aim_drives(
    # Data in:
    rows: wp.array(dtype=int),
    kind: wp.array2d(dtype=int),
    tendon: wp.array2d(dtype=int),  # of a row of a drive
    damping: wp.array2d(dtype=float),  # of each tendon's drive, in all worlds alike or in each
    mobility: wp.array2d(dtype=float),  # what each yields to an effort, likewise
    dof: wp.array(dtype=int),  # of each tendon
    effort: wp.array2d(dtype=float),
    most: wp.array2d(dtype=float),  # effort of a row
    free: wp.array2d(dtype=float),  # acceleration without constraints
    last: wp.array2d(dtype=float),  # and that of the step before
    timestep: wp.array(dtype=float),
    # Data out:
    weight: wp.array2d(dtype=float),
    aref: wp.array2d(dtype=float),
):
    """Let a drive's row push with effort - damping h acceleration: the drive's law with the speed of the step's end.

    A motor far below its speed asks for an acceleration that it cannot give by far, and the solver's cost, the effort
    times what is missing, would drown all else in single precision. Less gives the same effort, its largest.
    """
    world, row = wp.tid()
    if row >= rows[world] or kind[world, row] != DRIVE:
        return
    which = tendon[world, row]
    own = world % damping.shape[0]
    share = damping[own, which] * timestep[world % timestep.shape[0]]
    weight[world, row] = share
    given = most[world, row]
    known = given * mobility[own, which] + wp.abs(free[world, dof[which]]) + wp.abs(last[world, dof[which]])
    bound = given / share + BEYOND * known
    aref[world, row] = wp.clamp(effort[world, which] / share, -bound, bound)
