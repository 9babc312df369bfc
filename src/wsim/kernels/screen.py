"""What objectives come to in each world, worked out on the device from what its bodies did."""

import warp as wp

# What a number is of, at a frame: `wsim.sweep.screen` says which predicate asks for which.
SPEED = wp.constant(0)  # of the centre of mass [m/s]
FASTEST = wp.constant(1)  # of the fastest point of a ball of a size [m/s]
DISTANCE = wp.constant(2)  # of the origin from a point, or from another body's [m]
PLACE = wp.constant(3)  # of the origin along a vector [m]
WAY = wp.constant(4)  # of the origin along a vector, since the start [m]
LEVEL_WAY = wp.constant(5)  # of the origin across a unit vector, since the start [m]
TILT = wp.constant(6)  # of what pointed along a unit vector at the start [deg]
RATE = wp.constant(7)  # of turning about a vector, against another body if there is one [deg/s]

# How frames are taken together.
LEAST = wp.constant(0)
GREATEST = wp.constant(1)
MEAN = wp.constant(2)

DEGREES = wp.constant(wp.float64(57.29577951308232))
NONE = wp.constant(-1)


@wp.func
def place(q: wp.array3d(dtype=wp.transform), w: int, t: int, b: int) -> wp.vec3d:
    """Where a body's origin is."""
    return wp.vec3d(wp.transform_get_translation(q[w, t, b]))


@wp.func
def turned(q: wp.array3d(dtype=wp.transform), w: int, t: int, b: int) -> wp.quatd:
    """How a body is turned, in double precision."""
    r = wp.transform_get_rotation(q[w, t, b])
    return wp.quatd(wp.float64(r[0]), wp.float64(r[1]), wp.float64(r[2]), wp.float64(r[3]))


@wp.func
def rotated(q: wp.quatd, v: wp.vec3d) -> wp.vec3d:
    """As `wsim.geometry.rotations.rotate` has it, of quaternions that are not quite of length 1, too."""
    axis = wp.vec3d(q[0], q[1], q[2])
    t = wp.float64(2.0) * wp.cross(axis, v)
    return v + q[3] * t + wp.cross(axis, t)


@wp.func
def number(
    what: int,
    q: wp.array3d(dtype=wp.transform),
    qd: wp.array3d(dtype=wp.spatial_vector),
    w: int,
    t: int,
    body: int,
    other: int,
    along: wp.vec3d,
    size: wp.float64,
) -> wp.float64:
    """What is asked of a body at a frame."""
    v = wp.vec3d(wp.spatial_top(qd[w, t, body]))
    spin = wp.vec3d(wp.spatial_bottom(qd[w, t, body]))
    if what == SPEED:
        return wp.length(v)
    if what == FASTEST:
        return wp.length(v) + wp.length(spin) * size
    if what == RATE:
        if other >= 0:
            spin = spin - wp.vec3d(wp.spatial_bottom(qd[w, t, other]))
        return DEGREES * wp.dot(spin, along)
    if what == TILT:
        start = turned(q, w, 0, body)
        own = rotated(wp.quatd(-start[0], -start[1], -start[2], start[3]), along)
        cosine = wp.dot(rotated(turned(q, w, t, body), own), along)
        return DEGREES * wp.acos(wp.clamp(cosine, wp.float64(-1.0), wp.float64(1.0)))
    p = place(q, w, t, body)
    if what == DISTANCE:
        if other >= 0:
            return wp.length(p - place(q, w, t, other))
        return wp.length(p - along)
    if what == PLACE:
        return wp.dot(p, along)
    way = p - place(q, w, 0, body)
    if what == WAY:
        return wp.dot(way, along)
    return wp.length(way - wp.dot(way, along) * along)


@wp.kernel(enable_backward=False)
def find_broken(
    # Data in:
    q: wp.array3d(dtype=wp.transform),  # by world, frame and body
    qd: wp.array3d(dtype=wp.spatial_vector),
    # Data out:
    broken: wp.array(dtype=int),
):
    """Mark the worlds that hold a number which is not finite."""
    w, t, b = wp.tid()
    sound = bool(True)
    for k in range(7):
        sound = sound and wp.isfinite(q[w, t, b][k])
    for k in range(6):
        sound = sound and wp.isfinite(qd[w, t, b][k])
    if not sound:
        broken[w] = 1


@wp.kernel(enable_backward=False)
def reduce_objectives(
    # Data in:
    q: wp.array3d(dtype=wp.transform),  # by world, frame and body
    qd: wp.array3d(dtype=wp.spatial_vector),
    broken: wp.array(dtype=int),  # by world: something in it is no finite number
    what: wp.array(dtype=int),  # of each objective, as all that follows,
    body: wp.array(dtype=int),
    other: wp.array(dtype=int),  # NONE: there is no other body
    how: wp.array(dtype=int),
    sign: wp.array(dtype=wp.float64),  # -1: it is not to keep to its range
    first: wp.array(dtype=int),  # frames, from this one to the one before the last
    last: wp.array(dtype=int),
    along: wp.array2d(dtype=wp.vec3d),  # and of each world
    size: wp.array2d(dtype=wp.float64),
    low: wp.array2d(dtype=wp.float64),
    high: wp.array2d(dtype=wp.float64),
    # Data out:
    margin: wp.array2d(dtype=wp.float64),  # how far it is within its range; NaN where the world is broken
    value: wp.array2d(dtype=wp.float64),  # the number that decides
    moment: wp.array2d(dtype=int),  # the frame that decides
):
    """The margin of each objective in each world."""
    m, w = wp.tid()
    if broken[w] != 0:
        margin[m, w] = wp.float64(wp.nan)
        return
    best = wp.float64(0.0)
    total = wp.float64(0.0)
    decides = wp.float64(0.0)
    at = int(first[m])
    for t in range(first[m], last[m]):
        x = number(what[m], q, qd, w, t, body[m], other[m], along[m, w], size[m, w])
        room = sign[m] * wp.min(x - low[m, w], high[m, w] - x)
        total = total + x
        if t == first[m] or (how[m] == LEAST and room < best) or (how[m] == GREATEST and room > best):
            best = room
            decides = x
            at = t
    if how[m] == MEAN:
        decides = total / wp.float64(last[m] - first[m])
        at = int(first[m])
        best = sign[m] * wp.min(decides - low[m, w], high[m, w] - decides)
    margin[m, w] = best
    value[m, w] = decides
    moment[m, w] = at
