"""Rotations: quaternions xyzw, matrices that turn column vectors, the axes of a camera."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]


def rotate(q: Floats, v: Floats) -> Floats:
    """Vectors (..., 3) turned by quaternions (..., 4); shapes broadcast."""
    axis, w = q[..., :3], q[..., 3:4]
    t = 2.0 * cross(axis, v)
    turned: Floats = v + w * t + cross(axis, t)
    return turned


def cross(a: Floats, b: Floats) -> Floats:
    """Cross products (..., 3); for short arrays several times as fast as NumPy's own."""
    ax, ay, az = a[..., 0], a[..., 1], a[..., 2]
    bx, by, bz = b[..., 0], b[..., 1], b[..., 2]
    x = ay * bz - az * by
    found = np.empty((*x.shape, 3))
    found[..., 0], found[..., 1], found[..., 2] = x, az * bx - ax * bz, ax * by - ay * bx
    return found


def lengths(v: Floats) -> Floats:
    """Of vectors (..., n); for short ones several times as fast as NumPy's norm."""
    return np.asarray(np.sqrt(np.einsum("...i,...i->...", v, v)))


def conjugate(q: Floats) -> Floats:
    """The inverse of unit quaternions (..., 4)."""
    return q * np.array([-1.0, -1.0, -1.0, 1.0])


def multiply(a: Floats, b: Floats) -> Floats:
    """Hamilton products (..., 4) of quaternions: first b, then a."""
    va, wa, vb, wb = a[..., :3], a[..., 3:4], b[..., :3], b[..., 3:4]
    vector = wa * vb + wb * va + cross(va, vb)
    scalar = wa * wb - np.sum(va * vb, axis=-1, keepdims=True)
    return np.concatenate([vector, scalar], axis=-1)


def matrices(q: Floats) -> Floats:
    """Unit quaternions (..., 4) as rotation matrices (..., 3, 3)."""
    x, y, z, w = (q[..., k] for k in range(4))
    found = np.empty((*x.shape, 3, 3))
    for k, row in enumerate((
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )):  # fmt: skip
        found[..., k, 0], found[..., k, 1], found[..., k, 2] = row
    return found


UP = np.array([0.0, 0.0, 1.0])


def upwards(gravity: ArrayLike) -> Floats:
    """The unit vector against gravity (3,); +Z where there is none."""
    pull = np.asarray(gravity, dtype=np.float64)
    strength = float(np.linalg.norm(pull))
    return -pull / strength if strength > 0.0 else UP.copy()


def level(vectors: Floats, up: Floats) -> Floats:
    """What vectors (..., 3) have across a unit vector (3,)."""
    along: Floats = vectors - (vectors @ up)[..., None] * up
    return along


def sides_of(up: Floats) -> Floats:
    """Two level unit vectors (2, 3), square to each other: X and Y where Z is up, else turned with it the shortest way.

    Upside down, X and -Y.
    """
    if up[2] < -1.0 + 1e-12:
        return np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
    q = np.array([-up[1], up[0], 0.0, 1.0 + up[2]])  # (Z x up, 1 + Z . up), of the half angle
    return rotate(q / np.linalg.norm(q), np.eye(3)[:2])


def mean_rotation(q: Floats) -> Floats:
    """The mean (4,) of rotations (T, 4): the eigenvector of the summed outer products (Markley et al. 2007)."""
    _, vectors = np.linalg.eigh(q.T @ q)
    return np.asarray(vectors[:, -1], dtype=np.float64)


def tilt(q: Floats, up: Floats = UP) -> Floats:
    """The angle between what pointed up at the first of rotations (T, 4) and up, (T,) [deg]."""
    own = rotate(conjugate(q[0]), up)
    cosine = rotate(q, np.broadcast_to(own, (len(q), 3))) @ up
    return np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))


def line_of_sight(eye: ArrayLike, target: ArrayLike, up: ArrayLike) -> tuple[Floats, Floats]:
    """The unit vectors to the right and forward (3,) of who looks from `eye` to `target`, head up.

    Who looks along `up` has any right that there is; who looks at its own place looks along +X.
    """
    forward = _unit(np.subtract(target, eye))
    right = np.cross(forward, np.asarray(up))
    if np.linalg.norm(right) < 1e-6:
        right = np.cross(forward, (0.0, 1.0, 0.0) if abs(forward[1]) < 0.9 else (1.0, 0.0, 0.0))
    return _unit(right), forward


def _unit(vector: Floats) -> Floats:
    length = float(np.linalg.norm(vector))
    return vector / length if length > 0.0 else np.array([1.0, 0.0, 0.0])
