"""Where moving shapes touch a surface of triangles that stands still, as rows of contact need it.

Three things may touch: a corner of the shape a face, a convex edge of the surface the shape, and a corner of the
surface the shape (an edge's end). An edge between faces of one plane is none, so nothing catches on it.

A surface whose corners have normals is a curved one, of the second order: a point q of a triangle is lifted to the mean
of its projections on the tangent planes at the corners, half of the way (Boubekeur and Alexa, Phong tessellation, 2008:
half is a circle's arc). The normal that a ball touches with is that of the surface so made, along which the gap grows,
so that a push does no work on what keeps its gap; the corners' normals, interpolated, lean from it where the bend
changes along the triangle. These push what has corners: where triangles meet at large angles, they alone go over from
one to the next without a jump.
Its curvature makes a gap that closes along a straight way:
of the speed v along it the gap has lost v^2 / (2 R) h^2 at the end of a step of h. So what goes along a curve is asked
for a speed from the surface of v^2 h / (2 R) at a step's end, as it has one of that into the surface at its start:
the contact turns the velocity and takes none of it (the leapfrog of a constraint; Ryckaert et al. 1977).
"""

import warp as wp

from wsim.kernels.convex import SPHERE, Convex, corner_arm, corner_centre, corner_count, signed

FOOT_STEPS = wp.constant(16)  # to a curved surface's nearest point
HALVINGS = wp.constant(24)
INSIDE = wp.constant(1.0e-4)  # of a triangle: what lies on the line between two belongs to both
INSIDE_CURVED = wp.constant(1.0e-2)  # two curved ones meet at their line to the second order only
GUARD = wp.constant(1.0e-4)  # [m]: nearer than this to a convex edge the edge touches, not the face
LEVEL = wp.constant(1.0e-5)  # [m]: faces of two objects that differ by less are one plane
ASIDE = wp.constant(1.0e-4)  # [m]: how far beyond an edge another object's face must begin to carry on its plane
STEEPEST = wp.constant(0.2)  # cosine between a triangle's normal and one at its corners, at least
LEANS = wp.constant(0.01)  # [rad] into the surface, at most
ALONG = wp.constant(0.9995)  # cosine: one direction


@wp.struct
class Surface:
    """Triangles that stand still, in the world's frame."""

    mesh: wp.uint64
    points: wp.array(dtype=wp.vec3)
    corners: wp.array2d(dtype=int)  # (faces, 3)
    normals: wp.array2d(dtype=wp.vec3)  # (faces, 3), outward
    curved: wp.array(dtype=int)
    open: wp.array(dtype=int)  # whether a face is a sheet's, of two sides
    part: wp.array(dtype=int)  # which object a face is of
    edge: wp.array2d(dtype=int)  # (faces, 3): edge k is from corner k on; 1 sharp, 2 curved, 0 none of its own
    guard: wp.array2d(dtype=int)  # whether what is nearer to it than `GUARD` is the edge's
    beyond: wp.array2d(dtype=int)  # the point across the edge, or -1
    ring_first: wp.array(dtype=int)
    ring: wp.array(dtype=int)


@wp.struct
class Found:
    """Contacts, some slots for each probe."""

    count: wp.array(dtype=int)
    position: wp.array2d(dtype=wp.vec3)
    normal: wp.array2d(dtype=wp.vec3)  # from the surface
    distance: wp.array2d(dtype=float)
    bend: wp.array2d(dtype=float)  # [m/s], speed that the gap loses in a step to curvature
    part: wp.array2d(dtype=int)


@wp.func
def _keep(
    found: Found, probe: int, position: wp.vec3, normal: wp.vec3, distance: float, bend: float, part: int, size: float
):
    """Note a contact, unless there is one like it; where all slots are taken in place of the one farthest off."""
    count = found.count[probe]
    slots = found.position.shape[1]
    slot = count
    worst = distance
    for k in range(count):
        near = wp.length(found.position[probe, k] - position) < 1.0e-3 * size
        if near and wp.dot(found.normal[probe, k], normal) > ALONG:
            if found.distance[probe, k] <= distance:
                return
            slot = k
            worst = float(1.0e9)
        elif count == slots and found.distance[probe, k] > worst:
            worst = found.distance[probe, k]
            slot = k
    if slot >= slots:
        return
    if slot == count:
        found.count[probe] = count + 1
    found.position[probe, slot] = position
    found.normal[probe, slot] = normal
    found.distance[probe, slot] = distance
    found.bend[probe, slot] = bend
    found.part[probe, slot] = part


@wp.func
def _shares(a: wp.vec3, b: wp.vec3, c: wp.vec3, normal: wp.vec3, q: wp.vec3) -> wp.vec3:
    """Barycentric coordinates of a point in a triangle's plane."""
    area = wp.dot(wp.cross(b - a, c - a), normal)
    second = wp.dot(wp.cross(q - a, c - a), normal) / area
    third = wp.dot(wp.cross(b - a, q - a), normal) / area
    return wp.vec3(1.0 - second - third, second, third)


@wp.func
def _fall(own: wp.vec3, normal: wp.vec3, ball: bool) -> wp.vec3:
    """How a corner's tangent plane falls from it along the triangle: of a ball exactly, else of the first order."""
    upright = wp.dot(own, normal)
    if ball:
        return -own / wp.max(upright, STEEPEST)
    return -own * upright


@wp.func
def _slope(
    turned: wp.vec3, way: wp.vec3, shares: wp.vec3, lifts: wp.vec3, s0: wp.vec3, s1: wp.vec3, s2: wp.vec3
) -> float:
    """How fast the lift grows along a way in the plane, on which shares change by `turned`."""
    return wp.dot(turned, lifts) + 0.5 * (
        shares[0] * wp.dot(way, s0) + shares[1] * wp.dot(way, s1) + shares[2] * wp.dot(way, s2)
    )


@wp.func
def _way_to_foot(
    first: float, second: float, above: float, e1: wp.vec3, e2: wp.vec3, n1: wp.vec3, n2: wp.vec3
) -> wp.vec3:
    """How far the foot is from a point of the triangle's plane, whose normal misses a place above by so much.

    Over a surface that bulges, of radius R, the foot goes by R / (R + above) of what is missed: over a thin rod all
    of it would be too far by more than it was missed. Into a hollow all of it is taken.
    """
    bulge = wp.dot(n1, e1) + wp.dot(n2, e2)
    if bulge <= 0.0 or above <= 0.0:
        return first * e1 + second * e2
    a = 1.0 + above * wp.dot(n1, e1)
    b = 0.5 * above * (wp.dot(n1, e2) + wp.dot(n2, e1))
    d = 1.0 + above * wp.dot(n2, e2)
    det = a * d - b * b
    if det < 0.1:
        return first * e1 + second * e2
    return ((d * first - b * second) * e1 + (a * second - b * first) * e2) / det


@wp.func
def _carried_on(surface: Surface, at: wp.vec3, along: wp.vec3, normal: wp.vec3, third: wp.vec3) -> bool:
    """Whether beyond an edge another face carries on the plane of one: as pieces of one floor do."""
    out = wp.normalize(wp.cross(along, normal))
    if wp.dot(out, third - at) > 0.0:
        out = -out
    place = at + ASIDE * out
    query = wp.mesh_query_point_no_sign(surface.mesh, place, 10.0 * LEVEL)
    if not query.result:
        return False
    there = wp.mesh_eval_position(surface.mesh, query.face, query.u, query.v)
    same = wp.dot(wp.mesh_eval_face_normal(surface.mesh, query.face), normal) > 1.0 - 1.0e-6
    return same and wp.length(there - place) < LEVEL


@wp.func
def _lies_along(
    shape: Convex, planes: wp.array(dtype=wp.vec4), pose: wp.transform, corner: wp.vec3, along: wp.vec3, third: wp.vec3
) -> bool:
    """Whether a shape goes on along the face from its corner at an edge: it is flat against it then."""
    inward = wp.normalize(third - wp.dot(third, along) * along)
    there = signed(shape, planes, wp.transform_point(wp.transform_inverse(pose), corner + 2.0 * GUARD * inward))
    return there[3] < 0.2 * GUARD


@wp.func
def _touch_face(
    surface: Surface,
    face: int,
    shape: Convex,
    corners: wp.array(dtype=wp.vec3),
    planes: wp.array(dtype=wp.vec4),
    pose: wp.transform,
    middle: wp.vec3,
    com: wp.vec3,
    velocity: wp.vec3,
    spin: wp.vec3,
    reach: float,
    deepest: float,
    size: float,
    h: float,
    probe: int,
    found: Found,
):
    a = surface.points[surface.corners[face, 0]]
    b = surface.points[surface.corners[face, 1]]
    c = surface.points[surface.corners[face, 2]]
    normal = wp.normalize(wp.cross(b - a, c - a))
    height = wp.dot(middle - a, normal)
    side = float(1.0)
    if height < 0.0:
        if surface.open[face] == 0:
            return
        side = float(-1.0)
    m0 = side * surface.normals[face, 0]
    m1 = side * surface.normals[face, 1]
    m2 = side * surface.normals[face, 2]
    normal = side * normal
    local_up = wp.quat_rotate_inv(wp.transform_get_rotation(pose), normal)
    ball = shape.kind == SPHERE
    for k in range(corner_count(shape)):
        centre = wp.transform_point(pose, corner_centre(shape, corners, k))
        arm = wp.transform_vector(pose, corner_arm(shape, k, local_up))
        round = -wp.dot(arm, normal)
        p = centre + arm + round * normal  # so far over the corner as its centre is
        over = wp.dot(p - a, normal)
        if over - round > 2.0 * reach or over - round < -deepest - 2.0 * reach:
            continue
        q = p - over * normal
        shares = _shares(a, b, c, side * normal, q)
        up = normal
        foot = q
        if surface.curved[face] != 0:
            e1 = wp.normalize(b - a)
            e2 = wp.cross(normal, e1)
            t1 = _shares(a, b, c, side * normal, a + e1) - wp.vec3(1.0, 0.0, 0.0)
            t2 = _shares(a, b, c, side * normal, a + e2) - wp.vec3(1.0, 0.0, 0.0)
            n1 = t1[0] * m0 + t1[1] * m1 + t1[2] * m2
            n2 = t2[0] * m0 + t2[1] * m1 + t2[2] * m2
            s0 = _fall(m0, normal, ball)
            s1 = _fall(m1, normal, ball)
            s2 = _fall(m2, normal, ball)
            for _step in range(FOOT_STEPS):
                lifts = 0.5 * wp.vec3(wp.dot(q - a, s0), wp.dot(q - b, s1), wp.dot(q - c, s2))
                foot = q + wp.dot(shares, lifts) * normal
                rise1 = _slope(t1, e1, shares, lifts, s0, s1, s2)
                rise2 = _slope(t2, e2, shares, lifts, s0, s1, s2)
                up = wp.normalize(normal - rise1 * e1 - rise2 * e2)
                if not ball:
                    up = wp.normalize(shares[0] * m0 + shares[1] * m1 + shares[2] * m2)
                miss = p - foot
                above = wp.dot(miss, up)
                miss = miss - above * up
                q = q + _way_to_foot(wp.dot(miss, e1), wp.dot(miss, e2), above, e1, e2, n1, n2)
                shares = _shares(a, b, c, side * normal, q)
        if wp.min(shares) < wp.where(surface.curved[face] != 0, -INSIDE_CURVED, -INSIDE):
            continue
        distance = wp.dot(p - foot, up) - round
        if distance > reach or distance < -deepest:
            continue
        near = float(0.0)  # to an edge that touches by itself
        for e in range(3):
            if surface.guard[face, e] != 0:
                from_ = surface.points[surface.corners[face, e]]
                to = surface.points[surface.corners[face, (e + 1) % 3]]
                along = wp.normalize(to - from_)
                off = (foot - from_) - wp.dot(foot - from_, along) * along
                third = surface.points[surface.corners[face, (e + 2) % 3]]
                if wp.length(off) < GUARD and not _lies_along(shape, planes, pose, centre + arm, along, third - from_):
                    if not _carried_on(surface, foot - off, along, side * normal, third):
                        near = float(1.0)
        if near > 0.0:
            continue
        lever = centre - com
        speed = velocity + wp.cross(spin, lever)
        speed = speed - wp.dot(speed, up) * up
        bend = -wp.dot(up, wp.cross(spin, wp.cross(spin, lever)))
        if surface.curved[face] != 0:
            flat = speed - wp.dot(speed, normal) * normal
            turned = _shares(a, b, c, side * normal, q + flat) - shares
            change = turned[0] * m0 + turned[1] * m1 + turned[2] * m2
            curve = wp.dot(change, flat)  # of the surface, times speed squared
            square = wp.dot(flat, flat)
            if square > 0.0:
                bend -= curve / wp.max(1.0 + curve / square * (distance + round), 0.05)
        place = foot + 0.5 * distance * up
        _keep(found, probe, place, up, distance, 0.5 * h * bend, surface.part[face], size)


@wp.func
def _behind(surface: Surface, at: wp.vec3, way: wp.vec3, point: int) -> bool:
    """Whether a point of the surface does not stand out from `at` along `way`."""
    if point < 0:
        return True
    off = surface.points[point] - at
    return wp.dot(way, off) <= LEANS * wp.length(off)


@wp.func
def _runs(shape: Convex, planes: wp.array(dtype=wp.vec4), x: wp.vec3, way: wp.vec3, up: wp.vec3, reach: float) -> float:
    """How much of the line from x along `way` is near the same side of the shape, 0 to 1."""
    end = signed(shape, planes, x + way)
    if -wp.dot(wp.vec3(end[0], end[1], end[2]), up) > ALONG and end[3] < reach:
        return 1.0
    low = float(0.0)
    high = float(1.0)
    for _step in range(HALVINGS):
        middle = 0.5 * (low + high)
        there = signed(shape, planes, x + middle * way)
        if -wp.dot(wp.vec3(there[0], there[1], there[2]), up) > ALONG and there[3] < reach:
            low = middle
        else:
            high = middle
    return low


@wp.func
def _touch_edge(
    surface: Surface,
    face: int,
    e: int,
    shape: Convex,
    planes: wp.array(dtype=wp.vec4),
    pose: wp.transform,
    reach: float,
    deepest: float,
    size: float,
    probe: int,
    found: Found,
):
    first = surface.corners[face, e]
    last = surface.corners[face, (e + 1) % 3]
    back = wp.transform_inverse(pose)
    x = wp.transform_point(back, surface.points[first])
    along = wp.transform_point(back, surface.points[last]) - x
    # The nearest point of the edge: where the distance, which is convex, stops falling.
    low = float(0.0)
    high = float(1.0)
    for _step in range(HALVINGS):
        middle = 0.5 * (low + high)
        there = signed(shape, planes, x + middle * along)
        if wp.dot(wp.vec3(there[0], there[1], there[2]), along) > 0.0:
            high = middle
        else:
            low = middle
    before = signed(shape, planes, x + low * along)
    after = signed(shape, planes, x + high * along)
    falls = wp.dot(wp.vec3(before[0], before[1], before[2]), along)
    rises = wp.dot(wp.vec3(after[0], after[1], after[2]), along)
    at = high
    distance = after[3]
    out = wp.vec3(after[0], after[1], after[2])
    if low == 0.0 and falls >= 0.0:
        at = float(0.0)
    if high < 1.0 and low > 0.0 and rises - falls > 1.0e-9:
        # An edge of the shape crosses this one: the way between them is at right angles to both.
        both = (rises * wp.vec3(before[0], before[1], before[2]) - falls * out) / (rises - falls)
        length = wp.length(both)
        if length < 0.1:
            return
        out = both / length
        distance = distance / length
    if distance > reach or distance < -deepest:
        return
    turn = wp.transform_get_rotation(pose)
    place = wp.transform_point(pose, x + at * along)
    up = -wp.quat_rotate(turn, out)
    if not _behind(surface, place, up, surface.corners[face, (e + 2) % 3]):
        return
    if not _behind(surface, place, up, surface.beyond[face, e]):
        return
    if at < 1.0e-6 or at > 1.0 - 1.0e-6:
        point = wp.where(at < 0.5, first, last)
        for k in range(surface.ring_first[point], surface.ring_first[point + 1]):
            if not _behind(surface, place, up, surface.ring[k]):
                return
    if surface.edge[face, e] == 1:
        from_ = surface.points[first]
        to = surface.points[last]
        third = surface.points[surface.corners[face, (e + 2) % 3]]
        if _carried_on(surface, place, to - from_, wp.normalize(wp.cross(to - from_, third - from_)), third):
            return
        if surface.beyond[face, e] >= 0:
            fourth = surface.points[surface.beyond[face, e]]
            if _carried_on(surface, place, to - from_, wp.normalize(wp.cross(fourth - from_, to - from_)), fourth):
                return
    part = surface.part[face]
    ahead = float(0.0)
    behind = float(0.0)
    if shape.kind != SPHERE:
        ahead = _runs(shape, planes, x + at * along, (1.0 - at) * along, -out, reach) * (1.0 - at)
        behind = _runs(shape, planes, x + at * along, -at * along, -out, reach) * at
    if (ahead + behind) * wp.length(along) < 0.02 * size:
        _keep(found, probe, place + 0.5 * distance * up, up, distance, 0.0, part, size)
        return
    for end in range(2):
        at_end = at + ahead
        if end == 1:
            at_end = at - behind
        there = signed(shape, planes, x + at_end * along)
        spot = wp.transform_point(pose, x + at_end * along)
        _keep(found, probe, spot + 0.5 * there[3] * up, up, there[3], 0.0, part, size)


@wp.kernel(enable_backward=False)
def touch(
    # Data in:
    surface: Surface,
    probes: wp.array(dtype=Convex),
    probe_body: wp.array(dtype=int),
    probe_pose: wp.array(dtype=wp.transform),
    probe_bounds: wp.array2d(dtype=wp.vec3),  # (probes, 2), its own box's middle and half edges
    probe_row: wp.array(dtype=int),
    spared: wp.array2d(dtype=int),  # (rows, parts)
    corners: wp.array(dtype=wp.vec3),
    planes: wp.array(dtype=wp.vec4),
    body_q: wp.array(dtype=wp.transform),
    body_qd: wp.array(dtype=wp.spatial_vector),
    ahead: wp.array(dtype=wp.spatial_vector),  # by which velocities at the step's end are, as far as is known
    body_com: wp.array(dtype=wp.vec3),
    reach: float,
    h: float,
    # Data out:
    found: Found,
):
    """All contacts of one moving shape."""
    probe = wp.tid()
    found.count[probe] = 0
    body = probe_body[probe]
    shape = probes[probe]
    pose = wp.transform_multiply(body_q[body], probe_pose[probe])
    turn = wp.transform_get_rotation(pose)
    half = probe_bounds[probe, 1]
    middle = wp.transform_point(pose, probe_bounds[probe, 0])
    x = wp.quat_rotate(turn, wp.vec3(half[0], 0.0, 0.0))
    y = wp.quat_rotate(turn, wp.vec3(0.0, half[1], 0.0))
    z = wp.quat_rotate(turn, wp.vec3(0.0, 0.0, half[2]))
    room = wp.vec3(reach, reach, reach)
    room += wp.vec3(wp.abs(x[0]), wp.abs(x[1]), wp.abs(x[2])) + wp.vec3(wp.abs(y[0]), wp.abs(y[1]), wp.abs(y[2]))
    room += wp.vec3(wp.abs(z[0]), wp.abs(z[1]), wp.abs(z[2]))
    com = wp.transform_point(body_q[body], body_com[body])
    velocity = wp.spatial_top(body_qd[body] + ahead[body])
    spin = wp.spatial_bottom(body_qd[body] + ahead[body])
    deepest = wp.min(half)  # as deep as its middle
    row = probe_row[probe]
    query = wp.mesh_query_aabb(surface.mesh, middle - room, middle + room)
    face = int(0)
    while wp.mesh_query_aabb_next(query, face):
        if spared[row, surface.part[face]] != 0:
            continue
        _touch_face(
            surface,
            face,
            shape,
            corners,
            planes,
            pose,
            middle,
            com,
            velocity,
            spin,
            reach,
            deepest,
            deepest,
            h,
            probe,
            found,
        )
        for e in range(3):
            kind = surface.edge[face, e]
            if kind == 1 or (kind == 2 and shape.kind != SPHERE):
                _touch_edge(surface, face, e, shape, planes, pose, reach, deepest, deepest, probe, found)
