"""What sums over steps miss of an effort that changes within them, as a drive's damper does that takes a speed fast.

What a joint gives over a step of Runge and Kutta's is recorded as the mean of both its ends. Of an effort F(t) the sum
of these misses dt^2 / 12 of what dF/dt differs by at both ends of an interval (Euler and Maclaurin). By the drive's
law dF/dt = -k q' - c q'', and q'' is its mobility times F, beside what others give, which is slower: a damper that
takes a share x of a speed in a step, x <= 0.5, misses x^2 / 12 of what it gives.

A unit effort gives bodies accelerations a of which the sum of m a^2 and of their turning is the joint's mobility
(`wsim.judge.books.mobility`): none has more than all of that.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books.mobility import mobilities

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.books.laws import Laws
    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]


FASTEST = 0.5  # of a step: a damper's greatest c dt / m for which the sums' error is known


def sampled(evidence: Evidence, laws: Laws) -> Floats:
    """What the sums of joints' forces and torques may miss, over the mass and over m R, (T - 1, B, 2) [m/s^2]."""
    motion = evidence.motion
    found = np.zeros((len(motion.h), len(motion.mass), 2))
    driven = [joint for joint in evidence.world.joints if joint.drive is not None and laws.joints[joint.prim]]
    if not driven or not motion.step:
        return found
    loose, size = mobilities(evidence), np.maximum(motion.radius, 1e-9)
    heaviest = np.linalg.eigvalsh(motion.inertia)[:, -1]
    share = np.stack([1.0 / np.sqrt(motion.mass), np.sqrt(heaviest) / (motion.mass * size)], axis=1)
    for joint in driven:
        drive, mobility = joint.drive, loose.get(joint.prim, 0.0)
        assert drive is not None
        effort = np.abs(laws.effort(joint))
        changes = drive.stiffness * np.abs(np.diff(laws.rate(joint)))
        changes += min(drive.damping * mobility, FASTEST / motion.step) * (effort[1:] + effort[:-1])
        missed = np.minimum(motion.step, motion.h) ** 2 / 12.0 * changes / motion.h
        rows = motion.unit == motion.unit[evidence.index(joint.child)]
        found[:, rows] += np.sqrt(mobility) * missed[:, None, None] * share[rows]
    return found
