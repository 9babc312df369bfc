"""Where energy goes: what friction, blows, stops, dampers and ropes that come taut may take, by what is recorded.

A loss has something that takes it. Of each recorded impulse the most that it may take is known from its law: friction
takes its impulse times the slip, a blow with restitution e the share (1 - e) / 2 of its impulse times the approach
(Newton's law: P (v + v') / 2 with v' = -e v), rolling resistance its torque times the turning, dry friction in a joint
and a stop their impulses times the joint's speed, a damper c times the square of its own. What of them frames cannot
tell is taken for the most that it may be. What two bodies do to each other is lost to none but both: the books are
those of all that hangs together or has touched.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from wsim.geometry.rotations import rotate
from wsim.judge.books import relaxing
from wsim.judge.books.driven import changes_hands
from wsim.judge.books.led import STEADY, Led, late, told
from wsim.judge.books.phases import sinking
from wsim.judge.books.recorded import RecordedContacts
from wsim.judge.books.recorded_ties import OWN
from wsim.judge.books.rubbing import beside, taken
from wsim.judge.books.worked import worked
from wsim.judge.evidence.carriers import leads, surface_speed
from wsim.judge.evidence.cords import track_of_spring
from wsim.judge.evidence.motion import FLOAT32
from wsim.scene.contact import pair_law

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]
    Rows = NDArray[np.intp]

STRAY = 0.2  # of the way of a step: places that are farther off tell nothing of the steps' order
WINDOW = 5  # intervals
HOPS = 2.0  # steps of gravity


@dataclass(frozen=True)
class Taken:
    """What may have gone from some bodies since the start, (T,) each [J]."""

    damped: Floats  # by springs' dampers, by their law
    most: Floats  # by all else, at most
    least: Floats  # of that, by friction at least; asked of what something leads
    unsure: Floats  # of the work of drives, of dampers and of what is led
    driven: Floats  # what drives put in, and what is led
    held: float  # what drives hold as springs do, from its least to its most [J]


class Losses:
    """What may take the energy of a world's bodies; of recordings with contacts, and with ties where there are any."""

    def __init__(self, evidence: Evidence, contacts: RecordedContacts) -> None:
        self._evidence, self._contacts = evidence, contacts
        self._motion, self.ties = evidence.motion, contacts.ties

    @staticmethod
    def of(evidence: Evidence) -> Losses | None:
        """None where what acts is not recorded, or is work that is not known."""
        recording, world = evidence.recording, evidence.world
        if recording.contacts is None or not told(evidence) or world.fluids or recording.metadata.get("controlled"):
            return None
        if world.schedules:
            return None  # what they give within a step was not measured
        about = recording.metadata
        if str(about.get("device", "cpu")) != "cpu" or int(about.get("world_count") or 1) > 1:
            return None  # what single precision loses was not measured
        if any(not joint.drive.told or joint.kind not in OWN for joint in world.joints if joint.drive is not None):
            return None
        return Losses(evidence, RecordedContacts(evidence, recording.contacts))

    @cached_property
    def whole(self) -> bool:
        """Whether the groups are all that moves by itself."""
        return sum(len(rows) for rows in self.groups) == int((~self._motion.kinematic).sum())

    @cached_property
    def groups(self) -> list[Rows]:
        """The bodies that hang together or touch at some time, but not those that touch a mesh's triangles.

        From facet to facet a step turns the normal, and what of the velocity is along the new one is lost in no blow
        that frames show.
        """
        motion, unit = self._motion, self._motion.unit.copy()
        exact = np.array([shape.exact for shape in self._contacts.shapes], dtype=bool)[self._contacts.track.pair]
        faceted = set(self._contacts.body[exact.any(axis=1)].ravel().tolist())
        for one, two in np.unique(self._contacts.body, axis=0).tolist():
            if min(one, two) >= 0 and not motion.kinematic[[one, two]].any():
                unit[unit == unit[two]] = unit[one]
        found = [np.flatnonzero((unit == each) & ~motion.kinematic) for each in np.unique(unit)]
        return [rows for rows in found if len(rows) and not faceted & set(rows.tolist())]

    def of_group(self, rows: Rows) -> Taken:
        """What may have gone from a group of bodies."""
        intervals, ours = len(self._motion.h), set(rows.tolist())
        most, least, unsure, driven = (np.zeros(intervals) for _ in range(4))
        inside = np.isin(self._contacts.body, rows).any(axis=1) & (self._contacts.track.frame > 0)
        frame = self._contacts.track.frame[inside] - 1
        led = Led.of(self._evidence)
        lost, rubbed = self._by_contacts(rows), np.zeros(len(inside))
        if led.work[:, rows].any():
            rubbed, most_rubbed, goes_on = self._rubs
            lost = np.where(goes_on, np.maximum(lost, most_rubbed), np.minimum(lost, most_rubbed))
        most += np.bincount(frame, lost[inside], intervals)
        least += np.bincount(frame, rubbed[inside], intervals)
        damped, off = self._damped(ours)
        if self.ties is not None:
            for k, pair in enumerate(self.ties.pairs):
                if ours & set(pair) and self.ties.joints[k].kind in OWN:
                    most += self._of_joint(k)
            most += self._jerked(ours)
            driven, unsure = worked(self._evidence, self.ties, ours)
        damped, most, least, unsure, driven = (
            np.concatenate([[0.0], np.cumsum(each)]) for each in (damped, most, least, unsure + off, driven)
        )
        driven = driven + (led.work + led.late)[:, rows].sum(axis=1)
        unsure = unsure + led.unsure[:, rows].sum(axis=1)
        return Taken(damped, most, least, unsure, driven, changes_hands(self._evidence, rows))

    # ---- contacts
    def _by_contacts(self, rows: Rows) -> Floats:
        """What each recorded contact may take at most, (n,) [J]."""
        contacts, motion = self._contacts, self._motion
        track, frame = contacts.track, np.maximum(contacts.track.frame, 1)
        pressed = np.maximum(track.pressed.astype(np.float64), 1e-30)
        normal = track.along.astype(np.float64) / pressed[:, None]
        closing = np.abs(np.einsum("nei,ni->ne", contacts.slip, normal)).max(axis=1)
        across = contacts.slip - np.einsum("nei,ni->ne", contacts.slip, normal)[..., None] * normal[:, None]
        slip = np.linalg.norm(across, axis=2).max(axis=1)
        h = motion.h[frame - 1]
        fall = self._evidence.gravity * h
        closes = np.abs(np.einsum("ni,ni->n", contacts.slip[:, 0], normal))
        speeds, steady = self._within(rows, (pressed > self._steady) | (closes > 2.0 * fall))
        bounce, rolling = self._laws
        # What stands may have been set down from a hair above: a blow. What hops in each interval presses as evenly as
        # what stands; but that comes or goes at no end by more than a step's fall.
        hops = (bounce > 0.0) & (closing > HOPS * self._evidence.gravity * motion.dt)
        lasts = np.where((track.frame == 1) | hops, 0.0, steady)
        hit = pressed > steady
        many = hit & self._shared  # a blow goes on to others, and frames show nothing of how fast
        approach = np.where(many, speeds[0], closing) + fall
        slip = np.where(many, np.maximum(slip, speeds[1]), slip + np.where(pressed > lasts, fall, 0.0))
        blow = 0.5 * (1.0 - bounce) * np.where(hit, pressed - steady, 0.0) * approach
        # One that surfaces still come nearer in at the end goes on: its part loses by the mean of both speeds.
        goes_on = np.maximum(-np.einsum("ni,ni->n", contacts.slip[:, 1], normal), 0.0)
        goes_on = np.where(hit & (goes_on > fall), goes_on + bounce * approach, 0.0)
        blow += 0.5 * np.where(hit, pressed - steady, 0.0) * goes_on
        blow += 0.5 * (1.0 - bounce) * (np.minimum(pressed, steady) - np.minimum(pressed, lasts)) * (closing + fall)
        blow += np.where(
            bounce > 0.0, pressed * self._evidence.gravity * motion.dt, 0.0
        )  # a slower one does not bounce
        # What rocks from edge to edge meets at one what it leaves at another, and each slips by itself.
        rocks, turned = self._turned(pressed, normal, frame, rolling)
        blow += 0.5 * (1.0 - bounce) * pressed * rocks
        return np.asarray(blow + contacts.rubbed * (slip + rocks) + turned)

    @cached_property
    def _run(self) -> NDArray[np.bool_]:
        """Whether one of a contact's surfaces is a belt's, (n,)."""
        runs = np.array([any(shape.surface_velocity) for shape in self._contacts.shapes], dtype=bool)
        return np.asarray(runs[self._contacts.track.pair].any(axis=1))

    @cached_property
    def _rubs(self) -> tuple[Floats, Floats, NDArray[np.bool_]]:
        """What friction takes at least and at most where surfaces go on slipping, (n,) each [J]; 0 and inf elsewhere.

        And whether a blow of before goes on there: what this takes is no less than that.

        What is led works all the while, and most of that may go into friction: what this takes at most by its size
        alone would hide as much of a gain or of a loss. Within an interval slip and turning are those of both its ends,
        to within half of what they change by here or in the intervals beside.
        """
        contacts, track = self._contacts, self._contacts.track
        pressed = np.maximum(track.pressed.astype(np.float64), 1e-30)
        found, unsure = taken(contacts)
        found = found + late(contacts)[:, None]
        normal = track.along / pressed[:, None]
        rocks, _ = self._turned(pressed, normal, np.maximum(track.frame, 1), self._laws[1])
        lasts = contacts.lasting & (pressed <= self._steady)
        least = np.maximum(found.min(axis=1) - unsure, 0.0)
        most = np.maximum(found.max(axis=1), 0.0) + unsure + (contacts.rubbed + pressed) * rocks
        closes = -np.einsum("ni,ni->n", contacts.slip[:, 0], normal)
        goes_on = lasts & (closes > 2.0 * self._evidence.gravity * self._motion.h[np.maximum(track.frame, 1) - 1])
        return np.where(lasts, least, 0.0), np.where(lasts, most, np.inf), goes_on

    def _within(self, rows: Rows, blow: NDArray[np.bool_]) -> tuple[Floats, Floats]:
        """How fast surfaces may meet, and slip, within intervals, (2, n) [m/s]; what of each contact is no blow, (n,).

        A blow that comes to a ball goes on to all that it touches, however steadily these were pressed around it.
        """
        frame = np.maximum(self._contacts.track.frame, 1)
        led = self._motion.surface_speed[:, leads(self._evidence)].max(axis=1, initial=surface_speed(self._evidence))
        fastest = 2.0 * np.maximum(self._motion.surface_speed[:, rows].max(axis=1), led)
        fastest = np.maximum(fastest[frame], fastest[frame - 1])
        before, most = self._between_balls(rows)
        balls = most > 0.0
        speeds = np.where(balls, np.stack([np.minimum(before, most), before]), fastest)
        return speeds, np.where(balls & self._passed_on(blow), 0.0, self._steady)

    def _between_balls(self, rows: Rows) -> tuple[Floats, Floats]:
        """How fast each contact's surfaces may meet within its interval, of loose balls, (n,) each [m/s]; else 0.

        They met as they came into the interval, or what others gave them since brought them together: that is at most
        what was between them, and all that the others' impulses change of both; those of their own part them. And two
        that meet at u have (1 / m + 1 / m')^-1 u^2 / 2 at least, of what all had.
        """
        contacts, motion, h = self._contacts, self._motion, self._motion.h
        frame, body = contacts.track.frame, contacts.body
        own, there = np.maximum(body, 0), body >= 0
        light = np.where(there, 1.0 / motion.mass[own], 0.0)
        turns = np.where(there, (motion.radius**2 / np.linalg.eigvalsh(motion.inertia)[:, 0])[own], 0.0)
        pressed, rubbed = contacts.track.pressed.astype(np.float64)[:, None], contacts.rubbed[:, None]
        changes = (pressed + rubbed) * light + rubbed * turns
        every = np.zeros((len(self._evidence.time), len(motion.mass)))
        np.add.at(every, (frame[:, None].repeat(2, axis=1)[there], body[there]), changes[there])
        others = np.where(there, every[frame[:, None], own] - changes, 0.0).sum(axis=1)
        speed, weight = motion.speed[:-1, rows], motion.mass[rows] * self._evidence.gravity
        falls = (weight * (speed + self._evidence.gravity * h[:, None])).sum(axis=1) * h
        had = motion.kinetic[:-1, rows].sum(axis=1) + falls
        most = np.sqrt(2.0 * had[np.maximum(frame, 1) - 1] * light.sum(axis=1))
        balls = np.array([all(shape.kind == "sphere" for shape in body.shapes) for body in self._evidence.world.bodies])
        loose = ~there | (balls & ~motion.jointed & ~motion.kinematic)[own]
        asked = loose.all(axis=1) & ~motion.jointed[rows].any() & ~self._run
        before = np.linalg.norm(contacts.slip[:, 0], axis=1) + others
        return np.where(asked, before, 0.0), np.where(asked, most, 0.0)

    def _passed_on(self, blow: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Whether a contact hangs together with one that is a blow in its interval, by bodies that touch, (n,)."""
        bodies = len(self._motion.mass)
        node = self._contacts.track.frame[:, None].astype(np.int64) * bodies + self._contacts.body
        node = np.where(self._contacts.body >= 0, node, node[:, ::-1])  # what never moves passes nothing on
        links = coo_matrix((np.ones(len(node)), tuple(node.T)), (bodies * len(self._evidence.time),) * 2)
        label = connected_components(links, directed=False)[1][node[:, 0]]
        return np.isin(label, label[blow])

    @cached_property
    def _steady(self) -> Floats:
        """What each contact would press with if it went on as it does before and after, twice (n,) [N s]."""
        frame = self._contacts.track.frame
        before, after = beside(self._contacts, self._contacts.track.pressed.astype(np.float64))
        after = np.where(frame == len(self._evidence.time) - 1, before, after)
        return STEADY * np.minimum(np.where(frame == 1, after, before), after)

    @cached_property
    def _shared(self) -> NDArray[np.bool_]:
        """Whether one of a contact's bodies has another in its interval, or hangs on something, (n,)."""
        body, bodies = self._contacts.body, len(self._motion.mass)
        key = self._contacts.track.frame[:, None].astype(np.int64) * (bodies + 1) + body
        counts = np.bincount(np.where(body >= 0, key, 0).ravel(), minlength=1)
        held = np.append(self._motion.jointed, False)[body]
        return np.asarray((((counts[np.where(body >= 0, key, 0)] > 1) | held) & (body >= 0)).any(axis=1))

    @cached_property
    def _laws(self) -> tuple[Floats, Floats]:
        """Restitution and rolling resistance of each contact's pair, (n,) each."""
        world, shapes, track = self._evidence.world, self._contacts.shapes, self._contacts.track
        pairs, which = np.unique(track.pair, axis=0, return_inverse=True)
        laws = [pair_law(world, shapes[a], shapes[b]) for a, b in pairs.tolist()]
        values = np.array([(law.restitution, law.rolling) for law in laws], dtype=np.float64).reshape(-1, 2)
        found = values[which.ravel()]
        return found[:, 0], found[:, 1]

    def _turned(self, pressed: Floats, normal: Floats, frame: Rows, rolling: Floats) -> tuple[Floats, Floats]:
        """How fast surfaces rock on each other that are no balls, and what rolling and spinning take, (n,) [m/s], [J].

        What is round about an axis rolls about it, and does not rock.
        """
        motion, contacts = self._motion, self._contacts
        rate, rocking = np.zeros((len(pressed), 2, 3)), np.zeros((len(pressed), 2, 3))
        for end in (0, 1):
            for side, sign in ((0, -1.0), (1, 1.0)):
                own = contacts.body[:, side]
                spin = motion.w[frame - 1 + end, np.maximum(own, 0)]
                spin = sign * np.where((own >= 0)[:, None], spin, 0.0)
                axis = self._round_about(side, frame - 1 + end)
                rate[:, end] += spin
                rocking[:, end] += spin - np.einsum("ni,ni->n", spin, axis)[:, None] * axis
        fastest = np.linalg.norm(rate, axis=2).max(axis=1)
        about = np.abs(np.einsum("nei,ni->ne", rate, normal)).max(axis=1)
        size = np.append(motion.radius, np.inf)[contacts.body].min(axis=1)
        round_ = np.array([shape.kind == "sphere" for shape in contacts.shapes])[contacts.track.pair].any(axis=1)
        patch = contacts.friction * np.where(round_, 0.0, about) * size
        rocking -= np.einsum("nei,ni->ne", rocking, normal)[..., None] * normal[:, None]
        rocks = np.where(round_, 0.0, np.linalg.norm(rocking, axis=2).max(axis=1) * size)
        return rocks, pressed * (patch + (1.0 + np.pi) * rolling * size * fastest)

    def _round_about(self, side: int, frame: Rows) -> Floats:
        """The axis about which each contact's first or second shape is round, (n, 3); zeros where there is none."""
        contacts, found = self._contacts, np.zeros((len(frame), 3))
        placed = {(shape.body, shape.shape.prim): shape for shape in self._evidence.placed}
        for k in np.unique(contacts.track.pair[:, side]):
            rows = np.flatnonzero(contacts.track.pair[:, side] == k)
            shape = placed.get((int(contacts.body[rows[0], side]), contacts.shapes[k].prim))
            if shape is not None and shape.shape.kind in ("cylinder", "capsule"):
                found[rows] = rotate(shape.rotation[frame[rows]], np.array([[0.0, 0.0, 1.0]]))
        return found

    # ---- ties
    def _of_joint(self, k: int) -> Floats:
        """What a joint's friction and stops may take, (T - 1,) [J]."""
        assert self.ties is not None
        rate, track = self.ties.laws.rate(self.ties.joints[k]), self.ties.track
        friction, stop = (np.asarray(each[1:, k], dtype=np.float64) for each in (track.friction, track.stop))
        change, fastest = np.abs(np.diff(rate)), np.maximum(np.abs(rate[1:]), np.abs(rate[:-1]))
        return np.asarray(np.abs(friction) * fastest + np.abs(stop) * (fastest + change))

    def ahead(self, rows: Rows) -> tuple[Floats, Floats]:
        """What steps of the first order show too little of the energy that they keep, and how unsure it is, (T,) [J].

        v += a dt, z += v dt keeps E - dV/dt dt / 2 (`wsim.judge.books.phases`), and takes places along their way by
        dv dt / 2 farther than the mean of both ends' velocities, less h^2 / 12 of the change of accelerations, where
        velocities change by dv; steps of higher orders do not. Poses tell of a few intervals together which it was.
        """
        motion = self._motion
        v, h = motion.v[:, rows], motion.h[:, None, None]
        change, mean = np.diff(v, axis=0), 0.5 * (v[1:] + v[:-1])
        bend = h**2 / 12.0 * np.diff(np.gradient(v, self._evidence.time, axis=0), axis=0)
        way = mean / np.maximum(np.linalg.norm(mean, axis=2, keepdims=True), 1e-12)
        off = np.einsum("tbi,tbi->tb", np.diff(motion.com[:, rows], axis=0) - mean * h + bend, way)
        due = 0.5 * min(motion.dt, motion.dt_frames) * np.einsum("tbi,tbi->tb", change, way)
        window = np.ones(min(WINDOW, len(off)))
        found, most = (np.convolve(np.sum(each, axis=1), window, "same") for each in (off * due, due**2))
        rounding = 8.0 * FLOAT32 * np.abs(motion.com[:, rows]).max(initial=0.0)
        share = found / np.maximum(most, 1e-30)
        known = (most > (4.0 * rounding) ** 2) & (share > -STRAY) & (share < 1.0 + STRAY)
        share = np.where(known, np.clip(share, 0.0, 1.0), 0.5)
        gained = 0.5 * motion.dt * np.diff(sinking(self._evidence)[:, rows].sum(axis=1))
        doubt = np.abs(gained) * np.where(known, 2.0 * share * (1.0 - share), 0.5)
        correction, unsure = (np.concatenate([[0.0], np.cumsum(each)]) for each in (share * gained, doubt))
        return correction, unsure

    def _damped(self, ours: set[int]) -> tuple[Floats, Floats]:
        """What springs' dampers take by their law, and how unsure that is, (T - 1,) each [J]."""
        found = np.zeros((2, len(self._motion.h)))
        for spring in self._evidence.world.springs:
            held = {self._evidence.index(guide.body) for guide in spring.path if guide.body}
            if spring.damping == 0.0 or not held & ours:
                continue
            track = track_of_spring(self._evidence, spring)
            ratio, h = spring.stiffness / spring.damping, self._motion.h
            within = relaxing.taken(track.rate, track.length, spring.rest_length, ratio, h)
            resolved = relaxing.resolved(track.rate, track.length, h)
            found += spring.damping * np.where(np.isnan(within), resolved, within)
        return found[0], found[1]

    def _jerked(self, ours: set[int]) -> Floats:
        """What ropes that come taut may take, (T - 1,) [J]."""
        assert self.ties is not None
        springs, found = len(self._evidence.world.springs), np.zeros(len(self._motion.h))
        done: set[int] = set()
        for n, (cord, row) in enumerate(self.ties.ends):
            if cord < springs or row not in ours or cord in done:
                continue
            done.add(cord)
            tension = np.maximum(self.ties.track.tension[1:, n].astype(np.float64), 0.0)
            rate = np.abs(self.ties.ropes.rate(self._evidence.world.ropes[cord - springs]))
            jerks = self.ties.ropes.pulls[cord - springs].jerks  # in one interval after another, maybe
            starts = tension[:1] * (rate[0] <= self._evidence.gravity * self._motion.dt)  # or it comes taut at once
            around = np.concatenate([starts, tension, tension[-1:]])
            steady = np.where(jerks, 0.0, STEADY * np.minimum(around[2:], around[:-2]))
            excess = np.maximum(tension - steady, 0.0)
            found += excess * (np.maximum(rate[1:], rate[:-1]) + self._evidence.gravity * self._motion.h)
        return found
