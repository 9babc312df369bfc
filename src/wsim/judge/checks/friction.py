"""The check of what slides: friction takes from it what its weight on the face under it gives, and no more."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import level
from wsim.judge.checks.check import Check, Checks
from wsim.judge.evidence.faces import faces, rises_above
from wsim.judge.verdict import RepairTarget
from wsim.scene.contact import pair_law

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.evidence.faces import Face
    from wsim.judge.verdict import Finding

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]
    Indices = NDArray[np.intp]


@dataclass
class CheckFriction(Check):
    """What slides on a flat static face is slowed by mu (-g . n): it has friction, and no more than its materials give.

    n is the face's normal; gravity along the face is left out. A ball slides where its lowest point moves; rolling, it
    has none to lose.
    """

    least: float = 0.6  # of that: a pyramid of friction gives 1 / sqrt(2) of it aslant
    most: float = 1.25  # of that: a box that pitches as it slides presses unevenly
    fewest: int = 3  # intervals
    touch: float = 0.05  # of its smallest extent, that its lowest point may be off a face that it stands on

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each body that slides on a flat static face, touching nothing else."""
        motion = evidence.motion
        if len(motion.h) == 0 or evidence.gravity <= 0.0:
            return []
        loose = ~motion.jointed & ~motion.kinematic
        found = []
        for i in np.flatnonzero(loose):
            kinds = [shape.kind for shape in evidence.solid(int(i)).shapes]
            if kinds != ["sphere"] and any(kind not in ("box", "mesh") for kind in kinds):
                continue  # what else is round may roll some way and slide another
            finding = self._slides(evidence, int(i), kinds == ["sphere"])
            if finding is not None:
                found.append(finding)
        return found

    def _slides(self, evidence: Evidence, i: int, rolls: bool) -> Finding | None:
        motion = evidence.motion
        slowed, pressed, friction = (np.zeros(len(motion.h)) for _ in range(3))
        for face, stands in self._supports(evidence, i):
            mu = max(pair_law(evidence.world, own, face.shape).friction for own in evidence.solid(i).shapes)
            weight = float(-motion.gravity @ face.normal)
            slip, sliding = self._sliding(evidence, i, face, mu * weight, rolls)
            k = np.flatnonzero(stands & sliding)
            way = slip[k] / np.linalg.norm(slip[k], axis=1, keepdims=True)
            slowed[k] = -np.einsum("ki,ki->k", motion.acceleration[k, i] - motion.gravity, way)
            friction[k], pressed[k] = mu, weight
        k = np.flatnonzero(friction)
        if len(k) < self.fewest:
            return None
        return self._finding(
            evidence, i, k, float(slowed[k].mean()), float(pressed[k].mean()), float(friction[k].mean())
        )

    @staticmethod
    def _sliding(evidence: Evidence, i: int, face: Face, rubbed: float, rolls: bool) -> tuple[Floats, Bools]:
        """How the point of body i on a face slips (T, 3) [m/s], and whether it does so over the whole interval."""
        motion, h = evidence.motion, evidence.motion.h
        slip, hold = level(motion.v[:, i], face.normal), 2.0
        turning = np.linalg.norm(motion.w[:, i], axis=1) * motion.radius[i]
        if rolls:  # friction turns a ball until its lowest point stands
            slip = slip + np.cross(motion.w[:, i], -motion.radius[i] * face.normal)
            turning = np.zeros(len(slip))
            hold = 1.0 + float(motion.mass[i] * motion.radius[i] ** 2 / max(motion.inertia[i, 0, 0], 1e-12))
        across = np.linalg.norm(slip, axis=1)
        # Along the face, faster than friction and gravity could stop it, and not turning.
        along = (np.abs(motion.v[:, i] @ face.normal) < 0.1 * across) & (turning < 0.2 * across)
        stops = (hold * rubbed + float(np.linalg.norm(level(motion.gravity, face.normal)))) * h
        return slip, along[1:] & along[:-1] & (np.minimum(across[1:], across[:-1]) > stops)

    def _supports(self, evidence: Evidence, i: int) -> Iterator[tuple[Face, Bools]]:
        """The static faces, and the intervals (T - 1,) in which body i stands on each, touching nothing else."""
        motion, tolerance = evidence.motion, self.touch * evidence.solid(i).smallest
        alone = motion.touched[1:, i] & motion.touched[:-1, i] & ~motion.meets[:, i]
        every = np.arange(len(motion.h))
        fixed = [(placed.shape, motion.approaches(placed, i, every)) for placed in evidence.placed if placed.body < 0]
        for shape, near in fixed:
            if any(shape.surface_velocity) or not (near & alone).any():
                continue  # on a belt it is carried, not slowed
            for face in faces(shape):
                if face.normal @ motion.gravity >= 0.0:
                    continue
                low = face.height(evidence.body_q[:, i, :3])
                low = low + evidence.solid(i).reach(evidence.body_q[:, i, 3:], face.normal)[0]
                on = face.over(motion.com[:, i]) & (np.abs(low) < tolerance)
                stands = on[1:] & on[:-1] & alone
                for other, close in fixed:
                    if other is not shape and stands.any() and rises_above(other, face, tolerance):
                        stands &= ~close
                if stands.any():
                    yield face, stands

    def _finding(self, evidence: Evidence, i: int, k: Indices, slowed: float, weight: float, mu: float) -> Finding:
        body, full = evidence.world.bodies[i], mu * weight
        target = RepairTarget(
            kind="physical parameter", prim=body.prim, parameter="friction", suggested=mu,
            why="it is not slowed as its friction has it",
        )  # fmt: skip
        return self.between(
            f"{body.prim} slides, and friction slows it by {slowed:.3g} m/s^2; its {mu:g} gives {full:.3g}",
            slowed, (full * self.least, full * self.most), "m/s^2", expected=full, prim=body.prim,
            time=float(evidence.time[k[0]]), span=(float(evidence.time[k[0]]), float(evidence.time[k[-1] + 1])),
            limit_from=f"{self.most if slowed > full else self.least:g} mu g across the face, mu the smaller of "
            "the two surfaces'",
            target=target,
        )  # fmt: skip


CHECKS: Checks = (CheckFriction,)
