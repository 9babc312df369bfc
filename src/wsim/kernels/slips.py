"""The search for the slip that a step's contacts are left with, on MuJoCo Warp's rows: `wsim.solvers.slips` in kernels.

Each world of a batch seeks for itself; what it has found stays as it is while others still seek.
"""

import warp as wp

from wsim.kernels.contact_law import BLOWS, NEARER, OPEN, TURNS, along, vec5

SMALL_CHANGE = wp.constant(1.0e-5)  # [m/s], and
MOST_SHARE = wp.constant(19.0)  # of the solution before, as wsim.solvers.slips has them


@wp.kernel(enable_backward=False)
def weigh(
    # Data in:
    count: wp.array(dtype=int),
    contact_world: wp.array(dtype=int),
    contact_geom: wp.array(dtype=wp.vec2i),
    contact_row: wp.array2d(dtype=int),
    contact_dim: wp.array(dtype=int),
    pair_friction: wp.array(dtype=vec5),
    velocity: wp.array2d(dtype=float),
    timestep: wp.array(dtype=float),
    geom_body: wp.array(dtype=int),
    acceleration: wp.array2d(dtype=float),
    sparse: bool,
    nv: int,
    jacobian: wp.array3d(dtype=float),
    row_nnz: wp.array2d(dtype=int),
    row_start: wp.array2d(dtype=int),
    column: wp.array3d(dtype=int),
    force: wp.array2d(dtype=float),
    target: wp.array(dtype=float),
    blow: wp.array(dtype=float),
    slip: wp.array(dtype=float),
    before: wp.array(dtype=wp.vec2),  # guess, and what was left, of the solution before
    state: wp.array2d(dtype=int),
    # Data out:
    remaining: wp.array(dtype=float),
    sums: wp.array2d(dtype=wp.vec2),  # of each body's contacts
    change: wp.array(dtype=float),  # of each world's slips, the most
):
    """What slip a solution leaves, and what the bodies' contacts say together of how it goes with the guess.

    With it goes what a blow's friction takes of the rebound: `friction_pays` of `wsim.solvers.targets`.
    """
    k = wp.tid()
    if k >= count[0] or contact_row[k, 0] < 0:
        return
    world, geom = contact_world[k], contact_geom[k]
    if state[world, OPEN] == 0:
        return
    h = timestep[world % timestep.shape[0]]
    friction = pair_friction[k]
    slipped, gained = float(0.0), float(0.0)
    for j in range(contact_dim[k] - 1):
        r = contact_row[k, j + 1]
        faster = along(world, r, sparse, nv, jacobian, row_nnz, row_start, column, acceleration)
        end = velocity[world, r] + h * faster
        v = friction[j] * end
        slipped += v * v
        gained += force[world, r] * (velocity[world, r] + end)
    remaining[k] = wp.sqrt(slipped)
    push = force[world, contact_row[k, 0]]
    if blow[k] > 0.0 and push > 0.0:
        remaining[k] += wp.clamp(gained / push, 0.0, target[k])
    rest = remaining[k] - slip[k]
    wp.atomic_max(change, world, wp.abs(rest))
    if state[world, TURNS] > 0:
        moved = rest - (before[k][1] - before[k][0])
        for side in range(2):
            body = geom_body[geom[side]]
            if body > 0:
                wp.atomic_add(sums, world, body, wp.vec2(moved * rest, moved * moved))


@wp.kernel(enable_backward=False)
def go_on_from(
    # Data in:
    state: wp.array2d(dtype=int),
    acceleration: wp.array2d(dtype=float),
    # Data out:
    start: wp.array2d(dtype=float),
):
    """Start the next solution from this one in the worlds that seek; others find again what they have, to the bit."""
    world, k = wp.tid()
    if state[world, OPEN] > 0:
        start[world, k] = acceleration[world, k]


@wp.kernel(enable_backward=False)
def settle(
    # Data in:
    solutions: int,
    most: int,
    tolerance: float,
    rough: float,
    # Data out:
    change: wp.array(dtype=float),
    nearest: wp.array(dtype=float),
    state: wp.array2d(dtype=int),
    seeking: wp.array(dtype=int),  # whether any world still seeks
):
    """Whether each world's slips are those that were guessed, by the rules of `wsim.solvers.slips.seek_slip`."""
    world = wp.tid()
    if state[world, OPEN] == 0:
        return
    turns = state[world, TURNS] + 1
    if turns > most:
        state[world, OPEN] = 0
        return
    off = change[world]
    change[world] = 0.0
    state[world, TURNS] = turns
    state[world, NEARER] = 0
    enough = wp.where(turns < solutions, tolerance, rough)
    if turns == 0:
        seeking[0] = 1
    elif off < enough and (turns > 1 or state[world, BLOWS] == 0):
        state[world, OPEN] = 0
    else:
        if off < nearest[world] or turns == 1:
            nearest[world] = off
            state[world, NEARER] = 1
        if turns < most:
            seeking[0] = 1


@wp.kernel(enable_backward=False)
def guess(
    # Data in:
    count: wp.array(dtype=int),
    contact_world: wp.array(dtype=int),
    contact_geom: wp.array(dtype=wp.vec2i),
    contact_row: wp.array2d(dtype=int),
    pair_friction: wp.array(dtype=vec5),
    velocity: wp.array2d(dtype=float),
    timestep: wp.array(dtype=float),
    geom_body: wp.array(dtype=int),
    remaining: wp.array(dtype=float),
    sums: wp.array2d(dtype=wp.vec2),
    target: wp.array(dtype=float),
    blow: wp.array(dtype=float),
    inertia: wp.array2d(dtype=float),  # of the rows' regularisation, 1 / R
    force: wp.array2d(dtype=float),
    most: int,
    state: wp.array2d(dtype=int),
    # Data out:
    contact_friction: wp.array(dtype=vec5),
    slip: wp.array(dtype=float),
    before: wp.array(dtype=wp.vec2),  # guess, and what was left, of the solution before
    best: wp.array(dtype=float),
    aref: wp.array2d(dtype=float),
):
    """Guess the slip anew from what two solutions leave, as `extrapolated` of `wsim.solvers.slips` does.

    What a blow's row gave way is asked for in addition.
    """
    k = wp.tid()
    if k >= count[0]:
        return
    row = contact_row[k, 0]
    if row < 0:
        return
    world, geom = contact_world[k], contact_geom[k]
    if state[world, OPEN] == 0:
        return
    h = timestep[world % timestep.shape[0]]
    if state[world, TURNS] == 0:
        contact_friction[k] = pair_friction[k]
        slip[k] = remaining[k]
    else:
        if state[world, NEARER] > 0:
            best[k] = slip[k]
        both = wp.vec2(0.0, 0.0)
        for side in range(2):
            both += sums[world, wp.max(geom_body[geom[side]], 0)]  # nothing is added to the world's
        share = float(0.0)
        if both[1] > SMALL_CHANGE * SMALL_CHANGE:
            share = wp.clamp(both[0] / both[1], -MOST_SHARE, 1.0)
        guessed = wp.max(remaining[k] - share * (remaining[k] - before[k][1]), 0.0)
        before[k] = wp.vec2(slip[k], remaining[k])
        slip[k] = wp.where(state[world, TURNS] < most, guessed, best[k])
    given = float(0.0)
    if blow[k] > 0.0:
        given = force[world, row] / inertia[world, row]
    aref[world, row] = (target[k] - slip[k] - velocity[world, row]) / h + given
