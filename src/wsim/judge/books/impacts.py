"""Blows between two bodies that nothing else holds: how fast the points met that touch, and how fast they parted.

Between two frames bodies go on as they did before and as they will after, but for the blow itself. Where the course of
one frame, carried on, meets that of the next, carried back, in place and in turning, there was one blow, short beside
the frames; there the shapes touch, and Newton's law of impact holds for the points that do: no point parts at less than
the restitution times its approach, and one that pushes at no more. Where friction's impulse and the mean of first and
last slip have one way, friction gives energy: a point parts at so much less (`wsim.solvers.targets`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import lengths
from wsim.judge.books.courses import Courses, step_of
from wsim.judge.books.forces import Poses, slip
from wsim.judge.books.pressed import pushed_back
from wsim.judge.books.touching import Contacts, Touching
from wsim.judge.evidence.motion import FLOAT32
from wsim.scene.contact import pair_law

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]
    Rows = NDArray[np.intp]

SLIGHT = 0.003  # of a body's speed: what changes by less is no blow
SHOWS = 0.1  # of an approach: where it is less sure than that the frames say nothing of the parting
ACROSS = 0.2  # cosine between the normals of two contacts that do not share a blow
STAYS = 0.05  # of the approach: what was to bounce and parts by less may have done so more than once
SLOW = 2 * 9.81  # [m/s^2]: an approach slower than this times the step is no blow (docs/rigid.md)
SURE = 0.02  # of a step: points that come to touch within it do so together,
APART = 3.0  # and those that do after so many do not


@dataclass(frozen=True)
class Rub:
    """What friction did in a blow, over the mass that the point feels across it: speeds [m/s].

    Coulomb's law asks of the impulses what it asks of forces (Routh 1860): friction takes the slip away, or it is the
    friction's coefficient times the push, and no more, as long as the surfaces slip.
    """

    impulse: float  # of friction; of balls, whose slip keeps its way, what of it is against the slip that is left
    most: float  # the coefficient times the push
    before: float  # the slip as they met
    after: float  # and as they parted
    least: float  # of it, where they slip on: less than most if the slip turned, as friction's way did with it
    unsure: float | None = None  # of the impulse, where it is recorded and the slip is known to keep its way


@dataclass(frozen=True)
class Blow:
    """Two bodies that met once in an interval."""

    interval: int
    one: int  # row of a body, or below 0: what never moves
    two: int
    prims: tuple[str, str]
    approach: float  # [m/s]
    parting: float  # [m/s]
    restitution: float  # by the pair's law
    unsure: float  # of either speed [m/s]: what a step changes, and how far the normal turned
    spent: tuple[float, float]  # of the rebound, by friction that turned the slip round: least and most [m/s]
    rub: Rub | None = None  # where it was one point of both, and neither touched anything else


def blows(evidence: Evidence) -> list[Blow]:
    """All of a recording that stand alone."""
    motion = evidence.motion
    changed = _jumps(evidence) & ~motion.jointed & ~motion.kinematic
    if not changed.any():
        return []
    touching, courses = Touching.of(evidence), Courses(evidence, changed)
    found = []
    for k, one, two in _near(evidence, touching, changed).tolist():
        hit = [row for row in (one, two) if row >= 0 and changed[k, row]]
        when = None if motion.jointed[[row for row in (one, two) if row >= 0]].any() else courses.meet(k, hit)
        blow = None if when is None else _blow(courses, touching, k, (one, two), when)
        found += [blow] if blow is not None else []
    return found


def _near(evidence: Evidence, touching: Touching, changed: Bools) -> Rows:
    """Interval and rows of the pairs that may have met there, (n, 3): near each other at either end, one `changed`."""
    bodies, ks = evidence.body_q.shape[1], np.flatnonzero(changed.any(axis=1))
    reach = np.repeat(np.pad(evidence.motion.reach[ks], ((0, 0), (0, 1))), 2, axis=0)
    frames, rows = np.stack([ks, ks + 1], axis=1).ravel(), np.repeat(np.arange(len(ks)), 2)
    contacts = touching.of_many(evidence.body_q[frames], reach, rows, about=np.repeat(changed[ks], 2, axis=0))
    at = ks[np.maximum(contacts.one, contacts.two) // bodies]
    one, two = (np.where(each >= 0, each % bodies, each) for each in (contacts.one, contacts.two))
    # A blow's push that goes on in the next interval, or began in the one before, may take several steps.
    around = np.pad(changed, ((1, 1), (0, 1))).astype(np.intp)
    straddles = changed & (around[:-2] + around[1:-1] + around[2:] > 1)[:, :-1]
    straddles = np.pad(straddles, ((0, 0), (0, 1)))
    once = ~(straddles[at, one] | straddles[at, two])
    return np.unique(np.column_stack([at, one, two])[once], axis=0)


def _jumps(evidence: Evidence) -> Bools:
    """Where a velocity changes otherwise than in the intervals around and in a fall, (T - 1, B), beyond a step."""
    motion = evidence.motion
    gained = np.concatenate([np.diff(motion.v, axis=0), np.diff(motion.w, axis=0) * motion.radius[:, None]], axis=2)
    fall = np.zeros_like(gained) + motion.h[:, None, None] * np.concatenate([motion.gravity, np.zeros(3)])
    around = np.concatenate([fall[:1], gained, fall[:1]])
    jump = np.min([lengths(gained - other) for other in (around[:-2], around[2:], fall)], axis=0)
    fastest = np.maximum(motion.surface_speed[1:], motion.surface_speed[:-1])
    return np.asarray(jump > 2.0 * evidence.gravity * step_of(evidence) + SLIGHT * fastest)


def _blow(courses: Courses, touching: Touching, k: int, pair: tuple[int, int], when: float) -> Blow | None:
    evidence, motion, dt = courses.evidence, courses.evidence.motion, courses.dt
    before, after = (courses.at(k, side, when) for side in (0, 1))
    reach = 2.0 * APART * dt * float(motion.surface_speed[k : k + 2].max())
    contacts = touching.at(before.q, reach, [row for row in pair if row >= 0])
    closing = _closing(touching, contacts, before)
    ours = np.flatnonzero((contacts.one == pair[0]) & (contacts.two == pair[1]))
    if not len(ours) or closing[ours].max() <= 0.0:
        return None
    approach, lowest = float(closing[ours].max()), float(contacts.gap[ours].min())
    rounding = 8.0 * FLOAT32 * float(np.abs(before.com).max())
    touches, near = (ours[contacts.gap[ours] <= lowest + share * approach * dt + rounding] for share in (SURE, APART))
    jump = max(float(np.linalg.norm(after.v[row] - before.v[row])) for row in pair if row >= 0)
    rest = float(motion.h[k]) - when
    if (
        approach < max(SHOWS * jump, SLOW * dt)
        or len(near) > len(touches)  # they may have been in the blow, or in one of their own
        or abs(lowest) > approach * dt + rounding
        or (k == len(motion.h) - 1 and rest < APART * dt)  # its push may go on beyond what is recorded
        or not _alone(contacts, closing, touches, pair)
    ):
        return None
    shapes = [touching.shapes[s][2] for s in contacts.shapes[touches[0]]]
    law = pair_law(evidence.world, *shapes)
    parting = -_closing(touching, contacts, after)[touches]
    parting[closing[touches] < SHOWS * approach] = np.inf  # they were not in it
    n = int(np.argmin(parting - law.restitution * closing[touches]))
    met, speed = contacts.only(touches[n : n + 1]), float(closing[touches[n]])
    # As bodies fall and turn, and their surfaces do, points that touch a step earlier meet at another speed.
    speeds = speed, -float(parting[n])
    faster = _changing(courses, touching, k, when, met, speeds, 0)
    returns = 0.0 < 2.0 * law.restitution * speed * dt < faster * rest  # it may have bounced and come back,
    # or its rim rolls on from point to point, and each bounces in turn
    returns |= law.restitution > STAYS > abs(parting[n]) / speed and not _balls(evidence, pair)
    # A step takes a blow where it finds the body, above the surface or below: what comes back is slower or faster.
    back = law.restitution * speed
    there = float(np.sqrt(max(back**2 - 2.0 * faster / dt * lowest, 0.0)))
    # Gravity's pull over the step of the blow is on either side of it, whatever else changes by as much the other way.
    either = max(faster, _fallen(courses, met, pair))
    if max(law.restitution, parting[n] / speed) <= STAYS and not _balls(evidence, pair):
        # What stays in touch is carried round on it: how fast its point parts changes within a step as well.
        either = max(either, _changing(courses, touching, k, when, met, speeds, 1))
    unsure = 2.0 * either + abs(there - back) + sum(_off(courses, k, when, met, side) for side in (0, 1))
    parts = float(parting[n])
    slips = [_slip(touching, met, each) for each in (before, after)]
    others = contacts.only(_others(contacts, pair) & (contacts.gap <= approach * dt + rounding))
    if len(others):
        rubs = np.array([-law.friction / max(float(np.linalg.norm(each)), 1e-300) * each for each in slips])
        unsure += pushed_back(motion, touching, before, met, others, speed + parts, rubs)
    if returns or unsure > SHOWS * approach:
        return None
    prims = [touching.shapes[int(shape)][1] for shape in met.shapes[0]]
    across = _across(courses, met, (before, after), speed + parts, pair)
    exactly = min(max(float(across @ (slips[0] + slips[1])) / max(speed + parts, 1e-12), 0.0), back)
    if len(touches) > 1 or _others(contacts, pair).any():
        # One of some points has a share of what all gave that is not known, and no more than its cone allows.
        spent = 0.0, min(len(touches) * exactly, _spent_at_most(slips[0], slips[1], law.friction, unsure), back)
        return Blow(k, *pair, (prims[0], prims[1]), speed, parts, law.restitution, unsure, spent)
    rub = _rub(slips, across, speed + parts, law.friction, _balls(evidence, pair))
    return Blow(k, *pair, (prims[0], prims[1]), speed, parts, law.restitution, unsure, (exactly, exactly), rub)


def _slip(touching: Touching, met: Contacts, poses: Poses) -> Floats:
    """How fast one contact's second surface slips over the first [m/s], (3,)."""
    moves, normal = slip(touching, met, poses)[0], met.normal[0]
    found: Floats = moves - (moves @ normal) * normal
    return found


def _across(
    courses: Courses, met: Contacts, poses: tuple[Poses, Poses], bounce: float, pair: tuple[int, int]
) -> Floats:
    """Friction's impulse on the second of two bodies over the mass that their point feels [m/s], (3,).

    The points of their one contact part by `bounce` [m/s] faster than they met.
    """
    motion, normal = courses.evidence.motion, met.normal[0]
    row, sign = (pair[1], 1.0) if pair[1] >= 0 and not motion.kinematic[pair[1]] else (pair[0], -1.0)
    change = sign * (poses[1].v[row] - poses[0].v[row])  # of the push, and of friction, over the body's mass
    push = float(change @ normal)
    found: Floats = bounce / max(push, 1e-12) * (change - push * normal)
    return found


def _rub(slips: list[Floats], across: Floats, bounce: float, friction: float, balls: bool) -> Rub:
    """Of one contact of a pair, by its slips before and after, and by its friction's impulse."""
    before, after = (float(np.linalg.norm(each)) for each in slips)
    impulse, most = float(np.linalg.norm(across)), friction * bounce
    if after > STAYS * before and balls:
        impulse = -float(across @ slips[1]) / after
        return Rub(impulse, most, before, after, most)
    # The slip of what is no ball turns in a blow, from its first way to its last by one way round (Keller 1986), and
    # friction with it: pushes whose ways are no more than an angle apart add up to its half's cosine of them at least.
    cosine = float(slips[0] @ slips[1]) / max(before * after, 1e-30)
    return Rub(impulse, most, before, after, most * float(np.sqrt(0.5 * max(1.0 + cosine, 0.0))))


def _spent_at_most(before: Floats, after: Floats, friction: float, unsure: float) -> float:
    """What friction may have used up of a point's rebound [m/s], where several share the impulse.

    Its work over half the push, friction being at most the coefficient times the push, and against the slip that is
    left where there is one.
    """
    left = float(np.linalg.norm(after))
    if left <= unsure:
        return friction * float(np.linalg.norm(before))
    return friction * max(-float(before @ after) / left - left, 0.0)


def _changing(
    courses: Courses, touching: Touching, k: int, when: float, contact: Contacts, speeds: tuple[float, float],
    side: int,
) -> float:  # fmt: skip
    """By how much a contact closes faster or slower a step before a blow (side 0), or after it (1) [m/s].

    `speeds` are those with which it closes just before, and just after.
    """
    other = courses.at(k, side, when + (2 * side - 1) * courses.dt)
    reach = 2.0 * abs(speeds[0]) * courses.dt + float(abs(contact.gap[0]))
    contacts = touching.at(other.q, reach, [int(row) for row in (contact.one[0], contact.two[0]) if row >= 0])
    same = np.flatnonzero(np.all(contacts.shapes == contact.shapes[0], axis=1))
    apart = np.linalg.norm(contacts.point[same] - contact.point[0], axis=1)
    if not len(same):
        return abs(speeds[side])
    return float(abs(_closing(touching, contacts, other)[same[int(np.argmin(apart))]] - speeds[side]))


def _off(courses: Courses, k: int, when: float, contact: Contacts, side: int) -> float:
    """By how much the course before a blow (side 0), or after it (1), may err in how fast a contact closes [m/s]."""
    off, com, total = courses.off(k, side, when), courses.at(k, side, when).com, np.zeros(3)
    for row, sign, end in ((int(contact.one[0]), -1.0, 0), (int(contact.two[0]), 1.0, 1)):
        if row >= 0:
            total += sign * (off[row, :3] + np.cross(off[row, 3:], contact.surface(end)[0] - com[row]))
    return abs(float(total @ contact.normal[0]))


def _fallen(courses: Courses, contact: Contacts, pair: tuple[int, int]) -> float:
    """What gravity changes of how fast a contact closes in a step [m/s]: nothing where both bodies fall."""
    motion = courses.evidence.motion
    free = sum(row >= 0 and not motion.kinematic[row] for row in pair)
    return float(abs(motion.gravity @ contact.normal[0])) * courses.dt if free == 1 else 0.0


def _balls(evidence: Evidence, pair: tuple[int, int]) -> bool:
    solid = [[shape for shape in evidence.world.bodies[row].shapes if shape.collides] for row in pair if row >= 0]
    return all(len(shapes) == 1 and shapes[0].kind == "sphere" for shapes in solid)


def _others(contacts: Contacts, pair: tuple[int, int]) -> Bools:
    """Contacts that either body of a pair has with anything else."""
    shared = np.zeros(len(contacts), dtype=bool)
    for row in pair:
        if row >= 0:
            shared |= (contacts.one == row) | (contacts.two == row)
    return shared & ~((contacts.one == pair[0]) & (contacts.two == pair[1]))


def _alone(contacts: Contacts, closing: Floats, touches: Rows, pair: tuple[int, int]) -> bool:
    """Whether neither body has another contact that pushes along the same way, or is hit there, too."""
    shared = _others(contacts, pair)
    along = np.abs(contacts.normal @ contacts.normal[touches].T).max(axis=1, initial=0.0)
    return not np.any(shared & ((along > ACROSS) | (closing > SHOWS * closing[touches].max())))


def _closing(touching: Touching, contacts: Contacts, poses: Poses) -> Floats:
    """How fast each gap closes, (n,) [m/s]."""
    found: Floats = -np.einsum("ni,ni->n", slip(touching, contacts, poses), contacts.normal)
    return found
