"""What stands still for many frames: only what it touches all the while carries it.

Within one interval a gap may close and open again, so that all within its reach may push. What stays where it is for
many frames, beside nothing that moves, has its gaps all along: what is beyond a hair's breadth carries nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books.admissible import explain
from wsim.judge.books.balance import Books
from wsim.judge.books.creep import ENOUGH, INTERVALS, Lacking
from wsim.judge.books.forces import Poses, pushes
from wsim.judge.books.touching import NEAR, touching_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]
    Rows = NDArray[np.intp]

HAIR, SHARE = 1e-4, 1e-3  # [m], and of a body's radius: a wider gap carries nothing; wsim leaves 1e-8 m
STILL = 0.1  # of that: what stays where it is moves by less
PAIRS = 1_000_000  # of bodies in spans, whose distances are held at once


def standing(copies: Sequence[Evidence]) -> list[list[Lacking]]:
    """What is missing to all that stands, of each copy, in spans that overlap by a half; a longer stand in the first.

    Args:
        copies: W of one world or of similar ones, T frames of B bodies each.
    """
    motion = copies[0].motion
    firsts = np.arange(0, len(motion.h) - INTERVALS + 1, INTERVALS // 2)
    found: list[list[Lacking]] = [[] for _ in copies]
    if not len(firsts) or not len(motion.mass):
        return found
    stands = np.stack([_stands(evidence, firsts) for evidence in copies])  # (W, spans, B)
    known = np.concatenate([np.zeros_like(stands[:, :1]), stands[:, :-1]], axis=1)
    copy, span = np.nonzero(np.any(stands & ~known, axis=2))
    if not len(copy):
        return found
    first, those = firsts[span], stands[copy, span]
    for n, rest in enumerate(_left(copies, copy, first, those)):
        found[copy[n]] += [
            Lacking(int(row), int(first[n]), int(first[n]) + INTERVALS, np.zeros(3), rest[row])
            for row in np.flatnonzero(those[n])
        ]
    return found


def _stands(evidence: Evidence, firsts: Rows) -> Bools:
    """Bodies that nothing holds, that stay where they are, and that nothing comes by that moves, (spans, B)."""
    parts = -(-len(firsts) * len(evidence.motion.mass) ** 2 // PAIRS)
    return np.concatenate([_stand_in(evidence, part) for part in np.array_split(firsts, parts)])


def _stand_in(evidence: Evidence, firsts: Rows) -> Bools:
    motion, frames = evidence.motion, firsts[:, None] + np.arange(INTERVALS + 1)
    q, com = evidence.body_q[frames], motion.com[frames]  # (spans, frames, B, ...)
    way = np.linalg.norm(com - com[:, :1], axis=3).max(axis=1)
    turn = np.minimum(abs(q - q[:, :1]), abs(q + q[:, :1]))[..., 3:]
    stays = way + 2.0 * np.linalg.norm(turn, axis=3).max(axis=1) * motion.radius < STILL * hair(evidence)
    start = com[:, 0]
    apart = np.linalg.norm(start[:, :, None] - start[:, None], axis=3) - motion.radius[:, None] - motion.radius
    passed = np.any((apart < way[:, None] + NEAR) & ~stays[:, None] & ~np.eye(len(motion.mass), dtype=bool), axis=2)
    hit = Books.of(evidence).hit[frames[:, :-1]].any(axis=1)
    return np.asarray(stays & ~passed & ~hit & ~motion.jointed & ~motion.kinematic)


def _left(copies: Sequence[Evidence], copy: Rows, first: Rows, stands: Bools) -> Floats:
    """What nothing gives to what stands in K spans, (K, B, 3) [m/s^2]: of some copies, from some frames on.

    A body in a span is one of K B.
    """
    touching, middle = touching_of(copies), first + INTERVALS // 2
    motions, bodies = [one.motion for one in copies], stands.shape[1]
    size = np.stack([Books.of(one).size for one in copies])[copy]
    arrays = [[one.body_q for one in copies]]
    arrays += [[getattr(motion, name) for motion in motions] for name in ("com", "v", "w")]
    poses = Poses(*(np.concatenate([array[n][k] for n, k in zip(copy, middle, strict=True)]) for array in arrays))
    spans = np.arange(len(copy))
    contacts = touching.of_many(poses.q.reshape(len(copy), -1, 7), np.full(len(copy), NEAR), spans, copy)
    meshes = np.array([shape.kind == "mesh" for _, _, shape in touching.shapes], dtype=bool)
    rows = np.stack([contacts.one, contacts.two])
    finest = np.stack([hair(one) for one in copies])[copy].ravel()
    reach = np.where(rows >= 0, finest[rows], 0.0).max(axis=0, initial=HAIR)
    reach = np.where(meshes[contacts.shapes].any(axis=1), NEAR, reach)  # a mesh may stand for what is round
    contacts = contacts.only(contacts.gap <= reach)
    scale = np.repeat(1.0 / np.stack([motion.mass for motion in motions])[copy].reshape(-1, 1), 6, axis=1)
    scale[:, 3:] /= size.reshape(-1, 1)
    wanted = [Books.of(copies[n]).wanted[k : k + INTERVALS].mean(axis=0) for n, k in zip(copy, first, strict=True)]
    rest = np.where(stands[..., None], wanted, 0.0).reshape(-1, 6)
    if len(contacts):
        friction, rolling = touching.laws(contacts.shapes)
        none = np.zeros((len(contacts), 2, 3))
        columns = pushes(
            contacts, poses, friction, none, rolling * size.ravel()[np.maximum(contacts.one, contacts.two)]
        )
        rest, *_ = explain(columns, stands.ravel(), rest, scale, ENOUGH * max(copies[0].gravity, 1.0))
    return rest.reshape(len(copy), bodies, 6)[..., :3]


def hair(evidence: Evidence) -> Floats:
    """The gap of each body beyond which it touches nothing, (B,) [m]."""
    found: Floats = HAIR + SHARE * evidence.motion.radius
    return found
