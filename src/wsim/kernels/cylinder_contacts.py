"""Where a cylinder touches a box, a capsule or another cylinder: the nearest points, and all that lies on the other.

What is nearest is told by `wsim.kernels.apart`. Of what lies flat or along a line any point may bear, so the ends of the
line, points of the rim and corners of what both share are contacts too, each with its own gap. A contact's normal meets
the axis of what is round: so nothing without friction can turn it about its axis.
"""

from typing import Any

import warp as wp

from wsim.kernels.apart import Pair, apart, d

CAPSULE = wp.constant(3)  # mujoco.mjtGeom
CYLINDER = wp.constant(5)
BOX = wp.constant(6)
LEANS = wp.constant(wp.float64(0.1))  # [rad] of an end, a side or a face: what leans more touches with one point
ALL_BUT = wp.constant(wp.float64(0.995))  # its cosine
LEVEL = wp.constant(wp.float64(1.0e-5))  # [rad], where a drum leans by less, that way is rounding
ACROSS = wp.constant(wp.float64(1.0e-7))  # of a length: what lies across a direction
BARE = wp.constant(wp.float64(1.0e-6))  # [m]: the nearest points are a contact of their own from here on
NONE = wp.constant(wp.float64(1.0e9))
vec2 = wp.vec2d
vec3 = wp.vec3d


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
def _column(turn: wp.mat33d, k: int) -> wp.vec3d:
    return wp.vec3d(turn[0, k], turn[1, k], turn[2, k])


@wp.func
def _sign(x: wp.float64) -> wp.float64:
    return wp.where(x < d(0.0), d(-1.0), d(1.0))


@wp.func
def _note(scene: Scene, point: wp.vec3d, normal: wp.vec3d, gap: wp.float64) -> wp.float64:
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
def _on_side(scene: Scene, centre: wp.vec3d, radius: wp.float64, axis: wp.vec3d) -> wp.float64:
    """A point beside a cylinder, or one of the axis of another's side of a radius."""
    far = wp.sqrt(centre[0] * centre[0] + centre[1] * centre[1])
    if far == d(0.0):
        return NONE
    out = wp.vec3d(centre[0] / far, centre[1] / far, d(0.0))
    own = scene.pair.one.disc
    lean = wp.dot(out, axis)
    radius = radius / wp.sqrt(d(1.0) - lean * lean)
    gap = far - own - radius
    return _note(scene, wp.vec3d(d(0.0), d(0.0), centre[2]) + (own + d(0.5) * gap) * out, out, gap)


@wp.func
def _on_end(scene: Scene, point: wp.vec3d) -> wp.float64:
    """A point over a cylinder's end."""
    side = _sign(scene.way[2])
    far = wp.sqrt(point[0] * point[0] + point[1] * point[1])
    if far > scene.pair.one.disc * (d(1.0) + ACROSS):
        return NONE
    gap = side * point[2] - scene.pair.one.span[2]
    up = wp.vec3d(d(0.0), d(0.0), side)
    return _note(scene, point - d(0.5) * gap * up, up, gap)


@wp.func
def _on_rim(scene: Scene, point: wp.vec3d, along: wp.vec3d) -> wp.float64:
    """A point over a cylinder's rim where what goes on along a unit vector, an edge or another rim, crosses it."""
    side = _sign(scene.way[2])
    n = wp.cross(wp.vec3d(-point[1], point[0], d(0.0)), along)
    if wp.length(n) < LEANS * scene.pair.one.disc:
        return NONE
    n = _sign(wp.dot(n, scene.way)) * wp.normalize(n)
    if wp.dot(n, scene.way) < ALL_BUT:
        return NONE
    gap = (point[2] - side * scene.pair.one.span[2]) * n[2]
    return _note(scene, point - d(0.5) * gap * n, n, gap)


@wp.func
def _on_face(scene: Scene, point: wp.vec3d, face: int, out: wp.vec3d) -> wp.float64:
    """A point over a box's face."""
    own = wp.transpose(scene.pair.turn) * (point - scene.pair.place)
    for k in range(3):
        if k != face and wp.abs(own[k]) > scene.pair.two.span[k] * (d(1.0) + ACROSS):
            return NONE
    gap = wp.dot(point - scene.pair.place, out) - scene.pair.two.span[face]
    return _note(scene, point - d(0.5) * gap * out, -out, gap)


@wp.func
def _facing(scene: Scene) -> int:
    """The face of a box that is turned to the cylinder most."""
    toward = wp.transpose(scene.pair.turn) * scene.way
    face = int(0)
    for k in range(1, 3):
        if wp.abs(toward[k]) > wp.abs(toward[face]):
            face = k
    return face


@wp.func
def _disc_on_box(scene: Scene) -> wp.float64:
    """A cylinder's end on a box: four points of its rim on the face, corners, and where edges leave it."""
    face = _facing(scene)
    axis = _column(scene.pair.turn, face)
    out = -_sign(wp.dot(axis, scene.way)) * axis
    end = _sign(scene.way[2]) * scene.pair.one.span[2]
    radius = scene.pair.one.disc
    nearest = NONE
    if wp.abs(out[2]) > ALL_BUT:
        lowest = _low_point(out)
        for k in range(4):
            rim = wp.vec3d(radius * lowest[0], radius * lowest[1], end)
            nearest = wp.min(nearest, _on_face(scene, rim, face, out))
            lowest = wp.vec2d(-lowest[1], lowest[0])
    along = (face + 1) % 3
    aside = (face + 2) % 3
    one = scene.pair.two.span[along] * _column(scene.pair.turn, along)
    two = scene.pair.two.span[aside] * _column(scene.pair.turn, aside)
    middle = scene.pair.place + scene.pair.two.span[face] * out
    for _k in range(4):  # round the face
        corner = middle - one - two
        nearest = wp.min(nearest, _edge_on_end(scene, corner, d(2.0) * one))
        swap = one
        one = two
        two = -swap
    return nearest


@wp.func
def _low_point(out: wp.vec3d) -> wp.vec2d:
    """Which way a rim's lowest point over a face is; where that is rounding, any way that stays."""
    flat = wp.vec2d(out[0], out[1])
    if wp.length(flat) < LEVEL:
        return wp.vec2d(d(1.0), d(0.0))
    return -wp.normalize(flat)


@wp.func
def _edge_on_end(scene: Scene, start: wp.vec3d, along: wp.vec3d) -> wp.float64:
    """Where an edge enters what is over a cylinder's end, and where it leaves it; where it ends the next one starts."""
    inside = _over_disc(scene, start, along)
    if inside[1] <= inside[0]:
        return NONE
    nearest = NONE
    if inside[0] > d(0.0):
        nearest = _on_rim(scene, start + inside[0] * along, wp.normalize(along))
    else:
        nearest = _on_end(scene, start)
    if inside[1] < d(1.0):
        nearest = wp.min(nearest, _on_rim(scene, start + inside[1] * along, wp.normalize(along)))
    return nearest


@wp.func
def _over_disc(scene: Scene, start: wp.vec3d, along: wp.vec3d) -> wp.vec2d:
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
def _side_on_box(scene: Scene) -> wp.float64:
    """A cylinder's side on a box: the ends of what lies on the face, or along an edge."""
    face = _facing(scene)
    axis = _column(scene.pair.turn, face)
    out = -_sign(wp.dot(axis, scene.way)) * axis
    nearest = NONE
    if wp.abs(out[2]) < LEANS:
        down = -scene.pair.one.disc * wp.normalize(wp.vec3d(out[0], out[1], d(0.0)))
        low = -scene.pair.one.span[2]
        high = scene.pair.one.span[2]
        for k in range(3):
            if k != face:
                edge = _column(scene.pair.turn, k)
                start = wp.dot(down - scene.pair.place, edge)
                part = _within(start, edge[2], scene.pair.two.span[k])
                low = wp.max(low, part[0])
                high = wp.min(high, part[1])
        if high > low:
            nearest = _on_face(scene, down + wp.vec3d(d(0.0), d(0.0), low), face, out)
            nearest = wp.min(nearest, _on_face(scene, down + wp.vec3d(d(0.0), d(0.0), high), face, out))
    for k in range(3):
        if k != face and wp.abs(scene.pair.turn[2, k]) > ALL_BUT:
            other = 3 - face - k
            for side in range(2):
                beyond = wp.where(side == 0, d(1.0), d(-1.0)) * _column(scene.pair.turn, other)
                nearest = wp.min(nearest, _side_on_edge(scene, k, face, out, other, beyond))
    return nearest


@wp.func
def _within(start: wp.float64, slope: wp.float64, half: wp.float64) -> wp.vec2d:
    """Where along a line start + slope t is within half of zero."""
    if wp.abs(slope) < ACROSS:
        if wp.abs(start) > half:
            return wp.vec2d(d(0.0), d(-1.0))
        return wp.vec2d(-NONE, NONE)
    one = (-half - start) / slope
    two = (half - start) / slope
    return wp.vec2d(wp.min(one, two), wp.max(one, two))


@wp.func
def _side_on_edge(scene: Scene, k: int, face: int, out: wp.vec3d, other: int, beyond: wp.vec3d) -> wp.float64:
    """Both ends of what of an edge between two faces of a box is beside a cylinder that faces it, not one of them."""
    along = _column(scene.pair.turn, k)
    span = scene.pair.two.span
    middle = scene.pair.place + span[face] * out + span[other] * beyond
    part = _within(middle[2], along[2], scene.pair.one.span[2])
    low = wp.max(part[0], -span[k])
    high = wp.min(part[1], span[k])
    if high <= low:
        return NONE
    nearest = NONE
    for end in range(2):
        place = middle + wp.where(end == 0, low, high) * along
        if place[0] * out[0] + place[1] * out[1] < ACROSS:
            if place[0] * beyond[0] + place[1] * beyond[1] < ACROSS:
                nearest = wp.min(nearest, _on_side(scene, place, d(0.0), along))
    return nearest


@wp.func
def _side_on_round(scene: Scene) -> wp.float64:
    """A cylinder's side along another's or a capsule's: both ends of what is beside each other."""
    along = _column(scene.pair.turn, 2)
    half = scene.pair.two.span[2]
    part = _within(scene.pair.place[2], along[2], scene.pair.one.span[2])
    low = wp.max(part[0], -half)
    high = wp.min(part[1], half)
    if high <= low:
        return NONE
    radius = scene.pair.two.disc + scene.pair.two.ball
    nearest = NONE
    for end in range(2):
        share = wp.where(end == 0, low, high)
        centre = scene.pair.place + share * along
        if scene.pair.two.disc > d(0.0) and wp.abs(share) == half:  # its rim
            rim = centre
            for _step in range(2):
                toward = -wp.normalize(wp.vec3d(rim[0], rim[1], d(0.0)))
                rim = centre + radius * wp.normalize(toward - wp.dot(toward, along) * along)
            nearest = wp.min(nearest, _on_side(scene, rim, d(0.0), along))
        else:
            nearest = wp.min(nearest, _on_side(scene, centre, radius, along))
    return nearest


@wp.func
def _line_on_end(scene: Scene) -> wp.float64:
    """The side of another cylinder, or of a capsule, across a cylinder's end: both ends of what is over it."""
    axis = _column(scene.pair.turn, 2)
    along = d(2.0) * scene.pair.two.span[2] * axis
    side = _sign(scene.way[2])
    toward = wp.normalize(axis[2] * axis - wp.vec3d(d(0.0), d(0.0), d(1.0)))
    start = scene.pair.place - d(0.5) * along + side * (scene.pair.two.disc + scene.pair.two.ball) * toward
    inside = _over_disc(scene, start, along)
    if inside[1] <= inside[0]:
        return NONE
    nearest = NONE
    for end in range(2):
        place = start + inside[end] * along
        if inside[end] > d(0.0) and inside[end] < d(1.0):
            nearest = wp.min(nearest, _on_rim(scene, place, axis))
        else:
            nearest = wp.min(nearest, _on_end(scene, place))
    return nearest


@wp.func
def _end_on_end(scene: Scene, other: Scene) -> wp.float64:
    """A cylinder's end on a larger one's: points of its rim, where both rims cross, and where the larger's is inside."""
    radius = scene.pair.one.disc
    axis = _column(scene.pair.turn, 2)
    facing = -_sign(wp.dot(axis, scene.way)) * axis
    centre = scene.pair.place + scene.pair.two.span[2] * facing
    end = _sign(scene.way[2]) * scene.pair.one.span[2]
    back = wp.transpose(scene.pair.turn)
    nearest = NONE
    lowest = _low_point(facing)
    for _k in range(4):
        rim = wp.vec3d(radius * lowest[0], radius * lowest[1], end)
        nearest = wp.min(nearest, _on_end(other, back * (rim - scene.pair.place)))
        lowest = wp.vec2d(-lowest[1], lowest[0])
    apart = wp.sqrt(centre[0] * centre[0] + centre[1] * centre[1])
    wide = scene.pair.two.disc
    if apart < wide - radius + LEVEL * radius:
        return nearest
    way = wp.vec3d(centre[0] / apart, centre[1] / apart, d(0.0))
    along = (apart * apart + radius * radius - wide * wide) / (d(2.0) * apart)
    room = radius * radius - along * along
    if room > d(0.0):
        for side in range(2):
            aside = wp.where(side == 0, wp.sqrt(room), -wp.sqrt(room))
            place = _over(along * way + aside * wp.vec3d(-way[1], way[0], d(0.0)), centre, facing)
            tangent = wp.normalize(wp.cross(facing, place - centre))
            for _step in range(3):  # what is a circle seen along one axis is none along the other
                slope = d(2.0) * (place[0] * tangent[0] + place[1] * tangent[1])
                place += (radius * radius - place[0] * place[0] - place[1] * place[1]) / slope * tangent
                place = centre + wide * wp.normalize(place - centre)
                tangent = wp.normalize(wp.cross(facing, place - centre))
            nearest = wp.min(nearest, _on_rim(scene, place, tangent))
    if wp.abs(facing[0]) + wp.abs(facing[1]) < d(100.0) * LEVEL:
        nearest = wp.min(nearest, _on_end(scene, _over((apart - wide) * way, centre, facing)))
    return nearest


@wp.func
def _over(place: wp.vec3d, centre: wp.vec3d, normal: wp.vec3d) -> wp.vec3d:
    """The point of a plane that is over a place, along Z."""
    return place + wp.vec3d(d(0.0), d(0.0), wp.dot(centre - place, normal) / normal[2])


@wp.func
def _nearest_points(scene: Scene, gap: wp.float64) -> wp.float64:
    """The contact between the points that are nearest: along edges and sides across the way those that fit."""
    pair = scene.pair
    n = scene.way
    flat = wp.sqrt(n[0] * n[0] + n[1] * n[1])
    own = wp.vec3d(d(0.0), d(0.0), d(0.0))
    if flat > ACROSS:
        own = pair.one.disc / flat * wp.vec3d(n[0], n[1], d(0.0))
    lies = wp.abs(n[2]) < ACROSS
    if not lies:
        own += wp.vec3d(d(0.0), d(0.0), _sign(n[2]) * pair.one.span[2])
    toward = wp.transpose(pair.turn) * n
    two = -pair.two.ball * toward
    round = wp.sqrt(toward[0] * toward[0] + toward[1] * toward[1])
    stands = pair.two.disc > d(0.0) and round < ACROSS
    if round > ACROSS:
        two -= pair.two.disc / round * wp.vec3d(toward[0], toward[1], d(0.0))
    for k in range(3):
        if wp.abs(toward[k]) > ACROSS:
            two[k] -= _sign(toward[k]) * pair.two.span[k]
    miss = wp.transpose(pair.turn) * (pair.place - own) + two  # from the one's point to the other's
    if lies:
        slides = wp.transpose(pair.turn) * wp.vec3d(d(0.0), d(0.0), d(1.0))
        left = miss - wp.dot(miss, toward) * toward
        free = slides
        for k in range(3):
            if wp.abs(toward[k]) <= ACROSS and pair.two.span[k] > d(0.0):
                left[k] = d(0.0)
                free[k] = d(0.0)
        share = wp.dot(left, free) / wp.max(wp.dot(free, free), ACROSS * ACROSS)
        share = wp.clamp(share, -pair.one.span[2], pair.one.span[2])
        own += wp.vec3d(d(0.0), d(0.0), share)
        miss -= share * slides
    for k in range(3):
        if wp.abs(toward[k]) <= ACROSS:
            two[k] -= wp.clamp(miss[k], -pair.two.span[k], pair.two.span[k])
    point = own + d(0.5) * gap * n
    if flat <= ACROSS and not stands:  # an end: where the other is
        point = pair.place + pair.turn * two - d(0.5) * gap * n
    return _note(scene, point, n, gap)


@wp.func
def _turned_round(scene: Scene) -> Scene:
    """The same pair as the other sees it."""
    back = wp.transpose(scene.pair.turn)
    other = scene
    other.pair.one = scene.pair.two
    other.pair.two = scene.pair.one
    other.pair.place = -(back * scene.pair.place)
    other.pair.turn = back
    other.way = -(back * scene.way)
    other.turn = scene.turn * scene.pair.turn
    other.middle = scene.middle + scene.turn * scene.pair.place
    other.sense = -scene.sense
    return other


@wp.func
def _touch(scene: Scene, gap: wp.float64, is_box: bool):
    """All contacts of a pair whose way is known."""
    leans = wp.abs(scene.way[2])
    nearest = NONE
    if is_box:
        if leans > ALL_BUT:
            nearest = _disc_on_box(scene)
        elif leans < LEANS:
            nearest = _side_on_box(scene)
    else:
        along = _column(scene.pair.turn, 2)
        lean = wp.abs(wp.dot(along, scene.way))
        if leans < LEANS and wp.abs(along[2]) > ALL_BUT:
            nearest = _side_on_round(scene)
        elif leans > ALL_BUT and lean < LEANS:
            nearest = _line_on_end(scene)
        elif scene.pair.two.disc > d(0.0):
            other = _turned_round(scene)
            if leans < LEANS and lean > ALL_BUT:
                nearest = _line_on_end(other)
            elif leans > ALL_BUT and lean > ALL_BUT:
                if scene.pair.one.disc <= scene.pair.two.disc:
                    nearest = _end_on_end(scene, other)
                else:
                    nearest = _end_on_end(other, scene)
    if nearest > gap + BARE:
        _nearest_points(scene, gap)


@wp.func
def _vector(x: Any) -> wp.vec3d:
    return wp.vec3d(d(x[0]), d(x[1]), d(x[2]))


@wp.func
def _matrix(x: Any) -> wp.mat33d:
    return wp.mat33d(
        d(x[0, 0]), d(x[0, 1]), d(x[0, 2]), d(x[1, 0]), d(x[1, 1]), d(x[1, 2]), d(x[2, 0]), d(x[2, 1]), d(x[2, 2])
    )


@wp.kernel(enable_backward=False)
def touch_cylinders(
    # Model:
    geom_type: wp.array(dtype=int),
    geom_size: wp.array2d(dtype=Any),
    pairs: wp.array(dtype=wp.vec2i),  # of geoms, a cylinder first
    # Data in:
    geom_xpos: wp.array2d(dtype=Any),
    geom_xmat: wp.array2d(dtype=Any),
    reach: float,
    # Data out:
    found: Touches,
):
    """All contacts of cylinders with boxes, capsules and each other, in all worlds."""
    world, number = wp.tid()
    one = pairs[number][0]
    two = pairs[number][1]
    size = _vector(geom_size[world % geom_size.shape[0], one])
    other = _vector(geom_size[world % geom_size.shape[0], two])
    kind = geom_type[two]
    scene = Scene()
    scene.pair.one.span = wp.vec3d(d(0.0), d(0.0), size[1])
    scene.pair.one.disc = size[0]
    if kind == BOX:
        scene.pair.two.span = other
    else:
        scene.pair.two.span = wp.vec3d(d(0.0), d(0.0), other[1])
        scene.pair.two.disc = wp.where(kind == CYLINDER, other[0], d(0.0))
        scene.pair.two.ball = wp.where(kind == CAPSULE, other[0], d(0.0))
    scene.middle = _vector(geom_xpos[world, one])
    apart_by = _vector(geom_xpos[world, two]) - scene.middle
    bounds = wp.length(scene.pair.one.span) + size[0] + wp.length(scene.pair.two.span)
    scene.most = d(reach)
    if wp.length(apart_by) > bounds + scene.pair.two.disc + scene.pair.two.ball + scene.most:
        return
    scene.turn = _matrix(geom_xmat[world, one])
    scene.pair.place = wp.transpose(scene.turn) * apart_by
    scene.pair.turn = wp.transpose(scene.turn) * _matrix(geom_xmat[world, two])
    best = apart(scene.pair, scene.most)
    if best[3] > scene.most:
        return
    scene.way = wp.vec3d(best[0], best[1], best[2])
    scene.least = d(2.0) * wp.min(best[3], d(0.0)) - LEANS * scene.most
    scene.sense = d(1.0)
    scene.number = number
    scene.world = world
    scene.list = found
    _touch(scene, best[3], kind == BOX)
