"""Stops and ropes throw nothing back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from wsim.judge.books.catches import catches
from wsim.judge.checks.check import Check, Checks
from wsim.judge.evidence.scheduled import pushes
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from wsim.judge.books.catches import Catch
    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding


@dataclass
class CheckCatches(Check):
    """What comes to the end of its joint or its rope leaves it no faster than what else acts takes it back."""

    share: float = 0.02  # of the approach: 0.0001 in wsim's own runs

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The catch that throws back most, by its limit. Other engines' stops are springs."""
        if evidence.world.combine != "smaller" or evidence.recording.metadata.get("velocities") == "differences":
            return []
        if evidence.world.fluids or evidence.recording.metadata.get("controlled") or pushes(evidence.world):
            return []
        found = catches(evidence)
        if not found:
            return []
        worst = max(found, key=lambda catch: catch.back / self._limit(catch))
        time = float(evidence.time[worst.interval + 1])
        return [
            self.measured(
                f"{worst.prim} throws what comes to its end at {worst.approach:.3g} {worst.unit} back at "
                f"{worst.back:.3g} {worst.unit}, at {time:.3f} s",
                worst.back, self._limit(worst), worst.unit, prim=worst.prim, time=time, expected=0.0,
                limit_from=f"{self.share:g} of the approach, and twice what else changes it in an interval: stops and "
                "ropes have no restitution",
                target=RepairTarget(kind="joint", prim=worst.prim, why="its stop or its end pushes more than it may"),
            )
        ]  # fmt: skip

    def _limit(self, catch: Catch) -> float:
        return self.share * catch.approach + catch.others


CHECKS: Checks = (CheckCatches,)
