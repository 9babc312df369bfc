"""A cylinder and what is near it, and one contact of them: on its side, its end, its rim or a face."""

import warp as wp

from wsim.kernels.apart import Pair, d, sign

LEANS = wp.constant(wp.float64(0.1))  # [rad] of an end, a side or a face: what leans more touches with one point
ALL_BUT = wp.constant(wp.float64(0.995))  # its cosine
LEVEL = wp.constant(wp.float64(1.0e-5))  # [rad], where a drum leans by less, that way is rounding
ACROSS = wp.constant(wp.float64(1.0e-7))  # of a length: what lies across a direction
TANGENTS = wp.constant(5)  # steps of Newton's method, of which each doubles the digits
BARE = wp.constant(wp.float64(1.0e-6))  # [m]: the nearest points are a contact of their own from here on
NONE = wp.constant(wp.float64(1.0e9))


@wp.struct
class Touches:
    """Contacts, in a list."""

    count: wp.array(dtype=int)
    pair: wp.array(dtype=int)
    world: wp.array(dtype=int)
    position: wp.array(dtype=wp.vec3)
    normal: wp.array(dtype=wp.vec3)  # from the pair's first to its second
    distance: wp.array(dtype=float)


@wp.struct
class Scene:
    """A pair as one of the two sees it, and where what it finds is noted."""

    pair: Pair
    way: wp.vec3d  # from the one to the other
    turn: wp.mat33d  # its axes in the world
    middle: wp.vec3d
    sense: wp.float64  # 1 if it is the pair's first
    most: wp.float64  # gap [m]
    least: wp.float64
    number: int
    world: int
    list: Touches


@wp.func
def note(scene: Scene, point: wp.vec3d, normal: wp.vec3d, gap: wp.float64) -> wp.float64:
    """Note a contact halfway between two surfaces; its gap, or a large number where it is none."""
    if gap > scene.most or gap < scene.least:
        return NONE
    k = wp.atomic_add(scene.list.count, 0, 1)
    if k < scene.list.pair.shape[0]:
        scene.list.pair[k] = scene.number
        scene.list.world[k] = scene.world
        scene.list.position[k] = wp.vec3(scene.middle + scene.turn * point)
        scene.list.normal[k] = wp.vec3(scene.sense * (scene.turn * normal))
        scene.list.distance[k] = float(gap)
    return gap


@wp.func
def on_side(scene: Scene, centre: wp.vec3d, radius: wp.float64, axis: wp.vec3d) -> wp.float64:
    """A point beside a cylinder, or one of the axis of another's side of a radius."""
    far = wp.sqrt(centre[0] * centre[0] + centre[1] * centre[1])
    if far == d(0.0):
        return NONE
    out = wp.vec3d(centre[0] / far, centre[1] / far, d(0.0))
    own = scene.pair.one.disc + scene.pair.one.ball
    lean = wp.dot(out, axis)
    radius = radius / wp.sqrt(d(1.0) - lean * lean)
    gap = far - own - radius
    return note(scene, wp.vec3d(d(0.0), d(0.0), centre[2]) + (own + d(0.5) * gap) * out, out, gap)


@wp.func
def on_end(scene: Scene, point: wp.vec3d) -> wp.float64:
    """A point over a cylinder's end."""
    side = sign(scene.way[2])
    far = wp.sqrt(point[0] * point[0] + point[1] * point[1])
    if far > scene.pair.one.disc * (d(1.0) + ACROSS):
        return NONE
    gap = side * point[2] - scene.pair.one.span[2]
    up = wp.vec3d(d(0.0), d(0.0), side)
    return note(scene, point - d(0.5) * gap * up, up, gap)


@wp.func
def on_rim(scene: Scene, point: wp.vec3d, along: wp.vec3d) -> wp.float64:
    """Where a cylinder's rim is nearest to a line through a point over it along a unit vector, an edge or another
    rim's tangent: by Newton's method, from under the point, taking the rim for its tangent."""
    radius = scene.pair.one.disc
    rim = wp.vec3d(point[0], point[1], sign(scene.way[2]) * scene.pair.one.span[2])
    across = wp.vec3d()
    for _step in range(TANGENTS):
        out = wp.normalize(wp.vec3d(rim[0], rim[1], d(0.0)))
        tangent = wp.vec3d(-out[1], out[0], d(0.0))
        across = wp.cross(tangent, along)
        if wp.length(across) < LEANS:
            return NONE
        onward = wp.dot(wp.cross(point - rim, along), across) / wp.dot(across, across)
        rim = radius * wp.normalize(radius * out + onward * tangent) + wp.vec3d(d(0.0), d(0.0), rim[2])
    n = sign(wp.dot(across, scene.way)) * wp.normalize(across)
    if wp.dot(n, scene.way) < ALL_BUT:
        return NONE
    gap = wp.dot(point - rim, n)
    return note(scene, rim + d(0.5) * gap * n, n, gap)


@wp.func
def rim_on_side(scene: Scene, centre: wp.vec3d, axis: wp.vec3d, arm: wp.vec3d) -> wp.float64:
    """Where a rim about a unit vector is nearest to a cylinder's axis: by Newton's method, from an arm off its centre.

    Turned on by a small angle its point moves along the tangent t, and half the square of its distance by x . t, whose
    own change is t^2 - x . arm, all across the axis.
    """
    for _step in range(TANGENTS):
        tangent = wp.cross(axis, arm)
        place = centre + arm
        slope = place[0] * tangent[0] + place[1] * tangent[1]
        bow = tangent[0] * tangent[0] + tangent[1] * tangent[1] - place[0] * arm[0] - place[1] * arm[1]
        if bow < LEANS * LEANS * wp.dot(arm, arm):
            return NONE
        arm = wp.length(arm) * wp.normalize(arm - slope / bow * tangent)
    return on_side(scene, centre + arm, d(0.0), wp.vec3d())


@wp.func
def on_face(scene: Scene, point: wp.vec3d, face: int, out: wp.vec3d) -> wp.float64:
    """A point over a box's face."""
    own = wp.transpose(scene.pair.turn) * (point - scene.pair.place)
    for k in range(3):
        if k != face and wp.abs(own[k]) > scene.pair.two.span[k] * (d(1.0) + ACROSS):
            return NONE
    gap = wp.dot(point - scene.pair.place, out) - scene.pair.two.span[face]
    return note(scene, point - d(0.5) * gap * out, -out, gap)


@wp.func
def facing(scene: Scene) -> int:
    """The face of a box that is turned to the cylinder most."""
    toward = wp.transpose(scene.pair.turn) * scene.way
    face = int(0)
    for k in range(1, 3):
        if wp.abs(toward[k]) > wp.abs(toward[face]):
            face = k
    return face


@wp.func
def low_point(out: wp.vec3d) -> wp.vec2d:
    """Which way a rim's lowest point over a face is; where that is rounding, any way that stays."""
    flat = wp.vec2d(out[0], out[1])
    if wp.length(flat) < LEVEL:
        return wp.vec2d(d(1.0), d(0.0))
    return -wp.normalize(flat)


@wp.func
def over_disc(scene: Scene, start: wp.vec3d, along: wp.vec3d) -> wp.vec2d:
    """Which part of a line, 0 to 1, is over a cylinder's end."""
    x = wp.vec2d(start[0], start[1])
    v = wp.vec2d(along[0], along[1])
    square = wp.max(wp.dot(v, v), ACROSS * ACROSS * ACROSS)
    nearest = -wp.dot(x, v) / square
    off = x + nearest * v
    room = scene.pair.one.disc * scene.pair.one.disc - wp.dot(off, off)
    if room < d(0.0):
        return wp.vec2d(d(0.0), d(0.0))
    half = wp.sqrt(room / square)
    return wp.vec2d(wp.clamp(nearest - half, d(0.0), d(1.0)), wp.clamp(nearest + half, d(0.0), d(1.0)))


@wp.func
def within(start: wp.float64, slope: wp.float64, half: wp.float64) -> wp.vec2d:
    """Where along a line start + slope t is within half of zero."""
    if wp.abs(slope) < ACROSS:
        if wp.abs(start) > half:
            return wp.vec2d(d(0.0), d(-1.0))
        return wp.vec2d(-NONE, NONE)
    one = (-half - start) / slope
    two = (half - start) / slope
    return wp.vec2d(wp.min(one, two), wp.max(one, two))


@wp.func
def over(place: wp.vec3d, centre: wp.vec3d, normal: wp.vec3d) -> wp.vec3d:
    """The point of a plane that is over a place, along Z."""
    return place + wp.vec3d(d(0.0), d(0.0), wp.dot(centre - place, normal) / normal[2])
