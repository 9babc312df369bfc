"""Triangles that stand still, made ready for contact: one side out, edges that touch and edges that do not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import trimesh
import warp as wp

from wsim.kernels.surface import Surface

Array = np.ndarray

KINK = 1e-3  # [rad]: faces that differ by less are one plane; a kink of d takes sin² d of the energy, 1e-6
SAME_NORMAL = 1e-2  # two faces whose normals at an edge differ by less are one curved surface there
SHARP, CURVED = 1, 2


@dataclass(frozen=True)
class Part:
    """One object's triangles in the world's frame: (V, 3) [m], (F, 3), outward normals at their corners or None."""

    vertices: Array
    triangles: Array
    normals: Array | None = None  # (F, 3, 3)


@dataclass
class _Prepared:
    points: Array
    faces: Array
    normals: Array
    face_normals: Array
    edge: Array
    guard: Array
    beyond: Array
    is_open: bool


def _prepare(part: Part) -> _Prepared:
    mesh = trimesh.Trimesh(part.vertices, part.triangles, process=False)
    normals = part.normals
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    whole = mesh.area_faces > 1e-9 * float(np.ptp(mesh.vertices, axis=0).max()) ** 2
    points, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)[whole]
    normals = None if normals is None else normals[whole]
    solid = trimesh.Trimesh(points, faces, process=False)
    is_open = not solid.is_watertight
    if not is_open and solid.volume < 0.0:
        faces = np.ascontiguousarray(faces[:, ::-1])
        normals = None if normals is None else -normals[:, ::-1]
    corners = points[faces]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    flat /= np.linalg.norm(flat, axis=1, keepdims=True)
    if normals is None:
        normals = np.repeat(flat[:, None], 3, axis=1)
    normals = normals * np.sign(np.einsum("fki,fi->fk", normals, flat))[..., None]
    edge, guard, beyond = _edges(points, faces, flat, normals, is_open)
    return _Prepared(points, faces, normals, flat, edge, guard, beyond, is_open)


def _edges(points: Array, faces: Array, flat: Array, normals: Array, is_open: bool) -> tuple[Array, Array, Array]:
    """For each face and each of its edges: what it is (in one of its faces), whether to guard it, what is beyond it."""
    kind = np.zeros(faces.shape, dtype=np.int32)
    guard = np.zeros(faces.shape, dtype=np.int32)
    beyond = np.full(faces.shape, -1, dtype=np.int32)
    ends = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    order = np.lexsort(np.sort(ends, axis=1).T)
    ordered = np.sort(ends, axis=1)[order]
    starts = np.flatnonzero(np.r_[True, (np.diff(ordered, axis=0) != 0).any(axis=1)])
    sizes = np.diff(np.r_[starts, len(ordered)])
    lone = order[np.repeat(sizes != 2, sizes)]
    kind.reshape(-1)[lone] = SHARP
    guard.reshape(-1)[lone] = 1
    first, second = order[starts[sizes == 2]], order[starts[sizes == 2] + 1]
    f, e, g, d = first // 3, first % 3, second // 3, second % 3
    beyond[f, e], beyond[g, d] = faces[g, (d + 2) % 3], faces[f, (e + 2) % 3]
    from_ = points[faces[f, e]]
    off = points[beyond[f, e]] - from_
    along = points[faces[f, (e + 1) % 3]] - from_
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    off -= np.einsum("ni,ni->n", off, along)[:, None] * along
    rise = np.einsum("ni,ni->n", off, flat[f]) / np.linalg.norm(off, axis=1)
    folded = np.einsum("ni,ni->n", flat[f], flat[g]) < -1.0 + 1e-6  # a sheet of two sides
    sharp = (rise < -KINK) | folded | (is_open & (np.abs(rise) > KINK))
    same_way = faces[f, e] != faces[g, d]  # neighbours of one orientation run along their edge in opposite ways
    near_f = np.stack([normals[f, e], normals[f, (e + 1) % 3]], axis=1)
    near_g = np.stack([normals[g, (d + 1) % 3], normals[g, d]], axis=1)
    smooth = (np.linalg.norm(near_f - near_g, axis=2).max(axis=1) < SAME_NORMAL) & same_way
    kind[f, e] = np.where(sharp, np.where(smooth, CURVED, SHARP), 0)
    guard[f, e] = guard[g, d] = sharp & ~smooth
    return kind, guard, beyond


def make_surface(parts: Sequence[Part], device: Any) -> tuple[Any, Any]:
    """All parts as one `wsim.kernels.surface.Surface` on a device, and the `wp.Mesh` behind it, to be kept."""
    ready = [_prepare(part) for part in parts]
    first = np.cumsum([0, *(len(each.points) for each in ready)])
    points = np.concatenate([each.points for each in ready])
    faces = np.concatenate([each.faces + k for each, k in zip(ready, first, strict=False)])
    flat = np.concatenate([each.face_normals for each in ready])
    normals = np.concatenate([each.normals for each in ready])
    kind, guard = (np.concatenate([getattr(each, name) for each in ready]) for name in ("edge", "guard"))
    beyond = np.concatenate([np.where(r.beyond < 0, -1, r.beyond + k) for r, k in zip(ready, first, strict=False)])
    pairs = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    pairs = np.unique(np.concatenate([pairs, pairs[:, ::-1]]), axis=0)
    ring_first = np.searchsorted(pairs[:, 0], np.arange(len(points) + 1))
    surface = Surface()
    with wp.ScopedDevice(device):
        mesh = wp.Mesh(
            wp.array(points, dtype=wp.vec3), wp.array(np.ascontiguousarray(faces).reshape(-1), dtype=wp.int32)
        )
        surface.mesh, surface.points = mesh.id, mesh.points
        surface.corners = wp.array(faces, dtype=wp.int32, ndim=2)
        surface.normals = wp.array(normals, dtype=wp.vec3)
        surface.curved = wp.array((np.abs(normals - flat[:, None]).max(axis=(1, 2)) > 1e-5).astype(np.int32))
        surface.open = wp.array(
            np.repeat([each.is_open for each in ready], [len(r.faces) for r in ready]).astype(np.int32)
        )
        surface.part = wp.array(np.repeat(np.arange(len(ready)), [len(r.faces) for r in ready]).astype(np.int32))
        surface.edge, surface.guard = wp.array(kind.astype(np.int32)), wp.array(guard.astype(np.int32))
        surface.beyond = wp.array(beyond.astype(np.int32))
        surface.ring_first = wp.array(ring_first.astype(np.int32))
        surface.ring = wp.array(pairs[:, 1].astype(np.int32))
    return surface, mesh
