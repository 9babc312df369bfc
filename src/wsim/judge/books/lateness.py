"""How long an engine's steps may be where it does not say: by how far places go while velocities change.

In an interval h in which velocities change by dv and accelerations by da places go by the mean of both ends'
velocities, less h^2 da / 12. Steps dt of first order, v += a dt, z += v dt, take them dv dt / 2 farther, or less far;
of second order by a share of h^2 da / 12 that goes by (dt / h)^2: 2 of it less for a leapfrog's, 1 more for a
trapezoid's. Forces are taken as late as places, and as coarsely.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books.differences import by_differences
from wsim.judge.evidence.motion import FLOAT32

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]

SURE = 0.05  # what half of all values may differ by from the middle one, at most
FEW = 8  # values that tell it


def steps_at_most(evidence: Evidence) -> tuple[Floats, Floats]:
    """How long steps may be for each body's mechanism, as its motion tells, (B,) each.

    Blows are in some intervals, and tell nothing: the middle of all values counts, and by how much half of them differ
    from it. Where too little moves, or these differ by much, and where velocities are those of poses, steps may be as
    long as the time between frames.

    Returns:
        What a step of first order is at most, as recorded or as told [s]; and the share of what the trapezoidal rule
        leaves of an interval that steps of second order may leave, too.
    """
    motion = evidence.motion
    first, second = np.full(len(motion.mass), motion.dt), np.ones(len(motion.mass))
    if by_differences(evidence) or len(motion.h) < 2:
        return first, second
    v, h = motion.v, motion.h[:, None, None]
    late = 0.5 * h * np.diff(v, axis=0)  # of steps as long as intervals
    bend = h**2 / 12.0 * np.diff(np.gradient(v, evidence.time, axis=0), axis=0)
    off = np.diff(motion.com, axis=0) - 0.5 * (v[1:] + v[:-1]) * h + bend
    rounding = FLOAT32 * np.abs(motion.com).max(axis=(0, 2), initial=0.0)
    for unit in np.unique(motion.unit[~motion.kinematic]):
        rows = (motion.unit == unit) & ~motion.kinematic
        least, strays = rounding[rows] / SURE, off[:, rows]
        share = _middle(strays, late[:, rows], least)
        if share is None:
            continue
        if not motion.step:
            first[rows] = min(abs(share[0]) + share[1], 1.0) * motion.dt
        coarse = _middle(strays - share[0] * late[:, rows], bend[:, rows], least)
        if coarse is not None:
            second[rows] = min(abs(coarse[0]) + coarse[1], 1.0)
    return first, second


def _middle(off: Floats, unit: Floats, least: Floats) -> tuple[float, float] | None:
    """What share of `unit` places are off by, (N, B, 3) each, and how much half of all that tell it differ from that.

    None where few are as large as `least`, (B,), or they differ by much.
    """
    size = np.sum(unit**2, axis=2)
    told = size > np.maximum(least**2, 1e-300)
    shares = np.einsum("tbi,tbi->tb", off, unit)[told] / size[told]
    if len(shares) < FEW:
        return None
    middle = float(np.median(shares))
    differ = float(np.median(np.abs(shares - middle)))
    return (middle, differ) if differ < SURE else None
