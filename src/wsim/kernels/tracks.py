"""Keeps, on the device, what all worlds do at a frame: no number crosses to the host while they are stepped."""

import warp as wp


@wp.func
def push_body(force: wp.array2d(dtype=wp.float64), body: int, sign: float, push: wp.vec3):
    """Add a force to a body's sum; what never moves is below 0."""
    if body >= 0:
        for axis in range(3):
            wp.atomic_add(force, body, axis, wp.float64(sign * push[axis]))


@wp.func
def body_of(geom: int, shape_of: wp.array(dtype=int), shape_body: wp.array(dtype=int)) -> int:
    """The body that a geom belongs to; -1 for none."""
    shape = shape_of[geom]
    if shape < 0:
        return -1
    return shape_body[shape]


@wp.kernel(enable_backward=False)
def sum_contacts(
    # Data in:
    contacts: wp.array(dtype=int),  # how many there are
    world: wp.array(dtype=int),
    geom: wp.array(dtype=wp.vec2i),
    frame: wp.array(dtype=wp.mat33),  # rows are axes; the first points from the first geom to the second
    distance: wp.array(dtype=float),
    rows: wp.array2d(dtype=int),
    row_force: wp.array2d(dtype=float),
    geom_shape: wp.array2d(dtype=int),  # of each world
    shape_body: wp.array(dtype=int),
    # Data out:
    force: wp.array2d(dtype=wp.float64),  # on each body of all worlds [N]
    load: wp.array(dtype=wp.float64),  # on each body, whichever way contacts press [N]
    deepest: wp.array(dtype=wp.float64),  # of each world [m]
):
    """Add up the forces of all contacts, and their sizes, and find the deepest of each world."""
    k = wp.tid()
    if k >= contacts[0]:
        return
    w = world[k]
    wp.atomic_max(deepest, w, wp.float64(-distance[k]))
    if rows[k, 0] < 0:
        return
    # An elliptic cone's rows are the push and the two frictions, along the axes of the contact's frame.
    push = wp.vec3(0.0, 0.0, 0.0)
    for axis in range(3):
        push += row_force[w, rows[k, axis]] * frame[k][axis]
    for side in range(2):
        body = body_of(geom[k][side], geom_shape[w], shape_body)
        push_body(force, body, float(2 * side - 1), push)
        if body >= 0:
            wp.atomic_add(load, body, wp.float64(wp.length(push)))


@wp.kernel(enable_backward=False)
def keep_frame(
    # Data in:
    body_q: wp.array(dtype=wp.transform),
    body_qd: wp.array(dtype=wp.spatial_vector),
    body_force: wp.array2d(dtype=wp.float64),
    rows: wp.array(dtype=int),  # of the bodies that are kept, among those of a world
    bodies: int,  # of a world
    t: int,
    # Data out, by world, frame and body:
    q: wp.array3d(dtype=wp.transform),
    qd: wp.array3d(dtype=wp.spatial_vector),
    force: wp.array3d(dtype=wp.vec3),
):
    """Keep poses, velocities and contact forces as frame t."""
    w, b = wp.tid()
    body = w * bodies + rows[b]
    q[w, t, b] = body_q[body]
    qd[w, t, b] = body_qd[body]
    force[w, t, b] = wp.vec3(float(body_force[body, 0]), float(body_force[body, 1]), float(body_force[body, 2]))


@wp.kernel(enable_backward=False)
def keep_deepest(
    # Data in:
    deepest: wp.array(dtype=wp.float64),
    t: int,
    # Data out:
    kept: wp.array2d(dtype=wp.float64),
):
    """Keep each world's deepest contact as frame t."""
    w = wp.tid()
    kept[w, t] = deepest[w]
