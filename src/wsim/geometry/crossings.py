"""Where lines along an axis cross triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

ON_EDGE = 1e-9  # of a triangle's area: its edges belong to it, or a line could slip between two that share one
FLAT = 1e-12  # of a triangle's area: seen from its edge, it is not crossed


def crossings(
    triangles: Floats, axis: int, low: Floats, edge: float, count: tuple[int, int, int]
) -> tuple[Floats, ...]:
    """Where the lines through the centres of a grid's cells along an axis cross triangles.

    Args:
        triangles: Corners (F, 3, 3) [m].
        axis: Of the lines.
        low: Lower corner of the grid (3,) [m].
        edge: Of a cell [m].
        count: Cells along each axis.

    Returns:
        Of each crossing: the line, as cells along the two other axes in their order, (K, 2) integers; where it is along
        the axis, (K,) [m]; and 1 where the triangle faces along the axis, -1 against it, (K,).
    """
    sides = [k for k in range(3) if k != axis]
    flat = (triangles[:, :, sides] - low[sides]) / edge - 0.5  # in cells: lines are at whole numbers
    first = np.maximum(np.ceil(flat.min(axis=1) - ON_EDGE), 0).astype(np.int64)
    last = np.minimum(np.floor(flat.max(axis=1) + ON_EDGE), np.array(count)[sides] - 1).astype(np.int64)
    wide = np.maximum(last - first + 1, 0)
    area = _cross(flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0])
    many = np.where(np.abs(area) > FLAT, wide[:, 0] * wide[:, 1], 0)
    which = np.repeat(np.arange(len(flat)), many)
    rank = np.arange(len(which)) - np.repeat(np.cumsum(many) - many, many)
    lines = first[which] + np.stack([rank // wide[which, 1], rank % wide[which, 1]], axis=1)
    a, b, c = (flat[which, k] for k in range(3))
    weight = np.stack(
        [_cross(b - lines, c - lines), _cross(c - lines, a - lines), _cross(a - lines, b - lines)], axis=1
    )
    weight /= area[which, None]
    met = (weight > -ON_EDGE).all(axis=1)
    lines, weight, which = lines[met], weight[met], which[met]
    place = (weight * triangles[which][:, :, axis]).sum(axis=1)
    towards = np.sign(area[which]) * (-1.0 if axis == 1 else 1.0)  # (x, z) is left-handed seen along y
    return lines, place, towards


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
