"""Speeds that come and go between two frames: what is hit may be stopped again before the next one.

The lowest box of a stack, hit by a ball, slips until friction has it; a ball in a row hands on what it got. Neither
shows a velocity at a frame, and both have moved. What a body was given on the way came from bodies that did change
theirs: no more than the momentum that these changed by, all together, and no faster than twice the fastest of them,
which is what the lightest body leaves a blow with, of the heaviest (restitution 1).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from wsim.geometry.rotations import lengths
from wsim.judge.books.balance import Books
from wsim.judge.evidence.motion import FLOAT32

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]

ROUNDINGS = 8.0  # of single precision, in a speed: what changes by less does not


def hidden(evidence: Evidence) -> Floats:
    """The speed that each body may have had in an interval beyond those at its ends, (T - 1, B) [m/s].

    That of what hangs together, by contacts that there may have been, with what was hit, or changed its velocity
    otherwise than by falling: a knock may be less than gravity gives in an interval. In any what `landing` tells.
    """
    books, motion = Books.of(evidence), evidence.motion
    found = np.where(motion.kinematic, 0.0, books.landed)
    gained = np.diff(motion.v, axis=0)
    changed = np.minimum(lengths(gained), lengths(gained - motion.gravity * motion.h[:, None, None]))
    changed = np.where(motion.kinematic | (changed < ROUNDINGS * FLOAT32 * motion.speed[1:]), 0.0, changed)
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
