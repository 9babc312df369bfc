"""Objectives about bodies and fluid: Archimedes is the oracle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.evidence.recorded import MissingError
from wsim.judge.evidence.welded import displaced, still_draft, welded
from wsim.judge.language.objective import findings
from wsim.judge.objectives.objective import ObjectiveCheck, Objectives
from wsim.plan.schema.formula import StaysInside, Submerged

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence, Level
    from wsim.judge.verdict import Finding
    from wsim.scene.world import Fluid

    Floats = NDArray[np.float64]


@dataclass
class _Afloat:
    """What is measured of a body in a fluid over the final window."""

    i: int
    fluid: Fluid
    level: Level
    draft: float  # depth of its lowest point below the surface [m]
    height: float  # its vertical extent [m]
    ratio: float  # mean density over the fluid's, of it and of what is fixed to it
    needed: float  # volume that they must displace to float [m^3]
    joined: list[int]  # the bodies that fixed joints make one with it, itself too


@dataclass
class ObjectiveFloats(ObjectiveCheck):
    """The body floats as deep as Archimedes says.

    Its mean depth over the final window is held against the still-water draft of its own shape at its own mean
    rotation: the depth at which the volume under the surface weighs, as fluid, what the body weighs. Bodies that fixed
    joints hold to it float with it: then both are of all of them together.
    """

    share: float = 0.1  # tolerance: of the body's height,
    spacings: float = 0.5  # or of the particle spacing, whichever is more

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding: the depth of the body's lowest point below the surface [m]."""
        a = _afloat(evidence, self.objective.object, self.ref())
        tolerance = self.objective.tolerance or max(self.share * a.height, self.spacings * a.fluid.spacing)
        source = (
            "the plan's tolerance"
            if self.objective.tolerance
            else f"the larger of {self.share:g} of the body's height and {self.spacings:g} particle spacings, "
            f"{tolerance:.3g} m, about the still-water draft"
        )
        away = self._out_of_container(evidence, a)
        if away is not None:
            return [away]
        if a.ratio >= 1.0:
            return [self._too_heavy(evidence, a, tolerance)]
        expected = still_draft(evidence, a.i, a.needed)
        prim = evidence.world.bodies[a.i].prim
        low, _ = evidence.ends(a.i)
        wrong = np.abs(a.level.height - low - expected) > tolerance
        deeper = a.draft > expected
        failing = abs(a.draft - expected) > tolerance
        under = self._went_under(evidence, a)
        depth = f"its lowest point is {a.draft:.4g} m below the surface, where Archimedes has {expected:.4g} m"
        story = f"{prim} does not float as it should: {depth}" if failing else f"{prim} floats: {depth}"
        if failing and under is not None:
            story = f"{prim} went under at {under:.3f} s and stays there: {depth}"
        return [
            self.measured(
                story, a.draft, expected + tolerance if deeper else expected - tolerance, "m", at_most=deeper,
                expected=expected,
                time=evidence.earliest(under, evidence.since(wrong)) if failing else evidence.window_start,
                limit_from=source,
            )
        ]  # fmt: skip

    def _went_under(self, evidence: Evidence, a: _Afloat) -> float | None:
        """When the body's highest point left the surface for good [s]."""
        _, high = evidence.ends(a.i)
        return evidence.since(high < a.level.height)

    def _too_heavy(self, evidence: Evidence, a: _Afloat, tolerance: float) -> Finding:
        """A body denser than the fluid cannot float: by theory it lies on the floor, as deep as the fluid is."""
        body = evidence.world.bodies[a.i]
        density = a.ratio * a.fluid.density
        under = self._went_under(evidence, a)
        depth = a.level.height - a.level.floor
        went = f"sinks: it went under at {under:.3f} s, and its" if under is not None else "cannot float: its"
        message = (
            f"{body.prim} {went} lowest point is {a.draft:.4g} m below the surface. With {density:.4g} kg/m^3 in "
            f"fluid of {a.fluid.density:g} kg/m^3 Archimedes has it on the floor, {depth:.4g} m deep"
            + self._as_planned(evidence, a)
        )
        # It fails whatever the depth: at or above the limit it would float against physics.
        return self.failed(
            message, value=a.draft, expected=depth, limit=a.height,
            margin=min(a.height - a.draft, -abs(a.ratio - 1.0) * tolerance), unit="m", time=evidence.earliest(under),
            limit_from="the body's height: what floats is never deeper",
        )  # fmt: skip

    def _as_planned(self, evidence: Evidence, a: _Afloat) -> str:
        """The depth that the plan's own material would have given."""
        if evidence.plan is None or len(a.joined) > 1:
            return ""
        material = evidence.plan.object(self.objective.object).material
        if material is None or material.density >= a.fluid.density:
            return ""
        solid = evidence.solid(a.i)
        _, rotation = evidence.resting_pose(a.i)
        draft = solid.draft(rotation, solid.volume * material.density / a.fluid.density)
        return f"; the plan's {material.name} of {material.density:g} kg/m^3 would float {draft:.4g} m deep"

    def _out_of_container(self, evidence: Evidence, a: _Afloat) -> Finding | None:
        container = evidence.container_of(a.fluid)
        if container is None:
            return None
        p = np.abs(evidence.local(container, evidence.body_q[:, a.i, :3]))
        half = np.array(container.inner_size) / 2
        left = evidence.since((p[:, 0] > half[0]) | (p[:, 1] > half[1]))
        if left is None:
            return None
        beyond = float(max(p[-1, 0] - half[0], p[-1, 1] - half[1]))
        prim = evidence.world.bodies[a.i].prim
        message = f"{prim} left {container.prim} at {left:.3f} s: its centre is {beyond:.3g} m beyond the wall"
        source = "a body that floats in a container is over it"
        return self.measured(message, beyond, 0.0, "m", time=left, expected=0.0, limit_from=source)


@dataclass
class ObjectiveSubmerged(ObjectiveCheck):
    """The body is wholly under the surface, and what is lighter is held there: the language's predicate."""

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding: of the depth of its highest point [m] and the lift that nothing holds [N], what decides."""
        asked = self.objective
        return findings(self, Submerged(object=asked.object, fluid=self.ref(), within=asked.tolerance or 0.0), evidence)


@dataclass
class ObjectiveStaysInside(ObjectiveCheck):
    """A fluid, or a body's centre, stays within the walls and above the floor: the language's predicate."""

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding: share of particles outside, or how far the body's centre is from the nearest wall [m]."""
        asked, within = self.objective, self.objective.tolerance
        fluid = any(each.prim == evidence.prim(asked.object) for each in evidence.world.fluids)
        room = {} if within is None else {"share": within} if fluid else {"within": within}
        return findings(self, StaysInside(object=asked.object, ref=self.ref(), **room), evidence)


@dataclass
class ObjectiveFills(ObjectiveCheck):
    """What was poured ends in the container."""

    share: float = 0.9  # of the particles

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding: the share of the particles that is inside, below the rim, over the final window."""
        fluid = evidence.fluid(evidence.prim(self.objective.object))
        container = evidence.container(evidence.prim(self.ref()))
        if container is None:
            raise MissingError(f"the world has no container {evidence.prim(self.ref())}")
        track = evidence.track(fluid)
        shares = evidence.containment(container, fluid).inside()[track.time >= evidence.window_start - 1e-9]
        if not len(shares):
            raise MissingError(f"the recording has no particles of {fluid.prim} in the last second")
        value = float(np.mean(shares))
        return [
            self.measured(
                f"{value:.1%} of {fluid.prim} is in {container.prim} at the end",
                value, 1.0 - self.objective.tolerance if self.objective.tolerance else self.share, "share of particles",
                at_most=False, expected=1.0, time=evidence.window_start, limit_from="the rest may splash out",
            )
        ]  # fmt: skip


def _afloat(evidence: Evidence, name: str, ref: str) -> _Afloat:
    i = evidence.index(evidence.prim(name))
    fluid = evidence.fluid(evidence.prim(ref))
    level = evidence.level(fluid)
    low, high = evidence.ends(i)
    here = evidence.window
    needed, volume = displaced(evidence, i, fluid)
    return _Afloat(
        i,
        fluid,
        level,
        draft=level.height - float(low[here].mean()),
        height=float((high - low)[here].mean()),
        ratio=needed / volume,
        needed=needed,
        joined=welded(evidence, i),
    )


OBJECTIVES: Objectives = {
    "floats": ObjectiveFloats,
    "submerged": ObjectiveSubmerged,
    "stays_inside": ObjectiveStaysInside,
    "fills": ObjectiveFills,
}
