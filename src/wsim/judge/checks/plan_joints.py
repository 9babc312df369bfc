"""The check of a world's joints against the plan's: between whom, how far they go, and what drives them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from wsim.judge.checks.check import Check, Checks, listed
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import Joint as PlanJoint
    from wsim.scene.world import Joint

JOINTS = {"fixed": "fixed", "hinge": "revolute", "slider": "prismatic", "ball": "spherical"}


@dataclass
class CheckPlanJoints(Check):
    """The world has the plan's joints, between the plan's bodies, with the plan's limits and drives."""

    share: float = 0.05  # of the range, of what a drive is set to, or of its strength
    least: float = 0.01  # [rad], [m], or that a second: what a drive may be off of nothing

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each joint that is missing, or holds, ends or is driven otherwise; or one for none."""
        if evidence.plan is None or not evidence.plan.joints:
            return []
        found = []
        for planned in evidence.plan.joints:
            made = self._made(evidence, planned)
            if made is None:
                child = evidence.prim(planned.child)
                message = f"The plan's {planned.kind} {planned.name} is not in the world: nothing holds {child} so"
                target = RepairTarget(kind="joint", prim=child, parameter=planned.name, direction="add")
                found.append(self.failed(message, prim=child, time=0.0, target=target))
            elif not evidence.varied:
                found += [*self._limits(made, planned), *self._drive(evidence, made, planned)]
        return found or [self.passed("The world has the plan's joints")]

    @staticmethod
    def _made(evidence: Evidence, planned: PlanJoint) -> Joint | None:
        """The world's joint between the same two, either way round."""
        still = {static.prim for static in evidence.world.statics}
        parent = evidence.prim(planned.parent) if planned.parent is not None else None
        ends = {None if parent in still else parent, evidence.prim(planned.child)}
        fitting = (j for j in evidence.world.joints if j.kind == JOINTS[planned.kind] and {j.parent, j.child} == ends)
        return next(fitting, None)

    def _limits(self, made: Joint, planned: PlanJoint) -> Iterator[Finding]:
        if planned.limits is None:
            return
        scale, unit = (math.radians(1.0), "rad") if planned.kind == "hinge" else (1.0, "m")
        low, high = (scale * end for end in planned.limits)
        has = (-math.inf if made.low is None else made.low, math.inf if made.high is None else made.high)
        # Seen from the other end, or about the opposite axis, a joint turns the other way.
        off = min(max(abs(has[0] - a), abs(has[1] - b)) for a, b in ((low, high), (-high, -low)))
        limit = self.share * (high - low)
        if off > limit:
            yield self.measured(
                f"{made.prim} moves within {listed(has)} {unit}; the plan's {planned.name} within "
                f"{listed((low, high))} {unit}",
                off, limit, unit, expected=0.0, prim=made.prim, time=0.0,
                limit_from=f"{self.share:g} of the plan's range",
                target=RepairTarget(kind="joint", prim=made.prim, parameter="limits", direction="change"),
            )  # fmt: skip

    def _drive(self, evidence: Evidence, made: Joint, planned: PlanJoint) -> Iterator[Finding]:
        """What the joint's drive is set to, and how strongly it acts, against the plan's."""
        wanted = planned.drive
        # What a controller sets or does itself is not to be read off the stage.
        if wanted is None or evidence.recording.metadata.get("controlled"):
            return
        if made.drive is None:
            message = f"Nothing drives {made.prim}; the plan's {planned.name} has a drive"
            target = RepairTarget(kind="drive", prim=made.prim, parameter="drive", direction="add")
            yield self.failed(message, prim=made.prim, time=0.0, target=target)
            return
        turns = planned.kind == "hinge"
        scale, unit = (math.radians(1.0), "rad") if turns else (1.0, "m")
        effort = "N m" if turns else "N"
        # What has no stiffness holds no position, and what has no damping no speed.
        position = (made.drive.position, scale * wanted.position) if wanted.stiffness else (0.0, 0.0)
        velocity = (made.drive.velocity, scale * wanted.velocity) if wanted.damping else (0.0, 0.0)
        # Seen from the other end, or about the opposite axis, both are of the other sign.
        way = min((1.0, -1.0), key=lambda sign: sum(abs(sign * has - to) for has, to in (position, velocity)))
        for what, (has, to), of in (("position", position, unit), ("velocity", velocity, unit + "/s")):
            yield from self._target(made, what, has, to, abs(way * has - to), of)
        most, bound = (math.inf if end is None else end for end in (made.drive.max_effort, wanted.max_force))
        for what, has, to, of in (
            ("stiffness", made.drive.stiffness, wanted.stiffness, f"{effort}/{unit}"),
            ("damping", made.drive.damping, wanted.damping, f"{effort} s/{unit}"),
            ("max_force", most, bound, effort),
        ):
            yield from self._strength(made, what, has, to, of)

    def _target(self, made: Joint, what: str, has: float, to: float, off: float, unit: str) -> Iterator[Finding]:
        limit = max(self.share * abs(to), self.least)
        if off > limit:
            target = RepairTarget(
                kind="drive", prim=made.prim, parameter=f"drive.{what}", direction="change", current=has, suggested=to,
                unit=unit,
            )  # fmt: skip
            yield self.measured(
                f"{made.prim} is driven to {has:.3g} {unit}; the plan has {to:.3g} {unit}",
                off, limit, unit, expected=0.0, prim=made.prim, time=0.0,
                limit_from=f"{self.share:g} of the plan's, or {self.least:g} {unit}", target=target,
            )  # fmt: skip

    def _strength(self, made: Joint, what: str, has: float, to: float, unit: str) -> Iterator[Finding]:
        if has == to or abs(has - to) <= self.share * to < math.inf:
            return
        known, wanted = ((x if math.isfinite(x) else None) for x in (has, to))
        said = [f"{x:.4g} {unit}" if math.isfinite(x) else "none" for x in (has, to)]
        direction = "lower" if has > to else "raise"
        yield self.failed(
            f"The drive of {made.prim} has a {what.replace('_', ' ')} of {said[0]}; the plan has {said[1]}",
            prim=made.prim, time=0.0, value=known, expected=wanted, unit=unit,
            limit_from=f"the plan's, to {self.share:.0%}",
            target=RepairTarget(
                kind="drive", prim=made.prim, parameter=f"drive.{what}", direction=direction, current=known,
                suggested=wanted, unit=unit,
            ),
        )  # fmt: skip


CHECKS: Checks = (CheckPlanJoints,)
