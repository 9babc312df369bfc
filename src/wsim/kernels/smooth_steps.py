"""Which mechanisms touch nothing in a step, and the better step for those."""

import warp as wp

DRY = wp.constant(1)  # mjtConstraint: mjCNSTR_FRICTION_DOF,
DRIVE = wp.constant(2)  # mjCNSTR_FRICTION_TENDON, which jumps not,
STOP = wp.constant(3)  # mjCNSTR_LIMIT_JOINT,
TAUT = wp.constant(4)  # mjCNSTR_LIMIT_TENDON; contacts come after


@wp.kernel(enable_backward=False)
def find_touching(
    # Data in:
    rows: wp.array(dtype=int),
    kind: wp.array2d(dtype=int),
    which: wp.array2d(dtype=int),  # joint, degree of freedom, tendon or contact
    force: wp.array2d(dtype=float),
    contact_geom: wp.array(dtype=wp.vec2i),
    geom_owner: wp.array(dtype=int),
    joint_owner: wp.array(dtype=int),
    freedom_owner: wp.array(dtype=int),
    tendon_owner: wp.array(dtype=int),
    # Data out:
    touches: wp.array2d(dtype=int),
):
    """Mark mechanisms with dry friction, a stop or a contact that pushes, and the first where there is any such row."""
    world, row = wp.tid()
    if row >= rows[world]:
        return
    what, k = kind[world, row], which[world, row]
    if what < DRY or what == DRIVE:
        return
    touches[world, 0] = 1
    if what == DRY:
        touches[world, freedom_owner[k]] = 1
    elif what == STOP:
        touches[world, joint_owner[k]] = 1
    elif what == TAUT:
        touches[world, tendon_owner[k]] = 1
    elif force[world, row] != 0.0:
        for side in range(2):
            touches[world, geom_owner[contact_geom[k][side]]] = 1


@wp.kernel(enable_backward=False)
def count_touching(
    # Data in:
    breaks: wp.array(dtype=int),
    # Data out:
    touches: wp.array2d(dtype=int),
    steps: wp.array2d(dtype=int),
):
    """Count the steps in which a mechanism touches something, from the last one in which it does not."""
    world, k = wp.tid()
    if breaks[world] > 0:
        touches[world, k] = 1
    steps[world, k] = wp.where(touches[world, k] == 0, 0, steps[world, k] + 1)


@wp.kernel(enable_backward=False)
def keep_where_touched(
    # Data in:
    touches: wp.array2d(dtype=int),
    owner: wp.array(dtype=int),
    end: wp.array2d(dtype=float),  # of the law's step
    # Data out:
    state: wp.array2d(dtype=float),  # of the smooth one
):
    """Go by the law's step where a mechanism is pushed, or, of what is none, anything in its world touches."""
    world, k = wp.tid()
    if touches[world, owner[k]] > 0:
        state[world, k] = end[world, k]
