"""What a recording says of a state besides poses and velocities, worked out anew from these: energies, depths."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.books.fluids import particle_mass
from wsim.judge.books.touching import Touching
from wsim.judge.checks.check import Check, Checks
from wsim.judge.evidence.motion import FLOAT32
from wsim.judge.verdict import RepairTarget

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding

    Floats = NDArray[np.float64]

MADE_UP = RepairTarget(kind="program", why="the recording contradicts itself: simulate the world anew")


@dataclass
class CheckRecordedEnergy(Check):
    """Each energy that is recorded is the one of the recorded poses, velocities and particles.

    sum m v^2 / 2 + w I w / 2, -sum m g x and that of the springs, of the world's masses, inertias and springs.
    """

    rounding: float = 16.0 * FLOAT32  # of what is added up: masses and inertias are of single precision in a simulator

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The recorded energy that is farthest off, by its limit."""
        found: list[tuple[float, Finding]] = []
        for name, (known, size) in self._known(evidence).items():
            told = np.asarray(evidence.recording.scalars[name], dtype=np.float64)
            asked = np.isfinite(told) & np.isfinite(known)
            if not asked.any():
                continue
            off = np.where(asked, np.abs(told - known), 0.0)
            limit = self.rounding * size + 1e-30
            k = int(np.argmax(off / limit))
            time = float(evidence.time[k])
            finding = self.measured(
                f"{name} is said to be {told[k]:.6g} J at {time:.3f} s, and poses and velocities have {known[k]:.6g} J",
                float(off[k]), float(limit[k]), "J", expected=0.0, time=time, target=MADE_UP,
                fine="The recorded energies are those of the recorded poses and velocities",
                limit_from=f"{self.rounding:.1g} of the {size[k]:.3g} J that are added up: single precision",
            )  # fmt: skip
            found.append((float(off[k] / limit[k]), finding))
        return [max(found, key=lambda each: each[0])[1]] if found else []

    @staticmethod
    def _known(evidence: Evidence) -> dict[str, tuple[Floats, Floats]]:
        """Of each recorded energy what it must be, and the size of what is added up for it, (T,) each [J]."""
        motion, parts = evidence.motion, {}
        reach = motion.mass * np.sum(np.abs(motion.com * motion.gravity), axis=2)
        parts["kinetic_bodies"] = motion.kinetic.sum(axis=1), motion.kinetic.sum(axis=1)
        parts["potential_bodies"] = motion.potential.sum(axis=1), reach.sum(axis=1)
        if evidence.world.springs:
            # The stretch is a difference of places, each of which is rounded.
            held = motion.elastic.sum(axis=1)
            parts["potential_springs"] = held, held + _stretched(evidence)
        wet = [_of_particles(evidence, n) for n in range(len(evidence.world.fluids))]
        for n, name in enumerate(("kinetic_fluid", "potential_fluid")):
            if wet:
                parts[name] = sum(each[n][0] for each in wet), sum(each[n][1] for each in wet)
        for name in ("kinetic", "potential"):
            own = [part for key, part in parts.items() if key.startswith(name)]
            if own:
                parts[name] = sum(part[0] for part in own), sum(part[1] for part in own)
        return {key: part for name, part in parts.items() if (key := f"energy/{name}") in evidence.recording.scalars}


def _stretched(evidence: Evidence) -> Floats:
    """How much the rounding of places may do to what springs hold, over that rounding, (T,) [J]."""
    far = np.abs(evidence.motion.com).max(axis=(1, 2))
    most = sum(np.sqrt(2.0 * spring.stiffness) for spring in evidence.world.springs)
    found: Floats = most * np.sqrt(evidence.motion.elastic.sum(axis=1)) * far
    return found


def _of_particles(evidence: Evidence, n: int) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
    """Kinetic and potential energy of a fluid, each with the size of what is added up, (T,); NaN between its frames."""
    fluid = evidence.world.fluids[n]
    track, mass = evidence.track(fluid), particle_mass(fluid)
    found = np.full((3, len(evidence.time)), np.nan)
    frames = np.searchsorted(evidence.time, track.time)
    for k, q, v in zip(frames, track.position, track.velocity, strict=True):
        if k < len(evidence.time):
            weight = mass * q.astype(np.float64) * evidence.motion.gravity
            kinetic = 0.5 * mass * np.nansum(v.astype(np.float64) ** 2)
            found[:, k] = kinetic, -np.nansum(weight), np.nansum(np.abs(weight))
    return (found[0], found[0]), (found[1], found[2])


@dataclass
class CheckRecordedDepth(Check):
    """The deepest contact that is recorded is as deep as the shapes are in each other at the recorded poses.

    Asked of wsim's own recordings of one world on a CPU, whose contacts are those of the same search. A step looks for
    them where it begins, and its poses are those of its end: surfaces may have come or gone by the way of one step.
    """

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """Where they differ most, by the limit."""
        recording, world, motion = evidence.recording, evidence.world, evidence.motion
        told, about = recording.scalars.get("contact/penetration"), recording.metadata
        cpu = str(about.get("device", "")) == "cpu" and int(about.get("world_count") or 1) == 1
        margins = any(shape.shape.margin for shape in evidence.placed)
        if told is None or not world.bodies or not cpu or margins or "time_step" not in about:
            return []
        touching = Touching.of(evidence)
        known = touching.deepest(evidence.body_q)
        off = np.nan_to_num(told) - known
        if touching.triangles:  # how deep something is in a mesh poses do not tell
            off = np.minimum(off, 0.0)
        fastest = motion.surface_speed.max(axis=1)
        fastest[1:] = np.maximum(fastest[1:], fastest[:-1])
        rounding = 8.0 * FLOAT32 * np.abs(motion.com).max(axis=(1, 2))
        limit = 2.0 * (fastest + evidence.gravity * motion.dt_frames) * motion.dt + rounding
        k = int(np.argmax(np.abs(off) / limit))
        time, mesh = float(evidence.time[k]), " at least" if touching.triangles else ""
        return [
            self.measured(
                f"The deepest contact is said to be {told[k] * 1e3:.3g} mm deep at {time:.3f} s, and by the poses it "
                f"is {known[k] * 1e3:.3g} mm{mesh}",
                float(abs(off[k])), float(limit[k]), "m", expected=0.0, time=time, target=MADE_UP,
                fine="The deepest contact is as deep as the poses have it",
                limit_from="the way of both surfaces in one time step, as contacts are those of its beginning",
            )
        ]  # fmt: skip


CHECKS: Checks = (CheckRecordedEnergy, CheckRecordedDepth)
