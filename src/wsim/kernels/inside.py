"""Which points lie inside a closed triangle mesh."""

import warp as wp


@wp.kernel(enable_backward=False)
def mark_inside(
    # Data in:
    mesh: wp.uint64,
    points: wp.array(dtype=wp.vec3),
    reach: float,
    # Data out:
    inside: wp.array(dtype=wp.bool),
):
    """Mark points by the winding number, which holds for meshes that are not quite closed."""
    i = wp.tid()
    query = wp.mesh_query_point_sign_winding_number(mesh, points[i], reach)
    inside[i] = query.result and query.sign < 0.0
