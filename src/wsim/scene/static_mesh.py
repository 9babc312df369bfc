"""Write a static mesh whose triangles collide as they are, and curve as their normals say."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from pxr import Usd, UsdGeom, UsdPhysics, Vt

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


def define_mesh(
    stage: Usd.Stage, path: str, points: Floats, faces: list[Integers], normals: Floats | None
) -> UsdGeom.Mesh:
    """Author a mesh.

    Args:
        stage: Where.
        path: Of the prim.
        points: (V, 3) [m].
        faces: Groups of faces with as many corners, (F, corners) each.
        normals: Of all corners in turn, (sum of corners, 3); None: flat.
    """
    mesh = UsdGeom.Mesh.Define(stage, path)
    counts = np.concatenate([np.full(len(group), group.shape[1]) for group in faces])
    indices = np.concatenate([group.reshape(-1) for group in faces])
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points.astype(np.float32)))
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(counts.astype(np.int32)))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(indices.astype(np.int32)))
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    if normals is not None:
        mesh.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(normals.astype(np.float32)))
        mesh.SetNormalsInterpolation(UsdGeom.Tokens.faceVarying)
    UsdPhysics.MeshCollisionAPI.Apply(mesh.GetPrim()).CreateApproximationAttr(UsdPhysics.Tokens.none)
    return mesh


def smooth_normals(points: Floats, triangles: Integers, most: float) -> Floats:
    """Normals at triangles' corners, (F, 3, 3): the mean, by angle, over faces there that differ by less than `most`.

    Args:
        points: (V, 3), no two in one place.
        triangles: (F, 3).
        most: Kink up to which faces stand for a curve [rad].
    """
    corners = points[triangles]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    flat /= np.maximum(np.linalg.norm(flat, axis=1, keepdims=True), 1e-300)
    a, b = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    cosine = np.einsum("fki,fki->fk", a, b) / np.maximum(np.linalg.norm(a, axis=2) * np.linalg.norm(b, axis=2), 1e-300)
    angle = np.arccos(np.clip(cosine, -1.0, 1.0)).reshape(-1)
    at = triangles.reshape(-1)
    order = np.argsort(at, kind="stable")
    first = np.searchsorted(at[order], np.arange(len(points) + 1))
    sizes = np.diff(first)
    # Every pair of corners that meet at one point.
    mine = np.repeat(np.arange(len(order)), sizes[at[order]])
    start = np.repeat(first[at[order]], sizes[at[order]])
    theirs = start + np.arange(len(mine)) - np.repeat(np.cumsum(sizes[at[order]]) - sizes[at[order]], sizes[at[order]])
    i, j = order[mine], order[theirs]
    near = np.einsum("ni,ni->n", flat[i // 3], flat[j // 3]) >= math.cos(most)
    total = np.zeros((len(at), 3))
    np.add.at(total, i[near], angle[j[near], None] * flat[j[near] // 3])
    total /= np.linalg.norm(total, axis=1, keepdims=True)
    return total.reshape(-1, 3, 3)
