"""Objectives about bodies that move: how far, how, and what they hit."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, level, rotate
from wsim.geometry.shapes import into, kind_of
from wsim.judge.evidence.contact import distance
from wsim.judge.evidence.faces import normal_under
from wsim.judge.evidence.recorded import MissingError
from wsim.judge.language.objective import findings
from wsim.judge.objectives.objective import ObjectiveCheck, Objectives
from wsim.plan.schema.formula import CollidesWith

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding

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
    parting: float = 0.05  # of its smallest extent: a gap beyond is no contact any more

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
        """All of its way (T,): down a ramp until it leaves that, for what it meets then is another story."""
        if self.objective.ref is None:
            return np.ones(len(evidence.time), dtype=bool)
        gap = distance(evidence, evidence.world.bodies[i].prim, evidence.prim(self.objective.ref))
        near = gap <= self.parting * evidence.solid(i).smallest
        left = np.flatnonzero(~near & (np.cumsum(near) > 0))
        here = np.ones(len(near), dtype=bool)
        if len(left):
            here[left[0] :] = False
        return here


@dataclass
class ObjectiveRollsDown(ObjectiveSlides):
    """The body rolls down the ramp `ref`, at the acceleration that its own inertia leaves of gravity's pull."""

    accuracy: float = 0.1  # of the acceleration

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The way made [m], how much of it is rolling [1], and for a ball let go the acceleration [m/s^2]."""
        i = evidence.index(evidence.prim(self.objective.object))
        along = downhill(evidence, self.ref(), i)
        found = [self._way(evidence, i, None, along), self._turning(evidence, i, rolls=True)]
        body = evidence.world.bodies[i]
        here = self._frames(evidence, i)
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
        end = min(end, int(jolts[0]) + 1 if len(jolts) else end)
        end = max(1, min(end, self._splash(evidence, i, end)))
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

    @staticmethod
    def _splash(evidence: Evidence, i: int, end: int) -> int:
        """The first frame at which a particle of some fluid is within half a spacing of the body."""
        solid = evidence.solid(i)
        for k in range(end):
            for fluid in evidence.world.fluids:
                track = evidence.track(fluid)
                points = track.position[int(np.argmin(np.abs(track.time - evidence.time[k])))]
                apart = np.asarray(points, dtype=np.float64) - evidence.body_q[k, i, :3]
                near = apart[np.linalg.norm(apart, axis=1) < float(evidence.motion.radius[i]) + fluid.spacing]
                own = rotate(conjugate(evidence.body_q[k, i, 3:]), near)
                depths = (kind_of(shape).depth(into(shape, own)) for shape in solid.shapes)
                if len(own) and any(bool(np.any(depth > -fluid.spacing / 2)) for depth in depths):
                    return k
        return end


@dataclass
class ObjectiveCollidesWith(ObjectiveCheck):
    """The body comes at the other object, touches it, and the blow ends that at once: the language's predicate."""

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding: of the gap [m], the change of speed and the speed of approach [m/s], what decides."""
        return findings(self, CollidesWith(object=self.objective.object, ref=self.ref()), evidence)


OBJECTIVES: Objectives = {
    "moves": ObjectiveMoves,
    "slides": ObjectiveSlides,
    "rolls_down": ObjectiveRollsDown,
    "flies": ObjectiveFlies,
    "collides_with": ObjectiveCollidesWith,
}
