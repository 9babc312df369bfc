"""A fluid's surface mesh made ready for the eye."""

import warp as wp


@wp.kernel(enable_backward=False)
def keep_finite(
    # Data in:
    positions: wp.array(dtype=wp.vec3f),
    limit: float,  # [m], from the origin
    # Data out:
    out_positions: wp.array(dtype=wp.vec3f),
    out_flags: wp.array(dtype=wp.int32),
):
    """Copy positions; those that are not numbers, or farther out than `limit`, are moved to the origin and left out."""
    i = wp.tid()
    p = positions[i]
    inside = wp.abs(p[0]) < limit and wp.abs(p[1]) < limit and wp.abs(p[2]) < limit
    if inside:
        out_positions[i] = p
        out_flags[i] = 1
    else:
        out_positions[i] = wp.vec3f(0.0)
        out_flags[i] = 0


@wp.func
def cubic_spline(q: float) -> float:
    """The kernel that the surface is made with, over the length whose double is its reach; 1 / pi in the middle."""
    if q < 1.0:
        return (1.0 - 1.5 * q * q + 0.75 * q * q * q) / wp.pi
    if q < 2.0:
        t = 2.0 - q
        return 0.25 * t * t * t / wp.pi
    return 0.0


@wp.kernel(enable_backward=False)
def part_drops(
    # Data in:
    grid: wp.uint64,
    positions: wp.array(dtype=wp.vec3f),
    flags: wp.array(dtype=wp.int32),
    fluid_count: int,  # of the positions, the first
    spacing: float,  # [m]
    least: float,
    alone: float,
    # Data out:
    out_radii: wp.array(dtype=float),  # [m]
    out_flags: wp.array(dtype=wp.int32),
    out_drops: wp.array(dtype=wp.vec3f),
    out_count: wp.array(dtype=wp.int32),  # of drops; 0 before
):
    """Part single drops from the particles that make a surface, and let these fill space where they lie thin.

    The share of space that particles fill in the middle of one of them is 1 within a fluid. Where the others add less
    than `alone` to its own 1 / pi it is a drop, and no part of the surface. In a sheet one particle thick the share is
    hardly above the one at which the surface is drawn: such particles get a radius with which it is `least`.
    """
    i = wp.tid()
    out_flags[i] = flags[i]
    out_radii[i] = 0.5 * spacing
    if flags[i] == 0:
        return
    p = positions[i]
    share = float(0.0)
    for j in wp.hash_grid_query(grid, p, 2.0 * spacing):
        if flags[j] != 0:
            share += cubic_spline(wp.length(positions[j] - p) / spacing)
    if i < fluid_count and share < 1.0 / wp.pi + alone:
        out_flags[i] = 0
        out_drops[wp.atomic_add(out_count, 0, 1)] = p
    elif share < least:
        out_radii[i] = 0.5 * spacing * wp.pow(least / share, 1.0 / 3.0)


@wp.kernel(enable_backward=False)
def place_drops(
    # Data in:
    drops: wp.array(dtype=wp.vec3f),
    ball: wp.array(dtype=wp.vec3f),  # a drop's vertices about its middle [m]
    ball_triangles: wp.array(dtype=wp.int32),  # their indices, three a triangle
    first_vertex: int,
    first_index: int,
    # Data out:
    out_vertices: wp.array(dtype=wp.vec3f),
    out_indices: wp.array(dtype=wp.int32),
    out_normals: wp.array(dtype=wp.vec3f),
):
    """Write a ball for each drop, behind the surface's vertices and indices."""
    drop = wp.tid()
    start = first_vertex + drop * ball.shape[0]
    for k in range(ball.shape[0]):
        out_vertices[start + k] = drops[drop] + ball[k]
        out_normals[start + k] = wp.normalize(ball[k])
    for k in range(ball_triangles.shape[0]):
        out_indices[first_index + drop * ball_triangles.shape[0] + k] = start + ball_triangles[k]


@wp.func
def _reach_wall(x: float, half: float, near: float, overlap: float) -> float:
    """Move a coordinate close to a wall at +-half onto it, and a bit into it."""
    gap = half - wp.abs(x)
    wall = half + overlap
    side = wp.sign(x)
    if gap <= 0.5 * near:
        return side * wall
    if gap < near:
        # Stretch the last stretch before the wall, so that the surface stays in one piece without a crease.
        share = (near - gap) / (0.5 * near)
        return side * (half - near + (near + overlap) * share)
    return x


@wp.kernel(enable_backward=False)
def fit_container(
    # Data in:
    center: wp.vec3f,
    rotation: wp.quatf,
    half: wp.vec3f,  # [m], of the container's hollow; its top is open
    near: float,  # [m]
    overlap: float,  # [m]
    # Data in and out:
    vertices: wp.array(dtype=wp.vec3f),
):
    """Bring vertices within `near` of a container's walls and floor onto them; those elsewhere stay."""
    i = wp.tid()
    p = wp.quat_rotate_inv(rotation, vertices[i] - center)
    # Fluid that went over the rim, or through a wall, is shown where it is.
    slack = 0.5 * near
    if wp.abs(p[0]) > half[0] + slack or wp.abs(p[1]) > half[1] + slack or wp.abs(p[2]) > half[2] + slack:
        return
    x = _reach_wall(p[0], half[0], near, overlap)
    y = _reach_wall(p[1], half[1], near, overlap)
    z = p[2]
    if z < 0.0:
        z = _reach_wall(z, half[2], near, overlap)
    vertices[i] = center + wp.quat_rotate(rotation, wp.vec3f(x, y, z))


@wp.kernel(enable_backward=False)
def place_points(
    # Data in:
    points: wp.array(dtype=wp.vec3f),  # in their shapes' frames
    shape_of_point: wp.array(dtype=wp.int32),
    shape_pose: wp.array(dtype=wp.transformf),
    limit: float,  # [m], from the origin
    start: int,
    # Data out:
    out_positions: wp.array(dtype=wp.vec3f),
    out_flags: wp.array(dtype=wp.int32),
):
    """Bring points that ride on shapes into the world, behind the first `start` positions."""
    i = wp.tid()
    p = wp.transform_point(shape_pose[shape_of_point[i]], points[i])
    inside = wp.abs(p[0]) < limit and wp.abs(p[1]) < limit and wp.abs(p[2]) < limit
    out_positions[start + i] = wp.where(inside, p, wp.vec3f(0.0))
    out_flags[start + i] = wp.where(inside, 1, 0)
