"""What drives may give to and fro between two frames, which the sums of a recording leave out."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import lengths
from wsim.judge.evidence.joints import anchors_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.books.laws import Laws
    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]


def thrown(evidence: Evidence, laws: Laws) -> Floats:
    """What of drives counts as if all came at one end of an interval, on each body, (T - 1, B) [N s].

    A drive that is faster than the frames may give one way and take it back: of impulses whose sizes add up to s and
    whose sum is p no part is more than (s + p) / 2. One of stiffness k gives at most k A + c sqrt(k / m) A, A as far as
    what it holds and what moves can take it; a damper alone gives one way. What a hinge's drive gives and its stop
    takes back is recorded: (s - p) / 2 of it turned the child, of mass m and its centre at l, by the hinge's mobility
    times that, and so was m l times as much a push.
    """
    motion, ties = evidence.motion, evidence.recording.ties
    found = np.zeros((len(motion.h), len(motion.mass)))
    for k, joint in enumerate(evidence.world.joints):
        drive, track, law = joint.drive, evidence.joint(joint), laws.joints[joint.prim]
        if drive is None or track is None or ties is None or not law or joint.kind not in ("revolute", "prismatic"):
            continue
        child = evidence.index(joint.child)
        rows = np.flatnonzero(motion.unit == motion.unit[child])
        if joint.kind == "revolute":
            driven, stopped = (each[1:, k].astype(np.float64) for each in (ties.drive, ties.stop))
            back = 0.5 * (np.abs(driven) + np.abs(stopped) - np.abs(driven + stopped))
            arm = lengths(motion.com[:, child] - anchors_of(evidence, joint).below).max()
            found[:, rows] += (motion.mass[child] * arm * laws.loose(joint)[:-1] * back)[:, None]
            continue
        given = np.abs(ties.drive[1:, k].astype(np.float64))
        far = np.sqrt(
            (laws.aims(joint).position[:-1] - track.position[:-1]) ** 2
            + 2.0 * motion.kinetic[:-1, rows].sum(axis=1) / max(drive.stiffness, 1e-12)
        )
        most = (drive.stiffness + drive.damping * np.sqrt(drive.stiffness * laws.loose(joint)[:-1])) * far
        sizes = (
            given
            if drive.stiffness <= 0.0
            else np.minimum(most, np.inf if drive.max_effort is None else drive.max_effort) * motion.h
        )
        found[:, rows] += np.where(law[0].known, 0.0, 0.5 * (np.maximum(sizes, given) + given))[:, None]
    return found
