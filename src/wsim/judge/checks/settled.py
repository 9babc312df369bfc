"""The check that what is to float or rest has come to rest."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.kinds import ROUND
from wsim.judge.checks.check import Check, Checks
from wsim.judge.repair.lasting import settled

if TYPE_CHECKING:
    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding, RepairTarget


@dataclass
class CheckSettled(Check):
    """What is to float or rest has come to rest, so that a mean over the last second means something.

    Floating or round bodies may drift or roll: only their vertical speed counts.
    """

    factor: float = 0.05  # of sqrt(g L), L the body's smallest extent
    seconds: float = 0.5

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each body that an objective wants floating, under water or at rest."""
        if evidence.plan is None:
            return []
        found = []
        wanted = [o for o in evidence.plan.objectives if o.kind in ("floats", "submerged", "rests_on")]
        for name in dict.fromkeys(objective.object for objective in wanted):
            prim = evidence.prim(name)
            if any(body.prim == prim for body in evidence.world.bodies):
                found.append(self._speed(evidence, evidence.index(prim)))
        return found

    def _speed(self, evidence: Evidence, i: int) -> Finding:
        body, solid = evidence.world.bodies[i], evidence.solid(i)
        vertical = bool(evidence.world.fluids) or any(shape.kind in ROUND for shape in solid.shapes)
        v = evidence.body_qd[evidence.last(self.seconds), i, :3]
        speed = math.sqrt(float(np.mean((v @ evidence.up) ** 2 if vertical else np.sum(v**2, axis=1))))
        limit = self.factor * evidence.velocity_scale(solid.smallest)
        return self.measured(
            f"{body.prim} has {'a vertical speed' if vertical else 'a speed'} of {speed:.3g} m/s (rms) at the end",
            speed, limit, "m/s", prim=body.prim, time=float(evidence.time[-1]) - self.seconds,
            limit_from=f"{self.factor:g} sqrt(g L), L = {solid.smallest:.3g} m: bobbing by {self.factor:.0%} of L",
        )  # fmt: skip

    def repair(self, finding: Finding, evidence: Evidence) -> RepairTarget:
        """What dies down needs time; what does not is kept going."""
        return settled(finding, evidence)


CHECKS: Checks = (CheckSettled,)
