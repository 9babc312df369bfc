"""Objectives about bodies on a hinge: pendulums and seesaws."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, level, multiply, rotate
from wsim.judge.evidence.pendulum import swing_stretch
from wsim.judge.evidence.recorded import MissingError
from wsim.judge.objectives.objective import ObjectiveCheck, Objectives

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import Joint

    Floats = NDArray[np.float64]

AXES = {"X": (1.0, 0.0, 0.0), "Y": (0.0, 1.0, 0.0), "Z": (0.0, 0.0, 1.0)}


@dataclass
class _Pendulum:
    """What hangs on a hinge in the world, as one rigid body."""

    angle: Floats  # of its centre of mass from the vertical, about the hinge, (T,) [rad]
    mass: float  # [kg]
    arm: float  # from the hinge's axis to the centre of mass [m]
    inertia: float  # about the hinge's axis [kg m^2]


@dataclass
class ObjectiveSwings(ObjectiveCheck):
    """The body swings about its hinge with the period of a physical pendulum, and no higher than it was let go."""

    share: float = 0.03  # of the period
    growth: float = 0.02  # of the amplitude
    least: float = 0.5  # [deg]: a smaller swing is rest

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The amplitude at the start [deg], the period [s], and the amplitude at the end [deg]."""
        prim = evidence.prim(self.objective.object)
        swing = self._pendulum(evidence)
        amplitude = float(np.abs(swing.angle[0]))
        found = [
            self.measured(
                f"{prim} is let go at {math.degrees(amplitude):.3g} degrees", math.degrees(amplitude), self.least,
                "deg", at_most=False, time=float(evidence.time[0]), limit_from="a smaller swing is rest"
            )
        ]  # fmt: skip
        if not found[0].passed:
            return found
        expected = self._theory(evidence, swing, amplitude)
        crossings = _crossings(evidence.time, swing.angle)
        if len(crossings) < 2:
            message = f"{prim} passes the vertical {len(crossings)} times; a period takes {expected:.3g} s"
            return [*found, self.failed(message, expected=expected, unit="s", time=float(evidence.time[-1]))]
        value = 2 * float(np.diff(crossings).mean())
        slow = value > expected
        limit = expected * (1 + self.share if slow else 1 - self.share)
        found.append(
            self.measured(
                f"{prim} swings with a period of {value:.4g} s, where theory has {expected:.4g} s", value, limit, "s",
                at_most=slow, expected=expected, time=float(crossings[0]),
                limit_from=f"2 pi sqrt(I / m g d) at this amplitude, to {self.share:.0%}"
            )
        )  # fmt: skip
        late = np.abs(swing.angle[evidence.time >= crossings[0]])
        highest = math.degrees(float(late.max()))
        found.append(
            self.measured(
                f"{prim} swings up to {highest:.4g} degrees after it was let go at {math.degrees(amplitude):.4g}",
                highest, (1 + self.growth) * math.degrees(amplitude), "deg", expected=math.degrees(amplitude),
                time=float(evidence.time[evidence.time >= crossings[0]][np.argmax(late)]),
                limit_from=f"energy: no higher than at the start, to {self.growth:.0%}"
            )
        )  # fmt: skip
        return found

    def _theory(self, evidence: Evidence, swing: _Pendulum, amplitude: float) -> float:
        """Period of a physical pendulum at an amplitude: T0 / agm(1, cos(amplitude / 2)), which is exact [s]."""
        small = 2 * math.pi * math.sqrt(swing.inertia / (swing.mass * evidence.gravity * swing.arm))
        return small * float(swing_stretch(amplitude))

    def _pendulum(self, evidence: Evidence) -> _Pendulum:
        joint, names = self._chain(evidence)
        rows = [evidence.index(evidence.prim(name)) for name in names]
        hinge = evidence.index(evidence.prim(joint.child))
        offset = np.array(joint.anchor or (0.0, 0.0, 0.0))
        q = evidence.body_q[:, hinge]
        pivot = (q[:, :3] + rotate(q[:, 3:], np.broadcast_to(offset, (len(q), 3))))[0]
        axis = np.array(AXES[joint.axis])
        masses = np.array([evidence.world.bodies[i].mass for i in rows])
        centres = np.stack([self._centre(evidence, i) for i in rows])  # (B, T, 3)
        centre = np.tensordot(masses, centres, axes=1) / masses.sum() - pivot
        arm = centre - (centre @ axis)[:, None] * axis
        down = np.array(evidence.world.gravity) / max(evidence.gravity, 1e-9)
        angle = np.arctan2(np.cross(np.broadcast_to(down, arm.shape), arm) @ axis, arm @ down)
        inertia = sum(self._about(evidence, i, pivot, axis, c[0]) for i, c in zip(rows, centres, strict=True))
        return _Pendulum(angle, float(masses.sum()), float(np.linalg.norm(arm[0])), float(inertia))

    def _chain(self, evidence: Evidence) -> tuple[Joint, list[str]]:
        """The hinge in the world that the body hangs on, and every body that hangs there with it."""
        joints = evidence.plan.joints if evidence.plan is not None else []
        names = [self.objective.object]
        for name in names:
            for joint in joints:
                if joint.kind == "fixed" and name in (joint.child, joint.parent):
                    both = (joint.child, joint.parent)
                    names += [other for other in both if other is not None and other not in names]
        for joint in joints:
            if joint.kind == "hinge" and joint.parent is None and joint.child in names:
                return joint, names
        raise MissingError(f"the plan has no hinge that {self.objective.object} hangs on")

    @staticmethod
    def _centre(evidence: Evidence, i: int) -> Floats:
        """A body's centre of mass at each frame, (T, 3) [m]."""
        q = evidence.body_q[:, i]
        com = np.broadcast_to(np.array(evidence.world.bodies[i].com, dtype=np.float64), (len(q), 3))
        centre: Floats = q[:, :3] + rotate(q[:, 3:], com)
        return centre

    @staticmethod
    def _about(evidence: Evidence, i: int, pivot: Floats, axis: Floats, centre: Floats) -> float:
        """A body's inertia about the hinge at the start, by Steiner's theorem [kg m^2]."""
        body = evidence.world.bodies[i]
        turned = rotate(conjugate(evidence.body_q[0, i, 3:]), axis)
        own = float(turned @ np.array(body.inertia).reshape(3, 3) @ turned)
        arm = centre - pivot
        return own + body.mass * float(arm @ arm - (arm @ axis) ** 2)


def _crossings(time: Floats, angle: Floats) -> Floats:
    """When the angle passes zero, by straight lines between frames."""
    k = np.flatnonzero(angle[:-1] * angle[1:] < 0)
    crossed: Floats = time[k] - angle[k] * (time[k + 1] - time[k]) / (angle[k + 1] - angle[k])
    return crossed


@dataclass
class ObjectiveTilts(ObjectiveCheck):
    """The body ends turned, lower on the side where the other object starts."""

    angle: float = 5.0  # [deg]

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding: how far that side is below the level at the lowest [deg]."""
        prim = evidence.prim(self.objective.object)
        i, j = evidence.index(prim), evidence.index(evidence.prim(self.ref()))
        side = evidence.body_q[0, j, :3] - evidence.body_q[0, i, :3]
        side = level(side, evidence.up)
        if np.linalg.norm(side) < 1e-6:
            raise MissingError(f"{self.ref()} starts over the middle of {self.objective.object}: no side goes down")
        q = evidence.body_q[:, i, 3:]
        since = multiply(q, np.broadcast_to(conjugate(q[0]), q.shape))
        turned = rotate(since, np.broadcast_to(side / np.linalg.norm(side), (len(q), 3)))
        below = np.degrees(np.arcsin(np.clip(-turned @ evidence.up, -1.0, 1.0)))
        value = float(below.max())
        limit = self.objective.tolerance or self.angle
        return [
            self.measured(
                f"{prim} goes down by {value:.3g} degrees on the side of {self.ref()}", value, limit, "deg",
                at_most=False, time=float(evidence.time[np.argmax(below)]), limit_from="clearly out of level"
            )
        ]  # fmt: skip


OBJECTIVES: Objectives = {
    "swings": ObjectiveSwings,
    "tilts": ObjectiveTilts,
}
