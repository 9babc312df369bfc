"""Where a shape touches the triangles of a mesh: its lowest points over each face, and the mesh's edges in its sides.

Faces push along their normal, or along that of the curve that they stand for; edges and corners along the side of the
shape that they press on (Ericson, Real-Time Collision Detection, 2005, ch. 5). Only edges that stick out can press.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import ConvexHull, QhullError, cKDTree

from wsim.geometry.rotations import conjugate, cross, lengths, rotate
from wsim.geometry.shapes import kind_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.scene.world import Shape

    Floats = NDArray[np.float64]
    Rows = NDArray[np.intp]
    Depth = Callable[[Floats], Floats]

AROUND = 8  # points of a cylinder's rim
ALONG = 9  # points of an edge
OUTSIDE = 1e-3  # of a triangle: how far beside it a point still counts as over it
OUTSIDE_CURVED = 1e-2  # two that stand for what is curved meet at their line to the second order only
FOOT_STEPS = 8  # to the nearest point of what is curved
EVEN = 1e-5  # by which a normal at a corner may differ from that of a flat triangle
STEEPEST = 0.2  # cosine between a triangle's normal and one at its corners, at least
FLAT = 1e-3  # sine between two faces whose edge does not stick out
DEEPEST = 0.5  # of a shape's radius: what is deeper under a face is not pushed out by it
MOST = 256  # corners of a mesh that are asked for over another's faces
NEAR = 2e-3  # [m]: what is nearer than this touches
MANY = 32  # contacts of one pair: more are thinned to the deepest and the outermost in each of
SOME = 16  # of these, that touch, and are kept besides
WAYS = np.array([way for way in np.ndindex(3, 3, 3) if way != (1, 1, 1)]) - 1.0


def colliding(shape: Shape) -> list[Shape]:
    """What collides for a mesh: the convex pieces that a simulator cut, its hull, or its triangles as they are."""
    pieces = [np.array(piece, dtype=np.float64) for piece in shape.pieces]
    if not pieces and shape.convex:
        pieces = [np.array(shape.vertices, dtype=np.float64)]
    hulls = [_hull(piece) for piece in pieces]
    if not hulls or any(faces is None for faces in hulls):
        return [shape]
    return [
        shape.model_copy(update={"vertices": corners.tolist(), "triangles": faces.tolist(), "normals": []})
        for corners, faces in zip(pieces, hulls, strict=True)
        if faces is not None
    ]


def _hull(corners: Floats) -> Rows | None:
    """The triangles of a convex hull (F, 3), all outwards; None where it is flat."""
    try:
        hull = ConvexHull(corners)
    except QhullError:
        return None
    faces = np.array(hull.simplices, dtype=np.intp)
    a, b, c = (corners[faces[:, k]] for k in range(3))
    inwards = np.einsum("fi,fi->f", np.cross(b - a, c - a), hull.equations[:, :3]) < 0.0
    faces[inwards] = faces[inwards][:, ::-1]
    return faces


@dataclass(frozen=True)
class Near:
    """Contacts of a shape with a mesh, in the mesh's frame, n of them; normals from the mesh to the shape."""

    point: Floats  # (n, 3)
    normal: Floats  # (n, 3)
    gap: Floats  # (n,)

    @staticmethod
    def of(parts: list[Near]) -> Near:
        """All of several."""
        return Near(*(np.concatenate([getattr(part, name) for part in parts]) for name in ("point", "normal", "gap")))


class Triangles:
    """A mesh in its own frame, ready to be asked."""

    def __init__(self, shape: Shape) -> None:
        self.vertices = np.array(shape.vertices, dtype=np.float64)
        self.faces = np.array(shape.triangles, dtype=np.intp)
        corners = self.vertices[self.faces]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        twice = np.linalg.norm(across, axis=1)
        whole = twice > 1e-12 * max(float(twice.max(initial=0.0)), 1e-300)
        self.faces, self.corners = self.faces[whole], corners[whole]
        self.normals = across[whole] / twice[whole, None]
        smooth = np.array(shape.normals, dtype=np.float64).reshape(-1, 3, 3) if shape.normals else None
        self.smooth = None if smooth is None else smooth[whole]
        self.centres = self.corners.mean(axis=1)
        self.radii = np.linalg.norm(self.corners - self.centres[:, None], axis=2).max(axis=1)
        self.low, self.high = self.vertices.min(axis=0), self.vertices.max(axis=0)
        self.radius = float(np.linalg.norm(self.vertices, axis=1).max())  # about its origin
        self._tree = cKDTree(self.centres)

    @cached_property
    def edges(self) -> tuple[Rows, Rows]:
        """Edges that stick out, (e, 2) vertices, and the first face of each, (e,)."""
        pairs = np.concatenate([self.faces[:, [0, 1]], self.faces[:, [1, 2]], self.faces[:, [2, 0]]])
        owner = np.tile(np.arange(len(self.faces)), 3)
        # Corners that lie on each other are one.
        _, same = np.unique(self.vertices.round(9), axis=0, return_inverse=True)
        keys = np.sort(same.ravel()[pairs], axis=1)
        _, first, which = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        others = np.setdiff1d(np.arange(len(pairs)), first)
        edge = which.ravel()[others]
        beyond = self.corners[owner[others]] - self.vertices[pairs[others, 0]][:, None]
        rise = np.einsum("eki,ei->ek", beyond, self.normals[owner[first[edge]]]).min(axis=1)
        out = np.ones(len(first), dtype=bool)
        np.logical_and.at(out, edge, rise < -FLAT * np.linalg.norm(beyond, axis=2).max(axis=1))
        return pairs[first[out]], owner[first[out]]

    def edges_of(self, faces: Rows) -> Rows:
        """Edges that stick out and whose first face is one of some, (e, 2)."""
        edges, _ = self.edges
        order, first = self._by_face
        counts = first[faces + 1] - first[faces]
        at = np.arange(counts.sum()) + np.repeat(first[faces] - np.cumsum(counts) + counts, counts)
        return edges[order[at]]

    @cached_property
    def _by_face(self) -> tuple[Rows, Rows]:
        """Edges in the order of their faces, and where each face's begin."""
        _, owner = self.edges
        order = np.argsort(owner, kind="stable")
        return order, np.searchsorted(owner[order], np.arange(len(self.faces) + 1))

    @cached_property
    def points(self) -> Floats:
        """The corners of its hull, at most `MOST` of them."""
        try:
            rows = ConvexHull(self.vertices).vertices
        except QhullError:  # flat
            rows = np.arange(len(self.vertices))
        return self.vertices[rows[:: -(-len(rows) // MOST)]]

    @cached_property
    def curved(self) -> NDArray[np.bool_]:
        """Faces that stand for what is curved, (f,)."""
        if self.smooth is None:
            return np.zeros(len(self.faces), dtype=bool)
        return np.asarray(np.abs(self.smooth - self.normals[:, None]).max(axis=(1, 2)) > EVEN)

    def beyond(self, points: Floats) -> Floats:
        """How far points (n, 3) are from its bounding box, (n,) [m]."""
        return lengths(np.maximum(np.maximum(self.low - points, points - self.high), 0.0))

    def faces_near(self, centre: Floats, reach: float) -> Rows:
        """The faces that a ball meets."""
        near = np.array(self._tree.query_ball_point(centre, reach + float(self.radii.max())), dtype=np.intp)
        if not len(near):
            return near
        apart = np.linalg.norm(self.centres[near] - centre, axis=1)
        return np.asarray(near[apart <= reach + self.radii[near]])


def radius_about(shape: Shape) -> float:
    """Of the ball about a shape's origin that it is in [m]; a plane is in none."""
    return np.inf if shape.kind == "plane" else float(kind_of(shape).radius_about)


def touching(mesh: Triangles, shape: Shape, other: Triangles | None, pose: Floats, reach: float) -> Near | None:
    """Contacts with a shape at a pose in the mesh's frame (7,) whose gap is at most `reach` [m].

    `other` are the shape's own triangles where it is a mesh, too; of them its corners are asked for alone.
    """
    if shape.kind == "plane":
        return _corners_on(mesh, kind_of(shape).depth, pose, reach)
    radius = radius_about(shape) if other is None else other.radius
    faces = mesh.faces_near(pose[:3], radius + reach)
    if not len(faces):
        return None
    lowest = _lowest(shape, other, pose, mesh.normals[faces])
    rounded = shape.size[0] if shape.kind in ("sphere", "capsule", "cylinder") else 0.0
    found, curved = [], mesh.curved[faces] & (shape.kind == "sphere")
    if not curved.all():
        flat = lowest if len(lowest) == 1 else lowest[~curved]
        found.append(_over_faces(mesh, faces[~curved], flat, rounded, reach, DEEPEST * radius))
    if curved.any():
        found.append(_over_curves(mesh, faces[curved], pose[:3], radius, reach))
    if other is None:
        found.append(_edges_in(mesh, faces, kind_of(shape).depth, pose, radius, reach))
    return _thinned(Near.of(found), lines=True)


def _lowest(shape: Shape, other: Triangles | None, pose: Floats, normals: Floats) -> Floats:
    """The points of a shape that may be its lowest over faces with such normals (m, 3), (m, p, 3) or (1, p, 3)."""
    own = rotate(conjugate(pose[3:]), normals)
    if other is not None:
        local = other.points[None]
    elif shape.kind == "box":
        signs = np.array(np.meshgrid([-0.5, 0.5], [-0.5, 0.5], [-0.5, 0.5])).reshape(3, -1).T
        local = (signs * np.array(shape.size))[None]
    elif shape.kind == "sphere":
        local = -shape.size[0] * own[:, None]
    elif shape.kind == "capsule":
        ends = np.array([[0.0, 0.0, -0.5], [0.0, 0.0, 0.5]]) * shape.size[1]
        local = ends[None] - shape.size[0] * own[:, None]
    else:
        angle = np.arctan2(-own[:, 1], -own[:, 0])[:, None] + 2.0 * np.pi * np.arange(AROUND) / AROUND
        rim = shape.size[0] * np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=2)
        local = np.concatenate([rim + np.array([0.0, 0.0, half * shape.size[1]]) for half in (-0.5, 0.5)], axis=1)
    found: Floats = rotate(pose[3:], local) + pose[:3]
    return found


def _over_faces(mesh: Triangles, faces: Rows, points: Floats, rounded: float, reach: float, deepest: float) -> Near:
    """Points (m, p, 3), or (1, p, 3) for all faces, that are over their face, and no deeper under it."""
    corners, normals = mesh.corners[faces], mesh.normals[faces]
    along = points[0] @ normals.T if len(points) == 1 else np.einsum("mpi,mi->pm", points, normals)
    height = (along - np.einsum("mi,mi->m", corners[:, 0], normals)).T
    face, point = np.nonzero((height < reach) & (height > -deepest))
    at = points[face if len(points) > 1 else 0, point]
    shares = _shares(corners[face], normals[face], at)  # of the few that are near their face's plane
    over = shares.min(axis=1) > -OUTSIDE
    face, shares, gap, at = face[over], shares[over], height[face, point][over], at[over]
    fronted = ~_behind(corners, normals, face, at, gap)
    face, shares, gap, at = face[fronted], shares[fronted], gap[fronted], at[fronted]
    normal = normals[face]
    at = at - 0.5 * gap[:, None] * normal
    if mesh.smooth is not None:
        curved = np.einsum("nk,nki->ni", shares, mesh.smooth[faces][face])
        curved /= np.maximum(np.linalg.norm(curved, axis=1, keepdims=True), 1e-12)
        at, normal = at + rounded * (normal - curved), curved  # what is round touches where its side has the normal
    return Near(at, normal, gap)


def _lifted(corners: Floats, normals: Floats, own: Floats, at: Floats) -> tuple[Floats, Floats]:
    """Points of curved triangles over points of flat ones, and their normals, (n, 3) each.

    A point is lifted half of the way to the tangent planes at the corners (Boubekeur and Alexa 2008). Its normal is
    that of the surface so made: those of the corners, interpolated, are so only where these lean evenly from the face.

    Args:
        corners: Of the triangles, (n, 3, 3), and their
        normals: (n, 3).
        own: Normals at the corners, (n, 3, 3).
        at: Points in their planes, (n, 3).
    """
    shares = _shares(corners, normals, at)[..., None]
    upright = np.maximum(np.einsum("nki,ni->nk", own, normals), STEEPEST)
    slopes = -own / upright[..., None]
    lifts = 0.5 * np.einsum("nki,nki->nk", at[:, None] - corners, slopes)[..., None]
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = np.einsum("ni,ni->n", cross(one, two), normals)[:, None]
    second, third = cross(two, normals) / area, cross(normals, one) / area  # by which shares grow, along each axis
    rise = np.sum(np.stack([-second - third, second, third], axis=1) * lifts + 0.5 * shares * slopes, axis=1)
    rise -= np.einsum("ni,ni->n", rise, normals)[:, None] * normals
    up = normals - rise
    return at + np.sum(shares * lifts, axis=1) * normals, up / lengths(up)[:, None]


def _over_curves(mesh: Triangles, faces: Rows, centre: Floats, radius: float, reach: float) -> Near:
    """Where a ball touches triangles that stand for what is curved, of the second order.

    A ball that is large beside a rod is over none of its sides, and over an edge it is up to a side's sagitta off.
    """
    assert mesh.smooth is not None
    corners, normals, own = mesh.corners[faces], mesh.normals[faces], mesh.smooth[faces]
    ways = np.stack([corners[:, 1] - corners[:, 0], np.zeros_like(normals)], axis=1)
    ways[:, 0] /= np.maximum(lengths(ways[:, 0]), 1e-300)[:, None]
    ways[:, 1] = cross(normals, ways[:, 0])
    changes = np.stack(
        [np.einsum("nk,nki->ni", _shares(corners, normals, corners[:, 0] + way) - (1.0, 0.0, 0.0), own)
         for way in (ways[:, 0], ways[:, 1])], axis=1,
    )  # fmt: skip
    bend = np.einsum("nai,nbi->nab", ways, changes)
    bend = 0.5 * (bend + np.swapaxes(bend, 1, 2))
    height = np.einsum("ni,ni->n", centre - corners[:, 0], normals)
    bend[np.trace(bend, axis1=1, axis2=2) <= 0.0] = 0.0  # into a hollow the foot goes all of what is missed
    some = height > 0.0
    corners, normals, own, ways, bend = (array[some] for array in (corners, normals, own, ways, bend))
    foot = at = centre - height[some, None] * normals
    up = normals
    for _ in range(FOOT_STEPS):
        foot, up = _lifted(corners, normals, own, at)
        miss = centre - foot
        above = np.einsum("ni,ni->n", miss, up)
        aside = np.einsum("nai,ni->na", ways, miss - above[:, None] * up)
        part = np.eye(2) + np.maximum(above, 0.0)[:, None, None] * bend
        part[np.linalg.det(part) < 0.1] = np.eye(2)  # what is hollow along one way, as deep as it is wide
        at = at + np.einsum("na,nai->ni", np.linalg.solve(part, aside[..., None])[..., 0], ways)
    shares = _shares(corners, normals, at)
    gap = np.einsum("ni,ni->n", centre - foot, up) - radius
    over = (shares.min(axis=1) > -OUTSIDE_CURVED) & (gap < reach) & (gap > -DEEPEST * radius)
    return Near(foot[over] + 0.5 * gap[over, None] * up[over], up[over], gap[over])


def _behind(corners: Floats, normals: Floats, face: Rows, points: Floats, gap: Floats) -> NDArray[np.bool_]:
    """Which points (n, 3) under a face are on the other side of the mesh there: nearer to a face that looks away, (n,).

    What lies on a thin slab is no deeper in it than that, and its underside does not draw it down.

    Args:
        corners: Of faces, (m, 3, 3), and their
        normals: (m, 3).
        face: Of each point the one that it is over, (n,).
        points: (n, 3).
        gap: Height of each over its face, (n,) [m].
    """
    found = np.zeros(len(face), dtype=bool)
    under = np.flatnonzero(gap < 0.0)
    which, other = np.nonzero(normals[face[under]] @ normals.T < 0.0)
    which = under[which]
    height = np.einsum("ni,ni->n", points[which] - corners[other, 0], normals[other])
    nearer = np.abs(height) < -gap[which]
    which, other = which[nearer], other[nearer]
    shares = _shares(corners[other], normals[other], points[which])
    found[which[shares.min(axis=1) > -OUTSIDE]] = True
    return found


def _shares(corners: Floats, normals: Floats, points: Floats) -> Floats:
    """Barycentric coordinates of points (n, 3), each over its triangle (n, 3, 3), (n, 3)."""
    one, two, from_first = (end - corners[:, 0] for end in (corners[:, 1], corners[:, 2], points))
    area, second, third = (
        np.einsum("ni,ni->n", cross(a, b), normals) for a, b in ((one, two), (from_first, two), (one, from_first))
    )
    second, third = second / area, third / area
    return np.stack([1.0 - second - third, second, third], axis=1)


def _edges_in(mesh: Triangles, faces: Rows, depth: Depth, pose: Floats, radius: float, reach: float) -> Near:
    """Points of edges that stick out, as near a shape's sides as `reach`."""
    edges = mesh.edges_of(faces)
    start, way = mesh.vertices[edges[:, 0]], mesh.vertices[edges[:, 1]] - mesh.vertices[edges[:, 0]]
    # Only the part within the ball about the shape.
    length2 = np.maximum(np.einsum("ei,ei->e", way, way), 1e-300)
    middle = np.einsum("ei,ei->e", pose[:3] - start, way) / length2
    aside2 = np.sum((start + middle[:, None] * way - pose[:3]) ** 2, axis=1)
    half = np.sqrt(np.maximum((radius + reach) ** 2 - aside2, 0.0) / length2)
    first, last = np.clip(middle - half, 0.0, 1.0), np.clip(middle + half, 0.0, 1.0)
    near = (half > 0.0) & (last >= first)
    shares = first[near, None] + (last - first)[near, None] * np.linspace(0.0, 1.0, ALONG)
    points = (start[near, None] + shares[..., None] * way[near, None]).reshape(-1, 3)
    return _pressed(points, depth, pose, reach, radius)


def _corners_on(mesh: Triangles, depth: Depth, pose: Floats, reach: float) -> Near:
    return _thinned(_pressed(mesh.vertices, depth, pose, reach, np.inf))


def _pressed(points: Floats, depth: Depth, pose: Floats, reach: float, deepest: float) -> Near:
    """Points of a mesh that are in a shape, or nearly, pressed on along its nearest side."""
    local = rotate(conjugate(pose[3:]), points - pose[:3])
    inside = depth(local)
    near = (inside > -reach) & (inside < DEEPEST * deepest)
    local, inside = local[near], inside[near]
    step = 1e-6
    slope = np.stack([depth(local + step * axis) - depth(local - step * axis) for axis in np.eye(3)], axis=1)
    length = np.linalg.norm(slope, axis=1)
    sure = length > step  # of a point that is as near to two sides nothing is known
    normal = rotate(pose[3:], slope[sure] / length[sure, None])
    return Near(points[near][sure] + 0.5 * inside[sure, None] * -normal, normal, -inside[sure])


def _thinned(near: Near, *, lines: bool = False) -> Near:
    """Contacts with about one normal, of which the outermost carry whatever all of them do.

    Where they are of `lines`, of those that touch, and of those that are apart: a body that leans on an edge has the
    corners of its side apart. Where it turns on it, what touches slips each its own way, and rubs otherwise than the
    outermost: some of it stays. A mesh's corners over a plane touch one by one.
    """
    if len(near.gap) <= MANY:
        return near
    tenths = np.rint(10.0 * near.normal).astype(np.intp) + 10  # 0 to 20
    group = np.unique(tenths @ [441, 21, 1] + 9261 * (lines & (near.gap <= NEAR)), return_inverse=True)[1]
    order = np.argsort(group, kind="stable")
    group, point = group[order], near.point[order]
    first = np.flatnonzero(np.diff(group, prepend=-1))
    counts = np.diff(first, append=len(group))[:, None]
    normal = (np.add.reduceat(near.normal[order], first) / counts)[group]
    along = point @ WAYS.T - np.einsum("ni,ni->n", point, normal)[:, None] * (normal @ WAYS.T)
    row, way = np.nonzero(along == np.maximum.reduceat(along, first)[group])
    outermost = np.unique(group[row] * len(WAYS) + way, return_index=True)[1]
    touch = np.flatnonzero(lines & (near.gap <= NEAR))
    kept = [int(np.argmin(near.gap)), *order[row[outermost]], *touch[:: -(-len(touch) // SOME) or 1]]
    chosen = np.unique(kept)
    return Near(near.point[chosen], near.normal[chosen], near.gap[chosen])
