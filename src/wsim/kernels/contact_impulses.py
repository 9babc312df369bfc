"""Sums, over the steps of a frame, what each pair of geoms gives the other by contact, in a table of bounded size."""

import warp as wp

EMPTY = wp.constant(0)  # a key is one more than what stands for a pair


@wp.func
def slot_of(key: int, keys: wp.array(dtype=int)) -> int:
    """Where a pair's sums are, which may be new; -1 where the table is full (open addressing, linear probing)."""
    count = keys.shape[0]
    slot = (key * 40503 & 0x7FFFFFFF) % count
    for _ in range(count):
        found = wp.atomic_cas(keys, slot, EMPTY, key)
        if found == EMPTY or found == key:  # noqa: SIM109 - Warp has no tuples
            return slot
        slot = (slot + 1) % count
    return -1


@wp.func
def add(sums: wp.array2d(dtype=float), slot: int, column: int, value: wp.vec3):
    """Add to three columns that follow each other."""
    for axis in range(3):
        wp.atomic_add(sums, slot, column + axis, value[axis])


@wp.kernel(enable_backward=False)
def accumulate_contacts(
    # Data in:
    contacts: wp.array(dtype=int),  # how many there are
    world: wp.array(dtype=int),
    geom: wp.array(dtype=wp.vec2i),
    point: wp.array(dtype=wp.vec3),
    frame: wp.array(dtype=wp.mat33),  # rows are axes; the first points from the first geom to the second
    rows: wp.array2d(dtype=int),
    dim: wp.array(dtype=int),
    force: wp.array2d(dtype=float),
    geom_body: wp.array(dtype=int),
    center: wp.array2d(dtype=wp.vec3),  # of mass, of each body of each world
    geoms: int,
    dt: float,
    # Data out:
    keys: wp.array(dtype=int),
    sums: wp.array2d(dtype=float),
    lost: wp.array(dtype=int),
):
    """Add a step's impulses of the first world's contacts; the columns are those of `wsim.recording.contacts`."""
    k = wp.tid()
    if k >= contacts[0] or world[k] != 0 or rows[k, 0] < 0:
        return
    first = rows[k, 0]
    press = force[0, first] * dt
    if press == 0.0:
        return
    normal = frame[k][0]
    push = press * normal
    spin = wp.vec3(0.0, 0.0, 0.0)
    for row in range(1, dim[k]):
        amount = force[0, rows[k, row]] * dt
        axis = frame[k][row % 3]
        if row < 3:
            push += amount * axis
        else:
            spin += amount * axis
    slot = slot_of(geom[k][0] * geoms + geom[k][1] + 1, keys)
    if slot < 0:
        wp.atomic_add(lost, 0, 1)
        return
    one, two = geom_body[geom[k][0]], geom_body[geom[k][1]]
    add(sums, slot, 0, push)
    wp.atomic_add(sums, slot, 3, press)
    add(sums, slot, 4, press * normal)
    add(sums, slot, 7, press * point[k])
    add(sums, slot, 10, -wp.cross(point[k] - center[0, one], push) - spin)
    add(sums, slot, 13, wp.cross(point[k] - center[0, two], push) + spin)
