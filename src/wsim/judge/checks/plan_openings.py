"""The check of a world's taps and drains against the plan's."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from wsim.judge.checks.check import Check, Checks
from wsim.judge.verdict import RepairTarget
from wsim.plan.layout.openings import mouth_of
from wsim.scene.world_openings import Tap

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import OpeningPlan, Plan
    from wsim.scene.world_openings import Drain


@dataclass
class CheckPlanOpenings(Check):
    """Fluid comes in and leaves where the plan says, as much and as long; and nowhere else."""

    of_world = True

    share: float = 0.05  # of a rate, a width and a time
    widths: float = 0.5  # of a mouth, that it may be beside its place

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each number that is another, or one for none; nothing where a parameter was changed."""
        plan, world = evidence.plan, evidence.world
        if plan is None or evidence.varied or not (plan.openings or world.taps or world.drains):
            return []
        made: list[Tap | Drain] = [*world.taps, *world.drains]
        planned = {evidence.prim(each.name): each for each in plan.openings}
        found: list[Finding] = []
        for prim, opening in planned.items():
            found += self._one(plan, prim, opening, next((each for each in made if each.prim == prim), None))
        for prim in sorted({each.prim for each in made} - planned.keys()):
            target = RepairTarget(kind="extra object", prim=prim, direction="remove", why="the plan does not have it")
            message = f"{prim} lets fluid through; the plan has no such opening"
            found.append(self.failed(message, prim=prim, target=target))
        return found or [self.passed("Fluid comes in and leaves as the plan says")]

    def _one(self, plan: Plan, prim: str, opening: OpeningPlan, made: Tap | Drain | None) -> Iterator[Finding]:
        if made is None or isinstance(made, Tap) != (opening.kind == "tap"):
            target = RepairTarget(kind="missing object", prim=prim, direction="add", why="the plan has it")
            yield self.failed(f"The plan has a {opening.kind} {prim}; the world does not", prim=prim, target=target)
            return
        beside, wide = math.dist(mouth_of(plan, opening), made.position), self.widths * opening.narrowest
        yield from self._number(prim, "position", beside, 0.0, "m", wide)
        numbers = [("area", made.area, opening.area, "m^2")]
        if isinstance(made, Tap):
            end = plan.simulation.duration
            numbers += [
                ("rate", made.rate, opening.rate or 0.0, "m^3/s"),
                ("start", made.start, opening.start or 0.0, "s"),
                ("stop", made.stop or end, opening.stop or end, "s"),
                ("speed", made.drop_speed, opening.drop_speed or 0.0, "m/s"),
            ]
        for name, value, wanted, unit in numbers:
            yield from self._number(prim, name, value, wanted, unit, self.share * wanted + 1e-6)

    def _number(self, prim: str, name: str, value: float, wanted: float, unit: str, off: float) -> Iterator[Finding]:
        if abs(value - wanted) <= off:
            return
        target = RepairTarget(
            kind="program", prim=prim, parameter=name, direction="change", suggested=wanted, unit=unit,
            why="the plan's",
        )  # fmt: skip
        what = f"is {value:.4g} m from its place" if name == "position" else f"has {name} {value:.4g} {unit}"
        yield self.between(
            f"{prim} {what}; the plan has {wanted:.4g} {unit}", value, (wanted - off, wanted + off), unit,
            expected=wanted, prim=prim, time=0.0, limit_from="the plan's openings", target=target,
        )  # fmt: skip


CHECKS: Checks = (CheckPlanOpenings,)
