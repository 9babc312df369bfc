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

from wsim.geometry.rotations import cross
from wsim.judge.books.courses import Courses
from wsim.judge.books.encounters import APART, Met, about, jumps, meets, near
from wsim.judge.books.pressed import pushed_back
from wsim.judge.books.touching import touching_of
from wsim.judge.evidence.motion import FLOAT32
from wsim.judge.evidence.scheduled import pushes
from wsim.scene.contact import pair_law

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.judge.books.touching import Contacts, Touching
    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.evidence.motion import Motion
    from wsim.scene.contact import Pair

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]
    Rows = NDArray[np.intp]

SHOWS = 0.1  # of an approach: where it is less sure than that the frames say nothing of the parting
ACROSS = 0.2  # cosine between the normals of two contacts that do not share a blow
STAYS = 0.05  # of the approach: what was to bounce and parts by less may have done so more than once
SLOW = 2 * 9.81  # [m/s^2]: an approach slower than this times the step is no blow (docs/rigid.md)
REACH = 0.01  # [m]: gap at which wsim's contacts act; what goes farther in a step may be found in what it hits
FADES, FADING = 0.02, 0.5  # [s], [m/s]: time in which such overlap fades, at this speed at most (docs/rigid.md)
SURE = 0.02  # of a step: points that come to touch within it do so together


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


@dataclass(frozen=True)
class Point:
    """The point of a pair that parts least for its restitution, of those that meet as it does."""

    of: Met
    met: Contacts  # its own
    touches: int  # how many they are
    approach: float  # of the fastest of them [m/s]
    lowest: float  # gap of the pair [m]
    speed: float  # at which it closes [m/s]
    parting: float  # and opens after
    slips: tuple[Floats, Floats]  # along the surface, before and after, (3,) [m/s]
    law: Pair
    balls: bool  # whether they are

    @property
    def stays(self) -> bool:
        """Whether it is carried round on what it met, and how fast it parts changes within a step."""
        return max(self.law.restitution, self.parting / self.speed) <= STAYS and not self.balls


def tells(evidence: Evidence) -> bool:
    """Whether a recording tells of blows without their impulses: its velocities are its own, and contacts are rigid.

    Other engines' contacts are soft and state no restitution.
    """
    recording, world = evidence.recording, evidence.world
    if world.combine != "smaller" or recording.metadata.get("velocities") == "differences":
        return False
    return not (world.fluids or recording.metadata.get("controlled") or pushes(world))


def pushed_out(approach: float, restitution: float, step: float) -> float:
    """How fast a stated time step may leave what does not bounce on its way out of what it hit [m/s].

    What is farther away than `REACH` as a step begins is found by the next in the other surface, by up to v dt - REACH.
    Nothing of a step that nobody states, 0.
    What bounces is brought back to the surface by its own law.
    """
    deep = approach * step - REACH if restitution == 0.0 else 0.0
    return min(max(deep, 0.0) / FADES, FADING)


def comes_back(back: float, pull: float, travel: float) -> float:
    """How soon at least what bounces may be back [s]; inf of what does not, or is not pulled back.

    A step takes a blow where it finds the body, up to what that goes in a step above the surface, and there it has the
    speed of a bounce from the surface: from z above it comes down in (sqrt(back^2 - 2 pull z) + back) / pull, and from
    where it would turn in half the time of a bounce.

    Args:
        back: The speed at which it leaves the surface [m/s].
        pull: By what forces pull it back [m/s^2].
        travel: What it goes in a step [m].
    """
    if back <= 0.0 or pull <= 0.0:
        return float("inf")
    return float(back + np.sqrt(max(back**2 - 2.0 * pull * travel, 0.0))) / pull


def blows(copies: Sequence[Evidence]) -> list[list[Blow]]:
    """All of each of some recordings that stand alone; of worlds that are `similar`, over the same times."""
    motion = copies[0].motion
    changed = jumps(copies) & ~motion.jointed & ~motion.kinematic  # (W, T - 1, B)
    found: list[list[Blow]] = [[] for _ in copies]
    if not changed.any():
        return found
    touching, courses = touching_of(copies), Courses(copies, changed)
    flat = changed.reshape(-1, changed.shape[2])
    pairs = [(k, (one, two)) for k, one, two in near(copies, touching, changed).tolist()]
    pairs = [(k, pair) for k, pair in pairs if not any(row >= 0 and motion.jointed[row] for row in pair)]
    whens = courses.meet([(k, tuple(row for row in pair if row >= 0 and flat[k, row])) for k, pair in pairs])
    met = [(*each, when) for each, when in zip(pairs, whens, strict=True) if when is not None]
    points = [point for each in meets(courses, touching, met) if (point := _point(courses, touching, each))]
    faster = _changing(courses, touching, points, 0)
    staying = [point for point in points if point.stays]
    after = iter(_changing(courses, touching, staying, 1))
    for point, change in zip(points, faster, strict=True):
        blow = _blow(courses, touching, point, change, next(after) if point.stays else 0.0)
        if blow is not None:
            found[point.of.k // courses.count].append(blow)
    return found


def _closing(contacts: Contacts, slips: Floats) -> Floats:
    """How fast each gap closes, (n,) [m/s]."""
    return -np.einsum("ni,ni->n", slips, contacts.normal)


def _point(courses: Courses, touching: Touching, of: Met) -> Point | None:
    """The point that tells how two bodies part; None where theirs is no blow that stands alone."""
    copy, k = divmod(of.k, courses.count)
    evidence, pair, contacts, dt = courses.copies[copy], of.pair, of.contacts, float(courses.dt[copy])
    closing, opening = _closing(contacts, of.slips[0]), -_closing(contacts, of.slips[1])
    ours = np.flatnonzero((contacts.one == pair[0]) & (contacts.two == pair[1]))
    if not len(ours) or closing[ours].max() <= 0.0:
        return None
    approach, lowest = float(closing[ours].max()), float(contacts.gap[ours].min())
    rounding = _rounding(of)
    touches, close = (ours[contacts.gap[ours] <= lowest + share * approach * dt + rounding] for share in (SURE, APART))
    jump = max(float(np.linalg.norm(of.after.v[row] - of.before.v[row])) for row in pair if row >= 0)
    rest = float(evidence.motion.h[k]) - of.when
    if (
        approach < max(SHOWS * jump, SLOW * dt)
        or len(close) > len(touches)  # they may have been in the blow, or in one of their own
        or abs(lowest) > approach * dt + rounding
        or (k == courses.count - 1 and rest < APART * dt)  # its push may go on beyond what is recorded
        or not _alone(contacts, closing, touches, pair)
    ):
        return None
    law = pair_law(evidence.world, *(touching.shapes[s][2] for s in contacts.shapes[touches[0]]))
    parting = opening[touches]
    parting[closing[touches] < SHOWS * approach] = np.inf  # they were not in it
    n = int(np.argmin(parting - law.restitution * closing[touches]))
    at = touches[n]
    along = [_along(slips[at], contacts.normal[at]) for slips in of.slips]
    met, speed = contacts.only(touches[n : n + 1]), float(closing[at])
    return Point(
        of, met, len(touches), approach, lowest, speed, float(parting[n]), (along[0], along[1]), law,
        _balls(evidence, pair),
    )  # fmt: skip


def _rounding(of: Met) -> float:
    return 8.0 * FLOAT32 * float(np.abs(of.before.com).max())


def _blow(courses: Courses, touching: Touching, point: Point, faster: float, after: float) -> Blow | None:
    """What a point tells of its blow, if it does.

    Args:
        courses: Of all bodies.
        touching: Their shapes.
        point: It.
        faster: By how much it closes faster or slower a step before, as bodies fall and turn, and their surfaces do.
        after: And a step after, where it stays.
    """
    of, pair, law, speed, contacts = point.of, point.of.pair, point.law, point.speed, point.of.contacts
    copy, k = divmod(of.k, courses.count)
    evidence, dt = courses.copies[copy], float(courses.dt[copy])
    motion = evidence.motion
    rest, rounding = float(motion.h[k]) - of.when, _rounding(of)
    returns = comes_back(law.restitution * speed, faster / dt, speed * dt) < rest + dt
    # or its rim rolls on from point to point, and each bounces in turn
    returns |= law.restitution > STAYS > abs(point.parting) / speed and not point.balls
    # A step takes a blow where it finds the body, above the surface or below: what comes back is slower or faster.
    back = law.restitution * speed
    there = float(np.sqrt(max(back**2 - 2.0 * faster / dt * point.lowest, 0.0)))
    # Gravity's pull over the step of the blow is on either side of it, whatever else changes by as much the other way.
    either = max(faster, _fallen(motion, dt, point.met, pair), after)
    unsure = 2.0 * either + abs(there - back) + pushed_out(speed, law.restitution, motion.step)
    unsure += sum(_off(courses, point, side) for side in (0, 1))
    parts, slips = point.parting, point.slips
    others = contacts.only(_others(contacts, pair) & (contacts.gap <= point.approach * dt + rounding))
    if len(others):
        rubs = np.array([-law.friction / max(float(np.linalg.norm(each)), 1e-300) * each for each in slips])
        unsure += pushed_back(motion, touching, of.before, point.met, others, speed + parts, rubs)
    if returns or unsure > SHOWS * point.approach:
        return None
    one, two = (touching.shapes[int(shape)][1] for shape in point.met.shapes[0])
    across = _across(motion, point)
    exactly = min(max(float(across @ (slips[0] + slips[1])) / max(speed + parts, 1e-12), 0.0), back)
    if point.touches > 1 or _others(contacts, pair).any():
        # One of some points has a share of what all gave that is not known, and no more than its cone allows.
        spent = 0.0, min(point.touches * exactly, _spent_at_most(slips[0], slips[1], law.friction, unsure), back)
        return Blow(k, *pair, (one, two), speed, parts, law.restitution, unsure, spent)
    rub = _rub(slips, across, speed + parts, law.friction, point.balls)
    return Blow(k, *pair, (one, two), speed, parts, law.restitution, unsure, (exactly, exactly), rub)


def _along(moves: Floats, normal: Floats) -> Floats:
    """What of a contact's slip (3,) is along its surface."""
    found: Floats = moves - (moves @ normal) * normal
    return found


def _across(motion: Motion, point: Point) -> Floats:
    """Friction's impulse on the second of two bodies over the mass that their point feels [m/s], (3,)."""
    of, normal, bounce = point.of, point.met.normal[0], point.speed + point.parting
    row, sign = (of.pair[1], 1.0) if of.pair[1] >= 0 and not motion.kinematic[of.pair[1]] else (of.pair[0], -1.0)
    change = sign * (of.after.v[row] - of.before.v[row])  # of the push, and of friction, over the body's mass
    push = float(change @ normal)
    found: Floats = bounce / max(push, 1e-12) * (change - push * normal)
    return found


def _rub(slips: tuple[Floats, Floats], across: Floats, bounce: float, friction: float, balls: bool) -> Rub:
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


def _changing(courses: Courses, touching: Touching, points: list[Point], side: int) -> list[float]:
    """By how much each contact closes faster or slower a step before its blow (side 0), or after it (1) [m/s]."""
    if not points:
        return []
    ks = np.array([point.of.k for point in points])
    dt, speeds = courses.dt[ks // courses.count], [(point.speed, -point.parting)[side] for point in points]
    whens = np.array([point.of.when for point in points]) + (2 * side - 1) * dt
    gaps = np.array([abs(point.met.gap[0]) for point in points])
    reach = 2.0 * np.abs([point.speed for point in points]) * dt + gaps
    pairs = [point.of.pair for point in points]
    every, slips, parts = about(courses, touching, ks, [courses.at(ks, side, whens)], reach, pairs)
    found = []
    for point, speed, contacts, part in zip(points, speeds, every, parts, strict=True):
        same = np.flatnonzero(np.all(contacts.shapes == point.met.shapes[0], axis=1))
        apart = np.linalg.norm(contacts.point[same] - point.met.point[0], axis=1)
        closing = _closing(contacts, slips[0][part])
        found.append(abs(float(closing[same[int(np.argmin(apart))]]) - speed) if len(same) else abs(speed))
    return found


def _off(courses: Courses, point: Point, side: int) -> float:
    """By how much the course before a blow (side 0), or after it (1), may err in how fast a contact closes [m/s]."""
    of, contact, total = point.of, point.met, np.zeros(3)
    off, com = courses.off(of.k, side, of.when), (of.before, of.after)[side].com
    for row, sign, end in ((int(contact.one[0]), -1.0, 0), (int(contact.two[0]), 1.0, 1)):
        if row >= 0:
            total += sign * (off[row, :3] + cross(off[row, 3:], contact.surface(end)[0] - com[row]))
    return abs(float(total @ contact.normal[0]))


def _fallen(motion: Motion, dt: float, contact: Contacts, pair: tuple[int, int]) -> float:
    """What gravity changes of how fast a contact closes in a step [m/s]: nothing where both bodies fall."""
    free = sum(row >= 0 and not motion.kinematic[row] for row in pair)
    return float(abs(motion.gravity @ contact.normal[0])) * dt if free == 1 else 0.0


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
