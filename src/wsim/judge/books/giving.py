"""What joints give way by under their load, and hold by that as springs do."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.evidence.motion import FLOAT32

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.books.recorded_ties import RecordedTies
    from wsim.judge.evidence.evidence import Evidence


MOST = 1e-4  # of a body's radius, and [rad]: what is farther off than sags was not held there


def held_by_joints(evidence: Evidence, ties: RecordedTies | None, rows: NDArray[np.intp]) -> float:
    """What joints hold by giving way, as poses show and less than they can tell, under what they bear [J].

    What may break, or closes a loop, is held by rows that sag under their load: a cantilever of 1 m by 0.02 mm, which
    takes m g times that.
    """
    found, far = 0.0, float(np.abs(evidence.motion.com).max(initial=0.0))
    for k, pair in enumerate(ties.pairs if ties is not None else []):
        if ties is None or not set(pair) & set(rows.tolist()):
            continue
        track = ties.track.joints[1:, k].astype(np.float64)
        force, torque = (np.linalg.norm(part, axis=1) / evidence.motion.h for part in (track[:, :3], track[:, 9:12]))
        found += 8.0 * FLOAT32 * float(np.median(force) * far + np.median(torque))
        sags = evidence.joint(ties.joints[k])
        if sags is not None:
            size = max(float(evidence.motion.radius[i]) for i in pair if i >= 0)
            most = np.array([MOST * size, MOST])
            apart, turned = (
                np.minimum(np.maximum(each[1:], each[:-1]), limit)
                for each, limit in zip((sags.apart, sags.turned), most, strict=True)
            )
            found += float((force * apart + torque * turned).max(initial=0.0))
    return found
