"""Checks of what lies in a fluid: it is lifted as Archimedes has it, and is large enough for particles to tell."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books.fluids import fluid_impulse
from wsim.judge.checks.check import Check, Checks
from wsim.judge.evidence.containment import local
from wsim.judge.evidence.layers import layers, mass_displaced
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.scene.world import Fluid

    Floats = NDArray[np.float64]


def _pushed(evidence: Evidence) -> Floats | None:
    """The mean vertical force that the fluid gives each body over the final window, (B,) [N]; None if not recorded."""
    impulse, here = fluid_impulse(evidence.recording), np.flatnonzero(evidence.window)
    if impulse is None or len(here) < 2 or evidence.gravity == 0.0:
        return None
    span = float(evidence.time[here[-1]] - evidence.time[here[0]])
    force: Floats = impulse[here[1:]].sum(axis=0) @ evidence.up / span
    return force


@dataclass
class CheckBuoyancy(Check):
    """What lies or is held still in a fluid at rest is lifted by the weight of what it displaces.

    A body that hangs free is asked by `CheckDraft`: there the lift is its weight, whatever it displaces. One that lies
    on the floor, or is held, shows what the fluid gives it: water that presses down what is lighter is no water. Of
    liquids on each other it displaces its share of each; one that yields holds what lies in it.
    """

    share: float = 0.2  # of the lift: boxes flush with a floor get up to 14 % too little (docs/sph.md)
    layers: float = 0.3  # spacings of fluid over the body's area
    still: float = 0.05  # of sqrt(g L): slower is at rest

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The force on each such body over the final window."""
        pushed, found = _pushed(evidence), []
        if pushed is None:
            return []
        for fluid in evidence.world.fluids:
            if evidence.container_of(fluid) is None or (stack := layers(evidence, fluid))[0] is not fluid:
                continue
            if not all(each.newtonian and self._rests(evidence, each) for each in stack):
                continue
            for i in range(len(evidence.world.bodies)):
                if self._lies(evidence, fluid, i):
                    found.append(self._lifted(evidence, fluid, i, float(pushed[i])))
        return found

    def _rests(self, evidence: Evidence, fluid: Fluid) -> bool:
        track, level = evidence.track(fluid), evidence.level(fluid)
        late = track.time >= evidence.window_start - 1e-9
        square = float(track.mean(np.einsum("tni,tni->tn", track.velocity, track.velocity))[late].mean())
        return bool(square < (self.still * evidence.velocity_scale(level.height - level.floor)) ** 2)

    def _lies(self, evidence: Evidence, fluid: Fluid, i: int) -> bool:
        """Whether body i is at rest under the surface, and something but the fluid carries it."""
        motion, here, container = evidence.motion, evidence.window, evidence.container_of(fluid)
        slow = motion.speed[here, i].max() < self.still * evidence.velocity_scale(evidence.solid(i).smallest)
        held = motion.touched[here, i].any() or motion.jointed[i] or evidence.world.bodies[i].kinematic
        if container is None or not slow or not held:
            return False
        half = np.array(container.inner_size)[:2] / 2
        inside = (np.abs(local(container, motion.com[-1, i])[:2]) < half).all()
        low, high = (float(ends[here].mean()) for ends in evidence.ends(i))
        level, surface = evidence.level(fluid), evidence.level(layers(evidence, fluid)[-1]).height
        # The surface is not known well enough for what pierces it.
        return bool(inside and low > level.floor - fluid.spacing and high < surface - fluid.spacing)

    def _lifted(self, evidence: Evidence, fluid: Fluid, i: int, value: float) -> Finding:
        solid, (position, rotation) = evidence.solid(i), evidence.resting_pose(i)
        volume = solid.volume
        held = mass_displaced(evidence, fluid, lambda z: solid.volume_below(rotation, float(position[2]), z))
        reaches = [solid.reach(rotation[None], axis) for axis in np.eye(3)[:2]]
        area = float(np.prod([high - low for low, high in reaches]))
        weight = fluid.density * evidence.gravity
        expected, slack = held * evidence.gravity, weight * (self.share * volume + self.layers * fluid.spacing * area)
        prim = evidence.world.bodies[i].prim
        return self.between(
            f"{fluid.prim} lifts {prim}, which lies in it at rest, by {value:.4g} N; what it displaces weighs "
            f"{expected:.4g} N",
            value, (expected - slack, expected + slack), "N", expected=expected, prim=prim, time=evidence.window_start,
            limit_from=f"Archimedes, to {self.share:g} and {self.layers:g} spacing of fluid over its area",
            target=RepairTarget(
                kind="fluid", prim=fluid.prim, parameter="spacing", direction="lower",
                suggested=min(solid.smallest / 5.0, 0.7 * fluid.spacing), unit="m",
                why="it is too coarse to get under what lies on a floor",
            ),
        )  # fmt: skip


@dataclass
class CheckResolved(Check):
    """What a fluid pushes is no smaller than its particles: the lift of what is has no meaning."""

    spacings: float = 1.5  # that it is thick, at least; five give a draft to some per cent
    share: float = 0.01  # of its weight, that the fluid gives it

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """How many spacings the thinnest of the bodies that the fluid pushes has across."""
        pushed = _pushed(evidence)
        if pushed is None or not evidence.world.fluids:
            return []
        fluid = max(evidence.world.fluids, key=lambda each: each.spacing)
        weight = evidence.motion.mass * evidence.gravity
        holders = {each.container for each in evidence.world.fluids}  # whose walls are as deep as the fluid sees
        beside = np.array([body.prim not in holders for body in evidence.world.bodies], dtype=bool)
        wet = np.flatnonzero((np.abs(pushed) > self.share * weight) & beside)
        if not len(wet):
            return []
        thick = np.array([evidence.solid(int(i)).smallest for i in wet]) / fluid.spacing
        body, value = evidence.world.bodies[wet[thick.argmin()]], float(thick.min())
        fifth = value * fluid.spacing / 5.0
        return [
            self.between(
                f"{body.prim} is {value:.3g} spacings of {fluid.prim} thick, which pushes it",
                value, (self.spacings, np.inf), "spacings", expected=5.0, prim=body.prim, time=evidence.window_start,
                limit_from=f"{self.spacings:g} spacings: the lift of what is thinner has no meaning; five are right to "
                "some per cent",
                target=RepairTarget(
                    kind="fluid", prim=fluid.prim, parameter="spacing", direction="lower", suggested=fifth, unit="m",
                    why="its particles are larger than the body",
                ),
            )
        ]  # fmt: skip


CHECKS: Checks = (CheckBuoyancy, CheckResolved)
