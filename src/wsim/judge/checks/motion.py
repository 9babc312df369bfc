"""Checks of what moves in the air: by gravity alone, and by as much of it as the world states."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import lengths
from wsim.judge.checks.check import Check, Checks, share_about
from wsim.judge.checks.strangest import strangest
from wsim.judge.evidence.motion import FLOAT32
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding

    Floats = NDArray[np.float64]

EARTH = (9.78, 9.835)  # [m/s^2]: at sea level on the equator and at a pole, rounded outwards
# Where else a prompt may be: NASA's planetary fact sheets (nssdc.gsfc.nasa.gov/planetary/factsheet), to 2 %.
PLACES = {place: (0.98 * g, 1.02 * g) for place, g in (("moon", 1.62), ("mars", 3.71), ("jupiter", 24.8))}
FREE = ("gravity", "space", "weightless", "planet")  # words after which it may be any


@dataclass
class CheckFreeFlight(Check):
    """A body that touches nothing is moved by gravity alone, and by as much as the world has of it."""

    share: float = 0.02  # of g
    fewest: int = 3  # intervals that a mean is worth taking of

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """Gravity from the trajectories, and the acceleration that nothing explains."""
        motion = evidence.motion
        unknown = evidence.recording.metadata.get("controlled") and evidence.recording.applied_impulse is None
        if len(motion.h) == 0 or unknown:
            return []
        strange = lengths(motion.acceleration - motion.gravity)
        rounding = 4.0 * FLOAT32 * np.maximum(motion.speed[1:], motion.speed[:-1]) / motion.h[:, None]
        limit = self.share * max(evidence.gravity, 1.0) + rounding
        free = ~(motion.touched[1:] | motion.touched[:-1]) & ~motion.kinematic & ~motion.jointed
        dry = evidence.recording.applied_impulse is not None or not evidence.world.fluids
        _leave_out_what_may_touch(evidence, free, strange > limit, dry)
        found = []
        if free.any():
            story = "{prim} touches nothing at {time:.3f} s, and is accelerated by {value:.3g} m/s^2 besides gravity"
            source = f"{self.share:g} of g, and the rounding of recorded velocities"
            fine = "Bodies that touch nothing are moved by gravity alone"
            strange = np.where(free, strange, 0.0)
            found.append(strangest(self, evidence, strange, limit, "m/s^2", story, fine, limit_from=source))
        if int(free.sum()) >= self.fewest and evidence.gravity > 0.0:
            found.append(self._gravity(evidence, free))
        return found

    def _gravity(self, evidence: Evidence, free: NDArray[np.bool_]) -> Finding:
        motion, g = evidence.motion, evidence.gravity
        measured = float((motion.acceleration[free] @ (motion.gravity / g)).mean())
        where = np.argwhere(free)
        return self.between(
            f"Gravity is {measured:.4g} m/s^2 by what falls, {g:.4g} m/s^2 in the world",
            measured, share_about(g, self.share), "m/s^2", expected=g,
            prim=evidence.world.bodies[where[0][1]].prim,
            line=None,  # that body is one of many: no line of its own is to blame
            time=float(evidence.time[where[0][0]]),
            limit_from=f"{self.share:g} of the world's, over {len(where)} body-frames in the air",
            target=_gravity_target(g, "what falls shows another gravity than the world states"),
        )  # fmt: skip


@dataclass
class CheckFreeTurning(Check):
    """A body that touches nothing keeps its angular momentum: gravity has no torque about the centre of mass."""

    share: float = 0.02  # of the torque of its weight at its radius, as of g in free flight
    roundings: float = 8.0  # of float32: of a velocity and a rotation, at both ends

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The torque that nothing explains; nothing where a controller's torques were not recorded."""
        motion, recording = evidence.motion, evidence.recording
        if len(motion.h) == 0 or (recording.metadata.get("controlled") and recording.applied_turn is None):
            return []
        torque, most, rate = lengths(motion.torque), lengths(motion.angular_momentum), motion.rate
        most = np.maximum(most[1:], most[:-1])
        # A first-order step of length dt turns what tumbles by w dt too far or too late in each 1 / w.
        numerical = most * (
            np.maximum(rate[1:], rate[:-1]) ** 2 * motion.late + self.roundings * FLOAT32 / motion.h[:, None]
        )
        limit = self.share * motion.mass * max(evidence.gravity, 1.0) * motion.radius + numerical
        free = ~(motion.touched[1:] | motion.touched[:-1]) & ~motion.kinematic & ~motion.jointed & (limit > 0.0)
        _leave_out_what_may_touch(evidence, free, torque > limit, dry=not evidence.world.fluids)
        if not free.any():
            return []
        story = "{prim} touches nothing at {time:.3f} s, and is turned by a torque of {value:.3g} N m"
        source = f"{self.share:g} m g R, in steps of first order w^2 dt of it, and the rounding of recorded velocities"
        fine, why = "Bodies that touch nothing keep their angular momentum", "something turns it unseen"
        torque = np.where(free, torque, 0.0)
        return [strangest(self, evidence, torque, limit, "N m", story, fine, why, limit_from=source)]


def _leave_out_what_may_touch(evidence: Evidence, free: NDArray[np.bool_], odd: NDArray[np.bool_], dry: bool) -> None:
    """Within a frame a body may land and leave again: only what has nothing in reach is surely free."""
    for i in np.flatnonzero((free & odd).any(axis=0)):
        asked = np.flatnonzero(free[:, i] & odd[:, i])
        excused = evidence.motion.near(int(i), asked)
        if not dry:
            excused |= evidence.motion.wet(int(i), asked)
        free[asked[excused], i] = False


@dataclass
class CheckGravity(Check):
    """The world's gravity is the Earth's and straight down, unless the prompt is about another place."""

    of_world = True

    aslant: float = 0.5  # [deg]

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding, where there is a plan."""
        plan = evidence.plan
        words = plan.prompt.lower() if plan is not None else ""
        places = [bounds for place, bounds in PLACES.items() if place in words]
        if plan is None or len(places) > 1 or any(word in words for word in FREE):
            return []
        bounds, where = (places[0], "the place of the prompt") if places else (EARTH, "the Earth's, equator to poles")
        gravity = np.array(evidence.world.gravity)
        strength = float(np.linalg.norm(gravity))
        expected = 9.81 if bounds == EARTH else sum(bounds) / 2
        why = "nothing in the prompt asks for another gravity"
        aslant = math.degrees(math.acos(np.clip(-gravity[2] / strength, -1.0, 1.0))) if strength > 0.0 else 0.0
        if aslant > self.aslant:
            return [
                self.measured(
                    f"The world's gravity is {aslant:.3g} degrees aslant", aslant, self.aslant, "deg", expected=0.0,
                    limit_from="straight down",
                    target=_gravity_target(expected, why).model_copy(update={"direction": "change"}),
                )
            ]  # fmt: skip
        above = strength > expected
        return [
            self.measured(
                f"The world's gravity is {strength:.4g} m/s^2 downwards", strength, bounds[above], "m/s^2",
                at_most=above, expected=expected, limit_from=where, target=_gravity_target(expected, why, above),
            )
        ]  # fmt: skip


def _gravity_target(to: float, why: str, above: bool | None = None) -> RepairTarget:
    return RepairTarget(
        kind="physical parameter", parameter="gravity", suggested=to, vector=(0.0, 0.0, -to), unit="m/s^2", why=why,
        direction="" if above is None else "lower" if above else "raise",
    )  # fmt: skip


CHECKS: Checks = (CheckFreeFlight, CheckFreeTurning, CheckGravity)
