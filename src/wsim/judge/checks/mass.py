"""Checks of what bodies weigh: as their materials and sizes have it, and with an inertia that fits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.checks.check import Check, Checks, share_about
from wsim.judge.verdict import RepairTarget
from wsim.scene.solids import together

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.scene.world import Body

SOLIDS = ("box", "sphere", "cylinder", "capsule")  # of one material each, where a plan has them
LIGHTEST, DENSEST = 1.0, 22_600.0  # [kg/m^3]: an aerogel, osmium


@dataclass
class CheckMass(Check):
    """Each body weighs what its material and size give, and turns as its mass and size let it."""

    of_world = True

    share: float = 0.05  # of the plan's mass: a mesh is not quite the shape it stands for
    varied: float = 0.55  # of it, where a parameter of the program was set to another value than its own
    thin: float = 0.02  # of m R^2: below, its mass would have to lie on a line
    off: float = 0.02  # of its radius: from the centre of its shapes to that of its mass
    other: float = 0.05  # of a moment of inertia that its shapes give

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each body whose mass or inertia is out of bounds, or one for none."""
        found = []
        every = np.linalg.eigvalsh(evidence.motion.inertia)
        for i, body in enumerate(evidence.world.bodies):
            if not body.kinematic:
                found += self._mass(evidence, body)
                found += self._inertia(evidence, i, body, every[i], _stated_elsewhere(evidence))
                found += self._as_its_shapes(evidence, i, body)
        wrong = [finding for finding in found if not finding.passed]
        return wrong or ([self.passed("Bodies weigh what their sizes and materials give")] if found else [])

    def _mass(self, evidence: Evidence, body: Body) -> list[Finding]:
        item = evidence.planned(body.prim)
        expected = item.mass if item is not None else None
        if expected is None:
            return [] if _stated_elsewhere(evidence) else self._density(body)
        share = self.varied if evidence.varied else self.share
        return [
            self.between(
                f"{body.prim} weighs {body.mass:.4g} kg; the plan's material and size give {expected:.4g} kg",
                body.mass, share_about(expected, share), "kg", expected=expected, prim=body.prim, time=0.0,
                limit_from=f"{share:g} of density times volume, as the plan has them"
                + ("; a parameter was changed" if evidence.varied else ""),
                target=_mass_target(body, expected),
            )
        ]  # fmt: skip

    def _density(self, body: Body) -> list[Finding]:
        if body.volume <= 0.0:
            return []
        density = body.mass / body.volume
        above = density > 1000.0
        return [
            self.measured(
                f"{body.prim} has a density of {density:.4g} kg/m^3",
                density, DENSEST if above else LIGHTEST, "kg/m^3", at_most=above, prim=body.prim, time=0.0,
                limit_from="matter: an aerogel has 1 kg/m^3, osmium 22 600", target=_mass_target(body, None),
            )
        ]  # fmt: skip

    def _inertia(
        self, evidence: Evidence, i: int, body: Body, moments: NDArray[np.float64], only_spread: bool
    ) -> list[Finding]:
        """Whether the moments (3,) can be those of a body of its size; `only_spread`: of any body."""
        bound = body.mass * float(evidence.motion.radius[i]) ** 2
        if bound <= 0.0 or not np.isfinite(bound):
            return []
        greatest = float(moments[2])
        # Of any distribution of mass the two smaller moments add up to no less than the greatest.
        spread = moments[0] + moments[1] - moments[2]
        if only_spread and spread >= -1e-3 * greatest:
            return [self.passed(f"{body.prim}: its inertia fits", prim=body.prim)]
        if greatest <= bound * 1.001 and greatest >= self.thin * bound and spread >= -1e-3 * greatest:
            return [self.passed(f"{body.prim}: its inertia fits", prim=body.prim)]
        above = greatest > bound or spread < 0.0
        return [
            self.measured(
                f"{body.prim} has moments of inertia of {', '.join(f'{m:.3g}' for m in moments)} kg m^2, which no "
                f"{body.mass:.3g} kg of its size can have",
                greatest if greatest > bound or spread >= 0.0 else float(moments[2] - moments[0] - moments[1]),
                (bound if greatest > bound else 0.0) if above else self.thin * bound, "kg m^2", at_most=above,
                prim=body.prim, time=0.0,
                limit_from=f"m R^2 at most, R = {evidence.motion.radius[i]:.3g} m, {self.thin:g} of it at least, "
                "and the greatest no more than the sum of the others",
                target=RepairTarget(
                    kind="physical parameter", prim=body.prim, parameter="inertia",
                    direction="lower" if above else "raise",
                ),
            )
        ]  # fmt: skip

    def _as_its_shapes(self, evidence: Evidence, i: int, body: Body) -> list[Finding]:
        """Whether what the plan has as a solid of one material has the centre and the moments of one."""
        item = evidence.planned(body.prim)
        shapes = [shape for shape in body.shapes if shape.collides]
        if item is None or item.primitive not in SOLIDS or len(shapes) != 1:
            return []
        even, radius = together(shapes), max(float(evidence.motion.radius[i]), 1e-9)
        aside = float(np.linalg.norm(np.array(body.com) - even.com))
        inertia, expected = np.reshape(body.inertia, (3, 3)), even.inertia * body.mass / even.volume
        moment = float(np.linalg.norm(inertia - expected, 2) / np.linalg.norm(expected, 2))
        target = RepairTarget(kind="physical parameter", prim=body.prim, parameter="density", direction="change",
                              why="leave its centre of mass and its inertia to its shape and its density")  # fmt: skip
        return [
            self.measured(
                f"{body.prim} has its centre of mass {1e3 * aside:.3g} mm from that of its shape",
                aside, self.off * radius, "m", prim=body.prim, time=0.0, target=target,
                limit_from=f"{self.off:g} of its radius: the plan's is of one material",
            ),
            self.measured(
                f"{body.prim} has moments of inertia {100 * moment:.3g} % off those of its shape",
                moment, self.other, "", prim=body.prim, time=0.0, target=target,
                limit_from="the plan's solid is of one material",
            ),
        ]  # fmt: skip


def _stated_elsewhere(evidence: Evidence) -> bool:
    """Whether another engine's model states masses and inertias, whose shapes may be no more than what collides."""
    return "imported_from" in evidence.recording.metadata


def _mass_target(body: Body, expected: float | None) -> RepairTarget:
    """Another density; which way follows from the mass that is expected, where one is."""
    return RepairTarget(
        kind="physical parameter", prim=body.prim, parameter="density", direction="change" if expected is None else "",
        suggested=expected / body.volume if expected is not None and body.volume > 0.0 else None, unit="kg/m^3",
        why="its mass is not that of its material and size",
    )  # fmt: skip


CHECKS: Checks = (CheckMass,)
