"""Strengths of many impulses that only push, against non-negative least squares of all columns at once."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import nnls
from scipy.sparse import csr_matrix

from wsim.judge.books.pushing import pushing

BODIES, PAIRS = 12, 200


def contacts(seed: int) -> csr_matrix:
    """Impulses of random contacts: each on two of the bodies, of equal size and against each other."""
    random = np.random.default_rng(seed)
    matrix = np.zeros((6 * BODIES, PAIRS))
    for column in range(PAIRS):
        one, two = random.choice(BODIES, 2, replace=False)
        push, arms = random.normal(size=3), random.normal(size=(2, 3))
        for body, arm, sign in ((one, arms[0], -1.0), (two, arms[1], 1.0)):
            matrix[6 * body : 6 * body + 6, column] = sign * np.concatenate([push, np.cross(arm, push)])
    return csr_matrix(matrix * random.uniform(0.01, 100.0, PAIRS))


@pytest.mark.parametrize("seed", range(5))
def test_what_cannot_be_explained_is_left_as_by_all_columns_at_once(seed: int) -> None:
    matrix = contacts(seed)
    wanted = np.random.default_rng(100 + seed).normal(size=6 * BODIES)  # gives momentum that no pair can
    strength = pushing(matrix, wanted, 1e-9)
    _, left = nnls(matrix.toarray(), wanted, maxiter=10 * PAIRS)
    assert strength.min() >= 0.0
    assert left > 0.1
    assert np.linalg.norm(wanted - matrix @ strength) == pytest.approx(left, rel=1e-6)


@pytest.mark.parametrize("seed", range(8))
def test_each_body_is_left_the_same_where_many_contacts_are_alike(seed: int) -> None:
    """As of faces that share many points, in several frames; also where the change is hardly beyond what they can."""
    random, enough = np.random.default_rng(300 + seed), 1e-2
    few = contacts(seed).toarray()[:, : PAIRS // 4]
    matrix = csr_matrix(np.concatenate([few * random.uniform(0.5, 2.0), few, few, few + 1e-3 * few[:, ::-1]], axis=1))
    given = np.maximum(random.normal(size=matrix.shape[1]), 0.0) / np.linalg.norm(few, axis=0).mean()
    wanted = matrix @ given + 10.0 ** random.uniform(-1.5, 1.5) * random.normal(size=6 * BODIES)
    left = wanted - matrix @ pushing(matrix, wanted, enough)
    exact = wanted - matrix @ nnls(matrix.toarray(), wanted, maxiter=10 * matrix.shape[1])[0]
    assert np.linalg.norm(exact.reshape(-1, 6), axis=1).max() > enough
    assert np.linalg.norm((left - exact).reshape(-1, 6), axis=1).max() < 0.1 * enough


@pytest.mark.parametrize("seed", range(5))
def test_what_can_be_explained_is_left_by_no_body_with_more_than_is_enough(seed: int) -> None:
    matrix, enough = contacts(seed), 1e-3
    given = np.maximum(np.random.default_rng(200 + seed).normal(size=PAIRS), 0.0)
    wanted = matrix @ given
    strength = pushing(matrix, wanted / np.abs(wanted).max(), enough)
    rest = wanted / np.abs(wanted).max() - matrix @ strength
    assert strength.min() >= 0.0
    assert np.linalg.norm(rest.reshape(-1, 6), axis=1).max() <= enough


@pytest.mark.parametrize("seed", range(8))
def test_what_is_sought_wholly_is_found_where_there_is_any(seed: int) -> None:
    """Also of changes that are at their cone's edge, or just beyond it: there nothing explains all."""
    matrix, enough, random = contacts(seed), 1e-3, np.random.default_rng(400 + seed)
    given = np.maximum(random.normal(size=PAIRS), 0.0) * (random.random(PAIRS) < 0.2)
    for beyond in (0.0, 1.0):
        wanted = matrix @ given
        wanted = wanted / np.abs(wanted).max() + beyond * random.normal(size=6 * BODIES)
        rest = wanted - matrix @ pushing(matrix, wanted, enough, wholly=True)
        assert (np.linalg.norm(rest.reshape(-1, 6), axis=1).max() <= enough) == (beyond == 0.0)
