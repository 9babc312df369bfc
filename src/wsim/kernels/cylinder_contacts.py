"""Where a cylinder touches a box, a capsule or another cylinder: the nearest points, and all that lies on the other.

What is nearest is told by `wsim.kernels.apart`. Of what lies flat or along a line any point may bear, so the ends of
the line, points of the rim and corners of what both share are contacts too, each with its own gap. A contact's normal
meets the axis of what is round: so nothing without friction can turn it about its axis.
"""

from typing import Any

import warp as wp

from wsim.kernels.apart import apart, column, d, sign
from wsim.kernels.touches import (
    ACROSS,
    ALL_BUT,
    BARE,
    LEANS,
    LEVEL,
    NONE,
    Scene,
    Touches,
    facing,
    low_point,
    note,
    on_end,
    on_face,
    on_rim,
    on_side,
    over,
    over_disc,
    rim_on_side,
    within,
)

CAPSULE = wp.constant(3)  # mujoco.mjtGeom
CYLINDER = wp.constant(5)
BOX = wp.constant(6)


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
def _disc_on_box(scene: Scene) -> wp.float64:
    """A cylinder's end on a box: four points of its rim on the face, corners, and where edges leave it."""
    face = facing(scene)
    axis = column(scene.pair.turn, face)
    out = -sign(wp.dot(axis, scene.way)) * axis
    end = sign(scene.way[2]) * scene.pair.one.span[2]
    radius = scene.pair.one.disc
    nearest = NONE
    if wp.abs(out[2]) > ALL_BUT:
        lowest = low_point(out)
        for _k in range(4):
            rim = wp.vec3d(radius * lowest[0], radius * lowest[1], end)
            nearest = wp.min(nearest, on_face(scene, rim, face, out))
            lowest = wp.vec2d(-lowest[1], lowest[0])
    along = (face + 1) % 3
    aside = (face + 2) % 3
    one = scene.pair.two.span[along] * column(scene.pair.turn, along)
    two = scene.pair.two.span[aside] * column(scene.pair.turn, aside)
    middle = scene.pair.place + scene.pair.two.span[face] * out
    for _k in range(4):  # round the face
        corner = middle - one - two
        nearest = wp.min(nearest, _edge_on_end(scene, corner, d(2.0) * one))
        swap = one
        one = two
        two = -swap
    return nearest


@wp.func
def _edge_on_end(scene: Scene, start: wp.vec3d, along: wp.vec3d) -> wp.float64:
    """Where an edge enters what is over a cylinder's end, and where it leaves it; where it ends the next one starts."""
    inside = over_disc(scene, start, along)
    if inside[1] <= inside[0]:
        return NONE
    nearest = NONE
    if inside[0] > d(0.0):
        nearest = on_rim(scene, start + inside[0] * along, wp.normalize(along))
    else:
        nearest = on_end(scene, start)
    if inside[1] < d(1.0):
        nearest = wp.min(nearest, on_rim(scene, start + inside[1] * along, wp.normalize(along)))
    return nearest


@wp.func
def _side_on_box(scene: Scene) -> wp.float64:
    """A cylinder's side on a box: the ends of what lies on the face, or along an edge."""
    face = facing(scene)
    axis = column(scene.pair.turn, face)
    out = -sign(wp.dot(axis, scene.way)) * axis
    nearest = NONE
    if wp.abs(out[2]) < LEANS:
        down = -scene.pair.one.disc * wp.normalize(wp.vec3d(out[0], out[1], d(0.0)))
        low = -scene.pair.one.span[2]
        high = scene.pair.one.span[2]
        for k in range(3):
            if k != face:
                edge = column(scene.pair.turn, k)
                start = wp.dot(down - scene.pair.place, edge)
                part = within(start, edge[2], scene.pair.two.span[k])
                low = wp.max(low, part[0])
                high = wp.min(high, part[1])
        if high > low:
            nearest = on_face(scene, down + wp.vec3d(d(0.0), d(0.0), low), face, out)
            nearest = wp.min(nearest, on_face(scene, down + wp.vec3d(d(0.0), d(0.0), high), face, out))
    for k in range(3):
        if k != face and wp.abs(scene.pair.turn[2, k]) > ALL_BUT:
            other = 3 - face - k
            for side in range(2):
                beyond = wp.where(side == 0, d(1.0), d(-1.0)) * column(scene.pair.turn, other)
                nearest = wp.min(nearest, _side_on_edge(scene, k, face, out, other, beyond))
    return nearest


@wp.func
def _side_on_edge(scene: Scene, k: int, face: int, out: wp.vec3d, other: int, beyond: wp.vec3d) -> wp.float64:
    """Both ends of what of an edge between two faces of a box is beside a cylinder that faces it, not one of them."""
    along = column(scene.pair.turn, k)
    span = scene.pair.two.span
    middle = scene.pair.place + span[face] * out + span[other] * beyond
    part = within(middle[2], along[2], scene.pair.one.span[2])
    low = wp.max(part[0], -span[k])
    high = wp.min(part[1], span[k])
    if high <= low:
        return NONE
    nearest = NONE
    for end in range(2):
        place = middle + wp.where(end == 0, low, high) * along
        if place[0] * out[0] + place[1] * out[1] < ACROSS:
            if place[0] * beyond[0] + place[1] * beyond[1] < ACROSS:
                nearest = wp.min(nearest, on_side(scene, place, d(0.0), along))
    return nearest


@wp.func
def _side_on_round(scene: Scene) -> wp.float64:
    """A cylinder's side along another's or a capsule's: both ends of what is beside each other."""
    along = column(scene.pair.turn, 2)
    half = scene.pair.two.span[2]
    part = within(scene.pair.place[2], along[2], scene.pair.one.span[2])
    low = wp.max(part[0], -half)
    high = wp.min(part[1], half)
    if high <= low:
        return NONE
    radius = scene.pair.two.disc + scene.pair.two.ball
    nearest = NONE
    for end in range(2):
        share = wp.where(end == 0, low, high)
        centre = scene.pair.place + share * along
        if wp.abs(share) < half:
            nearest = wp.min(nearest, on_side(scene, centre, radius, along))
        elif scene.pair.two.disc == d(0.0):  # a ball
            nearest = wp.min(nearest, on_side(scene, centre, radius, wp.vec3d()))
        else:  # a rim
            toward = -wp.normalize(wp.vec3d(centre[0], centre[1], d(0.0)))
            arm = radius * wp.normalize(toward - wp.dot(toward, along) * along)
            nearest = wp.min(nearest, rim_on_side(scene, centre, along, arm))
    return nearest


@wp.func
def _line_on_end(scene: Scene) -> wp.float64:
    """The side of another cylinder, or of a capsule, across a cylinder's end: both ends of what is over it."""
    axis = column(scene.pair.turn, 2)
    along = d(2.0) * scene.pair.two.span[2] * axis
    side = sign(scene.way[2])
    toward = wp.normalize(axis[2] * axis - wp.vec3d(d(0.0), d(0.0), d(1.0)))
    start = scene.pair.place - d(0.5) * along + side * (scene.pair.two.disc + scene.pair.two.ball) * toward
    inside = over_disc(scene, start, along)
    if inside[1] <= inside[0]:
        return NONE
    nearest = NONE
    back = wp.transpose(scene.pair.turn)
    other = _turned_round(scene)
    centre = wp.vec3d(d(0.0), d(0.0), side * scene.pair.one.span[2])
    for end in range(2):
        place = start + inside[end] * along
        if inside[end] > d(0.0) and inside[end] < d(1.0):
            arm = scene.pair.one.disc * wp.normalize(wp.vec3d(place[0], place[1], d(0.0)))
            up = wp.vec3d(d(0.0), d(0.0), d(1.0))
            nearest = wp.min(nearest, rim_on_side(other, back * (centre - scene.pair.place), back * up, back * arm))
        else:
            nearest = wp.min(nearest, on_end(scene, place))
    return nearest


@wp.func
def _end_on_end(scene: Scene, other: Scene) -> wp.float64:
    """A cylinder's end on a larger one's: points of its rim, where both rims cross, and one of the other's inside."""
    radius = scene.pair.one.disc
    axis = column(scene.pair.turn, 2)
    out = -sign(wp.dot(axis, scene.way)) * axis
    centre = scene.pair.place + scene.pair.two.span[2] * out
    end = sign(scene.way[2]) * scene.pair.one.span[2]
    back = wp.transpose(scene.pair.turn)
    nearest = NONE
    lowest = low_point(out)
    for _k in range(4):
        rim = wp.vec3d(radius * lowest[0], radius * lowest[1], end)
        nearest = wp.min(nearest, on_end(other, back * (rim - scene.pair.place)))
        lowest = wp.vec2d(-lowest[1], lowest[0])
    between = wp.sqrt(centre[0] * centre[0] + centre[1] * centre[1])
    wide = scene.pair.two.disc
    if between < wide - radius + LEVEL * radius:
        return nearest
    way = wp.vec3d(centre[0] / between, centre[1] / between, d(0.0))
    along = (between * between + radius * radius - wide * wide) / (d(2.0) * between)
    room = radius * radius - along * along
    if room > d(0.0):
        for side in range(2):
            aside = wp.where(side == 0, wp.sqrt(room), -wp.sqrt(room))
            place = over(along * way + aside * wp.vec3d(-way[1], way[0], d(0.0)), centre, out)
            tangent = wp.normalize(wp.cross(out, place - centre))
            for _step in range(3):  # what is a circle seen along one axis is none along the other
                slope = d(2.0) * (place[0] * tangent[0] + place[1] * tangent[1])
                place += (radius * radius - place[0] * place[0] - place[1] * place[1]) / slope * tangent
                place = centre + wide * wp.normalize(place - centre)
                tangent = wp.normalize(wp.cross(out, place - centre))
            nearest = wp.min(nearest, on_rim(scene, place, tangent))
    if wp.abs(out[0]) + wp.abs(out[1]) < d(100.0) * LEVEL:
        nearest = wp.min(nearest, on_end(scene, over((between - wide) * way, centre, out)))
    return nearest


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
        own += wp.vec3d(d(0.0), d(0.0), sign(n[2]) * pair.one.span[2])
    toward = wp.transpose(pair.turn) * n
    two = -pair.two.ball * toward
    round = wp.sqrt(toward[0] * toward[0] + toward[1] * toward[1])
    stands = pair.two.disc > d(0.0) and round < ACROSS
    if round > ACROSS:
        two -= pair.two.disc / round * wp.vec3d(toward[0], toward[1], d(0.0))
    for k in range(3):
        if wp.abs(toward[k]) > ACROSS:
            two[k] -= sign(toward[k]) * pair.two.span[k]
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
    return note(scene, point, n, gap)


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
        along = column(scene.pair.turn, 2)
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
