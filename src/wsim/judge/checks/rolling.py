"""Rolling resistance: what rolls is slowed as its surfaces state, and by nothing else."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from wsim.judge.books.rolling import rolls
from wsim.judge.checks.check import Check, Checks
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from wsim.judge.books.rolling import Rolls
    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding


@dataclass
class CheckRolling(Check):
    """The torque against what rolls is what the pair's resistance gives for the push."""

    least: float = 0.0003  # of its radius: 1e-5 in wsim's own runs
    share: float = 0.02  # of what is stated: 0.002 in wsim's own runs

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The span that is farthest off, by its limit. Other engines' contacts slip as they roll."""
        if evidence.world.combine != "smaller" or evidence.recording.metadata.get("velocities") == "differences":
            return []
        found = rolls(evidence)
        if not found:
            return []
        worst = max(found, key=lambda each: self._off(each) / self._limit(each))
        prim, limit = evidence.world.bodies[worst.row].prim, self._limit(worst)
        first, last = float(evidence.time[worst.first]), float(evidence.time[worst.last])
        return [
            self.between(
                f"{prim} rolls on {worst.other} against {worst.resisted / worst.radius:.3g} of its radius times the "
                f"push, from {first:.3f} to {last:.3f} s; their surfaces state {worst.stated / worst.radius:.3g}",
                worst.resisted, (worst.least - limit, worst.stated + limit), "m", worst.stated, prim=prim, time=last,
                span=(first, last),
                limit_from=f"the pair's rolling resistance, less what friction takes; {self.least:g} of its radius "
                f"and {self.share:g} of it",
                target=RepairTarget(
                    kind="physical parameter", prim=prim, parameter="rolling_friction", why="it is another than stated"
                ),
            )
        ]  # fmt: skip

    def _off(self, found: Rolls) -> float:
        return max(found.resisted - found.stated, found.least - found.resisted)

    def _limit(self, found: Rolls) -> float:
        return self.least * found.radius + self.share * found.stated + found.unsure


CHECKS: Checks = (CheckRolling,)
