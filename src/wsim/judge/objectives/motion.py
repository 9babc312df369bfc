"""Objectives about bodies that move: how far, how, and what they hit."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import level
from wsim.judge.evidence.contact import distance
from wsim.judge.evidence.faces import normal_under
from wsim.judge.evidence.recorded import MissingError
from wsim.judge.objectives.objective import ObjectiveCheck, Objectives
from wsim.scene.contact import largest_friction

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.scene.world import Body

    Floats = NDArray[np.float64]

DIRECTIONS = {"front": (1.0, 0.0), "back": (-1.0, 0.0), "left": (0.0, 1.0), "right": (0.0, -1.0)}
DOWNHILL_LEAST = 0.01  # of a unit: a slope below this has no direction
START_SHARE, END_SHARE = 0.1, 0.9  # of a ramp's length that a fall line is fitted over, from where the body starts


@dataclass
class ObjectiveMoves(ObjectiveCheck):
    """The body gets at least so far from where it was, in a direction if one is given."""

    share: float = 0.5  # of its smallest extent, where the plan names no distance

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding: the way made by the end, level [m]."""
        prim = evidence.prim(self.objective.object)
        i = evidence.index(prim)
        return [self._way(evidence, i, self.objective.direction)]

    def _way(self, evidence: Evidence, i: int, direction: str | None, along: Floats | None = None) -> Finding:
        moved = evidence.body_q[:, i, :3] - evidence.body_q[0, i, :3]
        if along is not None:
            way, where = moved @ along, "down the ramp"
        elif direction is not None:
            way, where = moved[:, :2] @ np.array(DIRECTIONS[direction]), f"to the {direction}"
        else:
            way, where = np.linalg.norm(level(moved, evidence.up), axis=1), "from where it was"
        wanted = self.objective.value
        limit = wanted if wanted is not None else self.share * evidence.solid(i).smallest
        # Down a ramp it may come back from what it hits; else it is the end that counts.
        value = float(way.max() if along is not None else way[-1])
        reached = way >= limit
        time = float(evidence.time[np.argmax(reached)] if reached.any() else evidence.time[-1])
        return self.measured(
            f"{evidence.world.bodies[i].prim} moves {value:.4g} m {where}",
            value, limit, "m", at_most=False, time=time,
            limit_from="the plan's distance" if wanted is not None else f"{self.share:g} of its smallest extent",
        )  # fmt: skip


@dataclass
class ObjectiveSlides(ObjectiveMoves):
    """The body moves so far without turning: down the ramp `ref`, or from where it was."""

    turning: float = 0.5  # of the way that it would roll at its rate of turning

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The way made [m], and how much of it is rolling [1]."""
        i = evidence.index(evidence.prim(self.objective.object))
        along = downhill(evidence, self.ref(), i) if self.objective.ref is not None else None
        return [self._way(evidence, i, self.objective.direction, along), self._turning(evidence, i, rolls=False)]

    def _turning(self, evidence: Evidence, i: int, rolls: bool) -> Finding:
        """The way that the body's turning would carry it, over the way that it makes, while it moves freely."""
        here = self._frames(evidence, i)
        turned = np.linalg.norm(evidence.body_qd[here, i, 3:], axis=1).sum() * evidence.solid(i).smallest / 2
        made = np.linalg.norm(evidence.body_qd[here, i, :3], axis=1).sum()
        value = float(turned / made) if made > 0 else math.nan
        word = "rolls" if value > self.turning else "slides"
        return self.measured(
            f"{evidence.world.bodies[i].prim} {word}: its turning makes up {value:.2f} of its way",
            value, self.turning, "1", at_most=not rolls, expected=1.0 if rolls else 0.0,
            limit_from="1 is rolling without slipping, 0 sliding without turning",
        )  # fmt: skip

    def _frames(self, evidence: Evidence, i: int) -> NDArray[np.bool_]:
        """From the start until the planned way is made; all, where it never is."""
        moved = np.linalg.norm(evidence.body_q[:, i, :3] - evidence.body_q[0, i, :3], axis=1)
        beyond = np.flatnonzero(moved > (self.objective.value or math.inf))
        here = np.ones(len(moved), dtype=bool)
        if len(beyond):
            here[beyond[0] + 1 :] = False
        return here


@dataclass
class ObjectiveRollsDown(ObjectiveSlides):
    """The body rolls down the ramp `ref`, at the acceleration that its own inertia leaves of gravity's pull."""

    accuracy: float = 0.1  # of the acceleration
    parting: float = 0.05  # of its smallest extent: a gap beyond is no contact any more

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The way made [m], how much of it is rolling [1], and for a ball let go the acceleration [m/s^2]."""
        i = evidence.index(evidence.prim(self.objective.object))
        along = downhill(evidence, self.ref(), i)
        found = [self._way(evidence, i, None, along), self._turning(evidence, i, rolls=True)]
        body = evidence.world.bodies[i]
        here = self._frames(evidence, i) & self._on_ramp(evidence, body)
        ball = len(body.shapes) == 1 and body.shapes[0].kind == "sphere"
        if not ball or np.linalg.norm(body.velocity) > 0.0 or here.sum() < 4 or not found[0].passed:
            return found
        radius = body.shapes[0].size[0]
        inertia = float(np.trace(np.array(body.inertia).reshape(3, 3))) / 3
        pull = float(evidence.motion.gravity @ along)
        expected = pull / (1 + inertia / (body.mass * radius**2))
        way = (evidence.body_q[here, i, :3] - evidence.body_q[0, i, :3]) @ along
        # From rest s = a t^2 / 2, so that the speed at s tells a = v^2 / 2 s, whenever it was let go.
        speed = evidence.body_qd[here, i, :3] @ along
        value = float(speed[-1] ** 2 / (2 * way[-1]))
        low = value < expected
        found.append(
            self.measured(
                f"{body.prim} gathers speed at {value:.4g} m/s^2; a rolling ball of its inertia does at {expected:.4g}",
                value, expected * (1 - self.accuracy if low else 1 + self.accuracy), "m/s^2", at_most=not low,
                expected=expected, time=float(evidence.time[here][-1]),
                limit_from=f"g sin(slope) / (1 + I / m r^2), to {self.accuracy:.0%}",
            )
        )  # fmt: skip
        return found

    def _on_ramp(self, evidence: Evidence, body: Body) -> NDArray[np.bool_]:
        """The frames (T,) until it leaves the ramp: what it meets after that is another story."""
        gap = distance(evidence, body.prim, evidence.prim(self.ref()))
        near = gap <= self.parting * evidence.solid(evidence.index(body.prim)).smallest
        left = np.flatnonzero(~near & (np.cumsum(near) > 0))
        here = np.ones(len(near), dtype=bool)
        if len(left):
            here[left[0] :] = False
        return here


def downhill(evidence: Evidence, name: str, i: int) -> Floats:
    """The unit vector (3,) down the slope of the static object's face that body i is over; MissingError without one."""
    prim = evidence.prim(name)
    static = evidence.static(prim)
    if static is None or not static.shapes:
        raise MissingError(f"the world has no static object {prim} to go down")
    slope = level(-evidence.up, normal_under(static.shapes, evidence.body_q[:, i, :3], evidence.up))
    steepness = float(np.linalg.norm(slope))
    if steepness < DOWNHILL_LEAST:
        raise MissingError(f"{prim} is level: nothing goes down it")
    return np.asarray(slope / steepness, dtype=np.float64)


@dataclass
class ObjectiveFlies(ObjectiveCheck):
    """Until it touches something, the body keeps to the parabola of its start: no air in this world."""

    share: float = 0.02  # of the way flown
    seconds: float = 0.1  # a flight lasts at least

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The flight's length [s], and the farthest off the parabola [m]."""
        prim = evidence.prim(self.objective.object)
        i = evidence.index(prim)
        body = evidence.world.bodies[i]
        t = evidence.time - evidence.time[0]
        touched = np.flatnonzero(np.any(evidence.recording.contact_force[:, i] != 0.0, axis=1))
        end = int(touched[0]) if len(touched) else len(t)
        # A contact between two frames shows in the speed alone: what gravity gives, and no more.
        gain = np.diff(evidence.body_qd[:, i, :3], axis=0) - np.array(evidence.world.gravity) * np.diff(t)[:, None]
        jolts = np.flatnonzero(np.linalg.norm(gain, axis=1) > 0.5)
        end = max(1, min(end, int(jolts[0]) + 1 if len(jolts) else end))
        flown = float(t[end - 1])
        found = [
            self.measured(
                f"{prim} flies for {flown:.3g} s before it touches anything", flown, self.seconds, "s", at_most=False,
                time=flown, limit_from="shorter than this is no flight"
            )
        ]  # fmt: skip
        start, velocity = evidence.body_q[0, i, :3], np.array(body.velocity)
        expected = start + velocity * t[:end, None] + np.array(evidence.world.gravity) * t[:end, None] ** 2 / 2
        off = np.linalg.norm(evidence.body_q[:end, i, :3] - expected, axis=1)
        way = float(np.linalg.norm(np.diff(expected, axis=0), axis=1).sum())
        limit = self.objective.tolerance or max(self.share * way, 1e-3)
        found.append(
            self.measured(
                f"{prim} is at most {off.max():.3g} m off the parabola of its start", float(off.max()), limit, "m",
                expected=0.0, time=float(t[np.argmax(off)]), limit_from=f"{self.share:g} of the way flown, {way:.3g} m"
            )
        )  # fmt: skip
        return found


@dataclass
class ObjectiveCollidesWith(ObjectiveCheck):
    """The body comes up to the other object and their speeds change at once; two free bodies keep their momentum."""

    change: float = 0.05  # of the speed of approach, that the collision must change at least
    frames: int = 1  # before and after the closest approach, between which speeds are compared
    share: float = 0.1  # of the momentum that the equations may lose, beside what friction takes

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The gap at the closest [m], the change of speed [m/s], and the change of the pair's momentum [kg m/s]."""
        prim, other = evidence.prim(self.objective.object), evidence.prim(self.ref())
        i = evidence.index(prim)
        free = evidence.static(other) is None
        j = evidence.index(other) if free else -1
        gap = distance(evidence, prim, other)
        v = evidence.body_qd[:, i, :3]
        relative = v - evidence.body_qd[:, j, :3] if free else v
        step = float(np.median(np.diff(evidence.time)))
        speed = np.linalg.norm(relative, axis=1)
        # Between two frames they may come that much nearer, and part again.
        reach = self.objective.tolerance or max(step * float(speed[: int(np.argmin(gap)) + 1].max()), 1e-3)
        touch = self._moment(gap <= reach, relative) if (gap <= reach).any() else int(np.argmin(gap))
        time = float(evidence.time[touch])
        found = [
            self.measured(
                f"{prim} comes within {max(float(gap.min()), 0.0):.3g} m of {other}", float(gap.min()), reach, "m",
                time=time, expected=0.0, limit_from="the way that they close between two recorded frames"
            )
        ]  # fmt: skip
        if found[0].passed:
            found += self._exchange(evidence, i, j, touch, speed, time)
        return found

    def _moment(self, near: NDArray[np.bool_], relative: Floats) -> int:
        """The frame near the other at which their speed to each other changes most."""
        jump = np.zeros(len(relative))
        jump[1:-1] = np.linalg.norm(relative[2:] - relative[:-2], axis=1)
        return int(np.argmax(np.where(near, jump, -1.0)))

    def _exchange(self, evidence: Evidence, i: int, j: int, touch: int, speed: Floats, time: float) -> list[Finding]:
        """What the collision changed, beside what gravity and friction did in the meantime."""
        before, after = max(0, touch - self.frames), min(len(evidence.time) - 1, touch + self.frames)
        span = float(evidence.time[after] - evidence.time[before])
        rubbed = largest_friction(evidence.world) * evidence.gravity * span
        changes = {k: self._jump(evidence, k, before, after, falling=j < 0) - rubbed for k in (i, j) if k >= 0}
        whose = max(changes, key=lambda k: changes[k])
        body = evidence.world.bodies[whose]
        found = [
            self.measured(
                f"{body.prim} changes its velocity by {changes[whose]:.3g} m/s as they meet, beyond what friction can",
                changes[whose], self.change * float(speed[before]), "m/s",
                at_most=False, prim=body.prim, time=time, line=body.line,
                limit_from=f"{self.change:g} of the speed at which they approach"
            )
        ]  # fmt: skip
        # A third body may take its share of the momentum, and a static one any amount.
        if j >= 0 and len(evidence.world.bodies) == 2:
            # A box that is hit tips on an edge, and may press harder for a frame than it weighs; a ball does not.
            balls = all(shape.kind == "sphere" for k in (i, j) for shape in evidence.solid(k).shapes)
            frames = sorted({before, touch, after}) if balls else [before, after]
            found.append(self._momentum(evidence, (i, j), frames))
        return found

    @staticmethod
    def _jump(evidence: Evidence, k: int, before: int, after: int, falling: bool) -> float:
        jump = evidence.body_qd[after, k, :3] - evidence.body_qd[before, k, :3]
        if falling:  # what comes at a fixed thing may be falling; what is on the ground is carried
            return float(
                np.linalg.norm(jump - np.array(evidence.world.gravity) * np.diff(evidence.time[[before, after]]))
            )
        return float(np.linalg.norm(level(jump, evidence.up)))

    def _momentum(self, evidence: Evidence, pair: tuple[int, int], frames: list[int]) -> Finding:
        """What the two do to each other leaves their momentum as it is: the time between frames that takes most."""
        masses = np.array([evidence.world.bodies[k].mass for k in pair])
        v = level(evidence.body_qd[np.ix_(frames, pair)][:, :, :3], evidence.up)  # (frames, 2 bodies, 3)
        scale = float(masses @ np.linalg.norm(v[0], axis=1))
        lost = np.linalg.norm(np.diff(np.einsum("b,tbi->ti", masses, v), axis=0), axis=1)
        weight = evidence.gravity * float(masses.sum())
        rubbed = largest_friction(evidence.world) * weight * np.diff(evidence.time[frames])
        limit = self.share * scale + rubbed
        k = int(np.argmax(lost / limit))
        start, end = float(evidence.time[frames[k]]), float(evidence.time[frames[k + 1]])
        return self.measured(
            f"The two keep their momentum to {lost[k]:.3g} kg m/s of {scale:.3g} between two frames",
            float(lost[k]), float(limit[k]), "kg m/s", time=end, span=(start, end), expected=0.0,
            limit_from=f"{self.share:g} of it, and what friction on the ground takes between two frames",
        )  # fmt: skip


OBJECTIVES: Objectives = {
    "moves": ObjectiveMoves,
    "slides": ObjectiveSlides,
    "rolls_down": ObjectiveRollsDown,
    "flies": ObjectiveFlies,
    "collides_with": ObjectiveCollidesWith,
}
