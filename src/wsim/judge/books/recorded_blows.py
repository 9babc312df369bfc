"""Blows whose impulses are recorded: how fast the points met, and how fast they parted.

What is recorded says which pair it was, where it pushed and along which normal. What it does not say is when. A body
that gets its impulse J at once is off from its course by J / m times what was left of the interval: where its courses
before and after meet (`wsim.judge.books.followed`) it has the velocities that Newton's law of impact and Coulomb's law
of friction are about. That holds of what hangs on joints, too: whatever passes the impulse on, the points that meet
part as their surfaces have it.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, cross, rotate
from wsim.geometry.shapes import kind_of
from wsim.judge.books.followed import Course, Followed, Pose
from wsim.judge.books.forces import ONE_WAY, STILL
from wsim.judge.books.impacts import ACROSS, APART, SHOWS, SLOW, STAYS, Blow, Rub, comes_back, pushed_out
from wsim.judge.books.pressed import answers
from wsim.judge.books.recorded import RecordedContacts
from wsim.judge.books.touching import Contacts, Touching, together
from wsim.judge.evidence.motion import FLOAT32
from wsim.scene.contact import pair_law

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.contact import Pair

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]
    Rows = NDArray[np.intp]

STEADY = 2.0  # times what a contact gives in the intervals around: more than that is a blow
SHARED = 0.02  # of friction's impulse by the size of a body: points that rub different ways turn it by more
FLAT = 1e-3  # of a push: normals that differ by less are one
VEERS = 0.01  # [m]: surfaces that have met are no farther apart a step later
UNSEEN = 4.0  # times the rounding of a body's momentum: no blow
NONE = 2e-5  # of a push: surfaces without friction have 1e-5, the least that MuJoCo knows


def recorded_blows(evidence: Evidence) -> list[Blow]:
    """All of a recording with contacts that are one pair's, at one instant, with nothing else that strikes either."""
    track = evidence.recording.contacts
    if track is None or not len(track.frame) or not len(evidence.motion.mass):
        return []
    books = RecordedBlows(evidence, RecordedContacts(evidence, track))
    return [blow for row in books.candidates if (blow := books.blow(int(row))) is not None]


class RecordedBlows:
    """What the rows of a recording's contacts say of blows; n rows, T - 1 intervals, B bodies."""

    def __init__(self, evidence: Evidence, contacts: RecordedContacts) -> None:
        self._evidence, self._contacts, self._motion = evidence, contacts, evidence.motion
        track = contacts.track
        self._pressed = np.maximum(track.pressed.astype(np.float64), 1e-30)
        self._normal = track.along.astype(np.float64) / self._pressed[:, None]
        count = np.int64(len(contacts.shapes))
        self._key = (track.frame.astype(np.int64) * count + track.pair[:, 0]) * count + track.pair[:, 1]
        self._hits = self._pressed > np.maximum(STEADY * np.minimum(self._at(-1), self._at(1)), self._unseen())
        unit = np.append(np.where(self._motion.kinematic, -1, self._motion.unit), -1)
        self._unit = unit[contacts.body]  # (n, 2) of each row's mechanisms, -1 for what gives no way
        self._followed = Followed(evidence, self._struck)
        moving = [body.prim for body in evidence.world.bodies for _ in body.shapes]
        self._owners = moving + [still.prim for still in evidence.world.statics for _ in still.shapes]

    @property
    def candidates(self) -> Rows:
        """Rows that may be a blow by themselves."""
        return np.flatnonzero(self._hits & (self._contacts.track.frame > 0) & (self._unit >= 0).any(axis=1))

    def _at(self, later: int) -> Floats:
        """What each row's pair presses with so many intervals later, (n,) [N s]."""
        order, key = np.argsort(self._key, kind="stable"), self._key
        other = key + later * np.int64(len(self._contacts.shapes)) ** 2
        place = order[np.minimum(np.searchsorted(key[order], other), len(key) - 1)]
        return np.where(key[place] == other, self._pressed[place], 0.0)

    def _unseen(self) -> Floats:
        """An impulse that is lost in the rounding of its bodies' momentum, (n,) [N s]: what grazes has any normal."""
        bodies, motion = self._contacts.body, self._motion
        rows = np.maximum(bodies, 0)
        of_each = motion.mass[rows] * motion.speed[self._contacts.track.frame[:, None], rows]
        return np.asarray(UNSEEN * FLOAT32 * np.where(bodies >= 0, of_each, 0.0).max(axis=1))

    @cached_property
    def _struck(self) -> Bools:
        """Whether something strikes a body's mechanism in an interval, (T - 1, B): a contact, or a joint's stop."""
        found, unit = np.zeros((len(self._motion.h), len(self._motion.mass)), dtype=bool), self._motion.unit
        hits = self._hits & (self._contacts.track.frame > 0)
        for frame, ours in zip(self._contacts.track.frame[hits], self._unit[hits], strict=True):
            found[frame - 1] |= np.isin(unit, ours[ours >= 0])
        return found | self._stopped

    @cached_property
    def _stopped(self) -> Bools:
        """Whether a stop pushes in a body's mechanism, or a rope that may come taut is tied to it, (T - 1, B)."""
        found, unit = np.zeros((len(self._motion.h), len(self._motion.mass)), dtype=bool), self._motion.unit
        ties = self._contacts.ties
        if ties is None:
            return found | (self._motion.jointed & ~self._motion.kinematic)
        for k, pair in enumerate(ties.pairs):
            stops = np.asarray(ties.track.stop[1:, k]) != 0.0
            found[np.ix_(stops, np.isin(unit, unit[[row for row in pair if row >= 0]]))] = True
        springs = len(self._evidence.world.springs)
        roped = [row for cord, row in ties.ends if cord >= springs]
        return found | np.isin(unit, unit[roped])

    # ---- one of them
    def blow(self, row: int) -> Blow | None:
        """The blow of a row; None where it is not one alone, or frames do not tell how fast its points met."""
        contacts, motion = self._contacts, self._motion
        k, bodies, normal = int(contacts.track.frame[row]) - 1, contacts.body[row].tolist(), self._normal[row]
        if abs(float(np.linalg.norm(normal)) - 1.0) > FLAT or not self._alone(row):
            return None
        one, two = (self._followed.course(body, k, self._flies(row, side)) for side, body in enumerate(bodies))
        if one is None or two is None:
            return None
        when = self._followed.meet([each for each in (one, two) if each.gives])
        if when is None:
            return None
        point = contacts.track.point[row].astype(np.float64)
        poses = [(one.at(side, when), two.at(side, when)) for side in (0, 1)]
        slips = [b.at(point) - a.at(point) for a, b in poses]
        law = pair_law(self._evidence.world, *(contacts.shapes[shape] for shape in contacts.track.pair[row].tolist()))
        approach, parting = -float(slips[0] @ normal), float(slips[1] @ normal)
        if approach <= 0.0:  # they do not meet: nothing below holds of them
            return None
        pull = self._followed.pull(one, two, when, point, normal)
        deep = max(0.5 * approach * self._followed.dt, self._depth(row, poses[0], point))
        unsure = _step_leaves(approach, law.restitution, pull / self._followed.dt, deep) + pull
        unsure += pushed_out(approach, law.restitution, motion.step)
        unsure += one.off(when, point) + two.off(when, point)
        unsure += max(self._followed.turned(each, point, 2) for each in poses)
        if law.restitution <= STAYS:
            unsure += self._veers(row, (one, two), when)
        unsure += self._answered(row, (one, two), when, approach, law)
        rest = float(motion.h[k]) - when
        if approach < SLOW * self._followed.dt + unsure:
            return None
        dt, bounces = self._followed.dt, law.restitution > STAYS
        soonest = comes_back(law.restitution * approach, pull / dt, 2.0 * deep) if bounces else np.inf
        if unsure > SHOWS * approach or soonest < rest + dt or self._stays(row, law):
            return None  # too slow, or it may have bounced and come back, or it is pressed on
        first, second = (self._owners[shape] for shape in contacts.track.pair[row].tolist())
        slides = "slides" in (one.kind, two.kind)  # what else rubs may change its slip at once, before frames show it
        rub = None if slides else self._rub(row, law, slips, poses, point)
        spent, doubt = self._spent(row, law, slips, poses, point, law.restitution * approach)
        return Blow(
            k, bodies[0], bodies[1], (first, second), approach, parting, law.restitution, unsure + doubt, spent, rub
        )

    def _alone(self, row: int) -> bool:
        """Whether nothing else strikes what the pair's bodies are part of in the interval, or pushes along the blow."""
        frame, rows = self._contacts.track.frame, np.arange(len(self._hits))
        for unit, body in zip(self._unit[row], self._contacts.body[row], strict=True):
            with_it = (frame == frame[row]) & (rows != row) & (self._unit == unit).any(axis=1) & (unit >= 0)
            if np.any(self._hits[with_it] | (np.abs(self._normal[with_it] @ self._normal[row]) > ACROSS)):
                return False
            if unit >= 0 and self._stopped[frame[row] - 1, body]:
                return False
        return True

    def _flies(self, row: int, side: int) -> bool:
        """Whether nothing but the blow and gravity acts on a body of the pair in its interval."""
        frame, body, unit = self._contacts.track.frame, int(self._contacts.body[row, side]), self._unit[row, side]
        if body < 0 or self._motion.jointed[body]:
            return False
        return int(np.sum((frame == frame[row]) & (self._unit == unit).any(axis=1))) == 1

    def _stays(self, row: int, law: Pair) -> bool:
        """Whether the pair goes on to press where it does not bounce: what it gives after the blow is in the sum."""
        return law.restitution <= STAYS and bool(self._at(1)[row] > 0.0)

    def _veers(self, row: int, courses: tuple[Course, Course], when: float) -> float:
        """By how much a pair parts faster or slower a step after the blow, where it touches then [m/s].

        What does not bounce is stopped in two steps: the first leaves it as fast as its gap asks for. Place and normal
        that are recorded are means of both; surfaces part as the second has it.
        """
        rates = []
        for later in (when, when + self._followed.dt):
            poses, contacts = self._touching(row, courses, (1, later), VEERS)
            if not len(contacts):
                return np.inf
            n = int(np.argmin(contacts.gap))
            rates.append(-float(_closing(contacts, poses)[n]))
        return abs(rates[1] - rates[0])

    def _answered(self, row: int, courses: tuple[Course, Course], when: float, approach: float, law: Pair) -> float:
        """By how much points of the pair that met one after another change how fast their mean parts [m/s].

        Where two come down within a step, the one that is met second is met as the first blow leaves it, and its own
        changes how fast the first parts: of both impulses' mean place Newton's law says nothing (`answers`). What the
        others had of the impulse the place tells. All that meet at once part at e, and so does their mean; of two that
        do not, one parts at less and the other at more (of what rubs not), which then is the bound.
        """
        dt, point = self._followed.dt, self._contacts.track.point[row].astype(np.float64)
        poses, contacts = self._touching(row, courses, (0, when), 2.0 * APART * approach * dt)
        near = contacts.only(contacts.gap <= contacts.gap.min(initial=np.inf) + APART * approach * dt)
        if len(near) < 2:
            return 0.0
        closing, opening = _closing(near, poses), -_closing(near, (courses[0].at(1, when), courses[1].at(1, when)))
        differ = float(np.ptp(opening / closing)) if closing.min() > 0.0 else np.inf
        first = int(np.argmin(np.linalg.norm(near.point - point, axis=1)))
        apart = np.delete(near.point, first, axis=0) - near.point[first]
        share = np.clip(apart @ (point - near.point[first]) / np.maximum(np.sum(apart**2, axis=1), 1e-30), 0.0, 1.0)
        if any(each.kind in ("hangs", "slides") for each in courses):
            return differ * approach  # what passes the impulse on is not known
        free = [
            (pose, float(self._motion.mass[each.body]), self._motion.inertia[each.body])
            for each, pose in zip(courses, poses, strict=True)
            if each.gives
        ]
        answer = [answers(free, self._normal[row], near.point[first], near.point[first] + arm, law) for arm in apart]
        return min(differ * approach, float(share @ answer) * float(self._pressed[row]))

    def _touching(
        self, row: int, courses: tuple[Course, Course], at: tuple[int, float], reach: float
    ) -> tuple[tuple[Pose, Pose], Contacts]:
        """Both bodies of a row at an instant, as they went before its blow (0) or after (1), and where they touch."""
        bodies, q = self._contacts.body[row].tolist(), self._evidence.body_q[courses[0].k + 1].copy()
        one, two = (each.at(*at) for each in courses)
        for body, pose in zip(bodies, (one, two), strict=True):
            if body >= 0:
                com = np.array(self._evidence.world.bodies[body].com)
                q[body] = np.concatenate([pose.com - rotate(pose.q, com), pose.q])
        touching = Touching.of(self._evidence)
        contacts = touching.at(q, reach)
        ends = [
            (body, self._contacts.shapes[shape].prim)
            for body, shape in zip(bodies, self._contacts.track.pair[row].tolist(), strict=True)
        ]
        met = [
            [(touching.shapes[shape][0], touching.shapes[shape][2].prim) for shape in pair]
            for pair in contacts.shapes.tolist()
        ]
        ours, turned = (
            contacts.only(np.array([pair == way for pair in met], dtype=bool)) for way in (ends, ends[::-1])
        )
        return (one, two), together([ours, replace(turned, one=turned.two, two=turned.one, normal=-turned.normal)])

    def _depth(self, row: int, poses: tuple[Pose, Pose], point: Floats) -> float:
        """How far the surfaces are in each other or apart where they push, halfway between them [m]; 0 of meshes."""
        found = 0.0
        for body, number, pose in zip(self._contacts.body[row], self._contacts.track.pair[row], poses, strict=True):
            shape, local = self._contacts.shapes[int(number)], point
            if shape.kind == "mesh":
                continue
            if body >= 0:
                local = rotate(conjugate(pose.q), point - pose.com) + np.array(self._evidence.world.bodies[body].com)
            own = rotate(conjugate(np.array(shape.rotation)), local - np.array(shape.position))
            found = max(found, 2.0 * abs(float(kind_of(shape).depth(own[None])[0])))
        return found

    def _spent(
        self, row: int, law: Pair, slips: list[Floats], poses: list[tuple[Pose, Pose]], point: Floats, back: float
    ) -> tuple[tuple[float, float], float]:
        """What friction that turned the slip round took of the rebound, least and most, and how unsure that is [m/s].

        P_t (v_t + v_t') / P_n (`wsim.solvers.targets`); of points that rub different ways, no more than cones allow.
        """
        normal, pressed = self._normal[row], float(self._pressed[row])
        given = self._contacts.track.impulse[row].astype(np.float64)
        share = (given - (given @ normal) * normal) / pressed
        doubt = float(np.linalg.norm(share)) * self._followed.turned(poses[1], point, 1)
        moved = slips[0] + slips[1]
        exactly = float(np.clip(share @ moved, 0.0, back))
        if self._one_way(row, [each.com for each in poses[0]], point, given, share * pressed):
            return (exactly, exactly), doubt if exactly > 0.0 or float(share @ moved) > -doubt else 0.0
        most = law.friction * float(np.linalg.norm(moved - (moved @ normal) * normal))
        return (0.0, min(max(exactly, most), back)), doubt

    def _one_way(self, row: int, coms: list[Floats], point: Floats, given: Floats, along: Floats) -> bool:
        """Whether all points of the pair rub the same way: their impulses turn the bodies as one at their mean does."""
        for side, (com, sign) in enumerate(zip(coms, (-1.0, 1.0), strict=True)):
            body = int(self._contacts.body[row, side])
            if body < 0:
                continue
            turn = self._contacts.track.turn[row, side] - sign * cross(point - com, given)
            if np.linalg.norm(turn) > SHARED * self._motion.radius[body] * np.linalg.norm(along):
                return False
        return True

    def _rub(
        self, row: int, law: Pair, slips: list[Floats], poses: list[tuple[Pose, Pose]], point: Floats
    ) -> Rub | None:
        """What friction did, where its points slip one way throughout; else nothing says how much of it acted."""
        contacts, normal, pressed = self._contacts, self._normal[row], float(self._pressed[row])
        across = [slip - (slip @ normal) * normal for slip in slips]
        before, after = (float(np.linalg.norm(each)) for each in across)
        cosine = float(across[0] @ across[1]) / max(before * after, 1e-30)
        given = contacts.track.impulse[row].astype(np.float64)
        along = given - (given @ normal) * normal
        if law.rolling or cosine < ONE_WAY or after < STILL + 2.0 * self._followed.turned(poses[1], point, 1):
            return None
        rubs = float(np.linalg.norm(along))
        if rubs > NONE * pressed and not self._one_way(row, [each.com for each in poses[0]], point, given, along):
            return None
        scale = float((slips[1] - slips[0]) @ normal) / pressed
        way = across[0] / before + across[1] / after
        impulse = -float(along @ way) / float(np.linalg.norm(way))
        if impulse < ONE_WAY * rubs - NONE * pressed:
            return None  # what is left of the slip is what turning makes of it
        most = law.friction * pressed
        unsure = ((1.0 - cosine) * most + NONE * pressed) * scale
        return Rub(impulse * scale, most * scale, before, after, most * scale, unsure)


def _closing(contacts: Contacts, poses: tuple[Pose, Pose]) -> Floats:
    """How fast two bodies close in on each other where they touch, (n,) [m/s]."""
    one, two = poses
    return np.array([(one.at(at) - two.at(at)) @ way for at, way in zip(contacts.point, contacts.normal, strict=True)])


def _step_leaves(approach: float, restitution: float, pull: float, deep: float) -> float:
    """By how much a step changes the speed at which points part, as it finds them above the surface or below [m/s].

    What is z above it comes back as if it had gone there and back: v'^2 = e^2 (v^2 - 2 a z) + 2 a z. That is up to half
    of what it goes in a step, and more where another end of the body was hit the step before.
    """
    change, back = 2.0 * (1.0 - restitution**2) * pull * deep, restitution * approach
    return max(abs(float(np.sqrt(max(back**2 + sign * change, 0.0))) - back) for sign in (-1.0, 1.0))
