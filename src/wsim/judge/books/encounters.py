"""Where two bodies meet between frames: near each other, one of them with a jump in its velocity, by their courses.

Of several recordings at once, of worlds that are `similar`, over the same times.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import lengths
from wsim.judge.books.courses import step_of
from wsim.judge.books.forces import Poses, slip

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.judge.books.courses import Courses
    from wsim.judge.books.touching import Contacts, Touching
    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]
    Rows = NDArray[np.intp]

SLIGHT = 0.003  # of a body's speed: what changes by less is no blow
APART = 3.0  # steps: points that come to touch after so many do not do so together


@dataclass(frozen=True)
class Met:
    """Two bodies whose courses meet."""

    k: int  # interval, of those of all recordings
    pair: tuple[int, int]
    when: float  # after its first frame [s]
    before: Poses  # of all bodies, as they went before
    after: Poses
    contacts: Contacts  # of either body then
    slips: tuple[Floats, Floats]  # of each, before and after, (n, 3) [m/s]


def near(copies: Sequence[Evidence], touching: Touching, changed: Bools) -> Rows:
    """Interval and rows of the pairs that may have met there, (n, 3): near each other at either end, one `changed`."""
    count, bodies = changed.shape[1:]
    flat = changed.reshape(-1, bodies)
    ks = np.flatnonzero(flat.any(axis=1))
    copy, first = ks // count, ks + ks // count
    reach = np.concatenate([evidence.motion.reach for evidence in copies])[ks]
    reach = np.repeat(np.pad(reach, ((0, 0), (0, 1))), 2, axis=0)
    frames, rows = np.stack([first, first + 1], axis=1).ravel(), np.repeat(np.arange(len(ks)), 2)
    poses = np.concatenate([evidence.body_q for evidence in copies])[frames]
    contacts = touching.of_many(poses, reach, rows, np.repeat(copy, 2), np.repeat(flat[ks], 2, axis=0))
    at = ks[np.maximum(contacts.one, contacts.two) // bodies]
    one, two = (np.where(each >= 0, each % bodies, each) for each in (contacts.one, contacts.two))
    # A blow's push that goes on in the next interval, or began in the one before, may take several steps.
    around = np.pad(changed, ((0, 0), (1, 1), (0, 1))).astype(np.intp)
    straddles = changed & (around[:, :-2] + around[:, 1:-1] + around[:, 2:] > 1)[..., :-1]
    straddles = np.pad(straddles.reshape(-1, bodies), ((0, 0), (0, 1)))
    once = ~(straddles[at, one] | straddles[at, two])
    return np.unique(np.column_stack([at, one, two])[once], axis=0)


def jumps(copies: Sequence[Evidence]) -> Bools:
    """Where a velocity changes otherwise than in the intervals around and in a fall, (W, T - 1, B), beyond a step."""
    speed = np.stack([evidence.motion.surface_speed for evidence in copies])
    step = np.array([step_of(evidence) for evidence in copies])[:, None, None]
    fastest = np.maximum(speed[:, 1:], speed[:, :-1])
    return np.asarray(sudden(copies) > 2.0 * copies[0].gravity * step + SLIGHT * fastest)


def sudden(copies: Sequence[Evidence]) -> Floats:
    """By how much a velocity, of the surface too, changes otherwise than around and in a fall, (W, T - 1, B) [m/s]."""
    motions, first = [evidence.motion for evidence in copies], copies[0].motion
    v, w = (np.stack([getattr(motion, name) for motion in motions]) for name in ("v", "w"))
    radius = np.stack([motion.radius for motion in motions])[:, None, :, None]
    gained = np.concatenate([np.diff(v, axis=1), np.diff(w, axis=1) * radius], axis=3)
    fall = np.zeros_like(gained) + first.h[:, None, None] * np.concatenate([first.gravity, np.zeros(3)])
    around = np.concatenate([fall[:, :1], gained, fall[:, :1]], axis=1)
    return np.asarray(np.min([lengths(gained - other) for other in (around[:, :-2], around[:, 2:], fall)], axis=0))


def meets(courses: Courses, touching: Touching, met: list[tuple[int, tuple[int, int], float]]) -> list[Met]:
    """What either body of some pairs touches as their courses meet."""
    if not met:
        return []
    ks, whens = np.array([k for k, *_ in met]), np.array([when for *_, when in met])
    poses = [courses.at(ks, side, whens) for side in (0, 1)]
    where = (divmod(int(k), courses.count) for k in ks)
    fastest = [courses.copies[copy].motion.surface_speed[i : i + 2].max() for copy, i in where]
    reach = 2.0 * APART * courses.dt[ks // courses.count] * np.array(fastest)
    contacts, slips, parts = about(courses, touching, ks, poses, reach, [pair for _, pair, _ in met])
    before, after = poses
    return [
        Met(*each, _one(before, n), _one(after, n), contact, (slips[0][part], slips[1][part]))
        for n, (each, contact, part) in enumerate(zip(met, contacts, parts, strict=True))
    ]


def about(
    courses: Courses, touching: Touching, ks: Rows, poses: list[Poses], reach: Floats, pairs: list[tuple[int, int]]
) -> tuple[list[Contacts], list[Floats], list[Rows]]:
    """Contacts of some pairs with anything, at the first of several poses (K, B, ...), and their slips at each.

    Returns:
        Contacts of each pair, the slips of all of them, and which of these are of each pair.
    """
    bodies = poses[0].q.shape[1]
    asked = np.zeros(poses[0].q.shape[:2], dtype=bool)
    for n, pair in enumerate(pairs):
        asked[n, [row for row in pair if row >= 0]] = True
    every = touching.of_many(poses[0].q, reach, np.arange(len(ks)), ks // courses.count, asked)
    slips = [slip(touching, every, _flat(pose)) for pose in poses]
    at = np.maximum(every.one, every.two) // bodies
    first = np.searchsorted(at, np.arange(len(ks) + 1)).tolist()
    one, two = (np.where(rows >= 0, rows - at * bodies, rows) for rows in (every.one, every.two))
    own = replace(every, one=one, two=two)
    parts = [np.arange(*ends) for ends in pairwise(first)]
    return [own.only(part) for part in parts], slips, parts


def _flat(poses: Poses) -> Poses:
    """Those of all bodies at several poses (K, B, ...), one after another."""
    return Poses(*(each.reshape(-1, each.shape[2]) for each in (poses.q, poses.com, poses.v, poses.w)))


def _one(poses: Poses, n: int) -> Poses:
    return Poses(poses.q[n], poses.com[n], poses.v[n], poses.w[n])
