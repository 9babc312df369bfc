"""How deep points lie inside a closed triangle mesh."""

import warp as wp


@wp.kernel(enable_backward=False)
def depth_inside(
    # Data in:
    mesh: wp.uint64,
    points: wp.array(dtype=wp.vec3),
    reach: float,
    # Data out:
    depth: wp.array(dtype=float),
):
    """Distance to the surface [m], negative outside, by the winding number, which holds for meshes not quite closed."""
    i = wp.tid()
    query = wp.mesh_query_point_sign_winding_number(mesh, points[i], reach)
    depth[i] = -reach
    if query.result:
        depth[i] = -query.sign * wp.length(points[i] - wp.mesh_eval_position(mesh, query.face, query.u, query.v))
