"""What goes on for many frames, rolling or sliding, beside what it never comes to: nothing carries it.

Within one interval a gap may close and open again. Between two frames a body that nothing else is near falls freely to
where it touches, and away from there: a gap d that it comes to at u is closed after t, d = u t + a t^2 / 2, at the
earliest, a what gravity and all else that is known give, and likewise from the other frame backwards. Where the first
is later than the last it touched nothing. (Distances of convex bodies that do not turn are convex along straight ways,
Boyd and Vandenberghe, Convex Optimization, 2004, so that no gap closes sooner; a turning body's points may, by w R.)
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books.balance import Books
from wsim.judge.books.creep import ENOUGH, INTERVALS, Lacking
from wsim.judge.books.standing import hair
from wsim.judge.books.touching import NEAR, touching_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]
    Rows = NDArray[np.intp]


def gliding(copies: Sequence[Evidence]) -> list[list[Lacking]]:
    """What is missing to all that goes on over gaps, of each copy, in spans that overlap by a half.

    Args:
        copies: W of one world or of similar ones, T frames of B bodies each.
    """
    found: list[list[Lacking]] = [[] for _ in copies]
    firsts = np.arange(0, len(copies[0].motion.h) - INTERVALS + 1, INTERVALS // 2)
    if not len(firsts):
        return found
    goes = np.stack([_goes(evidence, firsts) for evidence in copies])  # (W, spans, B)
    every = 0, INTERVALS // 2, INTERVALS, *range(1, INTERVALS)  # few frames tell of most that it touches
    for part in (every[:1], every[1:3], every[3:]):
        copy, span = np.nonzero(np.any(goes, axis=2))
        for offset in part if len(copy) else ():
            early, _ = _touches(copies, copy, firsts[span] + offset, goes[copy, span])
            goes[copy, span] &= early > 0.0
    copy, span = np.nonzero(np.any(goes, axis=2))
    if len(copy):
        goes[copy, span] &= _aloft(copies, copy, firsts[span], goes[copy, span])
    for n, k, row in zip(*np.nonzero(goes), strict=True):
        first = int(firsts[k])
        force = Books.of(copies[n]).wanted[first : first + INTERVALS, row, :3].mean(axis=0)
        found[n].append(Lacking(int(row), first, first + INTERVALS, np.zeros(3), force))
    return found


def _goes(evidence: Evidence, firsts: Rows) -> Bools:
    """Bodies that something carries and nothing holds or hits, and that nothing comes by that moves, (spans, B)."""
    motion, books, spans = evidence.motion, Books.of(evidence), firsts[:, None] + np.arange(INTERVALS)
    calm = books.judged & ~books.hit & ~motion.meets
    carried = np.linalg.norm(books.wanted[spans, :, :3].mean(axis=1), axis=2) > ENOUGH * max(evidence.gravity, 1.0)
    solid = [all(shape.kind != "mesh" for shape in body.shapes) for body in evidence.world.bodies]
    way = motion.surface_speed[spans].max(axis=1) * (evidence.time[spans[:, -1]] - evidence.time[firsts])[:, None]
    found = calm[spans].all(axis=1) & carried & ~motion.jointed & np.array(solid, dtype=bool)
    return np.asarray(found & (way > hair(evidence)))  # the others stand (`wsim.judge.books.standing`)


def _aloft(copies: Sequence[Evidence], copy: Rows, first: Rows, asked: Bools) -> Bools:
    """Whether bodies of K spans come to nothing in any of their intervals, (K, B)."""
    found, after = asked.copy(), _touches(copies, copy, first, asked)
    for offset in range(INTERVALS):
        before, after = after, _touches(copies, copy, first + offset + 1, asked)
        h = np.array([copies[n].motion.h[k + offset] for n, k in zip(copy, first, strict=True)])
        found &= before[0] + after[1] > h[:, None]
    return found


def _touches(copies: Sequence[Evidence], copy: Rows, frames: Rows, asked: Bools) -> tuple[Floats, Floats]:
    """How long after some frames (K,) bodies may touch anything at the earliest, and how long before, (K, B) [s]."""
    touching, bodies = touching_of(copies), asked.shape[1]
    chosen = list(zip(copy, frames, strict=True))
    q = np.stack([copies[n].body_q[k] for n, k in chosen])
    v, w = (np.stack([getattr(copies[n].motion, name)[k] for n, k in chosen]) for name in ("v", "w"))
    near = [np.minimum(k + np.array([-1, 0]), len(copies[n].motion.h) - 1).clip(0) for n, k in chosen]
    reach = np.stack([copies[n].motion.reach[ks].max(axis=0) for (n, _), ks in zip(chosen, near, strict=True)])
    reach = 0.5 * NEAR + np.pad(np.where(asked, reach, 0.0), ((0, 0), (0, 1)))
    contacts = touching.of_many(q, reach, np.arange(len(q)), copy, asked)
    rows = np.maximum(contacts.one, contacts.two)
    normal = np.where((contacts.two >= 0)[:, None], contacts.normal, -contacts.normal)  # towards the body
    apart = np.einsum("ni,ni->n", v.reshape(-1, 3)[rows], normal)
    whirls = np.stack([_whirls(evidence) for evidence in copies])[copy] * np.linalg.norm(w, axis=2)
    pull = np.stack([_pull(copies[n], ks) for (n, _), ks in zip(chosen, near, strict=True)]).ravel()[rows]
    gap = np.maximum(contacts.gap - np.stack([hair(one) for one in copies])[copy].ravel()[rows], 0.0)
    meshes = np.array([shape.kind == "mesh" for _, _, shape in touching.shapes], dtype=bool)
    gap[meshes[contacts.shapes].any(axis=1)] = 0.0  # a mesh may stand for what is round
    found = []
    for closing in (-apart, apart):
        u = closing + whirls.ravel()[rows]
        time = np.full(asked.size, np.inf)
        np.minimum.at(time, rows, (np.sqrt(u**2 + 2.0 * pull * gap) - u) / pull)
        found.append(time.reshape(-1, bodies))
    return found[0], found[1]


def _pull(evidence: Evidence, ks: Rows) -> Floats:
    """What gravity and all else that is known give bodies in some intervals at most, (B,) [m/s^2]."""
    known = evidence.motion.acceleration[ks] - Books.of(evidence).wanted[ks, :, :3]
    return np.asarray(np.maximum(np.linalg.norm(known, axis=2).max(axis=0), 1e-6))


def _whirls(evidence: Evidence) -> Floats:
    """How far a body's points may be that come nearer as it turns, (B,) [m]: none of a ball about its middle."""
    bodies = evidence.world.bodies
    balls = [all(shape.kind == "sphere" and shape.position == body.com for shape in body.shapes) for body in bodies]
    return np.where(np.array(balls, dtype=bool), 0.0, evidence.motion.radius)
