"""Forces that follow from where bodies are and how they go: of springs, drives and dry friction in joints.

Each is taken as the mean of what its law gives at the frames at both ends of an interval, where these are near enough
to tell: a mode of phase `p` between frames leaves p^2 / 12 of it (the trapezoidal rule's error), and of a spring, whose
length and rate are known at both ends, p^4 / 720, up to 1.2 rad. Where they are not, and where somebody
sets the law's numbers while the world runs, the force is unknown, and any along its line may act.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import rotate
from wsim.judge.books import jolts
from wsim.judge.books.arms import bent, ranging
from wsim.judge.books.lateness import steps_at_most
from wsim.judge.books.mobility import mobilities
from wsim.judge.books.ways import Course, eased, off_the_way
from wsim.judge.evidence.cords import track_of_spring
from wsim.judge.evidence.joints import AXES, broken, track_of
from wsim.judge.evidence.motion import FLOAT32
from wsim.judge.evidence.scheduled import Aims

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.evidence.motion import Motion
    from wsim.scene.world import Guide, Joint, Motor, Spring

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]

RESOLVED = 0.5  # of a mode's phase between two frames [rad]: what is faster is not known from the frames
SPRUNG = 1.2  # the same of springs [rad], of which p^4 / 720 is left, 0.3 %
USUAL_STEP = 2e-3  # [s], of engines that do not tell theirs


@dataclass(frozen=True)
class Law:
    """A force along one way, by its law at each frame."""

    wrench: Floats  # on the second body at each frame, (T, 6) [N, N m]; torques about its centre of mass
    back: Floats  # on the first one
    one: int  # row of the first body, or below 0: the world
    two: int
    error: Floats  # (T - 1,) share of the force that the frames do not tell
    known: Bools  # (T - 1,) whether the frames tell it
    most: float = np.inf  # what it may be at most where they do not [N or N m]
    mean: Floats | None = None  # (T - 1,) what its joint's way tells of it there, where that is more [N or N m]
    off: Floats | None = None  # (T - 1,) by how much that may be off; inf where the way tells nothing

    @property
    def beside(self) -> Floats:
        """What it may be at most beside what is given of it, either way, (T - 1,) [N or N m]."""
        bound = np.full(len(self.known), self.most) if self.off is None else np.minimum(self.most, self.off)
        return np.where(self.known, 0.0, bound)


@dataclass(frozen=True)
class _Along:
    """A joint's own motion, of T frames."""

    rows: list[int]
    arms: list[Floats]  # from both centres of mass, (T, 3) each [m]
    axis: Floats  # (T, 3)
    turns: bool
    rate: Floats  # (T,) [rad/s or m/s]
    loose: Floats  # how much a unit effort speeds it up, (T,)

    def acting(self, effort: Floats) -> tuple[list[int], list[Floats], Floats, Floats]:
        """The bodies and arms of an effort (T,) along it, its force and its torque, (T, 3) each."""
        along = effort[:, None] * self.axis
        none = np.zeros_like(along)
        return self.rows, self.arms, *((none, along) if self.turns else (along, none))


class Laws:
    """All springs, drives and dry frictions of a world."""

    def __init__(self, evidence: Evidence) -> None:
        self._evidence, self._motion = evidence, evidence.motion
        self._row = {body.prim: i for i, body in enumerate(evidence.world.bodies)}
        self._aims: dict[str, Aims] = {}
        self._set = bool(evidence.recording.metadata.get("controlled"))
        self.springs = [self._spring(spring) for spring in evidence.world.springs]
        self.joints = {joint.prim: self._joint(joint) for joint in evidence.world.joints}

    @cached_property
    def _steps(self) -> tuple[Floats, Floats]:
        """How long steps may be, and how coarse (`steps_at_most`): asked where anything has a law."""
        return steps_at_most(self._evidence)

    def given(self) -> tuple[Floats, Floats]:
        """What is known, (T - 1, B, 6) [N, N m], and how much of forces and torques may be wrong, (T - 1, B, 2)."""
        intervals, bodies = len(self._motion.h), len(self._motion.mass)
        total, wrong = np.zeros((intervals, bodies, 6)), np.zeros((intervals, bodies, 2))
        for law in [*self.springs, *(law for laws in self.joints.values() for law in laws)]:
            for row, wrench in ((law.one, law.back), (law.two, law.wrench)):
                if row < 0:
                    continue
                mean = np.where(law.known[:, None], 0.5 * (wrench[1:] + wrench[:-1]), 0.0)
                total[:, row] += mean
                most = np.maximum(np.abs(wrench[1:]), np.abs(wrench[:-1])).reshape(-1, 2, 3)
                change = np.linalg.norm((wrench[1:] - wrench[:-1]).reshape(-1, 2, 3), axis=2)
                # A step takes the force at its end, or at its start.
                late = 0.5 * (self._step(law) / self._motion.h)[:, None] * change
                off = law.error[:, None] * np.linalg.norm(most, axis=2) + late
                wrong[:, row] += np.where(law.known[:, None], off, 0.0)
        for spring, law in zip(self._evidence.world.springs, self.springs, strict=True):
            self._refine(spring, law, total, wrong)
        for joint in self._evidence.world.joints:
            if joint.drive is not None and self.joints[joint.prim]:
                self._refine_drive(joint, self.joints[joint.prim][0], total, wrong)
                self._on_the_way(joint, self.joints[joint.prim][0], total, wrong)
        for joint in self._evidence.world.joints:
            self._by_schedule(joint, total, wrong)
        return total, wrong

    def _by_schedule(self, joint: Joint, total: Floats, wrong: Floats) -> None:
        """What a schedule pushes a joint with beside its drive."""
        if joint.kind not in ("revolute", "prismatic") or not self.aims(joint).effort.any():
            return
        mean, along = self.aims(joint).effort, self._along(joint)
        unit = self._law(*along.acting(np.ones(len(along.rate))), (0.0, 0.0), along.loose)
        for row, way in ((unit.one, unit.back), (unit.two, unit.wrench)):
            if row >= 0:
                total[:, row] += mean[:, None] * 0.5 * (way[1:] + way[:-1])
                turned = 0.5 * np.linalg.norm(np.diff(way, axis=0).reshape(-1, 2, 3), axis=2) + bent(way)
                wrong[:, row] += np.abs(mean)[:, None] * turned

    def _refine_drive(self, joint: Joint, law: Law, total: Floats, wrong: Floats) -> None:
        """What the mean of both ends leaves of a drive's effort where it is below its full strength.

        What its stiffness and its damping give may be large, and their sum small: a share of the sum does not bound it.
        """
        struck, smooth = self.mean_of_drive(joint), self.mean_of_drive(joint, late=False)  # `given` has that it is late
        if struck is None or smooth is None or joint.drive is None:
            return
        effort, most = self.effort(joint), joint.drive.max_effort
        below = struck[2] if most is None else np.maximum(np.abs(effort[1:]), np.abs(effort[:-1])) < most
        hit = self._may_be_hit([row for row in (law.one, law.two) if row >= 0])
        mean, may, refined = (np.where(hit, *pair) for pair in zip(struck, (*smooth[:2], below), strict=True))
        refined &= law.known
        extent = np.pi if joint.kind == "revolute" else float(np.abs(self._motion.com).max(initial=0.0))
        may = may + 8.0 * FLOAT32 * joint.drive.damping * extent / self._motion.h  # positions are rounded
        more, unsure = (np.where(refined, of, 0.0) for of in (mean - 0.5 * (effort[1:] + effort[:-1]), may))
        along = self._along(joint)
        unit = self._law(*along.acting(np.ones(len(effort))), (0.0, 0.0), along.loose)
        for row, way in ((law.one, unit.back), (law.two, unit.wrench)):
            if row >= 0:
                middle = 0.5 * (way[1:] + way[:-1])
                total[:, row] += more[:, None] * middle
                wrong[:, row] += unsure[:, None] * np.linalg.norm(middle.reshape(-1, 2, 3), axis=2)

    def _on_the_way(self, joint: Joint, law: Law, total: Floats, wrong: Floats) -> None:
        """What a drive gives in the mean where frames do not tell it and the way of its joint does.

        It may have given it at either end of the interval, along the way that it has there, and as much to and fro.
        """
        if law.mean is None or joint.drive is None:
            return
        effort = np.abs(self.effort(joint))
        most = np.maximum(np.abs(law.mean), np.maximum(effort[1:], effort[:-1]))
        most = np.where(law.mean == 0.0, 0.0, most + joint.drive.damping * np.abs(np.diff(self.rate(joint))))
        along = self._along(joint)
        unit = self._law(*along.acting(np.ones(len(along.rate))), (0.0, 0.0), along.loose)
        for row, way in ((law.one, unit.back), (law.two, unit.wrench)):
            if row >= 0:
                total[:, row] += law.mean[:, None] * 0.5 * (way[1:] + way[:-1])
                turned = 0.5 * np.linalg.norm(np.diff(way, axis=0).reshape(-1, 2, 3), axis=2) + bent(way)
                wrong[:, row] += most[:, None] * turned

    def _told_by_way(self, joint: Joint, law: Law) -> Law:
        """A drive's law with what the joint's way tells of its mean where frames do not; a rotor takes its gain."""
        found, drive, motion, place = self.mean_of_drive(joint), joint.drive, self._motion, self.position(joint)
        if joint.kind != "prismatic":  # of what turns far between two frames they tell too little
            return law
        if found is None or place is None or drive is None or not drive.told or self._set:
            return law
        rate, extent = self.rate(joint), float(np.abs(motion.com).max(initial=0.0))
        late = motion.step or max(self._step(law), USUAL_STEP)
        course = Course(place, rate, motion.h, extent, self._mobility.get(joint.prim, np.inf), late)
        struck = np.full(len(motion.h), False)
        if drive.max_effort is not None:
            struck = self._may_be_hit([row for row in (law.one, law.two) if row >= 0])
        off = off_the_way(drive, course, *found, struck)
        tells = ~law.known & (off < law.most) & ~broken(self._evidence, joint)[1:]
        rotor = np.where(law.known, 0.0, joint.armature * np.diff(rate) / motion.h)
        return replace(law, mean=np.where(tells, found[0], 0.0) - rotor, off=np.where(tells, off, law.most))

    @cached_property
    def _mobility(self) -> dict[str, float]:
        """By how much a unit effort speeds up each joint at most [1/kg or 1/(kg m^2)]."""
        return mobilities(self._evidence)

    @property
    def _late(self) -> float:
        """How old what a step takes of drives and springs may be [s]; one of higher order takes their mean."""
        return 0.0 if self._evidence.world.stepped == "neither" else self._motion.step

    def aims(self, joint: Joint) -> Aims:
        """What a joint's drive aims at, by schedules too."""
        if joint.prim not in self._aims:
            self._aims[joint.prim] = Aims.of(self._evidence, joint)
        return self._aims[joint.prim]

    def effort(self, joint: Joint) -> Floats:
        """What the law of a joint's drive gives at each frame, as much as it can, (T,) [N or N m]."""
        drive, track = joint.drive, self._evidence.joint(joint)
        assert drive is not None and track is not None
        return _effort(drive, self.aims(joint), track.position, self.rate(joint))

    def mean_of_drive(self, joint: Joint, *, late: bool = True) -> tuple[Floats, Floats, Bools] | None:
        """What a drive gives in the mean of each interval, blow or none, by how much that may be off, and where it is
        sure to have been below its full strength, (T - 1,) each [N or N m]; None of what moves unseen.

        With `late` it may be what it is at steps' starts, else it is its mean over time.
        """
        drive, track = joint.drive, self._evidence.joint(joint)
        if drive is None or track is None:
            return None
        h, rate, aims = self._motion.h, self.rate(joint), self.aims(joint)
        step = self._late if late else 0.0
        mean, may = jolts.mean_force((drive.stiffness, drive.damping), track.position, rate, h, step)
        left = track.position - aims.position
        most = drive.stiffness * np.abs(left) + drive.damping * np.abs(rate - aims.velocity)
        below = np.maximum(most[1:], most[:-1]) < (np.inf if drive.max_effort is None else drive.max_effort)
        if drive.max_effort is not None:
            below &= jolts.between(track.position, rate, h) & ~aims.jumps
        # A step has the mean of its aims; what its effort is late by goes with them.
        moved = drive.stiffness * np.abs(np.diff(aims.position)) + drive.damping * np.abs(np.diff(aims.velocity))
        may = may + np.minimum(step / h, 1.0) * moved
        return drive.stiffness * aims.mean_position + drive.damping * aims.mean_velocity - mean, may, below

    def _refine(self, spring: Spring, law: Law, total: Floats, wrong: Floats) -> None:
        """What the mean of both ends leaves of a spring's force: of its size, and as its way turns.

        A force that changes by f while its way turns by u is less by f u / 6 on the whole than the mean of both ends:
        what the trapezoidal rule makes of their product. Its size is what its length and how that changes tell, blow or
        none: an error of order p^4, p the phase between frames, where the mean of both ends leaves p^2 / 12.
        """
        motion, track = self._motion, track_of_spring(self._evidence, spring)
        gains, stretch = (spring.stiffness, spring.damping), track.length - spring.rest_length
        mean, may = jolts.mean_force(gains, stretch, track.rate, motion.h, self._late)
        if not motion.step:  # a step's start has the rate by which the length went in the one before
            may = may + 0.5 * self._step(law) / motion.h * spring.damping * np.abs(np.diff(track.rate))
        may = may + 8.0 * FLOAT32 * spring.damping * np.abs(motion.com).max(initial=0.0) / motion.h
        more = np.where(law.known, mean - 0.5 * (track.pull[1:] + track.pull[:-1]), 0.0)
        unsure = np.where(law.known, may, 0.0)
        change = np.where(law.known, np.diff(track.pull), 0.0)
        most = np.where(law.known, np.maximum(np.abs(track.pull[1:]), np.abs(track.pull[:-1])), 0.0)
        ranges = np.where(law.known, 0.0, ranging(track.pull))
        for guide, row, sign in zip(spring.path, (law.one, law.two), (1.0, -1.0), strict=True):
            if row >= 0:
                arm = self.arm(row, self.end(guide))
                way = sign * np.concatenate([track.along, np.cross(arm, track.along)], axis=1)
                middle = 0.5 * (way[1:] + way[:-1])
                total[:, row] += more[:, None] * middle - change[:, None] * np.diff(way, axis=0) / 6.0
                wrong[:, row] += unsure[:, None] * np.linalg.norm(middle.reshape(-1, 2, 3), axis=2)
                wrong[:, row] += most[:, None] * bent(way)
                # Along the mean of its way it may be any; the mean of both's product is less than a quarter of what
                # they range over, times each other, off the product of their means (Gruess 1935).
                turns = np.linalg.norm(np.diff(way, axis=0).reshape(-1, 2, 3), axis=2) + bent(way)
                wrong[:, row] += 0.25 * ranges[:, None] * turns

    def _step(self, law: Law) -> float:
        """The engine's time step for what a law acts on, or the longest that it may be [s]."""
        return float(max((self._steps[0][row] for row in (law.one, law.two) if row >= 0), default=self._motion.dt))

    def _may_be_hit(self, rows: list[int]) -> Bools:
        """Whether anything may touch what some bodies hang together with, (T - 1,)."""
        motion, every = self._motion, np.arange(len(self._motion.h))
        ours = np.flatnonzero(np.isin(motion.unit, motion.unit[rows]))
        found: Bools = np.any([motion.near(int(row), every) for row in ours], axis=0)
        return found

    def rate(self, joint: Joint) -> Floats:
        """The speed of a hinge or a slider, (T,) [rad/s or m/s]."""
        return self._along(joint).rate

    # ---- springs
    def _spring(self, spring: Spring) -> Law:
        track = track_of_spring(self._evidence, spring)
        rows = [self._row.get(guide.body or "", -1) for guide in spring.path]
        arms = [self.arm(row, self.end(guide)) for row, guide in zip(rows, spring.path, strict=True)]
        force = -(track.pull[:, None] * track.along)
        loose = np.sum([self._looseness(row, arm, track.along) for row, arm in zip(rows, arms, strict=True)], axis=0)
        law = self._law(rows, arms, force, np.zeros_like(force), (spring.stiffness, spring.damping), loose)
        coarse = max((self._steps[1][row] for row in rows if row >= 0), default=1.0)
        # Its ends swing on all springs that hold them: no mode of both is faster than their own together.
        pulled = np.sum([self._sprung[:, row] for row in set(rows) if row >= 0], axis=0) * np.ones(len(loose))
        swing = np.maximum(np.maximum(pulled[1:], pulled[:-1]) * self._motion.h**2, 12.0 * law.error)
        error = coarse * law.error + (swing / 12.0) ** 2 / 5.0  # p^4 / 720 (`_refine`)
        return replace(law, error=error, known=swing < SPRUNG**2)

    @cached_property
    def _sprung(self) -> Floats:
        """The square of the fastest rate at which all its springs swing each body, if else is at rest, (T, B) [1/s^2].

        The greatest eigenvalue of its stiffness, by its mass and its inertia.
        """
        found = np.zeros((len(self._evidence.time), len(self._row)))
        ways: dict[int, list[Floats]] = {}
        for spring in self._evidence.world.springs:
            along = track_of_spring(self._evidence, spring).along
            for guide in spring.path:
                row = self._row.get(guide.body or "", -1)
                if row >= 0 and not self._motion.kinematic[row]:
                    way = np.sqrt(spring.stiffness) * self._by_mass(row, self.arm(row, self.end(guide)), along)
                    ways.setdefault(row, []).append(way)
        for row, each in ways.items():
            way = np.stack(each, axis=2)
            found[:, row] = np.linalg.eigvalsh(way @ way.transpose(0, 2, 1))[:, -1]
        return found

    def _by_mass(self, row: int, arm: Floats, along: Floats) -> Floats:
        """A unit force at an arm over the root of what it moves, (T, 6): its square is the looseness there."""
        q = self._evidence.body_q[:, row, 3:]
        own = rotate(q * np.array([-1.0, -1.0, -1.0, 1.0]), np.cross(arm, along))
        share, axes = np.linalg.eigh(np.linalg.pinv(self._motion.inertia[row]))
        return np.hstack([along / np.sqrt(self._motion.mass[row]), own @ axes * np.sqrt(np.maximum(share, 0.0))])

    def end(self, guide: Guide) -> Floats:
        """Where a point of a spring's way is, (T, 3) [m]."""
        frames = len(self._evidence.time)
        if guide.body is None:
            return np.tile(np.array(guide.position, dtype=np.float64), (frames, 1))
        q = self._evidence.body_q[:, self._row[guide.body]]
        place: Floats = q[:, :3] + rotate(q[:, 3:], np.array(guide.position)[None])
        return place

    def arm(self, row: int, place: Floats) -> Floats:
        """From a body's centre of mass, (T, 3) [m]; zeros of the world."""
        return np.zeros_like(place) if row < 0 else place - self._motion.com[:, row]

    def _looseness(self, row: int, arm: Floats, along: Floats) -> Floats:
        """By how much a unit force at an arm speeds its point up along its own way, (T,) [1/kg]."""
        if row < 0 or self._motion.kinematic[row]:
            return np.zeros(len(arm))
        turned = np.cross(arm, along)
        found: Floats = 1.0 / self._motion.mass[row] + self._turning(row, turned)
        return found

    def _turning(self, row: int, torque: Floats) -> Floats:
        """Work of a torque (T, 3) on the turning that it starts, (T,)."""
        q = self._evidence.body_q[:, row, 3:]
        own = rotate(q * np.array([-1.0, -1.0, -1.0, 1.0]), torque)
        return np.einsum("ti,ij,tj->t", own, np.linalg.pinv(self._motion.inertia[row]), own)

    # ---- joints
    def _joint(self, joint: Joint) -> list[Law]:
        """What a joint's drive and its friction give along its own motion; none where it has neither."""
        if joint.kind not in ("revolute", "prismatic") or (joint.drive is None and joint.friction <= 0.0):
            return []
        track = track_of(self._evidence, joint)
        if track is None or joint.child_anchor is None:
            return []
        along = self._along(joint)
        holds = ~broken(self._evidence, joint)[1:] & (joint.armature == 0.0)
        laws = []
        if joint.drive is not None:
            laws = [self._told_by_way(joint, self._drive(joint, joint.drive, along, track.position, holds))]
        laws += [self._friction(joint.friction, along, holds)] if joint.friction > 0.0 else []
        if joint.armature and (joint.drive is None or laws[0].mean is None):  # what its rotor takes is not told
            return [replace(law, most=np.inf) for law in laws]
        return laws

    def _drive(self, joint: Joint, drive: Motor, along: _Along, position: Floats, holds: Bools) -> Law:
        aims = self.aims(joint)
        effort = _effort(drive, aims, position, along.rate)
        most = np.inf if drive.max_effort is None else drive.max_effort
        full = np.where(np.abs(effort) >= most, np.sign(effort), 0.0)
        law = self._law(*along.acting(effort), (drive.stiffness, drive.damping), along.loose)
        # All of an interval at its full strength it is known; where it comes to that, or leaves it, it is not.
        strained, told = full[1:] * full[:-1] > 0.0, drive.told and not self._set
        known = ((law.known & (full[1:] == full[:-1])) | strained) & holds & told & ~aims.jumps
        error = np.where(strained, eased(drive, aims, position, along.rate, self._motion.h), law.error)
        return replace(law, known=known, error=error, most=most if told else np.inf)

    @property
    def motion(self) -> Motion:
        """Of the bodies."""
        return self._motion

    def position(self, joint: Joint) -> Floats | None:
        """Of a hinge or a slider, (T,) [rad or m]; None of other kinds."""
        track = track_of(self._evidence, joint)
        return None if track is None else track.position

    def loose(self, joint: Joint) -> Floats:
        """By how much a unit effort speeds up a joint that is loose from all others, (T,) [1/kg or 1/(kg m^2)]."""
        return self._along(joint).loose

    def slowing(self, joint: Joint) -> Floats:
        """By how much dry friction slows a joint that is loose from all others, (T,) [m/s^2 or rad/s^2]."""
        return joint.friction * self._along(joint).loose

    def _friction(self, friction: float, along: _Along, holds: Bools) -> Law:
        """It is known where the joint goes on all of an interval; at rest it may hold by anything up to as much."""
        law = self._law(*along.acting(-friction * np.sign(along.rate)), (0.0, 0.0), along.loose)
        slow, rate = friction * along.loose[1:] * self._motion.h, along.rate
        goes_on = (rate[1:] * rate[:-1] > 0.0) & (np.minimum(np.abs(rate[1:]), np.abs(rate[:-1])) > slow)
        return replace(law, known=goes_on & holds, most=friction)

    def _along(self, joint: Joint) -> _Along:
        rows = [self._row.get(joint.parent or "", -1), self._row[joint.child]]
        place = self._end_of(joint)
        arms = [self.arm(row, place) for row in rows]
        axis, turns = self.axis(joint), joint.kind == "revolute"
        loose = np.zeros(len(place))
        for row, arm in zip(rows, arms, strict=True):
            if row >= 0 and not self._motion.kinematic[row]:
                own = self._turning(row, axis) if turns else self._looseness(row, arm, axis)
                if turns and min(rows) < 0:  # about an axis that stands still its mass goes round as well
                    round_ = self._motion.mass[row] * np.sum(np.cross(arm, axis) ** 2, axis=1)
                    own = 1.0 / (1.0 / np.maximum(own, 1e-12) + round_)
                loose = loose + own
        return _Along(rows, arms, axis, turns, self._rate(joint, rows, arms, axis), loose)

    def _end_of(self, joint: Joint) -> Floats:
        q = self._evidence.body_q[:, self._row[joint.child]]
        place: Floats = q[:, :3] + rotate(q[:, 3:], np.array(joint.child_anchor)[None])
        return place

    def axis(self, joint: Joint) -> Floats:
        """The joint's axis in the world, by its child, (T, 3)."""
        own = rotate(np.array(joint.child_turn), np.eye(3)[AXES[joint.axis]])
        found: Floats = rotate(self._evidence.body_q[:, self._row[joint.child], 3:], np.asarray(own)[None])
        return found

    def _rate(self, joint: Joint, rows: list[int], arms: list[Floats], axis: Floats) -> Floats:
        """The joint's own speed, (T,) [rad/s or m/s]."""
        speeds = []
        for row, arm in zip(rows, arms, strict=True):
            if row < 0:
                speeds.append(np.zeros_like(axis))
            elif joint.kind == "revolute":
                speeds.append(self._motion.w[:, row])
            else:
                speeds.append(self._motion.v[:, row] + np.cross(self._motion.w[:, row], arm))
        found: Floats = np.einsum("ti,ti->t", speeds[1] - speeds[0], axis)
        return found

    # ---- both
    def _law(
        self,
        rows: list[int],
        arms: list[Floats],
        force: Floats,
        torque: Floats,
        gains: tuple[float, float],
        loose: Floats,
    ) -> Law:
        h, loose = self._motion.h, np.maximum(loose[1:], loose[:-1])
        swing = gains[0] * loose * h**2 + (gains[1] * loose * h) ** 2
        two = np.concatenate([force, np.cross(arms[1], force) + torque], axis=1)
        one = -np.concatenate([force, np.cross(arms[0], force) + torque], axis=1)
        return Law(two, one, rows[0], rows[1], swing / 12.0, swing < RESOLVED**2)


def _effort(drive: Motor, aims: Aims, position: Floats, rate: Floats) -> Floats:
    """What a drive's law gives at joint positions and rates (T,), as much as it can [N or N m]."""
    most = np.inf if drive.max_effort is None else drive.max_effort
    asked = drive.stiffness * (aims.position - position) + drive.damping * (aims.velocity - rate)
    return np.asarray(np.clip(asked, -most, most))
