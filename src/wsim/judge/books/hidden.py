"""Speeds that come and go between two frames: what is hit may be stopped again before the next one.

The lowest box of a stack, hit by a ball, slips until friction has it; a ball in a row hands on what it got. Neither
shows a velocity at a frame, and both have moved. What a body was given on the way came from bodies that did change
theirs: no more than the momentum that these changed by, all together, and no faster than twice the fastest of them,
which is what the lightest body leaves a blow with, of the heaviest (restitution 1). A stack that a blow has set rocking
goes on to sway, faster than frames follow: what its upper boxes lose in one interval, and lost in none around it,
has gone through those below, which may have gone and come as they do.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from wsim.judge.books.balance import Books
from wsim.judge.books.encounters import sudden

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]


def hidden(evidence: Evidence) -> Floats:
    """The speed that each body may have had in an interval beyond those at its ends, (T - 1, B) [m/s].

    In an interval with a blow that of what hangs together with what was hit, by contacts that there may have been; in
    others what bodies change their velocities by otherwise than in the intervals around, and in a fall, in place of the
    blow; in any what `landing` tells.
    """
    books, motion = Books.of(evidence), evidence.motion
    found = np.where(motion.kinematic, 0.0, books.landed)
    changed = np.where(motion.kinematic, 0.0, sudden([evidence])[0])
    passed = motion.mass * np.where(books.hit, books.blow, changed)
    fastest = np.maximum(motion.surface_speed[1:], motion.surface_speed[:-1])
    for k in np.flatnonzero(passed.any(axis=1)):
        near = motion.radius + motion.reach[k]
        apart = np.linalg.norm(motion.com[k][:, None] - motion.com[k][None], axis=2)
        count, group = connected_components(csr_matrix(apart < near[:, None] + near[None]), directed=False)
        momentum = np.bincount(group, passed[k], count)[group]
        speed = np.zeros(count)
        np.maximum.at(speed, group, fastest[k])
        given = np.minimum(momentum / motion.mass, 2.0 * speed[group])
        found[k] = np.where(motion.kinematic, 0.0, np.maximum(found[k], given))
    return np.asarray(found)
