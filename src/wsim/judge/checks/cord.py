"""The check of ropes: they get no longer than they are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.checks.check import Check, Checks
from wsim.judge.evidence.cords import length_of_rope
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding


@dataclass
class CheckRopes(Check):
    """A rope holds: its way is never longer than it is."""

    share: float = 0.005  # of its length

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each rope."""
        found = []
        for rope in evidence.world.ropes:
            over = length_of_rope(evidence, rope) - rope.length
            limit = self.share * rope.length
            wrong = over > limit
            at = int(np.argmax(wrong)) if wrong.any() else int(np.argmax(over))
            value = float(max(over.max(), 0.0))
            found.append(
                self.measured(
                    f"{rope.prim} is stretched by {value * 1e3:.3g} mm, {value / rope.length:.2%} of its length",
                    value, limit, "m", fine=f"{rope.prim} holds", prim=rope.prim, time=float(evidence.time[at]),
                    expected=0.0, limit_from=f"{self.share:g} of its {rope.length:.3g} m",
                    target=RepairTarget(kind="program", prim=rope.prim, why="it does not hold what pulls on it"),
                )
            )  # fmt: skip
        return found


CHECKS: Checks = (CheckRopes,)
