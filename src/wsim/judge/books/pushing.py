"""Strengths of impulses that only push, for one large problem: min |b - A x|, x >= 0, of some hundred rows.

A pile of bodies in contact is one problem of thousands of columns, most of which can be done without.
First accelerated projections (Beck and Teboulle 2009, started anew where they overshoot: O'Donoghue and Candes 2015) on
|b - A x| in the metric of (A A^T + r)^-1, in which a step of one is safe; they stop where all is explained. What they
leave is solved by non-negative least squares (Lawson and Hanson 1974) on the columns that they use, to which those that
would still push along the rest are added until there are none: the optimum of all columns.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import lsq_linear, nnls
from scipy.sparse import csc_matrix, csr_matrix

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

RIDGE = 1e-3  # of the mean of A A^T's diagonal: what is nearly explained is not weighed by 1 / 0
ROUNDS = 200  # of accelerated projections
ADDED = 100  # columns at once
PUSHES = 1e-9  # of what is wanted: a column that gains less would not push


def pushing(matrix: csr_matrix, wanted: Floats, enough: float) -> Floats:
    """Strengths (c,) that are not negative and leave least of what is wanted (6 b,), or `enough` of each body or less.

    Args:
        matrix: (6 b, c).
        wanted: Six rows a body.
        enough: A rest of a body's six rows that is as good as none.
    """
    length = np.sqrt(np.asarray(matrix.multiply(matrix).sum(axis=0)).ravel())
    unit = csr_matrix(matrix.multiply(1.0 / np.maximum(length, 1e-300)))
    strength = _projected(unit, wanted, enough)
    if _most(wanted - unit @ strength) > enough:
        strength = _least(unit, wanted, strength, enough)
    return np.asarray(strength / np.maximum(length, 1e-300))


def _most(rest: Floats) -> float:
    """The largest rest of a body, of all bodies' six rows each (6 b,)."""
    return float(np.sqrt(np.einsum("bi,bi->b", rest.reshape(-1, 6), rest.reshape(-1, 6)).max(initial=0.0)))


def _projected(unit: csr_matrix, wanted: Floats, enough: float) -> Floats:
    """Strengths after accelerated projections, or as soon as they leave no more than `enough`."""
    across = csr_matrix(unit.T)
    gram = (unit @ across).toarray()
    gram[np.diag_indices(len(gram))] += RIDGE * np.trace(gram) / len(gram)
    inverse = np.linalg.inv(gram)
    strength = ahead = np.zeros(unit.shape[1])
    made, there, pace = np.zeros(len(wanted)), np.zeros(len(wanted)), 1.0  # what strengths make, and those ahead
    for _ in range(ROUNDS):
        before, strength = strength, np.maximum(ahead + across @ (inverse @ (wanted - there)), 0.0)
        last_made, made = made, unit @ strength
        if _most(wanted - made) <= enough:
            break
        if (ahead - strength) @ (strength - before) > 0.0:
            pace = 1.0
        pace, last = 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * pace * pace)), pace
        ahead = strength + (last - 1.0) / pace * (strength - before)
        there = made + (last - 1.0) / pace * (made - last_made)
    return np.asarray(strength)


def _least(unit: csr_matrix, wanted: Floats, start: Floats, enough: float) -> Floats:
    """The strengths that leave least, from those columns on that a first guess uses most."""
    columns, across = csc_matrix(unit), csr_matrix(unit.T)
    rows, count = unit.shape
    some = np.flatnonzero(start)
    some = some[np.argsort(-start[some], kind="stable")[: 2 * rows]]
    strength, left = np.zeros(count), np.inf
    for _ in range(count):
        found = not_negative(columns[:, some].toarray(), wanted)
        strength[:], strength[some] = 0.0, found
        rest = wanted - unit @ strength
        if _most(rest) <= enough or rest @ rest >= left * (1.0 - 1e-12):
            break
        left, gain = rest @ rest, across @ rest
        gain[some] = 0.0
        more = np.flatnonzero(gain > PUSHES * np.linalg.norm(wanted))
        if not len(more):
            break
        more = more[np.argsort(-gain[more], kind="stable")[:ADDED]]
        some = np.concatenate([some[found > 0.0], more])
    return strength


def not_negative(matrix: Floats, wanted: Floats) -> Floats:
    """Non-negative least squares of a dense matrix."""
    try:
        found: Floats = nnls(matrix, wanted, maxiter=10 * matrix.shape[1])[0]
    except RuntimeError:  # where many columns are alike it may go round in circles
        found = lsq_linear(matrix, wanted, (0.0, np.inf)).x
    return found
