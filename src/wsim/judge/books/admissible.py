"""The admissible impulses that leave least of a change of momentum.

Bodies that pass impulses to each other make one small problem each; there are thousands in a recording. Where all
impulses are one-sided, alternating projections between "they make the change" and "they only push" (von Neumann;
Bauschke and Borwein 1996) explain all that rests or slides in a few products of stacked matrices. What they do not
explain is left to non-negative least squares (Lawson and Hanson 1974), one problem after another; of many bodies
without ties in a way of its own (`wsim.judge.books.pushing`).
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import lsq_linear
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import connected_components

from wsim.judge.books.pushing import not_negative, pushing

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.books.forces import Columns

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]
    Rows = NDArray[np.intp]
    Known = dict[bytes, Floats]

ROUNDS = 12  # of alternating projections
ALIKE = 16  # columns of problems that are solved at once differ by less
LARGE = 24  # bodies: beyond, a problem is its own
SMALL = 6  # bodies: up to so many, a dense matrix is the quickest
NOTHING = 1e-6  # of what is wanted, left


@dataclass(frozen=True)
class Problems:
    """Bodies that pass impulses to each other, and their columns, g problems."""

    bodies: list[Rows]
    columns: list[Rows]

    @classmethod
    def of(cls, columns: Columns, judged: Bools, among: Bools | None = None) -> Problems:
        """Those of the columns `among` all, (c,). What is not judged passes nothing on."""
        ours = [(which >= 0) & judged[np.maximum(which, 0)] for which in (columns.one, columns.two)]
        if among is not None:
            ours = [which & among for which in ours]
        inner = ours[0] & ours[1]
        links = coo_matrix((np.ones(int(inner.sum())), (columns.one[inner], columns.two[inner])), (len(judged),) * 2)
        _, label = connected_components(links, directed=False)
        owner = np.where(ours[1], label[np.maximum(columns.two, 0)], label[np.maximum(columns.one, 0)])
        known = np.flatnonzero(ours[0] | ours[1])
        by_owner = known[np.argsort(owner[known], kind="stable")]
        groups, first = np.unique(owner[by_owner], return_index=True)
        members = np.flatnonzero(judged)
        by_label = members[np.argsort(label[members], kind="stable")]
        starts, ends = (np.searchsorted(label[by_label], groups, side) for side in ("left", "right"))
        bodies = [by_label[start:end] for start, end in zip(starts, ends, strict=True)]
        return cls(bodies, np.split(by_owner, first[1:])[: len(groups)])


def explain(
    columns: Columns, judged: Bools, wanted: Floats, scale: Floats, enough: float, bent: Floats | None = None,
    hit: Bools | None = None, known: Known | None = None,
) -> tuple[Floats, Floats, Bools]:  # fmt: skip
    """What is left of changes (N, 6) of N bodies, to within `enough`, and what may be missing of both parts, (N, 2).

    What is at hand is asked first, but of what is hit: what that explains needs no impulses of what is apart.
    What ties pass on is known no better than the arms and axes that they do it with, and what is wrong with one body's
    ends at any that hangs together with it or touches it: a link that whips about beside a ball pushes it, too. Of none
    is it more than all of it where it is wrong, counted as what is left: the impulses that acted leave that, and those
    that leave least no more.

    Args:
        columns: Impulses that the world can exert.
        judged: (N,).
        wanted: Changes, (N, 6), already by `scale`.
        scale: (N, 6), what an impulse on a body counts for.
        enough: A rest of a body that is as good as none.
        bent: Share of what ties give a body that may be wrong, (N,); None: nothing is.
        hit: Bodies that something hits, (N,); None: none is.
        known: What explained large problems before, kept for when one is asked again; None: none is kept.

    Returns:
        These two, and the bodies that took impulses of what is apart, or are not explained, (N,).
    """
    rest, missing, apart = wanted.copy(), np.zeros((len(wanted), 2)), np.zeros(len(wanted), dtype=bool)
    problems = Problems.of(columns, judged)
    first = columns.near | _on(columns, hit) if hit is not None else columns.near
    some = [not first[chosen].all() and not columns.both[chosen].any() for chosen in problems.columns]
    if any(some):
        asked = np.zeros_like(judged)
        asked[np.concatenate([bodies for bodies, each in zip(problems.bodies, some, strict=True) if each])] = True
        near = Problems.of(columns, asked, first)
        _solve(columns, near, rest, missing, scale, enough, None, known, wholly=True)
        done = np.linalg.norm(rest, axis=1) <= enough
        for bodies, chosen in zip(near.bodies, near.columns, strict=True):
            apart[bodies] = not columns.near[chosen].all()
        left = [not (each and done[bodies].all()) for bodies, each in zip(problems.bodies, some, strict=True)]
        problems = Problems(*([part for part, each in zip(parts, left, strict=True) if each]
                              for parts in (problems.bodies, problems.columns)))  # fmt: skip
        for bodies in problems.bodies:
            rest[bodies] = wanted[bodies]
    _solve(columns, problems, rest, missing, scale, enough, bent, known)
    for bodies, chosen in zip(problems.bodies, problems.columns, strict=True):
        apart[bodies] = not columns.near[chosen].all()
    return rest, missing, apart | (judged & (np.linalg.norm(rest, axis=1) > enough))


def _on(columns: Columns, some: Bools) -> Bools:
    """Whether each column acts on any of some bodies (N,), (c,)."""
    rows = np.stack([columns.one, columns.two])
    return np.asarray((some[np.maximum(rows, 0)] & (rows >= 0)).any(axis=0))


def _solve(
    columns: Columns, problems: Problems, rest: Floats, missing: Floats, scale: Floats, enough: float,
    bent: Floats | None, known: Known | None, *, wholly: bool = False,
) -> None:  # fmt: skip
    """Take from what is left what the columns of some problems explain; of use may be `wholly` alone."""
    for k, made in _easy(columns, problems, rest, scale, enough):
        bodies, chosen = problems.bodies[k], problems.columns[k]
        if len(bodies) > SMALL and not columns.both[chosen].any():
            sparse = _sparse(columns, bodies, chosen, scale)
            wanted = rest[bodies].ravel()
            problem = _digest(sparse, wanted, wholly)
            strength = known.get(problem) if known is not None else None
            if strength is None:
                strength = pushing(sparse, wanted, enough, wholly=wholly)
            if known is not None:
                known[problem] = strength
            rest[bodies] -= (sparse @ strength).reshape(-1, 6)
            continue
        matrix = _matrices(columns, bodies[None], [chosen], scale)[0] if made is None else made
        new = ~columns.goes_on[chosen]
        ties = columns.both[chosen][new]
        strength = least(matrix, rest[bodies].ravel(), ties, columns.most[chosen][new])
        rest[bodies] -= (matrix @ strength).reshape(-1, 6)
        if ties.any() and bent is not None:
            each = (np.abs(matrix[:, ties]) @ np.abs(strength[ties])).reshape(-1, 6) / scale[bodies]
            each *= bent[bodies, None]
            most = np.array([each[:, :3].max(), each[:, 3:].max()]) * scale[bodies][:, [0, 3]]
            missing[bodies] = np.minimum(most, np.linalg.norm(each * scale[bodies]))


def _digest(matrix: csr_matrix, wanted: Floats, wholly: bool) -> bytes:
    """That of a problem, to the bit."""
    found = hashlib.blake2b(bytes([wholly]), digest_size=16)
    for array in (matrix.data, matrix.indices, matrix.indptr, wanted):
        found.update(array.tobytes())
    return found.digest()


def least(matrix: Floats, wanted: Floats, both: Bools, most: Floats) -> Floats:
    """Strengths (c,) that leave least of what is wanted (r,): not negative but of `both`, and no more than `most`.

    Where what is at its most leaves anything to the others, it may have come there the wrong way: of two wheels in
    mesh, each with dry friction, that which is least in all drives one on. Then they are sought all at once, within
    their bounds (Stark and Parker 1995).
    """
    strength, full = _unbounded(matrix, wanted, both), np.zeros(len(both), dtype=bool)
    while np.any(over := ~full & (np.abs(strength) > most)):  # what is at its most stays there, and others do the rest
        full |= over
        held = np.where(full, np.clip(strength, -most, most), 0.0)
        strength = held.copy()
        strength[~full] = _unbounded(matrix[:, ~full], wanted - matrix @ held, both[~full])
    rest = float(np.linalg.norm(wanted - matrix @ strength))
    if full.any() and rest > NOTHING * float(np.linalg.norm(wanted)):
        length = np.maximum(np.linalg.norm(matrix, axis=0), 1e-300)
        bounds = np.where(both, -most * length, 0.0), np.maximum(most * length, 1e-300)
        found = lsq_linear(matrix / length, wanted, bounds, method="bvls").x / length
        if np.linalg.norm(wanted - matrix @ found) < rest:
            return np.asarray(found)
    return strength


def _unbounded(matrix: Floats, wanted: Floats, both: Bools) -> Floats:
    length = np.maximum(np.linalg.norm(matrix, axis=0), 1e-300)
    matrix = matrix / length
    free, pushing = matrix[:, both], matrix[:, ~both]
    strength = np.zeros(len(both))
    if pushing.shape[1]:
        # What acts both ways takes all within its span: the others are asked for what is outside.
        basis, size, _ = np.linalg.svd(free, full_matrices=False) if free.shape[1] else (free, np.zeros(0), None)
        span = basis[:, : int((size > 1e-9 * size.max(initial=0.0)).sum())]
        outside = pushing - span @ (span.T @ pushing)
        strength[~both] = not_negative(outside, wanted - span @ (span.T @ wanted))
    if free.shape[1]:
        strength[both] = np.linalg.lstsq(free, wanted - pushing @ strength[~both], rcond=1e-9)[0]
    found: Floats = strength / length
    return found


def _easy(
    columns: Columns, problems: Problems, rest: Floats, scale: Floats, enough: float
) -> list[tuple[int, Floats | None]]:
    """Take from the rest what projections explain, where they explain all; what is left, with its matrix if made."""
    tied = [bool(columns.both[chosen].any()) or len(chosen) == 0 for chosen in problems.columns]
    hard: list[tuple[int, Floats | None]] = []
    alike: dict[tuple[int, int], list[int]] = {}
    for k, (bodies, chosen) in enumerate(zip(problems.bodies, problems.columns, strict=True)):
        if tied[k] or len(bodies) > LARGE:
            hard.append((k, None))
        else:
            alike.setdefault((len(bodies), -(-len(chosen) // ALIKE)), []).append(k)
    for group in alike.values():
        at = np.stack([problems.bodies[k] for k in group])  # (g, b)
        matrices = _matrices(columns, at, [problems.columns[k] for k in group], scale)
        left = _projected(matrices, rest[at].reshape(len(group), -1)).reshape(*at.shape, 6)
        small = np.linalg.norm(left, axis=2).max(axis=1) <= enough
        rest[at[small]] = left[small]
        for n in np.flatnonzero(~small):
            count = int((~columns.goes_on[problems.columns[group[n]]]).sum())
            hard.append((group[n], matrices[n, :, :count]))
    return sorted(hard, key=lambda each: each[0])


def _projected(matrices: Floats, wanted: Floats) -> Floats:
    """What is left of what is wanted (g, r), of matrices (g, r, c), after some alternating projections."""
    gram = matrices @ matrices.transpose(0, 2, 1)
    gram += 1e-9 * np.trace(gram, axis1=1, axis2=2)[:, None, None] * np.eye(gram.shape[1])
    inverse = matrices.transpose(0, 2, 1) @ np.linalg.inv(gram)
    strength, left = np.zeros((len(matrices), matrices.shape[2], 1)), wanted[..., None]
    for _ in range(ROUNDS):
        strength = np.maximum(strength + inverse @ left, 0.0)
        left = wanted[..., None] - matrices @ strength
    return np.asarray(left[..., 0])


def _matrices(columns: Columns, bodies: Rows, chosen: list[Rows], scale: Floats) -> Floats:
    """The problems' columns for their bodies (g, b), (g, 6 b, c); zeros where one has fewer than another."""
    every, members = np.concatenate(chosen), bodies.shape[1]
    problem = np.repeat(np.arange(len(chosen)), [len(part) for part in chosen])
    new = ~columns.goes_on[every]
    counts = np.bincount(problem[new], minlength=len(chosen))
    column = np.cumsum(new) - 1 - (np.cumsum(counts) - counts)[problem]
    place = np.full(len(scale), -1)
    place[bodies] = np.arange(members)
    made = np.zeros((len(chosen), int(counts.max()), members, 6))
    for which, on in ((columns.one[every], columns.on_one), (columns.two[every], columns.on_two)):
        ours = np.flatnonzero(which >= 0)
        ours = ours[place[which[ours]] >= 0]
        body = which[ours]
        made[problem[ours], column[ours], place[body]] += on[every[ours]] * scale[body]
    return made.reshape(len(chosen), made.shape[1], -1).transpose(0, 2, 1)


def _sparse(columns: Columns, bodies: Rows, chosen: Rows, scale: Floats) -> csr_matrix:
    """One problem's columns for its bodies (b,), (6 b, c)."""
    column = np.cumsum(~columns.goes_on[chosen]) - 1
    place = np.full(len(scale), -1)
    place[bodies] = np.arange(len(bodies))
    parts = []
    for which, on in ((columns.one[chosen], columns.on_one[chosen]), (columns.two[chosen], columns.on_two[chosen])):
        ours = np.flatnonzero((which >= 0) & (place[np.maximum(which, 0)] >= 0))
        rows = 6 * place[which[ours]][:, None] + np.arange(6)
        parts.append((on[ours] * scale[which[ours]], rows, np.repeat(column[ours], 6)))
    values, rows, at = (np.concatenate([part[n].ravel() for part in parts]) for n in range(3))
    return csr_matrix((values, (rows, at)), shape=(6 * len(bodies), int(column[-1]) + 1))
