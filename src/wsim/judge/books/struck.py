"""Where the bodies of a mechanism are as what joins them passes impulses on.

A force that lasts acts, on the whole, at the mean of its arms at both frames. A blow does not: all of its impulse has
the arms of one instant, and what hangs straight passes it on straight, however its links whip about by the next frame.
That instant is where the mechanism's courses before and after meet (`wsim.judge.books.courses`). Of a push that is
shorter than the frames, but no blow, it is the mean of the push's times.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import rotate
from wsim.judge.books.courses import Courses
from wsim.judge.books.differences import by_differences

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.books.forces import Poses
    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]
    Rows = NDArray[np.intp]


@dataclass(frozen=True)
class Ends:
    """Two poses of all bodies, halfway between which ties act."""

    q: Floats  # (2, B, 7) of the bodies' origins [m; xyzw]
    com: Floats  # (2, B, 3) [m]


class Struck:
    """The poses at both ends of an interval, or of mechanisms that are hit in it twice that of the blow."""

    def __init__(self, evidence: Evidence, hit: Bools) -> None:
        self._evidence, self._hit = evidence, hit
        self._tells = not by_differences(evidence)  # those have no instant: what is told of them is a mean

    @cached_property
    def _courses(self) -> Courses:
        return Courses([self._evidence], self._hit)

    def ends(self, k: int, course: int | None) -> Ends:
        """Those of frames k and k + 1, or of the blow by the course to it (0) or from it (1)."""
        motion = self._evidence.motion
        q, com = self._evidence.body_q[k : k + 2], motion.com[k : k + 2]
        hit = self._hit[k] & motion.jointed
        if course is None or not self._tells or not hit.any():
            return Ends(q, com)
        q, com = q.copy(), com.copy()
        for unit in np.unique(motion.unit[hit]):
            rows = np.flatnonzero(motion.unit == unit)
            poses = self._courses.at(k, course, self._when(k, rows))
            q[:, rows], com[:, rows] = poses.q[rows], poses.com[rows]
        return Ends(q, com)

    def _when(self, k: int, rows: Rows) -> float:
        """When after frame k [s] the courses of some bodies come nearest to each other, by their masses."""
        motion, h = self._evidence.motion, float(self._evidence.motion.h[k])
        first, last = (
            self._points(self._courses.at(k, 0, when), rows) - self._points(self._courses.at(k, 1, when), rows)
            for when in (0.0, h)
        )
        weight = np.where(motion.kinematic[rows], 0.0, motion.mass[rows])[:, None, None]
        gone = last - first
        share = -np.sum(weight * first * gone) / max(float(np.sum(weight * gone * gone)), 1e-300)
        return h * float(np.clip(share, 0.0, 1.0))

    def _points(self, poses: Poses, rows: Rows) -> Floats:
        """Six points of each body that its mass is taken to be at, (b, 6, 3) [m]."""
        out = self._evidence.motion.radius[rows, None, None] * np.concatenate([np.eye(3), -np.eye(3)])
        turn = np.repeat(poses.q[rows, 3:], 6, axis=0)
        return poses.com[rows, None] + rotate(turn, out.reshape(-1, 3)).reshape(-1, 6, 3)
