"""Strengths of impulses that only push, for one large problem: min |b - A x|, x >= 0, of some hundred rows.

A pile of bodies in contact is one problem of thousands of columns, most of which can be done without.
First accelerated projections (Beck and Teboulle 2009, started anew where they overshoot: O'Donoghue and Candes 2015) on
|b - A x| in the metric of (A A^T + r)^-1, in which a step of one is safe; they stop where all is explained. What they
leave goes to an interior-point method (Mehrotra 1992), a dozen or two systems of the rows alone, however many columns
push; the square of what its rest is off is at most the gap that is left.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg.lapack import dpotrf, dpotrs
from scipy.optimize import lsq_linear, nnls
from scipy.sparse import csc_matrix, csr_matrix

from wsim.geometry.rotations import lengths

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

RIDGE = 1e-3  # of the mean of A A^T's diagonal: what is nearly explained is not weighed by 1 / 0
ROUNDS = 80  # of accelerated projections
TRIAL, HOPELESS = 20, 30.0  # rounds after which what leaves so many times enough will not come to it
STEPS = 60  # of the interior-point method, at most
GAP = 1e-9  # of its first gap: as good as none
ROUNDING = 1e-8  # of what is wanted: where steps go astray by more, they are at their end
SHORT = 0.995  # of the way to the nearest bound
STIFF = 1e12  # x / s at most, for what is solved for


def pushing(matrix: csr_matrix, wanted: Floats, enough: float, *, wholly: bool = False) -> Floats:
    """Strengths (c,) that are not negative and leave least of what is wanted (6 b,), or `enough` of each body or less.

    Args:
        matrix: (6 b, c).
        wanted: Six rows a body.
        enough: A rest of a body's six rows that is as good as none.
        wholly: Whether only strengths that leave no more are of use: they are any, where there are none.
    """
    length = np.sqrt(np.asarray(matrix.multiply(matrix).sum(axis=0)).ravel())
    unit = csr_matrix(matrix.multiply(1.0 / np.maximum(length, 1e-300)))
    strength = _projected(unit, wanted, enough)
    if _most(wanted - unit @ strength) > enough:
        strength = _interior(unit, wanted, strength, enough, wholly)
    return np.asarray(strength / np.maximum(length, 1e-300))


def _most(rest: Floats) -> float:
    """The largest rest of a body, of all bodies' six rows each (6 b,)."""
    each = rest.reshape(-1, 6)
    return math.sqrt(np.einsum("bi,bi->b", each, each).max(initial=0.0))


def _factor(gram: Floats) -> Floats:
    """Cholesky's, of a lower triangle (r, r), by LAPACK itself: of small ones SciPy's door takes as long as its solver.

    Raises:
        LinAlgError: Where it is not positive definite.
    """
    factor, wrong = dpotrf(gram, lower=1, clean=0)
    if wrong:
        raise np.linalg.LinAlgError(f"the leading minor of order {wrong} is not positive definite")
    return np.asarray(factor)


def _projected(unit: csr_matrix, wanted: Floats, enough: float) -> Floats:
    """Strengths after accelerated projections, or as soon as they leave no more than `enough`."""
    across = csr_matrix(unit.T)
    gram = (unit @ across).toarray()
    gram[np.diag_indices(len(gram))] += RIDGE * np.trace(gram) / len(gram)
    factor = _factor(gram)
    strength = ahead = np.zeros(unit.shape[1])
    made, there, pace = np.zeros(len(wanted)), np.zeros(len(wanted)), 1.0  # what strengths make, and those ahead
    for n in range(ROUNDS):
        step = across @ dpotrs(factor, wanted - there, lower=1)[0]
        before, strength = strength, np.maximum(ahead + step, 0.0)
        last_made, made = made, unit @ strength
        most = _most(wanted - made)
        if most <= enough or (n == TRIAL and most > HOPELESS * enough):
            break
        if (ahead - strength) @ (strength - before) > 0.0:
            pace = 1.0
        pace, last = 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * pace * pace)), pace
        ahead = strength + (last - 1.0) / pace * (strength - before)
        there = made + (last - 1.0) / pace * (made - last_made)
    return np.asarray(strength)


def _interior(unit: csr_matrix, wanted: Floats, start: Floats, enough: float, wholly: bool) -> Floats:
    """Positive strengths that leave nearly least of what is wanted, or `enough`, from those of a guess on.

    Of x the strengths, r what is left and s >= 0 how little each column gains, r + A x = b, A^T r + s = 0, x s = 0:
    Newton steps on these towards x s = mu, a share of what it is that falls as the steps find room (Mehrotra 1992).
    An r that no column is along shows what cannot be explained: of any rest r' of each body, r b <= r r' (Farkas 1902).
    """
    across, gram = csr_matrix(unit.T), Gram(unit)
    x = np.maximum(start, 0.1 * start.mean() + 1e-12)
    rest = r = wanted - unit @ x
    gain = across @ r
    s = np.maximum(-gain, 0.1 * np.abs(gain).mean() + 1e-12)
    gap = first = x @ s
    for _ in range(STEPS):
        if _most(rest) <= enough or gap <= GAP * first:
            break
        gain = across @ r
        if wholly and gain.max() <= 0.0 and r @ wanted > enough * lengths(r.reshape(-1, 6)).sum():
            break
        short, off = rest - r, -(gain + s)
        try:
            factor = _factor(gram.weighed(np.minimum(x / s, STIFF)))
        except np.linalg.LinAlgError:  # it is as near as rounding lets it come
            break

        def step(target: Floats) -> tuple[Floats, Floats, Floats]:
            dr = dpotrs(factor, short - unit @ ((target - x * off) / s), lower=1)[0]  # noqa: B023
            ds = off - across @ dr  # noqa: B023
            return (target - x * ds) / s, ds, dr  # noqa: B023

        dx, ds, _ = step(-x * s)
        ahead = (x + _room(x, dx) * dx) @ (s + _room(s, ds) * ds)
        dx, ds, dr = step((ahead / gap) ** 3 * gap / len(x) - x * s - dx * ds)
        share = SHORT * min(_room(x, dx), _room(s, ds))
        further, r = x + share * dx, r + share * dr
        rest = wanted - unit @ further
        if np.linalg.norm(rest - r) > ROUNDING * np.linalg.norm(wanted):
            break
        x, s = further, s + share * ds
        gap = x @ s
    return np.asarray(x)


def _room(value: Floats, change: Floats) -> float:
    """The share of a change, up to all of it, that leaves no value negative."""
    falls = change < 0.0
    return float(np.min(-value[falls] / change[falls], initial=1.0))


class Gram:
    """1 + A diag(w) A^T of one sparse matrix and many weights: each of its entries is a sum over columns."""

    def __init__(self, matrix: csr_matrix) -> None:
        columns = csc_matrix(matrix)
        columns.sort_indices()
        counts, self._rows = np.diff(columns.indptr), matrix.shape[0]
        self._order = np.argsort(counts, kind="stable")  # columns with as many entries, and so as many products
        places, products, many = [], [], []
        for count, times in zip(*np.unique(counts, return_counts=True), strict=True):
            alike = np.flatnonzero(counts == count)
            which = columns.indptr[alike][:, None] + np.arange(count)
            row, value = columns.indices[which], columns.data[which]
            low, high = np.tril_indices(count)
            places.append((row[:, low] * self._rows + row[:, high]).ravel())
            products.append((value[:, low] * value[:, high]).ravel())
            many.append(np.full(times, len(low)))
        first = np.concatenate([[0], np.cumsum(np.concatenate(many))])
        made = np.concatenate(products), np.concatenate(places), first
        self._sums = csc_matrix(made, shape=(self._rows**2, matrix.shape[1]))

    def weighed(self, weights: Floats) -> Floats:
        """Its lower triangle, (r, r)."""
        found = self._sums @ weights[self._order]
        found[:: self._rows + 1] += 1.0
        return np.asarray(found.reshape(self._rows, self._rows))


def not_negative(matrix: Floats, wanted: Floats) -> Floats:
    """Non-negative least squares of a dense matrix."""
    try:
        found: Floats = nnls(matrix, wanted, maxiter=10 * matrix.shape[1])[0]
    except RuntimeError:  # where many columns are alike it may go round in circles
        found = lsq_linear(matrix, wanted, (0.0, np.inf)).x
    return found
