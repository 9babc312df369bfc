"""The solid that a mesh of the model stands for, and how deep points are inside it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import trimesh
import warp as wp

from wsim.kernels.inside import depth_inside

Array = np.ndarray


def solid_of(vertices: Array, triangles: Array, convex: bool) -> trimesh.Trimesh:
    """A mesh as the fluid meets it: its convex hull where it is to be convex, or has holes."""
    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    return mesh.convex_hull if convex or not mesh.is_watertight else mesh


def is_open(vertices: Array, triangles: Array) -> bool:
    """Whether a mesh has an edge of one triangle alone, corners at one place taken as one."""
    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    return not mesh.is_watertight


def depth_in(solid: trimesh.Trimesh) -> Callable[[Array], Array]:
    """How deep points (n, 3) are inside a solid, (n,) [m]; negative outside."""
    vertices = np.asarray(solid.vertices)
    mesh = wp.Mesh(
        wp.array(vertices, dtype=wp.vec3, device="cpu"),
        wp.array(np.asarray(solid.faces).reshape(-1), dtype=wp.int32, device="cpu"),
        support_winding_number=True,
    )
    farthest = float(np.linalg.norm(vertices.max(axis=0) - vertices.min(axis=0)))
    return lambda points: mesh_depth(mesh, points, farthest).astype(float)


def mesh_depth(mesh: wp.Mesh, points: Array, farthest: float) -> Array:
    """How deep points (n, 3) are inside a mesh, (n,) [m]; -`farthest` where its skin is farther away than that."""
    depth = wp.zeros(len(points), dtype=wp.float32, device=mesh.device)
    if len(points):
        given = wp.array(points.astype(np.float32), dtype=wp.vec3f, device=mesh.device)
        wp.launch(depth_inside, dim=len(points), inputs=[mesh.id, given, farthest], outputs=[depth], device=mesh.device)
    return depth.numpy()
