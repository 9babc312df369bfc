"""Rocks: convex lumps of many faces, each another, of one seed the same. NumPy alone."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_JITTER = 0.16  # of an edge of the sphere's net, that a corner is moved by
FLATTEST = 0.6  # of its length, a rock's height or width at least
STANDS = 0.3  # [m] about its middle, within which a thing of the catalogue goes down to the lowest ground


@cache
def _net() -> tuple[Floats, Integers]:
    """A sphere of 80 triangles, an icosahedron whose edges are cut in two: corners (42, 3) and faces."""
    golden = 0.5 * (1.0 + 5.0**0.5)
    corners = [(s, t * golden, 0.0) for s in (-1.0, 1.0) for t in (-1.0, 1.0)]
    points = [np.roll(corner, k) for k in range(3) for corner in corners]
    points = [each / np.linalg.norm(each) for each in points]
    edge = min(float(np.linalg.norm(points[0] - each)) for each in points[1:]) * 1.01
    near = [[k for k, b in enumerate(points) if 0 < np.linalg.norm(a - b) < edge] for a in points]
    faces = [(i, j, k) for i in range(12) for j in near[i] if j > i for k in near[j] if k > j and k in near[i]]
    middle: dict[tuple[int, int], int] = {}
    for i, j, k in faces:
        for a, b in ((i, j), (j, k), (i, k)):
            if (a, b) not in middle:
                middle[a, b] = len(points)
                point = points[a] + points[b]
                points.append(point / np.linalg.norm(point))
    cut = []
    for i, j, k in faces:
        ij, jk, ik = middle[i, j], middle[j, k], middle[i, k]
        cut += [(i, ij, ik), (j, jk, ij), (k, ik, jk), (ij, jk, ik)]
    at, net = np.array(points), np.array(cut, dtype=np.int64)
    p, q, r = at[net[:, 0]], at[net[:, 1]], at[net[:, 2]]
    inward = np.einsum("fi,fi->f", np.cross(q - p, r - p), p + q + r) < 0.0
    net[inward] = net[inward][:, ::-1]
    return at, net


def rock(length: float, random: np.random.Generator) -> tuple[Floats, Integers]:
    """A rock that is `length` long [m] about its middle: corners (42, 3) [m], faces (80, 3), outward.

    Its corners lie on an ellipsoid, so that it is convex but for what the moved corners leave, 1 % of its size.
    """
    points, faces = _net()
    moved = points + _JITTER * random.uniform(-1.0, 1.0, points.shape)
    moved /= np.linalg.norm(moved, axis=1, keepdims=True)
    axes = np.array([1.0, *random.uniform(FLATTEST, 1.0, 2)])
    return 0.5 * length * axes * moved, faces
