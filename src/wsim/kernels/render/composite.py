"""Glass and water drawn over an opaque picture, along the same camera rays.

Each pixel's ray is cut at every face of a glass shape or a fluid's surface, up to the opaque hit. A piece inside a
medium absorbs by the Beer-Lambert law and scatters a little light of the medium's own; a face between two media of
different refractive index reflects the sky by Schlick's approximation of Fresnel's equations (C. Schlick, "An
Inexpensive BRDF Model for Physically-based Rendering", 1994). Rays are not bent.

All colours are linear RGB.
"""

import warp as wp

IOR_AIR = wp.constant(1.0)
IOR_WATER = wp.constant(1.33)
IOR_GLASS = wp.constant(1.5)
FAR = wp.constant(1.0e6)  # [m]: farther than anything
MAX_FACES = wp.constant(32)  # faces that one ray may cross
NO_SHAPE = wp.constant(wp.uint32(0xFFFFFFF0))  # shape indices from here on are the camera's marks, not shapes
BEVEL = wp.constant(0.15)  # width of a glass edge's bevel over half the pane's thickness
EDGE_SHINE = wp.constant(0.3)  # share of the sky's light that an edge shows
MAX_BOXES = wp.constant(16)  # glass boxes that one ray may meet

Floats = wp.types.vector(length=16, dtype=wp.float32)
Ints = wp.types.vector(length=16, dtype=wp.int32)


@wp.struct
class Look:
    """How the sky, the sun and the ground look."""

    sun_direction: wp.vec3  # unit, from the sun into the scene
    sun_color: wp.vec3
    ambient: wp.vec3  # radiance from above
    zenith: wp.vec3
    horizon: wp.vec3
    fog_distance: float  # [m]: where the ground has mostly faded into the horizon
    checker: float  # [m]: edge of a square of the ground's pattern; 0 is plain
    checker_contrast: float
    reflection: float  # 0 is none, 1 is Fresnel's
    scatter: float  # 0 is a medium that only absorbs
    pixel_angle: float  # [rad]: between two pixels


@wp.struct
class Face:
    """Where a ray next meets a medium's boundary, and whether it runs inside until there."""

    t: float
    inside: bool
    normal: wp.vec3
    medium: int  # which fluid


@wp.func
def sky(direction: wp.vec3, look: Look) -> wp.vec3:
    """Radiance of the sky [linear RGB], sun included."""
    up = wp.clamp(direction[2], 0.0, 1.0)
    color = wp.lerp(look.horizon, look.zenith, wp.pow(up, 0.55))
    toward_sun = wp.max(-wp.dot(direction, look.sun_direction), 0.0)
    glow = 0.25 * wp.pow(toward_sun, 24.0) + 12.0 * wp.pow(toward_sun, 1200.0)
    return color + look.sun_color * glow


@wp.func
def fresnel(cos_angle: float, ior_from: float, ior_to: float) -> float:
    """Reflected share at a face between two refractive indices (Schlick)."""
    ratio = (ior_from - ior_to) / (ior_from + ior_to)
    f0 = ratio * ratio
    if f0 < 1.0e-6:
        return 0.0
    # Glass against water hardly reflects at grazing angles either: the grazing term needs a real step of index.
    grazing = wp.clamp(f0 * 25.0, 0.0, 1.0)
    return f0 + grazing * (1.0 - f0) * wp.pow(1.0 - wp.clamp(cos_angle, 0.0, 1.0), 5.0)


@wp.func
def checker_filtered(x: float, y: float, width: float) -> float:
    """A checker of period 2 in x and y averaged over a square of edge `width`, in -1 .. 1."""
    w = wp.max(width, 1.0e-4)
    ax = 2.0 * (wp.abs(_fract((x - 0.5 * w) * 0.5) - 0.5) - wp.abs(_fract((x + 0.5 * w) * 0.5) - 0.5)) / w
    ay = 2.0 * (wp.abs(_fract((y - 0.5 * w) * 0.5) - 0.5) - wp.abs(_fract((y + 0.5 * w) * 0.5) - 0.5)) / w
    return ax * ay


@wp.func
def _fract(x: float) -> float:
    return x - wp.floor(x)


@wp.func
def span_of_box(half: wp.vec3, to_world: wp.transform, origin: wp.vec3, direction: wp.vec3) -> wp.vec2:
    """Where a ray enters and leaves a box; where it misses, the second is the smaller."""
    rotation = wp.transform_get_rotation(to_world)
    o = wp.quat_rotate_inv(rotation, origin - wp.transform_get_translation(to_world))
    d = wp.quat_rotate_inv(rotation, direction)
    t_in = -FAR
    t_out = FAR
    for axis in range(3):
        along = d[axis]
        if wp.abs(along) < 1.0e-9:
            along = 1.0e-9
        a = (-half[axis] - o[axis]) / along
        b = (half[axis] - o[axis]) / along
        t_in = wp.max(t_in, wp.min(a, b))
        t_out = wp.min(t_out, wp.max(a, b))
    return wp.vec2(t_in, t_out)


@wp.func
def normal_of_box(half: wp.vec3, to_world: wp.transform, point: wp.vec3) -> wp.vec3:
    """Outward normal of a box at a point on its boundary."""
    p = wp.transform_point(wp.transform_inverse(to_world), point)
    x = wp.abs(p[0]) - half[0]
    y = wp.abs(p[1]) - half[1]
    z = wp.abs(p[2]) - half[2]
    normal = wp.vec3(0.0, 0.0, wp.sign(p[2]))
    if x > y and x > z:
        normal = wp.vec3(wp.sign(p[0]), 0.0, 0.0)
    elif y > z:
        normal = wp.vec3(0.0, wp.sign(p[1]), 0.0)
    return wp.transform_vector(to_world, normal)


@wp.func
def edge_of_box(half: wp.vec3, to_world: wp.transform, point: wp.vec3, width: float) -> float:
    """1 on an edge of a box falling to 0 at `width` [m] from it, for a point on its boundary."""
    p = wp.transform_point(wp.transform_inverse(to_world), point)
    x = half[0] - wp.abs(p[0])
    y = half[1] - wp.abs(p[1])
    z = half[2] - wp.abs(p[2])
    # The face's own distance is about 0; the next smallest is the distance to the nearest edge.
    distance = wp.max(wp.min(x, y), wp.max(wp.min(y, z), wp.min(x, z)))
    return wp.clamp(1.0 - distance / width, 0.0, 1.0)


@wp.func
def face_of_mesh(mesh: wp.uint64, origin: wp.vec3, direction: wp.vec3, t: float) -> Face:
    """The first face of a closed mesh after `t`."""
    face = Face()
    face.t = FAR
    query = wp.mesh_query_ray(mesh, origin + direction * t, direction, FAR)
    if query.result:
        face.t = t + query.t
        face.inside = query.sign < 0.0
        face.normal = query.normal
    return face


@wp.func
def face_of_fluid(
    mesh: wp.uint64,
    normals: wp.array(dtype=wp.vec3f),
    fluid_of_vertex: wp.array(dtype=wp.int32),
    origin: wp.vec3,
    direction: wp.vec3,
    t: float,
) -> Face:
    """The first face of a fluid's surface after `t`, its normal interpolated between the vertices."""
    face = Face()
    face.t = FAR
    query = wp.mesh_query_ray(mesh, origin + direction * t, direction, FAR)
    if query.result:
        face.t = t + query.t
        face.inside = query.sign < 0.0
        i = wp.mesh_get_index(mesh, query.face * 3)
        j = wp.mesh_get_index(mesh, query.face * 3 + 1)
        k = wp.mesh_get_index(mesh, query.face * 3 + 2)
        smooth = wp.normalize(normals[i] * query.u + normals[j] * query.v + normals[k] * (1.0 - query.u - query.v))
        face.normal = wp.where(wp.dot(smooth, query.normal) > 0.2, smooth, query.normal)
        face.medium = fluid_of_vertex[i]
    return face


@wp.func
def exit_of_fluid(
    entry: Face,
    mesh: wp.uint64,
    normals: wp.array(dtype=wp.vec3f),
    fluid_of_vertex: wp.array(dtype=wp.int32),
    origin: wp.vec3,
    direction: wp.vec3,
    t_end: float,
    gap: float,
) -> Face:
    """The face where a ray that runs inside a fluid leaves it for good, given the first face it meets.

    Gaps of air shorter than `gap` are no gaps: particles keep that far off a body's skin and off each other.
    """
    face = entry
    for _gap in range(4):
        if face.t >= t_end or not face.inside:
            break
        if t_end - face.t < gap:
            face.t = FAR
            break
        start = face.t + 2.0e-5 * (1.0 + face.t)
        again = face_of_fluid(mesh, normals, fluid_of_vertex, origin, direction, start)
        if again.inside or again.t - face.t > gap:
            break
        start = again.t + 2.0e-5 * (1.0 + again.t)
        face = face_of_fluid(mesh, normals, fluid_of_vertex, origin, direction, start)
    return face


@wp.func
def opaque_color(
    origin: wp.vec3,
    direction: wp.vec3,
    t: float,
    lit: wp.vec3,
    on_ground: bool,
    look: Look,
) -> wp.vec3:
    """The colour behind all glass and water: a lit shape, patterned and faded into the distance, or the sky."""
    if t >= FAR:
        return sky(direction, look)
    color = lit
    if on_ground:
        if look.checker > 0.0:
            point = origin + direction * t
            footprint = look.pixel_angle * t / wp.max(wp.abs(direction[2]), 0.02) / look.checker
            if footprint < 8.0:
                pattern = checker_filtered(point[0] / look.checker, point[1] / look.checker, footprint)
                color = color * (1.0 + look.checker_contrast * pattern)
        fade = t / look.fog_distance
        level = wp.normalize(wp.vec3(direction[0], direction[1], 0.0))
        color = wp.lerp(sky(level, look), color, wp.exp(-fade * fade))
    return color


@wp.kernel(enable_backward=False)
def composite(
    # Data in:
    first_row: int,
    camera_rays: wp.array4d(dtype=wp.vec3f),  # (height, width, 1, 2), camera frame: origin, direction
    camera_pose: wp.array(dtype=wp.transformf),
    opaque_depth: wp.array3d(dtype=float),  # (1, height, width) [m], along the ray
    opaque_shape: wp.array3d(dtype=wp.uint32),
    opaque_light: wp.array3d(dtype=wp.vec3f),
    shape_is_ground: wp.array(dtype=wp.int32),
    shape_pose: wp.array(dtype=wp.transformf),
    glass_shape: wp.array(dtype=wp.int32),  # boxes first, then meshes
    glass_boxes: int,
    glass_half: wp.array(dtype=wp.vec3f),
    glass_mesh: wp.array(dtype=wp.uint64),
    glass_extinction: wp.array(dtype=wp.vec3f),  # [1/m]
    glass_color: wp.array(dtype=wp.vec3f),
    fluid_mesh: wp.uint64,  # 0 is none
    fluid_normals: wp.array(dtype=wp.vec3f),
    fluid_of_vertex: wp.array(dtype=wp.int32),
    fluid_extinction: wp.array(dtype=wp.vec3f),  # [1/m]
    fluid_color: wp.array(dtype=wp.vec3f),
    fluid_gap: wp.array(dtype=float),  # [m]: thinner sheets of air in a fluid are not drawn
    look: Look,
    # Data out:
    out_color: wp.array2d(dtype=wp.vec3f),  # linear
    out_depth: wp.array2d(dtype=float),  # [m], along the optical axis; 0 where nothing is
    out_shape: wp.array2d(dtype=wp.int32),  # -1 where nothing is
):
    """Blend glass and fluids over the opaque picture, and give the opaque picture's depth and shapes."""
    local_row, column = wp.tid()
    row = first_row + local_row
    pose = camera_pose[0]
    axis = wp.transform_vector(pose, wp.vec3(0.0, 0.0, -1.0))
    origin = wp.transform_point(pose, camera_rays[row, column, 0, 0])
    direction = wp.normalize(wp.transform_vector(pose, camera_rays[row, column, 0, 1]))

    shape = opaque_shape[0, row, column]
    t_end = FAR
    ground = wp.bool(False)
    if shape < NO_SHAPE:
        t_end = opaque_depth[0, row, column]
        ground = shape_is_ground[int(shape)] != 0
        out_shape[row, column] = int(shape)
        out_depth[row, column] = t_end * wp.dot(direction, axis)
    else:
        out_shape[row, column] = -1
        out_depth[row, column] = 0.0
    behind = opaque_color(origin, direction, t_end, opaque_light[0, row, column], ground, look)

    # Boxes are convex: one look at each tells both of its faces.
    box_in = Floats()
    box_out = Floats()
    box_glass = Ints()
    boxes = wp.int32(0)
    for glass in range(glass_boxes):
        span = span_of_box(glass_half[glass], shape_pose[glass_shape[glass]], origin, direction)
        if span[0] < span[1] and span[1] > 0.0 and span[0] < t_end and boxes < MAX_BOXES:
            box_in[boxes] = span[0]
            box_out[boxes] = span[1]
            box_glass[boxes] = glass
            boxes += 1

    day = look.ambient + look.sun_color * wp.max(-look.sun_direction[2], 0.0)
    # A face that lies on an opaque shape, as a tank's floor on the ground, is that shape's.
    t_last = t_end - 1.0e-4 * (1.0 + t_end)
    through = wp.vec3(1.0)  # share of the light from here on that reaches the eye
    seen = wp.vec3(0.0)
    t = wp.float32(0.0)
    ior_before = wp.float32(0.0)  # 0: not known yet
    normal_before = wp.vec3(0.0)
    edge_before = wp.float32(0.0)
    wet = wp.bool(False)
    fluid_face = Face()
    fluid_face.t = -1.0

    for _crossing in range(MAX_FACES):
        # Start a little behind the face just crossed, so that it is not met again: single precision is coarser far off.
        start = wp.where(t > 0.0, t + 2.0e-5 * (1.0 + t), 0.0)
        t_next = FAR
        box_next = wp.int32(-1)
        normal_next = wp.vec3(0.0)
        extinction = wp.vec3(0.0)
        own = wp.vec3(0.0)
        ior = IOR_AIR

        if fluid_mesh != wp.uint64(0):
            if fluid_face.t < start:
                fluid_face = face_of_fluid(fluid_mesh, fluid_normals, fluid_of_vertex, origin, direction, start)
                if fluid_face.inside:
                    gap = fluid_gap[fluid_face.medium]
                    fluid_face = exit_of_fluid(
                        fluid_face, fluid_mesh, fluid_normals, fluid_of_vertex, origin, direction, t_end, gap
                    )
            if fluid_face.t < t_next:
                t_next = fluid_face.t
                normal_next = fluid_face.normal
            if fluid_face.inside:
                ior = IOR_WATER
                extinction = fluid_extinction[fluid_face.medium]
                own = fluid_color[fluid_face.medium]
        for slot in range(boxes):
            if box_out[slot] > start:
                inside = box_in[slot] <= start
                face_t = wp.where(inside, box_out[slot], box_in[slot])
                if face_t < t_next:
                    t_next = face_t
                    box_next = box_glass[slot]
                if inside:
                    ior = IOR_GLASS
                    extinction = glass_extinction[box_glass[slot]]
                    own = glass_color[box_glass[slot]]
        for glass in range(glass_boxes, glass_shape.shape[0]):
            glass_pose = shape_pose[glass_shape[glass]]
            back = wp.transform_inverse(glass_pose)
            face = face_of_mesh(
                glass_mesh[glass],
                wp.transform_point(back, origin),
                wp.transform_vector(back, direction),
                start,
            )
            if face.t < t_next:
                t_next = face.t
                normal_next = wp.transform_vector(glass_pose, face.normal)
                box_next = -1
            if face.inside:
                ior = IOR_GLASS
                extinction = glass_extinction[glass]
                own = glass_color[glass]
        edge_next = wp.float32(0.0)
        if box_next >= 0:
            box_pose = shape_pose[glass_shape[box_next]]
            point = origin + direction * t_next
            normal_next = normal_of_box(glass_half[box_next], box_pose, point)
            edge_width = 1.4 * look.pixel_angle * t_next + BEVEL * wp.min(glass_half[box_next])
            edge_next = edge_of_box(glass_half[box_next], box_pose, point, edge_width)

        # The face at t parts the medium before it from the one now known.
        if ior_before > 0.0 and ior != ior_before:
            share = fresnel(wp.abs(wp.dot(direction, normal_before)), ior_before, ior)
            # Polished edges catch the light from all sides.
            share = look.reflection * wp.max(share, EDGE_SHINE * edge_before)
            mirrored = direction - normal_before * (2.0 * wp.dot(direction, normal_before))
            reflected = sky(mirrored, look)
            if wet:
                # From within, and in hollows of the fluid, a face mirrors the fluid and not the sky.
                reflected = wp.cw_mul(fluid_color[fluid_face.medium], day)
            seen += wp.cw_mul(through, reflected) * share
            through = through * (1.0 - share)

        stop = wp.min(t_next, t_end)
        if ior != IOR_AIR:
            length = stop - t
            kept = wp.vec3(
                wp.exp(-extinction[0] * length), wp.exp(-extinction[1] * length), wp.exp(-extinction[2] * length)
            )
            glow = wp.cw_mul(wp.cw_mul(own, day), wp.vec3(1.0) - kept) * look.scatter
            seen += wp.cw_mul(through, glow)
            through = wp.cw_mul(through, kept)
        if t_next >= t_last:
            break
        ior_before = ior
        wet = wet or ior == IOR_WATER
        normal_before = normal_next
        edge_before = edge_next
        t = t_next

    out_color[row, column] = seen + wp.cw_mul(through, behind)
