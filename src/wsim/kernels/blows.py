"""Rounds of blows on MuJoCo Warp's numbers: `wsim.solvers.blows` in kernels, for all worlds that something hits in."""

import warp as wp

from wsim.kernels.contact_law import BLOWS, ENDED, HITS, ROUNDS, RUBBING

DRIVEN = wp.constant(2)  # mjtConstraint: mjCNSTR_FRICTION_TENDON


@wp.kernel(enable_backward=False)
def begin_round(
    # Data out:
    state: wp.array2d(dtype=int),
    seeking: wp.array(dtype=int),
):
    """Forget the search of the round before."""
    world = wp.tid()
    for k in range(ROUNDS):
        state[world, k] = 0
    seeking[0] = 0


@wp.kernel(enable_backward=False)
def count_round(
    # Data out:
    state: wp.array2d(dtype=int),
    struck: wp.array(dtype=int),
):
    """Count the rounds of each world that has one, and note that any world has."""
    world = wp.tid()
    if state[world, HITS] > 0:
        state[world, ROUNDS] = state[world, ROUNDS] + 1
        state[world, ENDED] = 1 - state[world, BLOWS]
        struck[0] = 1


@wp.kernel(enable_backward=False)
def lose_finite(
    # Data in:
    rows: wp.array(dtype=int),
    kind: wp.array2d(dtype=int),
    # Data out:
    loss: wp.array2d(dtype=float),
):
    """Dry friction and drives give nothing in no time."""
    world, row = wp.tid()
    if row < rows[world] and (kind[world, row] == RUBBING or kind[world, row] == DRIVEN):
        loss[world, row] = 0.0


@wp.kernel(enable_backward=False)
def silence(
    # Data in:
    state: wp.array2d(dtype=int),
    # Data out:
    force: wp.array2d(dtype=float),
):
    """A solution of worlds that have no blow in this round is nobody's."""
    world, row = wp.tid()
    if state[world, HITS] == 0:
        force[world, row] = 0.0


@wp.kernel(enable_backward=False)
def jump(
    # Data in:
    state: wp.array2d(dtype=int),
    timestep: wp.array(dtype=float),
    acceleration: wp.array2d(dtype=float),
    # Data out:
    true_qd: wp.array2d(dtype=wp.float64),
    qvel: wp.array2d(dtype=float),
):
    """Take the velocities after a round."""
    world, k = wp.tid()
    if state[world, HITS] == 0:
        return
    true = true_qd[world, k]
    if float(true) != qvel[world, k]:
        true = wp.float64(qvel[world, k])
    true += wp.float64(timestep[world % timestep.shape[0]]) * wp.float64(acceleration[world, k])
    true_qd[world, k] = true
    qvel[world, k] = float(true)
