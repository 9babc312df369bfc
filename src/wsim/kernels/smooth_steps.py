"""Which worlds of a batch touch nothing in a step, and the better step for those."""

import warp as wp

FIRST_THAT_JUMPS = wp.constant(1)  # mjtConstraint: after equalities come dry friction, stops and contacts
DRIVE = wp.constant(2)  # mjCNSTR_FRICTION_TENDON, which jumps not


@wp.kernel(enable_backward=False)
def find_touching(
    # Data in:
    rows: wp.array(dtype=int),
    kind: wp.array2d(dtype=int),
    # Data out:
    touches: wp.array(dtype=int),
):
    """Mark the worlds with dry friction, a stop or a contact among their constraint rows."""
    world, row = wp.tid()
    if row < rows[world] and kind[world, row] >= FIRST_THAT_JUMPS and kind[world, row] != DRIVE:
        touches[world] = 1


@wp.kernel(enable_backward=False)
def count_touching(
    # Data in:
    touches: wp.array(dtype=int),
    # Data out:
    steps: wp.array(dtype=int),
):
    """Count each world's steps in which it touches something, from the last one in which it does not."""
    world = wp.tid()
    steps[world] = wp.where(touches[world] == 0, 0, steps[world] + 1)


@wp.kernel(enable_backward=False)
def take_where_free(
    # Data in:
    touches: wp.array(dtype=int),
    smooth: wp.array2d(dtype=float),
    # Data out:
    taken: wp.array2d(dtype=float),
):
    """Take the values of the smooth step where a world touches nothing."""
    world, k = wp.tid()
    if touches[world] == 0:
        taken[world, k] = smooth[world, k]
