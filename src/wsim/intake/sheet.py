"""What is open has no inside: as a sheet with a thickness it has one, and what it held it still holds."""

from __future__ import annotations

import numpy as np

from wsim.intake.model import Array, Faces, Mesh
from wsim.intake.shells import edges_of

THICKNESS = 0.02  # of its longest edge


def thickened(mesh: Mesh, thickness: float) -> Mesh:
    """A closed mesh about an open one: its faces half a thickness [m] to either side, and a rim where it ends.

    The corners go along the mean of their faces' normals, weighted by area. Where it is bent more sharply than it is
    thick it goes through itself, which does no harm to what is taken apart.
    """
    along = _normals(mesh.points, mesh.faces) * thickness / 2.0
    count = len(mesh.points)
    number, _ = edges_of(mesh.faces)
    edges = mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    start, end = edges[np.bincount(number)[number] == 1].T
    rim = np.concatenate([np.c_[end, start, start + count], np.c_[end, start + count, end + count]])
    points = np.concatenate([mesh.points + along, mesh.points - along])
    return Mesh(mesh.name, points, np.concatenate([mesh.faces, mesh.faces[:, ::-1] + count, rim]), mesh.color)


def _normals(points: Array, faces: Faces) -> Array:
    """Of each corner, (V, 3), of length 1; 0 where its faces cancel out."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    normals = np.zeros_like(points)
    np.add.at(normals, faces, np.cross(b - a, c - a)[:, None, :])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.divide(normals, length, out=np.zeros_like(normals), where=length > 0.0)
