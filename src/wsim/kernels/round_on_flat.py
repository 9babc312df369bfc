"""Where a cylinder touches a flat side of a box: by its own lowest points, not by search.

MuJoCo Warp finds these by a general convex search (GJK and EPA) in single precision, which ends at any point of a round
side that is within its tolerance of the lowest: 3e-4 m, so 13 mm aside on a radius of 0.3 m. Contacts that jump so turn
what rolls on them to all sides. Where the search ends on a flat side, its contacts are put on the line, the rim or the
end that is lowest over that side, which is exact; MuJoCo in C, in double precision, needs no such thing.
"""

import warp as wp

CYLINDER = wp.constant(5)  # mujoco.mjtGeom
BOX = wp.constant(6)
FLAT = wp.constant(0.98)  # cosine of what the search may miss a side's normal by, 11 degrees
UPRIGHT = wp.constant(0.9998)  # cosine: a cylinder stands on its end
BESIDE = wp.constant(1.0e-3)  # of a cylinder's size, how far beyond the side's edge a point may be


@wp.func
def _lowest(place: wp.vec3, middle: wp.vec3, axis: wp.vec3, size: wp.vec3, up: wp.vec3) -> wp.vec3:
    """The point of a cylinder near `place` that is lowest along `up`: of its line, its rim or its end."""
    lean = wp.dot(axis, up)
    along = wp.dot(place - middle, axis)
    end = -wp.sign(lean) * size[1]
    aside = (place - middle) - along * axis
    if wp.abs(lean) > UPRIGHT:
        return middle + end * axis + aside * wp.min(1.0, size[0] / wp.max(wp.length(aside), 1.0e-9))
    down = -wp.normalize(up - lean * axis)
    if wp.abs(lean) > 1.0 - FLAT:
        along = end
    return middle + wp.clamp(along, -size[1], size[1]) * axis + size[0] * down


@wp.kernel(enable_backward=False)
def settle_round_on_flat(
    # Model:
    geom_type: wp.array(dtype=int),
    geom_size: wp.array2d(dtype=wp.vec3),
    # Data in:
    contacts: wp.array(dtype=int),
    contact_world: wp.array(dtype=int),
    contact_geom: wp.array(dtype=wp.vec2i),
    geom_xpos: wp.array2d(dtype=wp.vec3),
    geom_xmat: wp.array2d(dtype=wp.mat33),
    # Data out:
    contact_pos: wp.array(dtype=wp.vec3),
    contact_dist: wp.array(dtype=float),
    contact_frame: wp.array(dtype=wp.mat33),
):
    """Put the contacts of cylinders with flat sides of boxes where they are."""
    k = wp.tid()
    if k >= contacts[0]:
        return
    round = contact_geom[k][0]
    box = contact_geom[k][1]
    if geom_type[round] != CYLINDER or geom_type[box] != BOX:
        return
    world = contact_world[k]
    turn = geom_xmat[world, box]
    half = geom_size[world % geom_size.shape[0], box]
    frame = contact_frame[k]
    toward = wp.transpose(turn) * wp.vec3(frame[0, 0], frame[0, 1], frame[0, 2])
    side = int(0)
    for axis in range(3):
        if wp.abs(toward[axis]) > wp.abs(toward[side]):
            side = axis
    if wp.abs(toward[side]) < FLAT:
        return
    way = -wp.sign(toward[side])
    up = way * wp.vec3(turn[0, side], turn[1, side], turn[2, side])
    size = geom_size[world % geom_size.shape[0], round]
    own = geom_xmat[world, round]
    middle = geom_xpos[world, round]
    lowest = _lowest(contact_pos[k], middle, wp.vec3(own[0, 2], own[1, 2], own[2, 2]), size, up)
    there = wp.transpose(turn) * (lowest - geom_xpos[world, box])
    for axis in range(3):
        if axis != side and wp.abs(there[axis]) > half[axis] + BESIDE * size[0]:
            return
    distance = way * there[side] - half[side]
    contact_dist[k] = distance
    contact_pos[k] = lowest - 0.5 * distance * up
    first = wp.vec3(frame[1, 0], frame[1, 1], frame[1, 2])
    first = wp.normalize(first - wp.dot(first, up) * up)
    second = wp.cross(-up, first)
    contact_frame[k] = wp.matrix_from_rows(-up, first, second)
