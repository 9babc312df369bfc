"""Action and reaction: what a fluid says that it gave to bodies and walls is what its own momentum lost."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books.fluids import fluid_books
from wsim.judge.checks.check import Check, Checks, listed
from wsim.judge.evidence.motion import FLOAT32
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding


@dataclass
class CheckFluidMomentum(Check):
    """The fluids' momentum changes by gravity, and by what they give to bodies and to what stands still."""

    share: float = 1e-5  # of all impulses in the sum: it is of single precision

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for all fluids, which share a solver: where most is missing, by its limit."""
        books = fluid_books(evidence)
        if books is None:
            return []
        # What is left of the last drops in a drained tank is the rounding of sums that all of it went through.
        limits = self.share * books.turnover + books.rounding + FLOAT32 * books.turnover.max()
        left = np.linalg.norm(books.left, axis=1)
        k = int(np.argmax(left / np.maximum(limits, 1e-300)))
        start, end = float(books.time[k]), float(books.time[k + 1])
        force, limit = float(left[k] / (end - start)), float(limits[k] / (end - start))
        way = listed(tuple((books.left[k] / max(left[k], 1e-300)).round(2)))
        fluid = evidence.world.fluids[0].prim
        return [
            self.measured(
                f"{fluid} gains {force:.3g} N towards {way} that neither gravity nor bodies nor walls give it, "
                f"from {start:.3f} to {end:.3f} s",
                force, limit, "N", prim=fluid, time=end, span=(start, end), expected=0.0,
                fine="What the fluids give to bodies and walls is what they lose",
                limit_from=f"{self.share:g} of all forces in the sum, which is of single precision",
                target=RepairTarget(
                    kind="program", prim=fluid, why="its forces on bodies are not those that its particles feel"
                ),
            )
        ]  # fmt: skip


CHECKS: Checks = (CheckFluidMomentum,)
