"""Objectives about bodies and what carries them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import tilt
from wsim.judge.evidence.welded import welded
from wsim.judge.objectives.objective import ObjectiveCheck, Objectives, Support, height_over, support_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding

    Floats = NDArray[np.float64]


@dataclass
class ObjectiveRestsOn(ObjectiveCheck):
    """The body ends on the other object: touching it from above, not moving up or down, carried by it."""

    share: float = 0.05  # gap: of the body's height,
    spacings: float = 0.25  # or of the particle spacing where there is fluid
    force: float = 0.25  # of the weight that the contact must carry

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The gap [m], and where contact forces are recorded, the force [N]."""
        prim = evidence.prim(self.objective.object)
        i = evidence.index(prim)
        support = support_of(evidence, i, evidence.prim(self.ref()))
        if not support.over[evidence.window].all():
            time = evidence.earliest(evidence.since(~support.over))
            return [self.failed(f"{prim} is not over {support.name} at the end", time=time)]
        found = [self._gap(evidence, i, support)]
        force = self._force(evidence, i, support)
        return [*found, force] if force is not None else found

    def _gap(self, evidence: Evidence, i: int, support: Support) -> Finding:
        low, high = evidence.ends(i)
        gap = height_over(evidence, i, evidence.prim(self.ref()), support)
        here = evidence.window
        tolerance = self.objective.tolerance or max(
            self.share * float((high - low)[here].mean()),
            self.spacings * support.fluid.spacing if support.fluid else 0.0,
        )
        value = float(gap[here].mean())
        prim = evidence.world.bodies[i].prim
        failing = abs(value) > tolerance
        since = evidence.since(np.abs(gap) > tolerance)
        word = "does not rest on" if failing else "rests on"
        return self.measured(
            f"{prim} {word} {support.name}: its lowest point is {value * 1e3:.3g} mm above it",
            value, tolerance if value >= 0 else -tolerance, "m", at_most=value >= 0, expected=0.0,
            time=evidence.earliest(since if failing else None),
            limit_from="the plan's tolerance"
            if self.objective.tolerance
            else f"{self.share:g} of the body's height"
            + (f", or {self.spacings:g} particle spacings if more" if support.fluid else ""),
        )  # fmt: skip

    def _force(self, evidence: Evidence, i: int, support: Support) -> Finding | None:
        """The mean contact force against weight less buoyancy; None where no force was recorded."""
        parts = welded(evidence, i)  # what is fixed together is carried as one
        force = np.asarray(evidence.recording.contact_force[evidence.window][:, parts], dtype=np.float64) @ evidence.up
        if not np.any(evidence.recording.contact_force):
            return None
        body = evidence.world.bodies[i]
        weight = sum(evidence.world.bodies[k].mass for k in parts) * evidence.gravity
        buoyancy, film = self._by_fluid(evidence, i, support)
        expected, value = weight - buoyancy, float(force.sum(axis=1).mean())
        above = value > expected
        limit = expected + self.force * weight + film if above else expected - self.force * weight
        source = f"{self.force:g} of its weight about weight less buoyancy, as a mean over the final window"
        if above and film > 0.0:
            source += f", and {film:.3g} N for the fluid that particles cannot bring under it"
        return self.measured(
            f"{body.prim} is carried with {value:.4g} N; its weight {'less buoyancy' if buoyancy else 'alone'} is "
            f"{expected:.4g} N",
            value, limit, "N", at_most=above, expected=expected, time=evidence.window_start, limit_from=source,
        )  # fmt: skip

    @staticmethod
    def _by_fluid(evidence: Evidence, i: int, support: Support) -> tuple[float, float]:
        """Buoyancy, and the lift that is lost where no particle fits between body and floor [N].

        Nothing presses up on the part of the body's underside that is within a spacing of the floor: at the most the
        still fluid's pressure there, times the body's section a spacing above its lowest point.
        """
        fluid = support.fluid
        if fluid is None:
            return 0.0, 0.0
        solid = evidence.solid(i)
        position, rotation = evidence.resting_pose(i)
        z, level = float(position[2]), evidence.level(fluid).height
        bottom = float(evidence.ends(i)[0][evidence.window].mean())
        specific = fluid.density * evidence.gravity
        thin = 0.05 * fluid.spacing
        height = bottom + min(fluid.spacing, solid.smallest / 2)
        slab = solid.volume_below(rotation, z, height + thin) - solid.volume_below(rotation, z, height - thin)
        film = specific * max(0.0, level - bottom) * slab / (2 * thin)
        poses = {k: evidence.resting_pose(k) for k in welded(evidence, i)}
        under = sum(evidence.solid(k).volume_below(q, float(at[2]), level) for k, (at, q) in poses.items())
        return specific * under, film


@dataclass
class ObjectiveStaysOn(ObjectiveCheck):
    """The body stays on the other object all the time."""

    share: float = 0.1  # of the body's height

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding: the largest gap at any time [m]."""
        prim = evidence.prim(self.objective.object)
        i = evidence.index(prim)
        support = support_of(evidence, i, evidence.prim(self.ref()))
        low, high = evidence.ends(i)
        tolerance = self.objective.tolerance or self.share * float((high - low)[0])
        source = "the plan's tolerance" if self.objective.tolerance else f"{self.share:g} of the body's height"
        gap = np.abs(height_over(evidence, i, evidence.prim(self.ref()), support))
        if not support.over.all():
            time = float(evidence.time[np.argmin(support.over)])
            return [
                self.failed(
                    f"{prim} leaves {support.name} at {time:.3f} s: it is no longer over it",
                    time=time, limit=tolerance, unit="m", limit_from=source,
                )
            ]  # fmt: skip
        worst, off = int(np.argmax(gap)), np.flatnonzero(gap > tolerance)
        time = float(evidence.time[worst])
        word = f"leaves {support.name} at {evidence.time[off[0]]:.3f} s" if len(off) else f"stays on {support.name}"
        message = f"{prim} {word}: the gap reaches {gap[worst] * 1e3:.3g} mm at {time:.3f} s"
        span = (float(evidence.time[off[0]]), time) if len(off) else None
        value = float(gap[worst])
        return [self.measured(message, value, tolerance, "m", expected=0.0, time=time, span=span, limit_from=source)]


@dataclass
class ObjectiveTopples(ObjectiveCheck):
    """The body tilts over its edge, and ends tilted, or lower than it was. A ball, which has no upright, falls."""

    tilt: float = 45.0  # [deg]
    drop: float = 0.5  # of its height

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """How far it tilts at the most [deg]; and at the end its tilt, or how far it fell [m]."""
        i = evidence.index(evidence.prim(self.objective.object))
        body = evidence.world.bodies[i]
        tilts = tilt(evidence.body_q[:, i, 3:], evidence.up)
        if all(shape.kind == "sphere" for shape in evidence.solid(i).shapes):
            return [self._end(evidence, i, np.zeros_like(tilts))]
        over = np.flatnonzero(tilts >= self.tilt)
        most, at = float(tilts.max()), over[0] if len(over) else int(np.argmax(tilts))
        word = "tips over" if len(over) else "does not tip over"
        turned = self.measured(
            f"{body.prim} {word}: it tilts by {most:.3g} degrees at the most", most, self.tilt, "deg", at_most=False,
            time=float(evidence.time[at]), limit_from="what is moved upright has not toppled",
        )  # fmt: skip
        return [turned, self._end(evidence, i, tilts)] if turned.passed else [turned]

    def _end(self, evidence: Evidence, i: int, tilts: Floats) -> Finding:
        low, high = evidence.ends(i)
        height = float((high - low)[0])
        fall, here = low[0] - low, evidence.window
        tilted, fell = float(tilts[here].mean()), float(fall[here].mean())
        by_drop = fell / (self.drop * height) > tilted / self.tilt
        fallen = (fall >= self.drop * height) | (tilts >= self.tilt)
        value, limit, unit = (fell, self.drop * height, "m") if by_drop else (tilted, self.tilt, "deg")
        word = "has toppled" if value >= limit else "stands"
        return self.measured(
            f"{evidence.world.bodies[i].prim} {word} at the end: tilted by {tilted:.3g} degrees, {fell:.3g} m lower "
            "than at the start",
            value, limit, unit, at_most=False,
            time=float(evidence.time[np.argmax(fallen)] if fallen.any() else evidence.time[-1]),
            limit_from=f"a tilt of {self.tilt:g} degrees, or a fall by {self.drop:g} of its height",
        )  # fmt: skip


@dataclass
class ObjectiveSettles(ObjectiveCheck):
    """The body comes to rest: it neither moves nor turns."""

    factor: float = 0.02  # of sqrt(g L)
    seconds: float = 0.5

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding: the speed of its fastest point (rms) [m/s]."""
        prim = evidence.prim(self.objective.object)
        i = evidence.index(prim)
        size = evidence.solid(i).smallest
        twist = evidence.body_qd[:, i]
        speed = np.linalg.norm(twist[:, :3], axis=1) + np.linalg.norm(twist[:, 3:], axis=1) * size / 2
        limit = self.objective.tolerance or self.factor * evidence.velocity_scale(size)
        value = math.sqrt(float(np.mean(speed[evidence.last(self.seconds)] ** 2)))
        word = "moves" if value > limit else "is at rest"
        return [
            self.measured(
                f"{prim} {word}: {value:.3g} m/s (rms) at the end",
                value, limit, "m/s", expected=0.0,
                time=evidence.earliest(evidence.since(speed > limit), float(evidence.time[-1]) - self.seconds),
                limit_from=f"{self.factor:g} sqrt(g L), L = {size:.3g} m: a head of {self.factor**2 / 2:.2g} L",
            )
        ]  # fmt: skip


OBJECTIVES: Objectives = {
    "rests_on": ObjectiveRestsOn,
    "stays_on": ObjectiveStaysOn,
    "topples": ObjectiveTopples,
    "settles": ObjectiveSettles,
}
