"""What stands still for many frames: only what it touches all the while carries it.

Within one interval a gap may close and open again, so that all within its reach may push. What stays where it is for
many frames, beside nothing that moves, has its gaps all along: what is beyond a hair's breadth carries nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books.admissible import explain
from wsim.judge.books.creep import ENOUGH, INTERVALS, NEAR, Lacking
from wsim.judge.books.forces import Poses, pushes
from wsim.judge.books.touching import Touching

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.books.balance import Books
    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]

HAIR, SHARE = 1e-4, 1e-3  # [m], and of a body's radius: a wider gap carries nothing; wsim leaves 1e-8 m
STILL = 0.1  # of that: what stays where it is moves by less


def standing(evidence: Evidence, books: Books, size: Floats, limits: Floats) -> list[Lacking]:
    """What is missing to all that stands, in spans that overlap by a half; of a longer stand, in its first one.

    Args:
        evidence: T frames of B bodies.
        books: Of its intervals.
        size: That torques are counted by, (B,) [m].
        limits: What may be missing of a force in each interval, (T - 1, B) [m/s^2].
    """
    found: list[Lacking] = []
    known = np.zeros(len(size), dtype=bool)
    for first in range(0, len(books.hit) - INTERVALS + 1, INTERVALS // 2):
        stands = _stands(evidence, books, first)
        if np.any(stands & ~known):
            found += _of_span(evidence, books, size, limits, stands, first)
        known = stands
    return found


def _stands(evidence: Evidence, books: Books, first: int) -> Bools:
    """Bodies that nothing holds, that stay where they are, and that nothing comes by that moves, (B,)."""
    motion, frames = evidence.motion, slice(first, first + INTERVALS + 1)
    q, com = evidence.body_q[frames], motion.com[frames]
    way = np.linalg.norm(com - com[:1], axis=2).max(axis=0)
    turn = 2.0 * np.linalg.norm(np.minimum(abs(q - q[:1]), abs(q + q[:1]))[..., 3:], axis=2).max(axis=0)
    stays = way + turn * motion.radius < STILL * _hair(evidence)
    apart = np.linalg.norm(com[0][:, None] - com[0][None], axis=2) - motion.radius[:, None] - motion.radius[None]
    passed = np.any((apart < way + NEAR) & ~stays[None] & ~np.eye(len(way), dtype=bool), axis=1)
    hit = books.hit[first : first + INTERVALS].any(axis=0)
    return np.asarray(stays & ~passed & ~hit & ~motion.jointed & ~motion.kinematic)


def _of_span(
    evidence: Evidence, books: Books, size: Floats, limits: Floats, stands: Bools, first: int
) -> list[Lacking]:  # fmt: skip
    motion, touching, last = evidence.motion, Touching.of(evidence), first + INTERVALS
    middle = (first + last) // 2
    poses = Poses(evidence.body_q[middle], motion.com[middle], motion.v[middle], motion.w[middle])
    contacts = touching.at(poses.q, NEAR)
    meshes = np.array([shape.kind == "mesh" for _, _, shape in touching.shapes], dtype=bool)
    rows = np.stack([contacts.one, contacts.two])
    reach = np.where(rows >= 0, _hair(evidence)[np.maximum(rows, 0)], 0.0).max(axis=0, initial=HAIR)
    reach = np.where(meshes[contacts.shapes].any(axis=1), NEAR, reach)  # a mesh may stand for what is round
    contacts = contacts.only(contacts.gap <= reach)
    scale = np.repeat(1.0 / motion.mass, 6).reshape(-1, 6)
    scale[:, 3:] /= size[:, None]
    rest = np.where(stands[:, None], books.wanted[first:last].mean(axis=0), 0.0)
    if len(contacts):
        friction, rolling = touching.laws(contacts.shapes)
        none = np.zeros((len(contacts), 2, 3))
        columns = pushes(contacts, poses, friction, none, rolling * size[np.maximum(contacts.one, contacts.two)])
        rest, _ = explain(columns, stands, rest, scale, ENOUGH * max(evidence.gravity, 1.0))
    limit = limits[first:last].mean(axis=0)
    return [
        Lacking(int(row), first, last, np.zeros(3), rest[row, :3], float(limit[row])) for row in np.flatnonzero(stands)
    ]


def _hair(evidence: Evidence) -> Floats:
    """The gap of each body beyond which it touches nothing, (B,) [m]."""
    found: Floats = HAIR + SHARE * evidence.motion.radius
    return found
