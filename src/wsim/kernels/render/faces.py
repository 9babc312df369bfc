"""Where a ray crosses the faces of glass and of a fluid, and what share of light such a face reflects."""

import warp as wp

from wsim.kernels.render.sky import FAR, Look

MAX_BOXES = wp.constant(16)  # glass boxes that one ray may meet
IOR_AIR = wp.constant(1.0)
IOR_WATER = wp.constant(1.33)
IOR_GLASS = wp.constant(1.5)
BEVEL = wp.constant(0.15)  # width of a glass edge's bevel over half the pane's thickness

Floats = wp.types.vector(length=16, dtype=wp.float32)
Ints = wp.types.vector(length=16, dtype=wp.int32)


@wp.struct
class Media:
    """All glass and water of a world. Glass is boxes first, then meshes."""

    shape_pose: wp.array(dtype=wp.transformf)  # of every shape
    glass_shape: wp.array(dtype=wp.int32)
    glass_boxes: int
    glass_half: wp.array(dtype=wp.vec3f)  # [m]
    glass_mesh: wp.array(dtype=wp.uint64)
    glass_extinction: wp.array(dtype=wp.vec3f)  # [1/m]
    glass_color: wp.array(dtype=wp.vec3f)
    fluid_mesh: wp.uint64  # 0 is none
    fluid_normals: wp.array(dtype=wp.vec3f)
    fluid_of_vertex: wp.array(dtype=wp.int32)
    fluid_extinction: wp.array(dtype=wp.vec3f)  # [1/m]
    fluid_color: wp.array(dtype=wp.vec3f)
    fluid_opaque: wp.array(dtype=float)  # share of the light that does not come through one particle
    fluid_gap: wp.array(dtype=float)  # [m]: thinner sheets of air in a fluid are not drawn


@wp.struct
class Face:
    """Where a ray next meets a medium's boundary, and whether it runs inside until there."""

    t: float
    inside: bool
    normal: wp.vec3
    medium: int  # which fluid


@wp.func
def fresnel(cos_angle: float, ior_from: float, ior_to: float) -> float:
    """Reflected share at a face between two refractive indices (Schlick)."""
    ratio = (ior_from - ior_to) / (ior_from + ior_to)
    f0 = ratio * ratio
    if f0 < 1.0e-6:
        return 0.0
    # Glass against water hardly reflects at grazing angles either: the grazing term needs a real step of index.
    grazing = wp.clamp(f0 * 25.0, 0.0, 1.0)
    off = 1.0 - wp.clamp(cos_angle, 0.0, 1.0)
    return f0 + grazing * (1.0 - f0) * off * off * off * off * off


@wp.func
def refracted(direction: wp.vec3, normal: wp.vec3, ior_from: float, ior_to: float) -> wp.vec3:
    """Where a ray goes on behind a face into a denser medium, by Snell's law.

    Args:
        direction: Of the ray, unit.
        normal: Of the face, unit, to either side.
        ior_from: Refractive index before the face.
        ior_to: Behind it, not less.
    """
    facing = wp.where(wp.dot(direction, normal) < 0.0, normal, -normal)
    ratio = ior_from / ior_to
    cosine = -wp.dot(direction, facing)
    beyond = wp.sqrt(1.0 - ratio * ratio * (1.0 - cosine * cosine))
    return wp.normalize(ratio * direction + (ratio * cosine - beyond) * facing)


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
def face_of_fluid(media: Media, origin: wp.vec3, direction: wp.vec3, t: float, reach: float) -> Face:
    """The first face of a fluid's surface after `t`, up to `reach` on, its normal interpolated between the vertices."""
    face = Face()
    face.t = FAR
    mesh = media.fluid_mesh
    query = wp.mesh_query_ray(mesh, origin + direction * t, direction, reach)
    if query.result:
        face.t = t + query.t
        face.inside = query.sign < 0.0
        i = wp.mesh_get_index(mesh, query.face * 3)
        j = wp.mesh_get_index(mesh, query.face * 3 + 1)
        k = wp.mesh_get_index(mesh, query.face * 3 + 2)
        a, b, c = media.fluid_normals[i], media.fluid_normals[j], media.fluid_normals[k]
        smooth = wp.normalize(a * query.u + b * query.v + c * (1.0 - query.u - query.v))
        face.normal = wp.where(wp.dot(smooth, query.normal) > 0.2, smooth, query.normal)
        face.medium = media.fluid_of_vertex[i]
    return face


@wp.func
def exit_of_fluid(media: Media, entry: Face, origin: wp.vec3, direction: wp.vec3, t_end: float) -> Face:
    """The face where a ray that runs inside a fluid leaves it for good, given the first face it meets.

    Gaps of air shorter than the fluid's are no gaps: particles keep that far off a body's skin and off each other.
    Where another fluid begins behind one it is left there.
    """
    face = entry
    gap = media.fluid_gap[entry.medium]
    for _gap in range(4):
        if face.t >= t_end or not face.inside:
            break
        if t_end - face.t < gap:
            face.t = FAR
            break
        start = face.t + 2.0e-5 * (1.0 + face.t)
        again = face_of_fluid(media, origin, direction, start, gap)
        if again.inside or again.t - face.t > gap:
            break
        if again.medium != face.medium:
            face.t = again.t
            break
        start = again.t + 2.0e-5 * (1.0 + again.t)
        face = face_of_fluid(media, origin, direction, start, FAR)
    return face


@wp.func
def fluid_after(media: Media, known: Face, origin: wp.vec3, direction: wp.vec3, start: float, t_end: float) -> Face:
    """The fluid's first face after `start`: the known one while it lies ahead.

    Surfaces of two fluids that lie on each other may overlap by a hair: a ray that comes into one and next leaves
    another has been in that.
    """
    face = known
    if media.fluid_mesh != wp.uint64(0) and known.t < start:
        face = face_of_fluid(media, origin, direction, start, FAR)
        if media.fluid_gap.shape[0] > 1 and not face.inside and face.t < t_end:
            behind = face_of_fluid(media, origin, direction, face.t + 2.0e-5 * (1.0 + face.t), FAR)
            if behind.inside and behind.medium != face.medium:
                face.inside = True
                face.medium = behind.medium
                return face
        if face.inside:
            face = exit_of_fluid(media, face, origin, direction, t_end)
    return face


@wp.struct
class Boxes:
    """The glass boxes that a ray meets. They are convex: one look at each tells both of its faces."""

    t_in: Floats
    t_out: Floats
    glass: Ints
    count: int


@wp.func
def boxes_along(media: Media, origin: wp.vec3, direction: wp.vec3, t_end: float) -> Boxes:
    """The boxes that a ray meets before `t_end`."""
    met = Boxes()
    for glass in range(media.glass_boxes):
        pose = media.shape_pose[media.glass_shape[glass]]
        span = span_of_box(media.glass_half[glass], pose, origin, direction)
        if span[0] < span[1] and span[1] > 0.0 and span[0] < t_end and met.count < MAX_BOXES:
            met.t_in[met.count] = span[0]
            met.t_out[met.count] = span[1]
            met.glass[met.count] = glass
            met.count += 1
    return met


@wp.struct
class Stretch:
    """A piece of a ray up to the face where it ends, and the medium that it runs in until there."""

    t: float
    normal: wp.vec3
    edge: float  # 1 on the edge of a glass box, 0 away from it
    ior: float
    extinction: wp.vec3  # [1/m]
    own: wp.vec3  # the medium's colour
    opaque: float  # share of its light that is scattered at the face where it begins: 0 of what light fills


@wp.func
def stretch_after(
    media: Media, boxes: Boxes, fluid: Face, look: Look, origin: wp.vec3, direction: wp.vec3, start: float
) -> Stretch:
    """What a ray runs through from `start` on, up to the next face."""
    ahead = Stretch()
    ahead.t = FAR
    ahead.ior = IOR_AIR
    box = int(-1)
    if media.fluid_mesh != wp.uint64(0):
        if fluid.t < ahead.t:
            ahead.t = fluid.t
            ahead.normal = fluid.normal
        if fluid.inside:
            ahead.ior = IOR_WATER
            ahead.extinction = media.fluid_extinction[fluid.medium]
            ahead.own = media.fluid_color[fluid.medium]
            ahead.opaque = media.fluid_opaque[fluid.medium]
    for slot in range(boxes.count):
        if boxes.t_out[slot] > start:
            inside = boxes.t_in[slot] <= start
            t = wp.where(inside, boxes.t_out[slot], boxes.t_in[slot])
            if t < ahead.t:
                ahead.t = t
                box = boxes.glass[slot]
            if inside:
                ahead.ior = IOR_GLASS
                ahead.extinction = media.glass_extinction[boxes.glass[slot]]
                ahead.own = media.glass_color[boxes.glass[slot]]
                ahead.opaque = 0.0
    for glass in range(media.glass_boxes, media.glass_shape.shape[0]):
        pose = media.shape_pose[media.glass_shape[glass]]
        back = wp.transform_inverse(pose)
        face = face_of_mesh(
            media.glass_mesh[glass], wp.transform_point(back, origin), wp.transform_vector(back, direction), start
        )
        if face.t < ahead.t:
            ahead.t = face.t
            ahead.normal = wp.transform_vector(pose, face.normal)
            box = -1
        if face.inside:
            ahead.ior = IOR_GLASS
            ahead.extinction = media.glass_extinction[glass]
            ahead.own = media.glass_color[glass]
            ahead.opaque = 0.0
    if box >= 0:
        pose = media.shape_pose[media.glass_shape[box]]
        half = media.glass_half[box]
        point = origin + direction * ahead.t
        width = 1.4 * look.pixel_angle * ahead.t + BEVEL * wp.min(half)
        ahead.normal = normal_of_box(half, pose, point)
        ahead.edge = edge_of_box(half, pose, point, width)
    return ahead
