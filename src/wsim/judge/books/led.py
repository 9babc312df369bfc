"""What bodies that go as they are told put into others through springs and ropes.

A cord that gives a kinematic body the wrench F, M takes F . v + M . w from it a second, and gives as much to all else
that it pulls: of the impulses of an interval, in which v and w are the mean of those at both ends, to within half of
what they change by.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import lengths
from wsim.recording.ties import cord_ends

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]


def led_work(evidence: Evidence) -> Floats | None:
    """The most that kinematic bodies may have given since the start, (T, B) [J], each its own.

    None where a cord hangs on one that moves, and what cords gave was not recorded.
    """
    motion, ties = evidence.motion, evidence.recording.ties
    work = np.zeros(motion.speed.shape)
    moves = motion.kinematic & ((motion.speed + motion.rate) > 0.0).any(axis=0)
    ends = [(n, row) for n, (_, row) in enumerate(cord_ends(evidence.world)) if moves[row]]
    if ends and ties is None:
        return None
    for n, row in ends:
        assert ties is not None
        for part, rate in ((slice(3), motion.v[:, row]), (slice(3, 6), motion.w[:, row])):
            given = ties.cords[1:, n, part].astype(np.float64)
            mean, change = 0.5 * (rate[1:] + rate[:-1]), lengths(np.diff(rate, axis=0))
            work[1:, row] += -np.einsum("ti,ti->t", given, mean) + 0.5 * change * lengths(given)
    return np.asarray(np.cumsum(work, axis=0))
