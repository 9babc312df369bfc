"""Solids with any closed surface, filled with particles in layers that follow the surface, as round ones are.

`wsim.geometry.filled` says why.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.spatial import cKDTree

from wsim.geometry.filled import Samples, box_lattice, lattice_axis
from wsim.solvers.inside import depth_in, solid_of

Array = np.ndarray
RELAXED = 3  # layers of a mesh, from its surface inward: what the fluid's kernel reaches
PIECES = 4  # that a lattice cell's edge is cut into, to say what belongs to which particle of a mesh
SWEEPS = 10
ROUGHLY = (3, 2)  # sweeps and pieces of what only lies there: nothing floats on how round it is


def mesh_layers(vertices: Array, triangles: Array, spacing: float, convex: bool) -> Samples:
    """Particles inside a closed triangle mesh, or its convex hull; the volumes add up to the solid's.

    The mesh is filled with a lattice. Near the surface its particles are then moved until each is the centroid of the
    part of its layer that is nearest to it, which is its volume (Lloyd 1982, IEEE Transactions on Information Theory
    28): they spread evenly along the surface. What a lattice fills, such as a box, stays as it is.

    Args:
        vertices: Positions [m], shape (n, 3).
        triangles: Vertex indices, shape (m, 3).
        spacing: Between particles [m].
        convex: Fill the convex hull.
    """
    solid = solid_of(vertices, triangles, convex)
    low, high = solid.bounds
    cells = box_lattice(high - low, spacing).position + 0.5 * (low + high)
    edge = np.array([length / lattice_axis(float(length), spacing)[0] for length in high - low])
    depth_of = depth_in(solid)
    depth = depth_of(cells)
    deep = depth >= RELAXED * spacing
    near = ~deep & (depth > -float(np.linalg.norm(edge)))
    outer = spread_layers(cells[near], depth[near], edge, spacing, depth_of)
    position = np.concatenate([outer.position, cells[deep]])
    volume = np.concatenate([outer.volume, np.full(int(deep.sum()), np.prod(edge))])
    if len(position) == 0:
        return Samples(np.asarray(solid.center_mass).reshape(1, 3), np.array([abs(float(solid.volume))]))
    return Samples(position, volume * (abs(float(solid.volume)) / volume.sum()))


def mesh_part(
    depth_of: Callable[[Array], Array], low: Array, high: Array, spacing: float, shell: float
) -> Samples:  # fmt: skip
    """Particles of the part of a solid that is in a box, less than `shell` below its surface.

    Each part is filled for itself, with what of the solid is in it: parts that meet fill it together, with volumes that
    add up, whichever comes first.

    Args:
        depth_of: How deep points are below the surface [m].
        low: Lower corner of the box [m].
        high: Upper corner.
        spacing: Between particles [m].
        shell: Thickness [m].
    """
    axes = [lattice_axis(float(length), spacing) for length in high - low]
    edge = np.array([length for _, length in axes])
    ticks = [low[k] + (np.arange(count) + 0.5) * edge[k] for k, (count, _) in enumerate(axes)]
    cells = np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, 3)
    depth = depth_of(cells)
    cells, depth = cells[depth < shell], depth[depth < shell]
    deep = depth >= RELAXED * spacing
    near = ~deep & (depth > -float(np.linalg.norm(edge)))
    outer = spread_layers(cells[near], depth[near], edge, spacing, depth_of, *ROUGHLY)
    inside = np.clip(outer.position, low, np.nextafter(high, low))
    volume = np.concatenate([outer.volume, np.full(int(deep.sum()), np.prod(edge))])
    return Samples(np.concatenate([inside, cells[deep]]), volume)


def spread_layers(
    cells: Array,
    depth: Array,
    edge: Array,
    spacing: float,
    depth_of: Callable[[Array], Array],
    sweeps: int = SWEEPS,
    fine: int = PIECES,
) -> Samples:
    """Particles of the layers at a surface, spread along it; in space, or in a plane.

    Args:
        cells: Centres of the lattice cells that the layers cross [m], shape (n, d).
        depth: Theirs below the surface [m], shape (n,).
        edge: Of a cell [m], shape (d,).
        spacing: Thickness of a layer [m].
        depth_of: Depth of any points below the surface [m].
        sweeps: Rounds of spreading.
        fine: Pieces that a cell's edge is cut into.
    """
    d = len(edge)
    ticks = [((np.arange(fine) + 0.5) / fine - 0.5) * length for length in edge]
    corners = np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, d)
    pieces = (cells[:, None, :] + corners).reshape(-1, d)
    below = depth_of(pieces)
    keep = (below > 0.0) & (below < RELAXED * spacing)
    # One more axis, along which layers are far apart: nothing is nearest to a particle of another layer.
    far = 1e3 * spacing
    pieces = np.column_stack([pieces, far * np.floor(below / spacing)])[keep]
    if len(pieces) == 0:
        return Samples(np.zeros((0, d)), np.zeros(0))
    seeds = np.column_stack([cells, far * np.floor(depth / spacing)])[depth > 0.0]
    seeds = _cover(seeds, pieces, spacing)
    for _ in range(sweeps):
        nearest = cKDTree(seeds).query(pieces, workers=-1)[1]
        count = np.bincount(nearest, minlength=len(seeds))
        sums = np.stack([np.bincount(nearest, pieces[:, axis], len(seeds)) for axis in range(d + 1)], axis=1)
        seeds, count = sums[count > 0] / count[count > 0, None], count[count > 0]
        seeds[:, :d] = _to_mid_depth(seeds[:, :d], spacing, depth_of)
    return Samples(seeds[:, :d], count * np.prod(edge / fine))


def _cover(seeds: Array, pieces: Array, spacing: float) -> Array:
    """More seeds where a thin part of the solid has none within a spacing, no two in one cell."""
    away = cKDTree(seeds).query(pieces, workers=-1)[0] if len(seeds) else np.full(len(pieces), np.inf)
    bare = pieces[away > spacing]
    _, first = np.unique(np.floor(bare / spacing), axis=0, return_index=True)
    return np.concatenate([seeds.reshape(-1, pieces.shape[1]), bare[first]])


def _to_mid_depth(points: Array, spacing: float, depth_of: Callable[[Array], Array]) -> Array:
    """Points moved to the middle of their layer, where that is inside; a thin part's stay where they are.

    A centroid lies outside the middle where the surface bulges: 0.03 spacings at 8 particles a diameter, and a ball
    floats 0.05 spacings high.
    """
    depth, step = depth_of(points), 0.1 * spacing
    middle = (np.floor(depth / spacing) + 0.5) * spacing
    slope = [
        (depth_of(points + step * axis) - depth_of(points - step * axis)) / (2.0 * step)
        for axis in np.eye(points.shape[1])
    ]
    moved = points + (middle - depth)[:, None] * np.stack(slope, axis=1)
    nearer = np.abs(depth_of(moved) - middle) < np.abs(depth - middle)
    return np.where(nearer[:, None], moved, points)
