"""Principal moments and axes of an inertia: the same on every machine, also where a symmetric body has many."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from pxr import Gf

Array = NDArray[np.float64]

_SAME = 1e-6  # of the largest moment: two that differ by less are one, and any axes between theirs would do
_DIGITS = 7  # of a quaternion, as many as USD keeps; what rounding leaves below differs between processors


def principal(inertia: Array, diagonal: float = _SAME) -> tuple[Array, Gf.Quatf]:
    """Principal moments (3,) [kg m^2], and the rotation from their axes to the body's.

    An eigensolver picks the axes of equal moments by rounding, which differs between processors; here they lie as
    near to the body's own as they can.

    Args:
        inertia: Of a body about its centre of mass, (3, 3) [kg m^2].
        diagonal: As share of the trace, what may stand beside the diagonal and count as nothing.
    """
    off = np.abs(inertia - np.diag(np.diag(inertia))).max()
    if off <= diagonal * np.trace(inertia):
        return np.diag(inertia).copy(), Gf.Quatf(1.0)
    moments, vectors = np.linalg.eigh(inertia)
    axes = np.column_stack([_upright(vectors[:, group]) for group in _groups(moments)])
    axes[:, 2] *= np.sign(np.linalg.det(axes))
    turn = Gf.Matrix3d(*axes.T.reshape(-1).tolist()).ExtractRotation().GetQuat()  # rows, as USD turns rows
    parts = np.round([turn.GetReal(), *turn.GetImaginary()], _DIGITS)
    parts *= np.sign(parts[np.flatnonzero(parts)[0]])  # of the two quaternions of a turn always the same one
    return moments, Gf.Quatf(*(parts + 0.0).tolist()).GetNormalized()


def _groups(moments: Array) -> list[slice]:
    """Runs of equal moments, which come in ascending order."""
    ends = [k for k in (1, 2) if moments[k] - moments[k - 1] > _SAME * moments[2]]
    return [slice(a, b) for a, b in zip([0, *ends], [*ends, 3], strict=True)]


def _upright(vectors: Array) -> Array:
    """A basis (3, n) of what `vectors` (3, n) span: each axis the part of a coordinate axis, of the nearest first."""
    rest, found = vectors @ vectors.T, np.zeros((3, 0))
    for _ in range(vectors.shape[1]):
        lengths = np.round(np.diag(rest), 9)  # squared, of each coordinate axis's part; of equal ones the first
        axis = rest[:, lengths.argmax()]
        axis = axis / np.linalg.norm(axis)
        found = np.column_stack([found, axis])
        rest = rest - np.outer(axis, axis)
    return found
