"""Checks of a fluid as a whole: none of it gets through what is solid, and at rest it lies level and even."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import rotate
from wsim.geometry.shapes import into, kind_of
from wsim.judge.checks.check import Check, Checks
from wsim.judge.checks.physics import lows
from wsim.judge.evidence.containment import local
from wsim.judge.evidence.layers import layers, mass_displaced
from wsim.scene.contact import within

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.scene.world import Container, Fluid

    Floats = NDArray[np.float64]


@dataclass
class CheckLeak(Check):
    """Not one particle gets under the floor of its tank, into the ground or what stands there, or falls for ever."""

    spacings: float = 1.0  # that particles may press into what is solid

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """How many particles of each fluid are where none can get, at most."""
        found = []
        for fluid in evidence.world.fluids:
            track = evidence.track(fluid)
            lost = np.array(
                [self._through(evidence, fluid, points[track.there(k)]) for k, points in enumerate(track.position)]
            )
            value, at = int(lost.max(initial=0)), int(np.argmax(lost > 0))
            found.append(
                self.measured(
                    f"{value} of {track.position.shape[1]} particles of {fluid.prim} are under a floor, or in what is "
                    f"solid, from {float(track.time[at]):.3f} s",
                    value, 0.0, "particles", prim=fluid.prim, time=float(track.time[at]), expected=0.0,
                    fine=f"No particle of {fluid.prim} gets under a floor or into what is solid",
                    limit_from=f"none, farther than {self.spacings:g} spacing: what is solid lets nothing through",
                )
            )  # fmt: skip
        return found

    def _through(self, evidence: Evidence, fluid: Fluid, points: NDArray[np.float32]) -> int:
        """Particles under the hollow of a tank, in what stands still, or under all of it, where nothing holds them."""
        deep, own = self.spacings * fluid.spacing, points.astype(np.float64)
        gone = own @ evidence.up < min(lows(evidence), default=-math.inf) - deep
        container = evidence.container_of(fluid)
        if container is not None:
            inside, half = local(container, own), np.array(container.inner_size) / 2
            gone |= (np.abs(inside[:, :2]) < half[:2]).all(axis=1) & (inside[:, 2] < -half[2] - deep)
        for shape in (shape for static in evidence.world.statics for shape in static.shapes if shape.collides):
            gone |= kind_of(shape).depth(into(shape, own)) > deep
        return int(gone.sum())


@dataclass
class CheckLevelSurface(Check):
    """A fluid at rest in a box, and alone there, has a level surface."""

    degrees: float = 1.0

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """Tilt of the surface, over the final window."""
        found = []
        for fluid in evidence.world.fluids:
            container = evidence.container_of(fluid)
            track = evidence.track(fluid)
            if container is None or track.present is not None or not self._alone(evidence, fluid, container):
                continue
            late = track.time >= evidence.window_start
            points = local(container, track.position[late].mean(axis=0).astype(np.float64))
            level = fluid.amount / (container.inner_size[0] * container.inner_size[1])
            speed = float(np.sqrt((track.velocity[late].astype(np.float64) ** 2).sum(axis=2).mean()))
            swing = speed * math.sqrt(level / max(evidence.gravity, 1e-9))  # as high as it still sloshes
            found.append(self._tilt(evidence, fluid, points, swing / min(container.inner_size[:2])))
        return found

    @staticmethod
    def _alone(evidence: Evidence, fluid: Fluid, container: Container) -> bool:
        """Whether it is the only fluid in an upright tank, and nothing else is in there."""
        upright = bool(rotate(np.array(container.rotation), np.array([0.0, 0.0, 1.0])) @ evidence.up > 1.0 - 1e-6)
        if not upright or evidence.gravity == 0.0 or len(evidence.world.fluids) > 1:
            return False
        half, motion = np.array(container.inner_size) / 2, evidence.motion
        for static in evidence.world.statics:
            for shape in (shape for shape in static.shapes if not within(shape.prim, container.prim)):
                size = 0.0 if shape.kind == "plane" else kind_of(shape).radius_about
                if shape.kind != "plane" and (np.abs(local(container, np.array(shape.position))) < half + size).all():
                    return False
        inside = np.abs(local(container, motion.com)) < half + motion.radius[:, None]
        return not inside.all(axis=2).any()

    def _tilt(self, evidence: Evidence, fluid: Fluid, points: Floats, swing: float) -> Finding:
        """Columns are as high as their mean is twice: the slope of all particles' heights is half the surface's."""
        level = np.column_stack([points[:, :2] - points[:, :2].mean(axis=0), np.ones(len(points))])
        slope = np.linalg.lstsq(level, points[:, 2], rcond=None)[0][:2]
        value = math.degrees(math.atan(2.0 * float(np.linalg.norm(slope))))
        return self.measured(
            f"The surface of {fluid.prim} is tilted by {value:.2g} degrees at rest",
            value, self.degrees + math.degrees(math.atan(2.0 * swing)), "deg", prim=fluid.prim,
            time=evidence.window_start, expected=0.0,
            limit_from=f"{self.degrees:g} degree, and how far it still sloshes",
        )  # fmt: skip


@dataclass
class CheckDraft(Check):
    """What hangs still in a fluid, touched by nothing else, displaces its own mass of it, whoever asks."""

    share: float = 0.1  # of its mass
    high: float = 0.6  # spacings that it may ride too high: particles stand off its faces
    low: float = 0.25
    still: float = 0.05  # of sqrt(g L)

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The mass of fluid that each such body displaces at the end."""
        found, motion = [], evidence.motion
        if evidence.gravity == 0.0 or evidence.recording.metadata.get("controlled"):
            return []
        late = evidence.last(0.5)
        for fluid in evidence.world.fluids:
            container = evidence.container_of(fluid)
            if container is None or (stack := layers(evidence, fluid))[0] is not fluid:  # of each container once
                continue
            if not all(each.newtonian for each in stack):  # one that yields holds what hangs in it
                continue
            half = np.array(container.inner_size)[:2] / 2
            for i, body in enumerate(evidence.world.bodies):
                slow = motion.speed[late, i].max() < self.still * evidence.velocity_scale(evidence.solid(i).smallest)
                held = motion.touched[late, i].any() or motion.jointed[i] or body.kinematic
                over = np.abs(local(container, motion.com[-1, i])[:2]) < half
                if slow and not held and over.all():
                    found.append(self._displaced(evidence, fluid, i))
        return found

    def _displaced(self, evidence: Evidence, fluid: Fluid, i: int) -> Finding:
        position, rotation = evidence.resting_pose(i)
        solid, body = evidence.solid(i), evidence.world.bodies[i]
        below = [
            mass_displaced(
                evidence, fluid, lambda z: solid.volume_below(rotation, float(position[2]), z), by * fluid.spacing
            )
            for by in (0.0, self.high, -self.low)
        ]
        least = (1.0 - self.share) * body.mass - (below[1] - below[0])
        most = (1.0 + self.share) * body.mass + (below[0] - below[2])
        return self.between(
            f"{body.prim} hangs in {fluid.prim} with {below[0]:.4g} kg displaced, and weighs {body.mass:.4g} kg",
            below[0], (least, most), "kg", body.mass, prim=body.prim,
            time=evidence.window_start,
            limit_from=f"Archimedes; {self.share:g} of its mass, {self.high:g} spacing higher, {self.low:g} lower",
        )  # fmt: skip


CHECKS: Checks = (CheckLeak, CheckLevelSurface, CheckDraft)
