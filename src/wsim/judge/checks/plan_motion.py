"""Checks of the stage's motion against the plan: spins, rolling starts, the speed of belts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import level, rotate
from wsim.judge.checks.check import Check, Checks, listed
from wsim.judge.checks.plan import pairs, quaternion
from wsim.judge.verdict import RepairTarget
from wsim.plan.schema.objects import ROLLS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import PlanObject
    from wsim.scene.world import Body, Static

    Floats = NDArray[np.float64]


@dataclass
class CheckPlanMotion(Check):
    """What rolls in the plan starts with the spin that fits, all else with its own or none, and belts run as fast."""

    of_world = True

    share: float = 0.05  # of the plan's speed
    still: float = 0.05  # [rad/s]: a spin below is none

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each object that moves otherwise, or one for none."""
        found = [finding for item, made in pairs(evidence) for finding in self._motion(evidence, made, item)]
        objects = evidence.plan.objects if evidence.plan is not None else []
        asked = any(o.rolling or o.angular_velocity_deg or o.surface_velocity for o in objects)
        return found or ([self.passed("Objects move from the start as the plan has it")] if asked else [])

    def _motion(self, evidence: Evidence, made: Body | Static, item: PlanObject) -> Iterator[Finding]:
        body = next((body for body in evidence.world.bodies if body.prim == made.prim), None)
        if body is not None and not evidence.varied:
            yield from self._spin(evidence, body, item)
        if item.surface_velocity is not None or any(any(shape.surface_velocity) for shape in made.shapes):
            yield from self._belt(made, item, fixed=body is None)

    def _spin(self, evidence: Evidence, body: Body, item: PlanObject) -> Iterator[Finding]:
        spin = np.array(body.angular_velocity)
        if item.rolling and item.primitive in ROLLS:
            slip = float(np.linalg.norm(np.array(body.velocity) - _rolled(body, spin, item.size[0], evidence.up)))
            speed = float(np.linalg.norm(body.velocity))
            if slip > self.share * speed:
                message = f"{body.prim} starts rolling, and its surface slips by {slip:.3g} m/s at {speed:.3g} m/s"
                yield self._off(message, slip, self.share * speed, "m/s", body, "rolling", "start it with rolling=True")
        else:
            stated = item.angular_velocity_deg or (0.0, 0.0, 0.0)
            planned = np.radians(stated)
            off = float(np.linalg.norm(spin - planned))
            limit = max(self.share * float(np.linalg.norm(planned)), self.still)
            if off > limit:
                told = listed(tuple(float(x) for x in np.degrees(spin)))
                message = f"{body.prim} starts turning at {told} deg/s; the plan has {listed(stated)}"
                why = "give it the plan's spin"
                yield self._off(message, off, limit, "rad/s", body, "angular_velocity_deg", why, stated)

    def _belt(self, made: Body | Static, item: PlanObject, *, fixed: bool) -> Iterator[Finding]:
        """In the body's axes, or the world's for what is static."""
        planned = np.array(item.surface_velocity or (0.0, 0.0, 0.0))
        if fixed and item.pose is not None:
            planned = rotate(quaternion(item.pose.rotation_deg), planned)
        stated = max((s.surface_velocity for s in made.shapes), key=lambda v: float(np.linalg.norm(v - planned)))
        off = float(np.linalg.norm(np.array(stated) - planned))
        limit = self.share * float(np.linalg.norm(planned))
        if off > limit:
            told = listed(tuple(float(x) for x in planned))
            message = f"The surface of {made.prim} runs at {listed(stated)} m/s; the plan has {told}"
            yield self._off(message, off, limit, "m/s", made, "surface_velocity", "call scene.surface_velocity")

    def _off(
        self, message: str, value: float, limit: float, unit: str, made: Body | Static, parameter: str, why: str,
        vector: tuple[float, ...] | None = None,
    ) -> Finding:  # fmt: skip
        target = RepairTarget(
            kind="physical parameter", prim=made.prim, parameter=parameter, direction="change", vector=vector, why=why
        )
        return self.measured(
            message, value, limit, unit, expected=0.0, prim=made.prim, time=0.0, line=made.line,
            limit_from=f"{self.share:g} of the plan's speed", target=target,
        )  # fmt: skip


def _rolled(body: Body, spin: Floats, radius: float, up: Floats) -> Floats:
    """The velocity that a spin gives what rolls, on what is as upright as its velocity lets it be [m/s]."""
    velocity = np.array(body.velocity)
    ahead = velocity / max(float(np.linalg.norm(velocity)), 1e-12)
    normal = level(up, ahead)
    rolled: Floats = radius * np.cross(spin, normal / max(float(np.linalg.norm(normal)), 1e-12))
    return rolled


CHECKS: Checks = (CheckPlanMotion,)
