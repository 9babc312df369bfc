"""Solids in a flow in the x-z plane: what the plane y = 0 cuts out of each, one metre deep."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from newton import GeoType

from wsim.geometry.filled import Samples, box_lattice
from wsim.geometry.outlines import Outline, outline_of
from wsim.geometry.rotations import matrices, rotate
from wsim.geometry.surfaces import Surface, arc, box_surface, revolved
from wsim.solvers.inside import solid_of
from wsim.solvers.layers import RELAXED, spread_layers

Array = np.ndarray
FACETS = 128  # of a round shape: a disc is right to 3e-4 of its area
PIECES = 8  # that a lattice cell's edge is cut into
UPRIGHT = 1.0 - 1e-9  # of an axis that is across the plane
EMPTY = Samples(np.zeros((0, 3)), np.zeros(0))


def section_of(kind: int, pose: Array, scale: Array, source: Any) -> Outline | None:
    """What the plane cuts out of a Newton shape; None of a kind that has no inside.

    Args:
        kind: A `newton.GeoType`.
        pose: Position and rotation in the world, (7,).
        scale: Newton's shape scale.
        source: The `newton.Mesh` of a mesh.
    """
    surface = _surface(kind, np.asarray(scale, dtype=float), source)
    pose = np.asarray(pose, dtype=float)
    return None if surface is None else outline_of(surface.turned(pose[3:], pose[:3]))


def upright_box(pose: Array, half: Array) -> tuple[Array, Array] | None:
    """A box with an axis across the plane, as one of a metre of depth about y = 0 that is turned about y alone.

    Args:
        pose: Position and rotation in the world, (7,).
        half: Half edges [m], (3,).

    Returns:
        Its pose and half edges; None of a box that leans, or that the plane does not cut.
    """
    pose = np.asarray(pose, dtype=float)
    axes = matrices(pose[3:])
    across = int(np.abs(axes[1]).argmax())
    if abs(axes[1, across]) < UPRIGHT or abs(pose[1]) >= half[across]:
        return None
    first, second = (k for k in range(3) if k != across)
    angle = math.atan2(-axes[2, first], axes[0, first])
    turned = np.array([pose[0], 0.0, pose[2], 0.0, math.sin(0.5 * angle), 0.0, math.cos(0.5 * angle)])
    return turned, np.array([half[first], 0.5, half[second]])


def fill_section(kind: int, pose: Array, scale: Array, source: Any, spacing: float) -> Samples | None:
    """Particles of what the plane cuts out of a Newton shape, in the world's frame, as `sample_shape` fills a solid.

    Volumes are those of one metre of depth, whatever the shape's own is. Boxes across the plane have their lattice; all
    else has layers that follow the outline.

    Args:
        kind: A `newton.GeoType`.
        pose: Position and rotation in the world, (7,).
        scale: Newton's shape scale.
        source: The `newton.Mesh` of a mesh.
        spacing: Between particles [m].

    Returns:
        None of a kind that has no inside; no particles of what the plane does not cut.
    """
    box = upright_box(pose, scale) if kind == GeoType.BOX else None
    if box is not None:
        own = box_lattice(2.0 * box[1], spacing, plane=True)
        return Samples(rotate(box[0][3:], own.position) + box[0][:3], own.volume)
    outline = section_of(kind, pose, scale, source)
    return None if outline is None else fill_outline(outline, spacing)


def fill_outline(outline: Outline, spacing: float) -> Samples:
    """Particles inside an outline, in layers that follow it, at y = 0; their volumes are of a metre of depth."""
    if len(outline.segments) == 0 or outline.area <= 0.0:
        return EMPTY
    low, high = outline.bounds
    extent = high - low
    counts = np.maximum(np.round(extent / spacing), 1.0)
    lattice = box_lattice(np.array([extent[0], 1.0, extent[1]]), spacing, plane=True).position[:, [0, 2]]
    cells, edge = lattice + 0.5 * (low + high), extent / counts
    depth = outline.depth(cells)
    deep = depth >= RELAXED * spacing
    near = ~deep & (depth > -float(np.linalg.norm(edge)))
    outer = spread_layers(cells[near], depth[near], edge, spacing, outline.depth, fine=PIECES)
    flat = np.concatenate([outer.position, cells[deep]])
    volume = np.concatenate([outer.volume, np.full(int(deep.sum()), edge.prod())])
    if len(flat) == 0:
        flat, volume = outline.centroid[None], np.ones(1)
    volume *= outline.area / volume.sum()
    flat += outline.centroid - (volume[:, None] * flat).sum(axis=0) / outline.area  # or the lift would turn the body
    return Samples(np.stack([flat[:, 0], np.zeros(len(flat)), flat[:, 1]], axis=1), volume)


def _surface(kind: int, scale: Array, source: Any) -> Surface | None:
    """The skin of a Newton shape in its own frame, closed and with its triangles facing outward."""
    radius, half = float(scale[0]), float(scale[1])
    if kind == GeoType.BOX:
        return box_surface(tuple(2.0 * scale))
    if kind == GeoType.SPHERE:
        return revolved(*arc(radius, 0.0, FACETS), volume=4.0 / 3.0 * math.pi * radius**3, around=FACETS)
    if kind == GeoType.ELLIPSOID:
        ball = revolved(*arc(1.0, 0.0, FACETS), volume=4.0 / 3.0 * math.pi, around=FACETS)
        return Surface(ball.vertices * scale, ball.triangles)
    if kind == GeoType.CAPSULE:
        volume = math.pi * radius**2 * (2.0 * half + 4.0 / 3.0 * radius)
        return revolved(*arc(radius, 2.0 * half, FACETS), volume=volume, around=FACETS)
    if kind in (GeoType.CYLINDER, GeoType.CONE):
        top = radius if kind == GeoType.CYLINDER else 0.0
        profile = np.array([0.0, radius, top, 0.0]), np.array([-half, -half, half, half])
        volume = math.pi * radius**2 * 2.0 * half * (1.0 if top else 1.0 / 3.0)
        return revolved(*profile, volume=volume, radial=True, around=FACETS)
    if kind in (GeoType.MESH, GeoType.CONVEX_MESH):
        vertices = np.asarray(source.vertices, dtype=float).reshape(-1, 3) * scale
        solid = solid_of(vertices, np.asarray(source.indices).reshape(-1, 3), kind == GeoType.CONVEX_MESH)
        triangles = np.asarray(solid.faces, dtype=np.intp)
        found = Surface(np.asarray(solid.vertices, dtype=float), triangles)
        return found if found.volume > 0.0 else Surface(found.vertices, triangles[:, ::-1])
    return None
