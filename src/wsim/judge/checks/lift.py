"""What a fluid is said to have given a body is what the fluid about the body says that it gave."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import stdtrit

from wsim.judge.books.fluids import fluid_impulse
from wsim.judge.books.lift import Surroundings
from wsim.judge.checks.check import Check, Checks
from wsim.judge.evidence.containment import lone_pool
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.scene.world import Fluid

    Floats = NDArray[np.float64]


@dataclass
class CheckLift(Check):
    """The vertical force that the fluid gives a body is in its particles' own momentum and pressure, too.

    `CheckFluidMomentum` asks for bodies and walls together, and what a body did not get may be written down as the
    walls'. Here the fluid near the body is asked, which knows of no walls.
    """

    # Spacings of fluid over the body's area: particles press by some percent more here than there, which is found to
    # make up to 0.42 too much in 12 s, growing slowly to 0.57 there, and up to 0.21 too little.
    high: float = 0.6
    low: float = 0.4
    sure: float = 0.95  # of the mean, from how the intervals scatter (Student's t)
    least: int = 4  # intervals
    most: int = 60  # of a body that are looked at
    narrowest: float = 0.6  # of a pipe's radius that a ball has, up to which Faxen's factor holds
    spilled: float = 0.001  # share of the particles, beyond which what is left in the tank is not a whole pool

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each body that swims, sinks or rises far enough from the floor and from other bodies."""
        impulse, fluids = fluid_impulse(evidence.recording), evidence.world.fluids
        if impulse is None or len(fluids) != 1 or evidence.gravity == 0.0 or not evidence.world.bodies:
            return []
        fluid = fluids[0]
        if evidence.track(fluid).present is not None:  # the pool's momentum changes by what comes and goes
            return []
        container, track = evidence.container_of(fluid), evidence.track(fluid)
        frames = np.flatnonzero(np.isin(evidence.time, track.time))
        if container is None or not lone_pool(evidence.world, container, evidence.up) or len(frames) < len(track.time):
            return []
        if track.density.size == 0 or evidence.outside(fluid).max(initial=0.0) > self.spilled:
            return []
        about = Surroundings(evidence, fluid, container, frames)
        given = np.diff(np.cumsum(impulse[..., 2], axis=0)[frames], axis=0) / np.diff(track.time)[:, None]
        found = [self._body(evidence, fluid, about, i, given[:, i]) for i in range(len(evidence.world.bodies))]
        return [finding for finding in found if finding is not None]

    def _body(self, evidence: Evidence, fluid: Fluid, about: Surroundings, i: int, given: Floats) -> Finding | None:
        near = np.array([k for k in range(len(given)) if about.near(i, k)], dtype=int)
        if len(near) > self.most:
            near = near[np.linspace(0, len(near) - 1, self.most).astype(int)]
        lifts = {k: lift for k in near.tolist() if (lift := about.lift(i, k)) is not None}
        if len(lifts) < self.least:
            return None
        rows, felt = np.array(list(lifts)), np.array(list(lifts.values()))
        off, time = given[rows] - felt, evidence.track(fluid).time
        area = float(np.prod(2.0 * np.array([about.column(i, k).half for k in rows]).mean(axis=0)))
        # Waves, of sound too, make errors last: as many are independent as there are times sqrt(H / g) in the span.
        span = float(np.diff(time)[rows].sum())
        many = max(2.0, min(span / math.sqrt(fluid.size[2] / evidence.gravity), float(len(rows))))
        spread = float(off.std()) * math.sqrt(many / (many - 1.0))
        noise = float(stdtrit(many - 1.0, 0.5 + 0.5 * self.sure)) * spread / math.sqrt(many)
        layer = fluid.spacing * fluid.density * evidence.gravity * area
        said, told = float(given[rows].mean()), float(felt.mean())
        drag = self._drag(evidence, fluid, i, float(evidence.body_qd[about.frames[rows], i, 2].mean()))
        limits = told - self.low * layer - noise + min(drag, 0.0), told + self.high * layer + noise + max(drag, 0.0)
        body, start, end = evidence.world.bodies[i], float(time[rows[0]]), float(time[rows[-1] + 1])
        return self.between(
            f"{fluid.prim} is said to lift {body.prim} by {said:.4g} N; by the momentum and the pressure of its "
            f"particles about it, it gives {told:.4g} N",
            said, limits, "N", told, prim=body.prim,
            time=end, span=(start, end),
            limit_from=f"the fluid's momentum about it; {self.high:g} spacing of fluid over its area more, "
            f"{self.low:g} less, as far as particles tell levels, how sure the mean is, to {self.sure:.0%}, and the "
            f"drag of its viscosity, of which that tells nothing",
            target=RepairTarget(
                kind="program", prim=body.prim, direction="change",
                why="something lifts it in the fluid's name that no particle feels",
            ),
        )  # fmt: skip

    def _drag(self, evidence: Evidence, fluid: Fluid, i: int, velocity: float) -> float:
        """The most that viscosity gives body i, which moves up at a velocity [N].

        A creeping body has no more drag than a ball around it (Hill & Power 1956), which in a pipe has Stokes' times a
        factor (Faxen 1923).
        """
        container, radius = evidence.container_of(fluid), float(evidence.motion.radius[i])
        narrow = radius / (min(container.inner_size[:2]) / 2.0) if container is not None else 0.0
        share = min(narrow, self.narrowest)
        pipe = 1.0 / (1.0 - 2.104 * share + 2.09 * share**3 - 0.95 * share**5)
        return -6.0 * math.pi * fluid.viscosity * radius * velocity * pipe


CHECKS: Checks = (CheckLift,)
