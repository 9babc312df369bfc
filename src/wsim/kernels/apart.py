"""How far a cylinder is from a box, a capsule or another cylinder, and which way: exactly, also where they overlap.

Each is a sum of three segments, a disc about its Z axis and a ball, and is its own mirror image. Along a direction n
two convex bodies are apart by g(n) = c . n - h_A(n) - h_B(n), c from one middle to the other, h how far a body reaches;
their distance is the greatest g of all directions, below 0 how far they overlap (the separating axis theorem). The
greatest is where all is smooth or on a great circle where an edge, or a cylinder's side, lies across n. So these are
tried: faces and ends, an edge across an edge or a side, a corner beside a side or beyond a rim, all in closed form; a
rim on an edge, by secants along its circle; and a rim on a rim, by Newton's method.
All is in the frame of the first, which is the cylinder. What is tried too much does no harm.
"""

import warp as wp

d = wp.float64
TINY = wp.constant(wp.float64(1.0e-9))
NEAR = wp.constant(wp.float64(0.2))  # cosine: a rim that faces away by no more may be one that touches
SECANTS = wp.constant(24)
RIM_STEPS = wp.constant(24)


@wp.struct
class Solid:
    """A box by its half edges, or what is round about Z by half its length."""

    span: wp.vec3d
    disc: wp.float64  # radius
    ball: wp.float64


@wp.struct
class Pair:
    """A cylinder, what is near it, and where: its middle, and its axes as columns."""

    one: Solid
    two: Solid
    place: wp.vec3d
    turn: wp.mat33d


@wp.func
def reach(solid: Solid, n: wp.vec3d) -> wp.float64:
    """How far a body reaches from its middle along a unit vector in its own frame."""
    far = solid.ball + solid.disc * wp.sqrt(n[0] * n[0] + n[1] * n[1])
    return far + wp.abs(n[0]) * solid.span[0] + wp.abs(n[1]) * solid.span[1] + wp.abs(n[2]) * solid.span[2]


@wp.func
def _reach_change(solid: Solid, n: wp.vec3d, turned: wp.vec3d) -> wp.float64:
    """How that grows as n turns towards a unit vector across it."""
    grows = wp.sign(n[0]) * turned[0] * solid.span[0] + wp.sign(n[1]) * turned[1] * solid.span[1]
    grows += wp.sign(n[2]) * turned[2] * solid.span[2]
    flat = wp.sqrt(n[0] * n[0] + n[1] * n[1])
    if flat > d(0.0):
        grows += solid.disc * (n[0] * turned[0] + n[1] * turned[1]) / flat
    return grows


@wp.func
def gap_along(pair: Pair, n: wp.vec3d) -> wp.float64:
    """How far a pair is apart along a unit vector [m]."""
    return wp.dot(pair.place, n) - reach(pair.one, n) - reach(pair.two, wp.transpose(pair.turn) * n)


@wp.func
def _gap_change(pair: Pair, n: wp.vec3d, turned: wp.vec3d) -> wp.float64:
    back = wp.transpose(pair.turn)
    return (
        wp.dot(pair.place, turned)
        - _reach_change(pair.one, n, turned)
        - _reach_change(pair.two, back * n, back * turned)
    )


@wp.func
def _try(pair: Pair, way: wp.vec3d, best: wp.vec4d) -> wp.vec4d:
    """The better of a direction, of any length and either sense, and the best so far, with its gap."""
    length = wp.length(way)
    if length < TINY:
        return best
    n = way / length
    if wp.dot(pair.place, n) < d(0.0):
        n = -n
    gap = gap_along(pair, n)
    if gap > best[3]:
        return wp.vec4d(n[0], n[1], n[2], gap)
    return best


@wp.func
def sign(x: wp.float64) -> wp.float64:
    """1, also of 0, or -1."""
    return wp.where(x < d(0.0), d(-1.0), d(1.0))


@wp.func
def column(turn: wp.mat33d, k: int) -> wp.vec3d:
    """A column of a matrix: an axis of what it turns."""
    return wp.vec3d(turn[0, k], turn[1, k], turn[2, k])


@wp.func
def _cut(quarter: int, cut: int, inner: wp.float64, bend: wp.float64) -> wp.float64:
    """The bounds of the three arcs of a quarter of a circle."""
    other = wp.where(quarter % 2 == 0, bend, d(0.5 * wp.pi) - bend)
    if cut == 0:
        return d(0.0)
    if cut == 1:
        return wp.min(inner, other)
    if cut == 2:
        return wp.max(inner, other)
    return d(0.5 * wp.pi)


@wp.func
def _gain(pair: Pair, first: wp.vec3d, second: wp.vec3d, angle: wp.float64) -> wp.float64:
    """How the gap grows as the direction goes on round a circle."""
    n = wp.cos(angle) * first + wp.sin(angle) * second
    return _gap_change(pair, n, wp.cos(angle) * second - wp.sin(angle) * first)


@wp.func
def _top(pair: Pair, first: wp.vec3d, second: wp.vec3d, low: wp.float64, high: wp.float64) -> wp.vec3d:
    """Where on an arc the gap stops growing: by secants, of which none keeps an end for long (Dowell, Jarratt 1971)."""
    rises = _gain(pair, first, second, low)
    falls = _gain(pair, first, second, high)
    middle = d(0.5) * (low + high)
    side = int(0)
    for _step in range(SECANTS):
        middle = low + (high - low) * rises / (rises - falls)
        there = _gain(pair, first, second, middle)
        if wp.abs(there) < TINY * TINY or high - low < TINY * TINY:
            break
        if there > d(0.0):
            low = middle
            rises = there
            if side == 1:
                falls *= d(0.5)
            side = 1
        else:
            high = middle
            falls = there
            if side == -1:
                rises *= d(0.5)
            side = -1
    return wp.cos(middle) * first + wp.sin(middle) * second


@wp.func
def _on_circle(pair: Pair, across: wp.vec3d, axis: wp.vec3d, other: wp.vec3d, best: wp.vec4d) -> wp.vec4d:
    """The best direction at right angles to `across`, an edge or a side, for a rim about `axis` to touch it.

    The circle is cut where corners change: at `other`, at right angles to `across`, every quarter; at the rim's axis
    and across it; and where the rim's share, -r sqrt(1 - (axis . n)^2), bends from one way to the other,
    sin^2 = b / (1 + b), b = |axis . across|.
    """
    tilt = wp.abs(wp.dot(axis, across))
    first = axis - wp.dot(axis, across) * across
    if wp.length(first) < d(1.0e-6):
        return best
    first = wp.normalize(first)
    second = wp.cross(across, first)
    quarter = d(0.5 * wp.pi)
    inner = wp.atan2(wp.dot(other, second), wp.dot(other, first))
    inner = inner - quarter * wp.floor(inner / quarter)
    bend = wp.asin(wp.sqrt(tilt / (d(1.0) + tilt)))
    arcs = int(12)
    for arc in range(arcs):
        turns = arc / 3
        low = quarter * d(float(turns)) + _cut(turns, arc - 3 * turns, inner, bend) + TINY
        high = quarter * d(float(turns)) + _cut(turns, arc - 3 * turns + 1, inner, bend) - TINY
        middle = d(0.5) * (low + high)
        away = wp.dot(pair.place, wp.cos(middle) * first + wp.sin(middle) * second) < d(0.0)
        if away or _gain(pair, first, second, low) <= d(0.0) or _gain(pair, first, second, high) >= d(0.0):
            continue
        best = _try(pair, _top(pair, first, second, low, high), best)
    return best


@wp.func
def _rims_gap(pair: Pair, corner: wp.vec3d, n: wp.vec3d) -> wp.float64:
    """How far two rims are apart, that about `corner` seen from the other's middle."""
    gap = wp.dot(corner, n) - pair.one.disc * wp.sqrt(n[0] * n[0] + n[1] * n[1])
    return gap - pair.two.disc * wp.length(wp.cross(column(pair.turn, 2), n))


@wp.func
def _on_rims(pair: Pair, corner: wp.vec3d, start: wp.vec3d, best: wp.vec4d) -> wp.vec4d:
    """The best direction where both rims touch, near `start`, by Newton's method; the longest step shrinks as it fails.

    Along the tangents of the unit sphere the gap g = corner . n - sum r |n x axis| has the Hessian
    -sum r / |n x axis| q q^T - g, q the rim's own tangent.
    """
    up = wp.vec3d(d(0.0), d(0.0), d(1.0))
    n = start
    limit = d(0.5)
    for _step in range(RIM_STEPS):
        first = wp.cross(up, n)
        if wp.abs(n[2]) > d(0.9):
            first = wp.cross(wp.vec3d(d(1.0), d(0.0), d(0.0)), n)
        first = wp.normalize(first)
        second = wp.cross(n, first)
        gap = _rims_gap(pair, corner, n)
        slope = wp.vec2d(wp.dot(corner, first), wp.dot(corner, second))
        stiff = wp.max(gap, d(1.0e-3) * pair.one.disc)
        bow = wp.diag(wp.vec2d(stiff, stiff))
        for rim in range(2):
            axis = wp.where(rim == 0, up, column(pair.turn, 2))
            radius = wp.where(rim == 0, pair.one.disc, pair.two.disc)
            tangent = wp.cross(axis, n)
            flat = wp.max(wp.length(tangent), TINY)
            q = wp.vec2d(wp.dot(tangent, first), wp.dot(tangent, second)) / flat
            outward = wp.cross(tangent, axis) / flat
            slope -= radius * wp.vec2d(wp.dot(outward, first), wp.dot(outward, second))
            bow += radius / flat * wp.outer(q, q)
        move = wp.inverse(bow) * slope
        if wp.length(move) < TINY:
            break
        move *= wp.min(d(1.0), limit / wp.length(move))
        there = wp.normalize(n + move[0] * first + move[1] * second)
        if _rims_gap(pair, corner, there) >= gap:
            n = there
        else:
            limit = d(0.3) * wp.length(move)
    return _try(pair, n, best)


@wp.func
def _off_axis(pair: Pair, corner: wp.vec3d, axis: wp.vec3d, other: wp.vec3d, best: wp.vec4d, from_one: int) -> wp.vec4d:
    """The same from where a rim's axis points, if the gap grows off it: the way that all but this rim would have it."""
    radius = wp.where(from_one == 1, pair.one.disc, pair.two.disc)
    rest = wp.where(from_one == 1, pair.two.disc, pair.one.disc)
    n = sign(wp.dot(pair.place, axis)) * axis
    tangent = wp.cross(other, n)
    flat = wp.max(wp.length(tangent), TINY)
    slope = corner - rest / flat * wp.cross(tangent, other)
    gap = wp.dot(slope, n)
    slope -= gap * n
    steep = wp.length(slope)
    if steep <= radius:
        return best
    step = wp.min((steep - radius) / (rest / flat + wp.max(gap, d(0.0))), d(0.3))
    return _on_rims(pair, corner, wp.normalize(n + step / steep * slope), best)


@wp.func
def _where_rims_cross(pair: Pair, corner: wp.vec3d, best: wp.vec4d) -> wp.vec4d:
    """The same from all starts: off each axis, and across the tangents where one rim is next to the other's plane."""
    up = wp.vec3d(d(0.0), d(0.0), d(1.0))
    best = _off_axis(pair, corner, up, column(pair.turn, 2), best, 1)
    best = _off_axis(pair, corner, column(pair.turn, 2), up, best, 0)
    axis = column(pair.turn, 2)
    tilt = wp.sqrt(axis[0] * axis[0] + axis[1] * axis[1])
    if tilt < TINY:
        return best
    first = wp.vec3d(axis[0], axis[1], d(0.0)) / tilt
    radius = pair.one.disc
    off = wp.clamp(wp.dot(corner, axis) / tilt, -radius, radius)  # of the end's plane from the rim's middle
    half = wp.sqrt(radius * radius - off * off)
    for side in range(2):
        aside = wp.where(side == 0, half, -half)
        place = wp.vec3d(off * first[0] - aside * first[1], off * first[1] + aside * first[0], d(0.0))
        start = wp.cross(wp.vec3d(-place[1], place[0], d(0.0)), wp.cross(axis, place - corner))
        if wp.dot(start, pair.place) < d(0.0):
            start = -start
        if wp.length(start) > TINY:
            best = _on_rims(pair, corner, wp.normalize(start), best)
    return best


@wp.func
def _past_corner(pair: Pair, corner: wp.vec3d, best: wp.vec4d) -> wp.vec4d:
    """The best of the directions of a corner from the cylinder's side and from its two rims."""
    best = _try(pair, wp.vec3d(corner[0], corner[1], d(0.0)), best)
    flat = wp.sqrt(corner[0] * corner[0] + corner[1] * corner[1])
    if flat < TINY:
        return best
    share = (flat - pair.one.disc) / flat
    for end in range(2):
        rise = corner[2] - wp.where(end == 0, -pair.one.span[2], pair.one.span[2])
        best = _try(pair, wp.vec3d(share * corner[0], share * corner[1], rise), best)
    return best


@wp.func
def apart(pair: Pair, enough: wp.float64) -> wp.vec4d:
    """The direction from a cylinder to another body along which they are apart, and by how much [m], last.

    Where that is more than `enough` [m] it may be less than the distance.
    """
    up = wp.vec3d(d(0.0), d(0.0), d(1.0))
    best = wp.vec4d(d(0.0), d(0.0), d(1.0), d(-1.0e9))
    best = _try(pair, pair.place, best)
    best = _try(pair, up, best)
    best = _try(pair, wp.vec3d(pair.place[0], pair.place[1], d(0.0)), best)
    for k in range(3):
        edge = column(pair.turn, k)
        if k == 2 or pair.two.span[k] > d(0.0):
            best = _try(pair, edge, best)
            best = _try(pair, wp.cross(up, edge), best)
            best = _try(pair, pair.place - wp.dot(pair.place, edge) * edge, best)
    if best[3] > enough:
        return best
    corners = int(8)
    for k in range(corners):
        doubled = (k & 1) != 0 and pair.two.span[0] == d(0.0)
        if doubled or ((k & 2) != 0 and pair.two.span[1] == d(0.0)):
            continue
        x = wp.where((k & 1) == 0, pair.two.span[0], -pair.two.span[0])
        y = wp.where((k & 2) == 0, pair.two.span[1], -pair.two.span[1])
        z = wp.where((k & 4) == 0, pair.two.span[2], -pair.two.span[2])
        best = _past_corner(pair, pair.place + pair.turn * wp.vec3d(x, y, z), best)
    if best[3] > enough:
        return best
    edges = int(3)
    for k in range(edges):
        if pair.two.span[k] > d(0.0):
            best = _on_circle(pair, column(pair.turn, k), up, column(pair.turn, (k + 1) % 3), best)
    if pair.two.disc > d(0.0):
        best = _on_circle(pair, up, column(pair.turn, 2), column(pair.turn, 2), best)
        axis = column(pair.turn, 2)
        way = wp.vec3d(best[0], best[1], best[2])
        ends = int(4)
        for k in range(ends):
            one = wp.where((k & 1) == 0, d(1.0), d(-1.0))
            two = wp.where((k & 2) == 0, d(1.0), d(-1.0))
            if one * way[2] > -NEAR and two * wp.dot(axis, way) < NEAR:
                best = _where_rims_cross(
                    pair, pair.place + two * pair.two.span[2] * axis - one * pair.one.span[2] * up, best
                )
    return best
