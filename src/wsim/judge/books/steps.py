"""What an engine's own time step leaves of momentum, where it steps joints' positions and not bodies' places.

A step of first order takes q' by M(q)^-1 and moves q after: the momentum A(q) q' of what hangs together is then off by
dt^2 (2 A'(q', q'') + A'' q' / 2), which of a body that turns at w, its mass at l from its joint, is m l dt (2 w w' +
w^3 dt / 2) a step. Nothing pushes, and no force of the world explains it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]


def step_error(evidence: Evidence, size: Floats) -> Floats:
    """How much of each body's force over its mass may be due to steps, (T - 1, B) [m/s^2].

    Args:
        evidence: What was recorded.
        size: How far from its centre of mass each body reaches or is held, (B,) [m].
    """
    motion, found = evidence.motion, np.zeros((len(evidence.motion.h), len(evidence.motion.mass)))
    if evidence.world.stepped != "joints":
        return found
    rate, change = np.linalg.norm(motion.w, axis=2), np.linalg.norm(np.diff(motion.w, axis=0), axis=2)
    fastest, h = np.maximum(rate[1:], rate[:-1]), motion.h[:, None]
    dt = np.minimum(motion.dt, h)
    off = size * (2.0 * fastest * change * dt / h + 0.5 * fastest**3 * dt)
    for unit in np.unique(motion.unit):
        rows = np.flatnonzero(motion.unit == unit)
        if motion.jointed[rows].any():  # it ends in any of the bodies, the more the heavier they are
            total = off[:, rows] @ motion.mass[rows]
            found[:, rows] = total[:, None] * motion.mass[rows] / np.sum(motion.mass[rows] ** 2)
    return found
