"""Newton's law of impact: bodies part as fast as their pair's restitution lets them, neither faster nor slower."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from wsim.judge.books.impacts import blows
from wsim.judge.checks.check import Check, Checks
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from wsim.judge.books.impacts import Blow
    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding


@dataclass
class CheckRestitution(Check):
    """After a blow that stands alone two bodies part at their restitution times the speed at which they met."""

    share: float = 0.02  # of the approach: twice what wsim's own blows leave

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The blow that is farthest off, by its limit. Other engines' contacts are soft and state no restitution."""
        if evidence.world.combine != "smaller" or evidence.recording.metadata.get("velocities") == "differences":
            return []
        if evidence.world.fluids or evidence.recording.metadata.get("controlled"):
            return []
        found = blows(evidence)
        if not found:
            return []
        worst = max(found, key=lambda blow: abs(self._off(blow)) / self._limit(blow))
        one, two = worst.prims
        expected, limit = worst.restitution * worst.approach, self._limit(worst)
        time = float(evidence.time[worst.interval + 1])
        return [
            self.between(
                f"{one} and {two} part at {worst.parting:.3g} m/s at {time:.3f} s, after they met at "
                f"{worst.approach:.3g} m/s",
                worst.parting, (expected - limit, expected + limit), "m/s", expected, prim=two, time=time,
                limit_from=f"restitution {worst.restitution:g} times the approach; {self.share:g} of it, and twice "
                "what a step changes",
                target=RepairTarget(
                    kind="physical parameter", prim=two, parameter="restitution", why="it is another than stated"
                ),
            )
        ]  # fmt: skip

    def _off(self, blow: Blow) -> float:
        return blow.parting - blow.restitution * blow.approach

    def _limit(self, blow: Blow) -> float:
        return self.share * blow.approach + blow.unsure


CHECKS: Checks = (CheckRestitution,)
