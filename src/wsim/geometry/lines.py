"""Lines through shapes: from where to where along them they are inside, and where they last leave."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Span = tuple[Floats, Floats]  # where lines come in and go out, by their distance from the start, (N,) each [m]

_PARALLEL = 1e-9  # of a unit way: less is the rounding of a rotation
_EDGE = 1e-9  # of a triangle: what meets the edge of two meets one of them at least


def between(start: Floats, way: float, half: float) -> Span:
    """Between two planes, at -half and half of the one coordinate that is given of starts (N,) and way."""
    if abs(way) < _PARALLEL:
        return _always(np.abs(start) <= half)
    middle, reach = -start / way, half / abs(way)
    return middle - reach, middle + reach


def within(start: Floats, way: Floats, radius: float) -> Span:
    """No further than a radius from the origin of k coordinates, starts (N, k) and way (k,): a ball or a round wall."""
    along, across = start @ way, np.sum(start * start, axis=1) - radius * radius
    squared = float(way @ way)
    if squared < _PARALLEL**2:
        return _always(across <= 0.0)
    under = along * along - squared * across
    reach = np.where(under >= 0.0, np.sqrt(np.maximum(under, 0.0)), -np.inf) / squared
    return -along / squared - reach, -along / squared + reach


def _always(inside: NDArray[np.bool_]) -> Span:
    return np.where(inside, -np.inf, np.inf), np.where(inside, np.inf, -np.inf)


def leaves(*spans: Span) -> Floats:
    """Where lines leave what all of the spans share, (N,) [m]; -inf where they share nothing."""
    enter, leave = np.max([low for low, _ in spans], axis=0), np.min([high for _, high in spans], axis=0)
    return np.where(enter <= leave, leave, -np.inf)


def leaves_triangles(start: Floats, way: Floats, corners: Floats) -> Floats:
    """Where lines from starts (N, 3) along a unit way (3,) last meet triangles (F, 3, 3), (N,) [m]; -inf where none.

    All lines go one way, so the triangles are looked at along it, where each is a flat one: what is left is which of
    them hold a point, and how far along the way they are there, both by its barycentric coordinates.
    """
    across = _across(way)
    places, flat, depth = start @ across.T, corners @ across.T, corners @ way
    b, c = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
    area = _cross(b, c)
    seen = np.abs(area) > _PARALLEL * np.sum(b * b + c * c, axis=1)  # those on edge are met at their neighbours
    flat, depth, b, c, area = flat[seen], depth[seen], b[seen], c[seen], area[seen]
    low, high = flat.min(axis=1), flat.max(axis=1)
    room = _EDGE * (high - low).max(axis=1, keepdims=True)
    low, high = low - room, high + room
    last = np.full(len(start), -np.inf)
    for n, place in enumerate(places):  # a mesh may have more triangles than fit into memory once for each line
        near = np.flatnonzero(np.all((low <= place) & (place <= high), axis=1))
        to = place - flat[near, 0]
        second, third = _cross(to, c[near]) / area[near], _cross(b[near], to) / area[near]
        met = (second >= -_EDGE) & (third >= -_EDGE) & (second + third <= 1.0 + _EDGE)
        at, second, third = depth[near[met]], second[met], third[met]
        last[n] = np.max((1.0 - second - third) * at[:, 0] + second * at[:, 1] + third * at[:, 2], initial=-np.inf)
    return last - start @ way


def _across(way: Floats) -> Floats:
    """Two unit vectors (2, 3) at right angles to a unit one (3,), and to each other."""
    other = np.eye(3)[np.argmin(np.abs(way))]
    first = np.cross(way, other)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(way, first)])


def _cross(a: Floats, b: Floats) -> Floats:
    """Cross products of vectors in a plane, (..., 2)."""
    product: Floats = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return product
