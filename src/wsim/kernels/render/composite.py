"""Glass and water drawn over an opaque picture, along the same camera rays.

Each pixel's ray is cut at every face of a glass shape or a fluid's surface, up to the opaque hit. A piece inside a
medium absorbs by the Beer-Lambert law and scatters light of the medium's own, all the more the less comes through: a
fluid that hides what is in it, as milk, is so lit at its face, as a solid is, and a clear one within. A face between
two media of different refractive index reflects the sky by Schlick's approximation of Fresnel's equations (C. Schlick,
"An Inexpensive BRDF Model for Physically-based Rendering", 1994).

Where a ray comes out of the air through a level surface into a fluid that light fills, it is bent by Snell's law, once.
What it meets from there on only another look at the opaque shapes can tell, so that a picture is made in two passes,
the first up to where rays bend. Where a ray leaves a fluid, or passes between it and glass, it is not bent: the walls
of a real tank mirror what is in it, and each body would be seen several times.

All colours are linear RGB.
"""

import warp as wp

from wsim.kernels.render.faces import (
    IOR_AIR,
    IOR_WATER,
    Face,
    Media,
    Stretch,
    boxes_along,
    fluid_after,
    fresnel,
    refracted,
    stretch_after,
)
from wsim.kernels.render.sky import FAR, Look, daylight, opaque_color, sky

MAX_FACES = wp.constant(32)  # faces that one ray may cross
NO_SHAPE = wp.constant(wp.uint32(0xFFFFFFF0))  # shape indices from here on are the camera's marks, not shapes
UNSEEN = wp.constant(0.02)  # contrast that the eye no longer sees (H. Koschmieder, 1924)
EDGE_SHINE = wp.constant(0.3)  # share of the sky's light that an edge shows
MURKY = wp.constant(0.5)  # share of light that one particle of a fluid stops, from which on rays in it are not bent
# Upright part of a surface's normal from which on rays are bent there: the rounded rim that particles have at a body or
# a wall is no water's, and would show what floats with bulges.
LEVEL = wp.constant(0.97)
ELSEWHERE = wp.constant(1.0e6)  # [m] over the world: a ray that has nothing to look for starts there, upwards


@wp.struct
class Light:
    """What has come to the eye along a ray so far, and where that goes on if it was bent."""

    seen: wp.vec3
    through: wp.vec3  # share of the light from here on that reaches the eye
    fluid_through: wp.vec3  # share that the fluids on the way let through
    fluid_at: float  # [m], along the optical axis: where the first of them begins; below 0 where none has yet
    bent: bool
    way: float  # [m], along the ray, to where it was bent
    origin: wp.vec3  # from where it goes on
    direction: wp.vec3
    normal: wp.vec3  # of the face where it was bent
    ior: float  # refractive index of where it goes on


@wp.func
def reflected_share(before: Stretch, ior: float, direction: wp.vec3, look: Look) -> float:
    """What the face at the end of a stretch reflects, against the medium behind it."""
    share = fresnel(wp.abs(wp.dot(direction, before.normal)), before.ior, ior)
    # Polished edges catch the light from all sides.
    return look.reflection * wp.max(share, EDGE_SHINE * before.edge)


@wp.func
def absorb(
    light: Light, before: Stretch, ahead: Stretch, direction: wp.vec3, axis: wp.vec3, length: float, look: Look
) -> Light:
    """The light after a stretch of a medium (Beer-Lambert), with a little of the medium's own."""
    made = light
    day = daylight(wp.vec3(0.0, 0.0, 1.0), look)
    if ahead.opaque > 0.0:
        # What no light fills is lit where it begins.
        facing = wp.where(wp.dot(direction, before.normal) < 0.0, before.normal, -before.normal)
        day = wp.lerp(day, daylight(facing, look), ahead.opaque)
    extinction = ahead.extinction
    kept = wp.vec3(wp.exp(-extinction[0] * length), wp.exp(-extinction[1] * length), wp.exp(-extinction[2] * length))
    glow = wp.cw_mul(wp.cw_mul(ahead.own, day), wp.vec3(1.0) - kept) * look.scatter
    made.seen = light.seen + wp.cw_mul(light.through, glow)
    made.through = wp.cw_mul(light.through, kept)
    if ahead.ior == IOR_WATER:
        if light.fluid_at < 0.0:
            made.fluid_at = before.t * wp.dot(direction, axis)
        made.fluid_through = wp.cw_mul(light.fluid_through, kept)
    return made


@wp.func
def begun(origin: wp.vec3, direction: wp.vec3) -> Light:
    """The light of a ray that leaves the camera."""
    light = Light()
    light.through = wp.vec3(1.0)
    light.fluid_through = wp.vec3(1.0)
    light.fluid_at = -1.0
    light.origin = origin
    light.direction = direction
    return light


@wp.func
def bent_at(light: Light, before: Stretch, ior: float) -> Light:
    """The light of a ray that goes on another way from the end of a stretch, in a medium of index `ior`."""
    made = light
    made.bent = True
    made.direction = refracted(light.direction, before.normal, before.ior, ior)
    # A little behind the face, so that it is not met again.
    made.origin = light.origin + light.direction * before.t + made.direction * (2.0e-5 * (1.0 + before.t))
    made.way = before.t
    made.normal = before.normal
    made.ior = ior
    return made


@wp.func
def through_media(
    media: Media, look: Look, so_far: Light, axis: wp.vec3, t_end: float, behind: wp.vec3, bends: bool
) -> Light:
    """The light of a ray through glass and water to `t_end`, where it meets `behind`, or to where it bends."""
    origin, direction = so_far.origin, so_far.direction
    boxes = boxes_along(media, origin, direction, t_end)
    day = daylight(wp.vec3(0.0, 0.0, 1.0), look)
    # A face that lies on an opaque shape, as a tank's floor on the ground, is that shape's.
    t_last = t_end - 1.0e-4 * (1.0 + t_end)
    light = so_far
    light.bent = False
    before = Stretch()
    before.ior = so_far.ior  # 0: not known yet
    before.normal = so_far.normal
    wet = so_far.fluid_at >= 0.0
    fluid = Face()
    fluid.t = -1.0
    for _crossing in range(MAX_FACES):
        # Start a little behind the face just crossed, so that it is not met again: single precision is coarser far off.
        start = wp.where(before.t > 0.0, before.t + 2.0e-5 * (1.0 + before.t), 0.0)
        fluid = fluid_after(media, fluid, origin, direction, start, t_end)
        ahead = stretch_after(media, boxes, fluid, look, origin, direction, start)
        # The last face parts the medium before it from the one now known.
        if before.ior > 0.0 and ahead.ior != before.ior:
            share = reflected_share(before, ahead.ior, direction, look)
            reflected = sky(direction - before.normal * (2.0 * wp.dot(direction, before.normal)), look)
            if wet:
                # From within, and in hollows of the fluid, a face mirrors the fluid and not the sky.
                reflected = wp.cw_mul(media.fluid_color[fluid.medium], day)
            light.seen += wp.cw_mul(light.through, reflected) * share
            light.through = light.through * (1.0 - share)
            enters = before.ior == IOR_AIR and ahead.ior == IOR_WATER and wp.abs(before.normal[2]) > LEVEL
            if bends and enters and not wet and ahead.opaque < MURKY:
                light.fluid_at = before.t * wp.dot(direction, axis)
                return bent_at(light, before, ahead.ior)
        if ahead.ior != IOR_AIR:
            light = absorb(light, before, ahead, direction, axis, wp.min(ahead.t, t_end) - before.t, look)
        if ahead.t >= t_last or wp.max(light.through) < 1.0e-4:
            break
        wet = wet or ahead.ior == IOR_WATER
        before = ahead
    light.seen += wp.cw_mul(light.through, behind)
    return light


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
    media: Media,
    look: Look,
    first_pass: bool,
    bends: bool,  # whether there is another pass
    # Data in and out:
    lights: wp.array2d(dtype=Light),
    bent_rays: wp.array4d(dtype=wp.vec3f),  # as `camera_rays`
    # Data out:
    row_goes_on: wp.array(dtype=wp.int32),  # 1 where a ray of a row was bent, 0 before
    out_color: wp.array2d(dtype=wp.vec3f),  # linear
    out_depth: wp.array2d(dtype=float),  # [m], along the optical axis, of a fluid that hides all; 0 where nothing is
    out_shape: wp.array2d(dtype=wp.int32),  # -1 where nothing is, or a fluid hides it
):
    """Blend glass and fluids over the opaque picture, and give the opaque picture's depth and shapes."""
    local_row, column = wp.tid()
    row = first_row + local_row
    pose = camera_pose[0]
    eye = wp.transform_get_translation(pose)
    axis = wp.transform_vector(pose, wp.vec3(0.0, 0.0, -1.0))
    light = lights[row, column]
    if first_pass:
        origin = wp.transform_point(pose, camera_rays[row, column, 0, 0])
        light = begun(origin, wp.normalize(wp.transform_vector(pose, camera_rays[row, column, 0, 1])))
    elif not light.bent:
        return

    shape = opaque_shape[0, row, column]
    t_end = FAR
    ground = wp.bool(False)
    if shape < NO_SHAPE:
        t_end = opaque_depth[0, row, column]
        ground = shape_is_ground[int(shape)] != 0
    # As far off as the whole way is long.
    start = light.origin - light.direction * light.way
    lit = opaque_light[0, row, column]
    behind = opaque_color(start, light.direction, wp.min(light.way + t_end, FAR), lit, ground, look)
    met = light.origin + light.direction * t_end
    light = through_media(media, look, light, axis, t_end, behind, bends)
    lights[row, column] = light
    if light.bent:
        row_goes_on[row] = 1
    if bends:
        back = wp.transform_inverse(pose)
        elsewhere, up = wp.vec3(0.0, 0.0, ELSEWHERE), wp.vec3(0.0, 0.0, 1.0)
        from_here = wp.where(light.bent, light.origin, elsewhere)
        that_way = wp.where(light.bent, light.direction, up)
        bent_rays[row, column, 0, 0] = wp.transform_point(back, from_here)
        bent_rays[row, column, 0, 1] = wp.transform_vector(back, that_way)
    if light.bent:
        return
    out_color[row, column] = light.seen
    out_shape[row, column] = -1
    out_depth[row, column] = 0.0
    if wp.max(light.fluid_through) < UNSEEN:
        out_depth[row, column] = light.fluid_at
    elif shape < NO_SHAPE:
        out_shape[row, column] = int(shape)
        out_depth[row, column] = wp.dot(met - eye, axis)
