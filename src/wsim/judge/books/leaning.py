"""How far the normals of a pair's points lean along its slip: a record has their mean alone.

Of points that press along normals n with p, and slip along a surface, friction is along their tangents. Where normals
lean apart along the slip, as under a box between two slopes, its sum is less than that of its sizes by as much as the
mean of the normals is shorter than 1; where they lean across it, as in a trough, by nothing. Places tell which.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books.touching import NEAR, Touching

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.books.recorded import RecordedContacts
    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]
    Rows = NDArray[np.intp]


def leaning(evidence: Evidence, contacts: RecordedContacts, rows: Rows, way: Floats, least: float) -> Floats:
    """The least cosine between a slip and the surfaces where they touch, of some rows, (rows,).

    Where a row's normals lean apart by more than `least` is the cosine of, the shapes are looked at, at both ends of
    the interval, as near to each other as a step takes them; where they do not, it is `least`.

    Args:
        evidence: Where bodies are.
        contacts: What is recorded.
        rows: Which of them, (rows,).
        way: Of their slips, of length 1, (rows, 3).
        least: A cosine.
    """
    track, motion, found = contacts.track, evidence.motion, np.full(len(rows), least)
    spread = np.linalg.norm(track.along[rows], axis=1) < least * track.pressed[rows]
    for n in np.flatnonzero(spread):
        last, (low, high) = max(int(track.frame[rows[n]]), 1), sorted(contacts.body[rows[n]].tolist())
        step = motion.dt / motion.h[last - 1] * motion.reach[last - 1, [row for row in (low, high) if row >= 0]].sum()
        for frame in (last - 1, last):
            near = Touching.of(evidence).at(evidence.body_q[frame], NEAR + float(step), about=[high])
            ours = (np.minimum(near.one, near.two) == low) & (np.maximum(near.one, near.two) == high)
            rise = np.abs(near.normal[ours] @ way[n]).max(initial=0.0)
            found[n] = min(found[n], float(np.sqrt(max(1.0 - rise**2, 0.0))))
    return found
