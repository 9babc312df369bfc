"""Particles that stand for solids: lattices that fill a shape, and layers behind the walls of a container."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Array = np.ndarray


@dataclass(frozen=True)
class Samples:
    """Particles of a solid: positions [m] of shape (n, 3) and volumes [m^3] of shape (n,)."""

    position: Array
    volume: Array


def lattice_axis(length: float, spacing: float) -> tuple[int, float]:
    """Cells that divide a length [m] evenly at about `spacing` [m], and their exact edge [m]."""
    count = max(1, round(length / spacing))
    return count, length / count


def box_lattice(size: Array, spacing: float, plane: bool = False) -> Samples:
    """Cell centres of a box of edge lengths `size` [m] about the origin; the volumes add up to the box's.

    With `plane` there is one cell along y, as deep as the box.
    """
    axes = [lattice_axis(float(length), spacing) for length in size]
    if plane:
        axes[1] = (1, float(size[1]))
    ticks = [(np.arange(count) + 0.5) * edge - 0.5 * count * edge for count, edge in axes]
    position = np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, 3)
    return Samples(position, np.full(len(position), np.prod([edge for _, edge in axes])))


def _keep(points: Array, inside: Array, volume: float) -> Samples:
    """The lattice points that are inside, sharing the shape's exact volume; one at the centre if none is."""
    kept = points[inside]
    if len(kept) == 0:
        kept = np.zeros((1, 3))
    return Samples(kept, np.full(len(kept), volume / len(kept)))


def sphere_lattice(radius: float, spacing: float) -> Samples:
    """Lattice points inside a sphere of `radius` [m]; the volumes add up to the sphere's."""
    points = box_lattice(np.full(3, 2.0 * radius), spacing).position
    inside = np.linalg.norm(points, axis=1) <= radius
    return _keep(points, inside, 4.0 / 3.0 * np.pi * radius**3)


def cylinder_lattice(radius: float, half_height: float, spacing: float) -> Samples:
    """Lattice points inside a cylinder along Z; the volumes add up to the cylinder's."""
    half = np.array([radius, radius, half_height])
    points = box_lattice(2.0 * half, spacing).position
    inside = np.hypot(points[:, 0], points[:, 1]) <= radius
    return _keep(points, inside, 2.0 * np.pi * radius**2 * half_height)


def capsule_lattice(radius: float, half_height: float, spacing: float) -> Samples:
    """Lattice points inside a capsule along Z whose cylinder is `2 half_height` [m] long."""
    half = np.array([radius, radius, half_height + radius])
    points = box_lattice(2.0 * half, spacing).position
    above = np.maximum(np.abs(points[:, 2]) - half_height, 0.0)
    inside = np.sqrt(points[:, 0] ** 2 + points[:, 1] ** 2 + above**2) <= radius
    volume = 2.0 * np.pi * radius**2 * half_height + 4.0 / 3.0 * np.pi * radius**3
    return _keep(points, inside, volume)


def mesh_lattice(vertices: Array, triangles: Array, spacing: float, convex: bool) -> Samples:
    """Lattice points inside a closed triangle mesh, or inside its convex hull.

    Args:
        vertices: Positions [m], shape (n, 3).
        triangles: Vertex indices, shape (m, 3).
        spacing: Lattice spacing [m].
        convex: Fill the convex hull.
    """
    import trimesh

    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    solid = mesh.convex_hull if convex or not mesh.is_watertight else mesh
    low, high = solid.bounds
    points = box_lattice(high - low, spacing).position + 0.5 * (low + high)
    inside = _inside_mesh(np.asarray(solid.vertices), np.asarray(solid.faces), points)
    return _keep(points, inside, abs(float(solid.volume)))


def _inside_mesh(vertices: Array, triangles: Array, points: Array) -> Array:
    import warp as wp

    from wsim.kernels.inside import mark_inside

    mesh = wp.Mesh(
        wp.array(vertices, dtype=wp.vec3, device="cpu"),
        wp.array(triangles.reshape(-1), dtype=wp.int32, device="cpu"),
        support_winding_number=True,
    )
    reach = float(np.linalg.norm(vertices.max(axis=0) - vertices.min(axis=0)))
    inside = wp.zeros(len(points), dtype=wp.bool, device="cpu")
    wp.launch(
        mark_inside,
        dim=len(points),
        inputs=[mesh.id, wp.array(points, dtype=wp.vec3, device="cpu"), reach],
        outputs=[inside],
        device="cpu",
    )
    return inside.numpy()


def container_walls(inner_size: Array, spacing: float, support: float, sides: Array, plane: bool = False) -> Samples:
    """Layers of particles behind the walls of a box, as deep as a kernel's support reaches.

    The layers carry on the lattice of a fluid that fills the box, whose first particles stand half a cell off the
    wall, and end at the rim of an open side. Positions [m] are relative to the centre of the hollow.

    Args:
        inner_size: Inner edge lengths [m].
        spacing: Particle spacing [m].
        support: Radius of the kernel's support [m].
        sides: Which walls there are, shape (3, 2): lower and upper of each axis.
        plane: One layer at y = 0 that stands for the box's whole depth.
    """
    axes = [lattice_axis(float(length), spacing) for length in inner_size]
    if plane:
        axes[1] = (1, float(inner_size[1]))
    ticks, outside = [], []
    for (count, edge), (lower, upper) in zip(axes, sides, strict=True):
        layers = max(1, round(support / edge - 0.5))
        index = np.arange(-layers if lower else 0, count + (layers if upper else 0))
        ticks.append((index + 0.5) * edge - 0.5 * count * edge)
        outside.append((index < 0) | (index >= count))
    position = np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, 3)
    keep = np.stack(np.meshgrid(*outside, indexing="ij"), axis=-1).reshape(-1, 3).any(axis=1)
    position = position[keep]
    return Samples(position, np.full(len(position), np.prod([edge for _, edge in axes])))


def plane_patch(low: Array, high: Array, spacing: float, support: float, plane: bool = False) -> Samples:
    """Layers below z = 0 over the rectangle from `low` to `high` [m], shape (2,) each; one metre deep if `plane`."""
    size = np.asarray(high) - np.asarray(low)
    axes = [lattice_axis(float(length), spacing) for length in size]
    layers = max(1, round(support / spacing - 0.5))
    ticks = [low[k] + (np.arange(count) + 0.5) * edge for k, (count, edge) in enumerate(axes)]
    if plane:
        axes[1], ticks[1] = (1, 1.0), np.zeros(1)
    ticks.append(-(np.arange(layers) + 0.5) * spacing)
    position = np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, 3)
    return Samples(position, np.full(len(position), axes[0][1] * axes[1][1] * spacing))
