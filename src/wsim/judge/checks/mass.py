"""Checks of what bodies weigh: as their materials and sizes have it, and with an inertia that fits."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.checks.check import Check, Checks, share_about
from wsim.judge.verdict import Finding, RepairTarget
from wsim.scene.solids import Solid, together

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Body

SOLIDS = ("box", "sphere", "cylinder", "capsule")  # of one material each, where a plan has them
FITS = Finding(check="CheckMass", passed=True, message="it fits")  # of whatever is asked: one finding tells of all
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
        off = _off_their_shapes(evidence)
        for i, body in enumerate(evidence.world.bodies):
            if not body.kinematic:
                found += self._mass(evidence, body)
                found += self._inertia(evidence, i, body, every[i], _stated_elsewhere(evidence))
                if i in off:
                    found += self._as_its_shapes(body, max(float(evidence.motion.radius[i]), 1e-9), *off[i])
        wrong = [finding for finding in found if not finding.passed]
        return wrong or ([self.passed("Bodies weigh what their sizes and materials give")] if found else [])

    def _mass(self, evidence: Evidence, body: Body) -> list[Finding]:
        item = evidence.planned(body.prim)
        expected = item.mass if item is not None else None
        if expected is None:
            return [] if _stated_elsewhere(evidence) else self._density(body)
        share = self.varied if evidence.varied else self.share
        low, high = share_about(expected, share)
        if low <= body.mass <= high:
            return [FITS]
        return [
            self.between(
                f"{body.prim} weighs {body.mass:.4g} kg; the plan's material and size give {expected:.4g} kg",
                body.mass, (low, high), "kg", expected=expected, prim=body.prim, time=0.0,
                limit_from=f"{share:g} of density times volume, as the plan has them"
                + ("; a parameter was changed" if evidence.varied else ""),
                target=_mass_target(body, expected),
            )
        ]  # fmt: skip

    def _density(self, body: Body) -> list[Finding]:
        if body.volume <= 0.0:
            return []
        density = body.mass / body.volume
        if LIGHTEST <= density <= DENSEST:
            return [FITS]
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
            return [FITS]
        if greatest <= bound * 1.001 and greatest >= self.thin * bound and spread >= -1e-3 * greatest:
            return [FITS]
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

    def _as_its_shapes(self, body: Body, radius: float, aside: float, moment: float) -> list[Finding]:
        """Whether what the plan has as a solid of one material has the centre and the moments of one."""
        if aside <= self.off * radius and moment <= self.other:
            return [FITS]
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


def _off_their_shapes(evidence: Evidence) -> dict[int, tuple[float, float]]:
    """How far bodies are from being of one material, by their rows, where the plan has them as that.

    From the centre of their shape to that of their mass [m], and of their moments of inertia the share that is off: the
    greatest singular value of what differs, over that of what the shape gives.
    """
    rows, aside, inertias = [], [], []
    alike: dict[tuple[object, ...], Solid] = {}
    for i, body in enumerate(evidence.world.bodies):
        shapes = [shape for shape in body.shapes if shape.collides]
        item = None if body.kinematic or len(shapes) != 1 else evidence.planned(body.prim)
        if item is None or item.primitive not in SOLIDS:
            continue
        (shape,) = shapes
        key = shape.kind, shape.size, shape.position, shape.rotation, i if shape.kind == "mesh" else None
        even = alike[key] = alike.get(key) or together(shapes)
        apart = np.array(body.com) - even.com
        rows.append(i)
        aside.append(math.sqrt(apart @ apart))
        expected = even.inertia * body.mass / even.volume
        inertias += [np.reshape(body.inertia, (3, 3)) - expected, expected]
    if not rows:
        return {}
    greatest = np.linalg.svd(np.array(inertias), compute_uv=False).max(axis=1).reshape(-1, 2)
    return dict(zip(rows, zip(aside, map(float, greatest[:, 0] / greatest[:, 1]), strict=True), strict=True))


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
