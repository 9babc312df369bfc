"""How bodies go on from a frame, or came to it, within an interval in which a blow is.

What flies alone goes by the laws of a free body: its centre falls, and its angular momentum stays. What hangs on joints
goes on as it did in the interval before, or as it does in the one after, as itself sees it: what goes round a hinge at
an even rate has in its own axes the same velocity at all times. What slides or rolls has the same acceleration.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.paths import exponential
from wsim.geometry.rotations import conjugate, cross, multiply, rotate
from wsim.judge.books.courses import step_of
from wsim.judge.evidence.motion import FLOAT32

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.evidence.motion import Motion

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]

STEPS = 6  # that a course is followed by in an interval: of the fourth order in flight, of the second on joints
WITHIN = 0.1  # of a step: courses that pass each other by no more of the jump meet
ROUNDS = 4  # of Newton's method for when they do
NONE = np.zeros(6)


@dataclass(frozen=True)
class Pose:
    """A body at one instant; of what never moves all is 0."""

    com: Floats  # (3,) [m]
    q: Floats  # (4,), xyzw
    v: Floats  # (3,) [m/s]
    w: Floats  # (3,) [rad/s]

    def at(self, point: Floats) -> Floats:
        """Velocity of the body's matter at a point (3,) [m/s]."""
        return np.asarray(self.v + cross(self.w, point - self.com))


STANDS = Pose(np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]), np.zeros(3), np.zeros(3))


@dataclass(frozen=True)
class Course:
    """One body's, around an interval k.

    Attributes:
        kind: "stands", "led", "flies", "hangs" or "slides".
        change: Its acceleration before the blow and after it, (6,) each, in its own axes where it hangs.
        doubt: How far that may be from what it is within the interval.
    """

    motion: Motion
    body: int
    k: int
    kind: str
    change: tuple[Floats, Floats] = (NONE, NONE)
    doubt: tuple[Floats, Floats] = (NONE, NONE)

    @property
    def gives(self) -> bool:
        """Whether a blow changes how it goes."""
        return self.kind not in ("stands", "led")

    def at(self, side: int, when: float) -> Pose:
        """Where it is `when` [s] after frame k, as it went before the blow (side 0), or after it (1)."""
        if self.kind == "stands":
            return STANDS
        motion, i, frame = self.motion, self.body, self.k + side
        by = when - side * float(motion.h[self.k])
        if self.kind == "hangs":
            return self._hung(side, by)
        com, v = self.going(side, when)
        q, w = _unit(motion.q[frame, i, 3:].astype(np.float64)), motion.w[frame, i]
        if self.kind == "flies":
            return self._flown(com, v, _Spin(motion.inertia[i], q, w), by)
        change = self.change[side][3:]
        angle = (w + 0.5 * change * by) * by
        return Pose(com, _unit(multiply(exponential(angle), q)), v, w + change * by)

    def going(self, side: int, when: float) -> tuple[Floats, Floats]:
        """Where its centre of mass is then, and how fast it goes, (3,) each [m], [m/s]."""
        if self.kind in ("stands", "hangs"):
            pose = self.at(side, when)
            return pose.com, pose.v
        motion, i, frame = self.motion, self.body, self.k + side
        by = when - side * float(motion.h[self.k])
        pull = motion.gravity if self.kind == "flies" else self.change[side][:3]
        v = motion.v[frame, i]
        return motion.com[frame, i] + (v + 0.5 * pull * by) * by, v + pull * by

    def _flown(self, com: Floats, v: Floats, spin: _Spin, by: float) -> Pose:
        q, dt = spin.q, by / STEPS
        for _ in range(STEPS):
            first = spin.rate(q)
            second = spin.rate(q + 0.5 * dt * first)
            third = spin.rate(q + 0.5 * dt * second)
            q = q + dt / 6.0 * (first + 2.0 * second + 2.0 * third + spin.rate(q + dt * third))
        q = _unit(q)
        return Pose(com, q, v, spin.velocity(q))

    def _hung(self, side: int, by: float) -> Pose:
        """By steps of the middle: twists change evenly in the body's own axes."""
        motion, i, frame = self.motion, self.body, self.k + side
        q, com = _unit(motion.q[frame, i, 3:].astype(np.float64)), motion.com[frame, i]
        own = np.concatenate([rotate(conjugate(q), motion.v[frame, i]), rotate(conjugate(q), motion.w[frame, i])])
        dt, change = by / STEPS, self.change[side]
        for _ in range(STEPS):
            own = own + 0.5 * dt * change
            half = multiply(q, exponential(0.5 * dt * own[3:]))
            com = com + dt * rotate(half, own[:3])
            q, own = _unit(multiply(q, exponential(dt * own[3:]))), own + 0.5 * dt * change
        return Pose(com, q, rotate(q, own[:3]), rotate(q, own[3:]))

    def off(self, when: float, point: Floats) -> float:
        """By how much it may err in how fast a point goes, before and after together [m/s]."""
        found = 0.0
        for side in (0, 1):
            by, pose = abs(when - side * float(self.motion.h[self.k])), self.at(side, when)
            doubt = self.doubt[side] * by
            found += float(np.linalg.norm(doubt[:3]) + np.linalg.norm(doubt[3:]) * np.linalg.norm(point - pose.com))
        return found if self.gives else 0.0


class _Spin:
    """A free body's turning: its angular momentum stays."""

    def __init__(self, inertia: Floats, q: Floats, w: Floats) -> None:
        self.q, self._inverse = q, np.linalg.inv(inertia)
        self._momentum = rotate(q, inertia @ rotate(conjugate(q), w))

    def velocity(self, q: Floats) -> Floats:
        return rotate(q, self._inverse @ rotate(conjugate(q), self._momentum))

    def rate(self, q: Floats) -> Floats:
        return 0.5 * multiply(np.append(self.velocity(_unit(q)), 0.0), q)


def _unit(q: Floats) -> Floats:
    return np.asarray(q / np.linalg.norm(q))


class Followed:
    """The courses of a recording's bodies.

    Args:
        evidence: The recording.
        struck: Intervals in which a body has a blow, (T - 1, B): how it speeds up in them says nothing of others.

    Attributes:
        dt: The simulator's time step [s].
    """

    def __init__(self, evidence: Evidence, struck: Bools) -> None:
        self._motion, self._struck, self.dt = evidence.motion, struck, step_of(evidence)

    def course(self, body: int, k: int, flies: bool) -> Course | None:
        """A body's around interval k; None where the intervals beside it do not tell."""
        motion = self._motion
        if body < 0:
            return Course(motion, body, k, "stands")
        if motion.kinematic[body]:
            change = self._change(body, k, hangs=False)
            return Course(motion, body, k, "led", (change, change))
        if flies:
            return Course(motion, body, k, "flies")
        hangs = bool(motion.jointed[body])
        changes, doubts = [], []
        for way in (-1, 1):
            if not self._quiet(body, k + way):
                return None
            changes.append(self._change(body, k + way, hangs))
            # As much as it changed from the interval beyond; all of it where nothing tells.
            beyond = self._change(body, k + 2 * way, hangs) if self._quiet(body, k + 2 * way) else NONE
            doubts.append(np.abs(changes[-1] - beyond))
        return Course(motion, body, k, "hangs" if hangs else "slides", (changes[0], changes[1]), (doubts[0], doubts[1]))

    def _quiet(self, body: int, k: int) -> bool:
        return 0 <= k < len(self._motion.h) and not self._struck[k, body]

    def _change(self, body: int, k: int, hangs: bool) -> Floats:
        """How a body speeds up in an interval, (6,), in its own axes where it hangs."""
        v, w = self._motion.v[k : k + 2, body], self._motion.w[k : k + 2, body]
        if hangs:
            own = conjugate(self._motion.q[k : k + 2, body, 3:])
            v, w = rotate(own, v), rotate(own, w)
        return np.concatenate([v[1] - v[0], w[1] - w[0]]) / float(self._motion.h[k])

    def meet(self, courses: list[Course]) -> float | None:
        """When [s] after the frame the courses of bodies before and after one blow meet; None if they do not."""
        h = float(self._motion.h[courses[0].k])
        mass = np.array([self._motion.mass[each.body] for each in courses])[:, None]
        when = 0.5 * h
        for _ in range(ROUNDS):
            before, after = (np.array([each.going(side, when) for each in courses]) for side in (0, 1))
            apart, gone = (before - after).transpose(1, 0, 2)
            when -= float(np.sum(mass * apart * gone) / max(float(np.sum(mass * gone * gone)), 1e-300))
            when = float(np.clip(when, 0.0, h))
        met = (self._meets(each.at(0, when), each.at(1, when), h) for each in courses)
        return when if all(met) else None

    def _meets(self, before: Pose, after: Pose, h: float) -> bool:
        """Whether a body is where it was, and turned as it was: what is struck twice is not."""
        far, jump = (float(np.linalg.norm(b - a)) for b, a in ((before.com, after.com), (before.v, after.v)))
        angle = 2.0 * float(np.linalg.norm(multiply(conjugate(before.q), after.q)[:3]))
        spun = float(np.linalg.norm(before.w - after.w))
        rate = max(float(np.linalg.norm(pose.w)) for pose in (before, after))
        rounding = 8.0 * FLOAT32 * float(np.abs(before.com).max())
        return bool(
            far <= WITHIN * jump * self.dt + rounding
            and angle <= WITHIN * spun * self.dt + 8.0 * FLOAT32 * (1.0 + rate * h)
        )

    def pull(self, one: Course, two: Course, when: float, point: Floats, normal: Floats) -> float:
        """What forces change in a step of how fast a point of one body closes in on the other's [m/s]."""
        found = []
        for side in (0, 1):
            total = np.zeros(3)
            for sign, course in ((-1.0, one), (1.0, two)):
                if course.gives:
                    total += sign * self._pulled(course, course.at(side, when), side, point)
            found.append(abs(float(total @ normal)))
        return max(found) * self.dt

    def _pulled(self, course: Course, pose: Pose, side: int, point: Floats) -> Floats:
        """Acceleration that forces give a point of a body, (3,) [m/s^2]."""
        if course.kind == "flies":
            return self._motion.gravity
        change = course.change[side]
        if course.kind == "hangs":
            change = np.concatenate([rotate(pose.q, change[:3]), rotate(pose.q, change[3:])])
        return np.asarray(change[:3] + cross(change[3:], point - pose.com))

    def turned(self, poses: tuple[Pose, Pose], point: Floats, order: int) -> float:
        """How much the velocities of points of bodies change in a step as they turn, to an order in the step [m/s].

        By w dt of w r; what a step whose push acts at its start leaves of that is half of the second order.
        """
        found = 0.0
        for pose in poses:
            rate = float(np.linalg.norm(pose.w))
            found += (rate * self.dt) ** order / order * rate * float(np.linalg.norm(point - pose.com))
        return found
