"""Convex shapes by their signed distance and their corners, in their own frame, round ones about Z."""

import warp as wp

SPHERE = wp.constant(0)
CAPSULE = wp.constant(1)
BOX = wp.constant(2)
CYLINDER = wp.constant(3)
HULL = wp.constant(4)


@wp.struct
class Convex:
    """One shape: size = (radius, half height, -), or half edges; a hull by its corners and its planes."""

    kind: int
    size: wp.vec3
    corner_first: int
    corner_count: int
    plane_first: int
    plane_count: int


@wp.func
def _toward(vector: wp.vec3, length: float, otherwise: wp.vec3) -> wp.vec3:
    if length > 1.0e-9:
        return vector / length
    return otherwise


@wp.func
def signed(shape: Convex, planes: wp.array(dtype=wp.vec4), x: wp.vec3) -> wp.vec4:
    """How far `x` is outside [m], last, and which way that grows. Convex in `x`."""
    up = wp.vec3(0.0, 0.0, 1.0)
    if shape.kind == SPHERE or shape.kind == CAPSULE:
        off = x
        if shape.kind == CAPSULE:
            off = x - wp.vec3(0.0, 0.0, wp.clamp(x[2], -shape.size[1], shape.size[1]))
        far = wp.length(off)
        way = _toward(off, far, wp.vec3(1.0, 0.0, 0.0))
        return wp.vec4(way[0], way[1], way[2], far - shape.size[0])
    if shape.kind == HULL:
        total = wp.vec3(0.0, 0.0, 0.0)
        square = float(0.0)
        most = float(-1.0e9)
        nearest = up
        for k in range(shape.plane_count):
            plane = planes[shape.plane_first + k]
            normal = wp.vec3(plane[0], plane[1], plane[2])
            beyond = wp.dot(normal, x) - plane[3]
            if beyond > most:
                most = beyond
                nearest = normal
            if beyond > 0.0:
                total += beyond * normal
                square += beyond * beyond
        if square > 0.0:
            way = _toward(total, wp.length(total), nearest)
            return wp.vec4(way[0], way[1], way[2], wp.sqrt(square))
        return wp.vec4(nearest[0], nearest[1], nearest[2], most)
    past = wp.vec3(wp.abs(x[0]) - shape.size[0], wp.abs(x[1]) - shape.size[1], wp.abs(x[2]) - shape.size[2])
    first = wp.vec3(wp.sign(x[0]), 0.0, 0.0)
    second = wp.vec3(0.0, wp.sign(x[1]), 0.0)
    third = wp.vec3(0.0, 0.0, wp.sign(x[2]))
    if shape.kind == CYLINDER:
        flat = wp.vec3(x[0], x[1], 0.0)
        across = wp.length(flat)
        past = wp.vec3(across - shape.size[0], -1.0e9, wp.abs(x[2]) - shape.size[1])
        first = _toward(flat, across, wp.vec3(1.0, 0.0, 0.0))
    out = wp.vec3(wp.max(past[0], 0.0), wp.max(past[1], 0.0), wp.max(past[2], 0.0))
    out_by = wp.length(out)
    if out_by > 0.0:
        side = (out[0] * first + out[1] * second + out[2] * third) / out_by
        return wp.vec4(side[0], side[1], side[2], out_by)
    if past[0] >= past[1] and past[0] >= past[2]:
        return wp.vec4(first[0], first[1], first[2], past[0])
    if past[1] >= past[2]:
        return wp.vec4(second[0], second[1], second[2], past[1])
    return wp.vec4(third[0], third[1], third[2], past[2])


@wp.func
def corner_count(shape: Convex) -> int:
    """How many corners may touch a plane."""
    if shape.kind == SPHERE:
        return 1
    if shape.kind == CAPSULE:
        return 2
    if shape.kind == HULL:
        return shape.corner_count
    return 8


@wp.func
def corner_centre(shape: Convex, corners: wp.array(dtype=wp.vec3), k: int) -> wp.vec3:
    """What a corner is round about: itself, the centre of a ball, or of a cylinder's end."""
    if shape.kind == SPHERE:
        return wp.vec3(0.0, 0.0, 0.0)
    if shape.kind == HULL:
        return corners[shape.corner_first + k]
    if shape.kind == BOX:
        x = wp.where((k & 1) == 0, -shape.size[0], shape.size[0])
        y = wp.where((k & 2) == 0, -shape.size[1], shape.size[1])
        z = wp.where((k & 4) == 0, -shape.size[2], shape.size[2])
        return wp.vec3(x, y, z)
    return wp.vec3(0.0, 0.0, wp.where((k & 1) == 0, -shape.size[1], shape.size[1]))


@wp.func
def corner_arm(shape: Convex, k: int, up: wp.vec3) -> wp.vec3:
    """From a corner's centre to the corner, where a plane's normal is `up`: a cylinder's are at its lowest side."""
    if shape.kind == SPHERE or shape.kind == CAPSULE:
        return -shape.size[0] * up
    if shape.kind != CYLINDER:
        return wp.vec3(0.0, 0.0, 0.0)
    flat = wp.vec3(up[0], up[1], 0.0)
    down = -_toward(flat, wp.length(flat), wp.vec3(1.0, 0.0, 0.0))
    if wp.length(flat) < 1.0e-3:  # it stands, and where it leans to is noise
        down = wp.vec3(1.0, 0.0, 0.0)
    quarter = k / 2
    if quarter == 1:
        down = wp.vec3(-down[1], down[0], 0.0)
    elif quarter == 2:
        down = -down
    elif quarter == 3:
        down = wp.vec3(down[1], -down[0], 0.0)
    return shape.size[0] * down
