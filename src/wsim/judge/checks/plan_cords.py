"""The check of a world's ropes, springs and cables against the plan's: between whom, how long, how stiff."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from wsim.judge.checks.check import Check, Checks
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import Cord
    from wsim.scene.world import Guide, Rope, Spring

_UNITS = {"stiffness": "N/m", "damping": "N s/m", "rest_length": "m", "length": "m"}


@dataclass
class CheckPlanCords(Check):
    """The world has the plan's ropes, springs and cables, between its objects, of its lengths and stiffness."""

    of_world = True

    share: float = 0.05  # of a length, a stiffness or a damping
    least: float = 1e-3  # what it may be off of nothing

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each cord that is missing or another than the plan's, or one for none."""
        plan = evidence.plan
        if plan is None or not plan.cords:
            return []
        found = [finding for cord in plan.cords for finding in self._cord(evidence, cord)]
        return found or [self.passed("The world has the plan's ropes, springs and cables")]

    def _cord(self, evidence: Evidence, cord: Cord) -> Iterator[Finding]:
        prim = evidence.prim(cord.name)
        if cord.kind == "cable":
            if not any(cord.owns(body.prim.rpartition("/")[2]) for body in evidence.world.bodies):
                yield self._missing(cord, prim)
            return
        made = next((each for each in _of_kind(evidence, cord.kind) if each.prim == prim), None)
        if made is None:
            yield self._missing(cord, prim)
            return
        first, *between, last = made.path
        rounds = [guide.owner for guide in between if guide.radius > 0.0]
        wanted = [evidence.prim(each.object) for each in cord.around or ()]
        ends = tuple(evidence.prim(name) if name else None for name in (cord.a, cord.b))
        if (_owner(first), _owner(last)) != ends or rounds != wanted:
            planned = " to ".join(str(end or "the world") for end in (ends[0], *wanted, ends[1]))
            message = f"{prim} does not run from {planned}, as the plan has it"
            target = RepairTarget(kind="joint", prim=prim, parameter="a", direction="change", text=planned)
            yield self.failed(message, prim=prim, time=0.0, target=target)
        if not evidence.varied:
            yield from self._numbers(made, cord)

    def _missing(self, cord: Cord, prim: str) -> Finding:
        target = RepairTarget(kind="joint", prim=prim, parameter=cord.name, direction="add")
        return self.failed(
            f"The plan's {cord.kind} {cord.name} is not in the world", prim=prim, time=0.0, target=target
        )

    def _numbers(self, made: Rope | Spring, cord: Cord) -> Iterator[Finding]:
        for field, unit in _UNITS.items():
            planned, value = getattr(cord, field), getattr(made, field, None)
            if planned is None or value is None:
                continue
            limit = max(self.share * planned, self.least)
            if abs(value - planned) > limit:
                yield self.measured(
                    f"{made.prim} has a {field} of {value:.4g} {unit}; the plan's {cord.name} {planned:.4g} {unit}",
                    abs(value - planned), limit, unit, expected=0.0, prim=made.prim, time=0.0,
                    limit_from=f"{self.share:g} of the plan's",
                    target=RepairTarget(
                        kind="physical parameter", prim=made.prim, parameter=field, direction="change", current=value,
                        suggested=planned, unit=unit,
                    ),
                )  # fmt: skip


def _of_kind(evidence: Evidence, kind: str) -> list[Rope] | list[Spring]:
    return evidence.world.ropes if kind == "rope" else evidence.world.springs


def _owner(guide: Guide) -> str | None:
    return guide.owner or guide.body


CHECKS: Checks = (CheckPlanCords,)
