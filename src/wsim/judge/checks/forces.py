"""The books: every motion has forces behind it that the world can exert."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books.balance import Balance, rounding
from wsim.judge.checks.check import Check, Checks, listed
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.books.balance import Books
    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding

    Floats = NDArray[np.float64]


@dataclass
class CheckForces(Check):
    """What changes the momentum of a body is gravity, what is known to push it, and what touches or holds it."""

    share: float = 0.05  # of gravity
    blow: float = 0.03  # of the change of velocity in an interval: where a body turns while it is hit is not known

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The force and the torque that nothing in the world gives, where they are largest by their limits."""
        motion, recording = evidence.motion, evidence.recording
        if not len(motion.h) or not len(motion.mass) or recording.metadata.get("velocities") == "differences":
            return []
        if recording.applied_impulse is None and (evidence.world.fluids or recording.metadata.get("controlled")):
            return []
        balance = Balance(evidence)
        books = balance.books()
        if not books.judged.any():
            return []
        pull = max(evidence.gravity, 1.0)
        base = self.share * pull + self.blow * books.blow / motion.h[:, None] + rounding(evidence)
        found = [self._missing(evidence, books, books.force, base + books.turned[..., 0], motion.mass, "N")]
        # What fluid and control turn bodies by is not recorded.
        pushed = recording.applied_impulse
        known = np.ones(len(motion.mass), dtype=bool) if pushed is None else ~np.any(pushed != 0.0, axis=(0, 2))
        if known.any() and not recording.metadata.get("controlled"):
            torque = np.where(known[None, :, None], books.torque, 0.0)
            found.append(
                self._missing(evidence, books, torque, base + books.turned[..., 1], motion.mass * balance.size, "N m")
            )
        return found

    def _missing(
        self, evidence: Evidence, books: Books, left: Floats, limit: Floats, weight: Floats, unit: str
    ) -> Finding:
        size = np.where(books.judged, np.linalg.norm(left, axis=2), 0.0)
        k, i = np.unravel_index(int(np.argmax(size / limit)), size.shape)
        prim, start, end = evidence.world.bodies[i].prim, float(evidence.time[k]), float(evidence.time[k + 1])
        way = listed(tuple((left[k, i] / max(float(size[k, i]), 1e-300)).round(2)))
        value, most = float(size[k, i] * weight[i]), float(limit[k, i] * weight[i])
        kind, verb = ("force", "pushed") if unit == "N" else ("torque", "turned")
        share = f", {size[k, i] / evidence.gravity:.2g} of its weight" if unit == "N" and evidence.gravity else ""
        return self.measured(
            f"{prim} is {verb} by {value:.3g} {unit}{share}, towards {way}, that nothing in the world gives, "
            f"from {start:.3f} to {end:.3f} s",
            value, most, unit, prim=prim, time=end, span=(start, end), expected=0.0,
            fine=f"Every {kind} on every body has something in the world that gives it",
            limit_from=f"{self.share:g} of gravity, {self.blow:g} of the change of velocity, and how far bodies turn "
            "between two frames",
            target=RepairTarget(kind="program", prim=prim, why=f"a {kind} acts on it that the world does not have"),
        )  # fmt: skip


CHECKS: Checks = (CheckForces,)
