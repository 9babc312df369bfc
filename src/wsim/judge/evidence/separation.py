"""How far shapes are apart at least: what a plane between them proves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, matrices, rotate

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.placed import Placed

    Floats = NDArray[np.float64]


def separation(a: Placed, b: Placed, frames: NDArray[np.intp]) -> Floats:
    """The least distance between two shapes' convex hulls at some frames, (n,) [m]; negative where they may overlap.

    Never more than the true distance: the widest gap between them along their own axes, the line of their centres and
    the normals of pairs of edges (the separating axis theorem: Ericson, Real-Time Collision Detection, 2005, ch. 5.2).
    """
    if a.shape.kind == "plane":
        if b.shape.kind == "plane":
            return np.full(len(frames), -np.inf)
        a, b = b, a
    own, other = matrices(a.rotation[frames]), matrices(b.rotation[frames])
    apart = a.position[frames] - b.position[frames]
    if b.shape.kind == "plane":
        normal = other[:, None, :, 2]
        low, _ = _extent(a, frames, normal)
        return np.asarray((np.einsum("ni,nki->nk", apart, normal) + low)[:, 0])
    sides = np.concatenate([np.moveaxis(own, 1, 2), np.moveaxis(other, 1, 2)], axis=1)
    edges = np.cross(sides[:, :3, None], sides[:, None, 3:]).reshape(len(frames), 9, 3)
    axes = np.concatenate([sides, edges, apart[:, None]], axis=1)
    length = np.linalg.norm(axes, axis=2, keepdims=True)
    axes = np.where(length > 1e-9, axes / np.maximum(length, 1e-9), [0.0, 0.0, 1.0])
    along = np.einsum("ni,nki->nk", apart, axes)
    (low_a, high_a), (low_b, high_b) = _extent(a, frames, axes), _extent(b, frames, axes)
    gap: Floats = np.maximum(along + low_a - high_b, low_b - along - high_a).max(axis=1)
    return gap


def _extent(placed: Placed, frames: NDArray[np.intp], axes: Floats) -> tuple[Floats, Floats]:
    """How far a shape reaches from its own place along unit axes (n, A, 3), backwards and forwards, (n, A) each [m]."""
    return placed.at(frames).ends(rotate(conjugate(placed.rotation[frames])[:, None], axes))
