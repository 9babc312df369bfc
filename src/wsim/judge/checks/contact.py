"""Checks of solids against solids: no wall is passed through, and nothing is pressed on by what is not there."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, cast

import numpy as np

from wsim.geometry.rotations import conjugate, lengths, rotate
from wsim.judge.checks.check import Check, Checks
from wsim.judge.evidence.motion import FLOAT32
from wsim.judge.evidence.separation import separation
from wsim.judge.verdict import RepairTarget
from wsim.scene.contact import passing

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.evidence.placed import Placed
    from wsim.judge.evidence.recorded import Recorded
    from wsim.judge.verdict import Finding
    from wsim.scene.world import Shape

    Floats = NDArray[np.float64]
    Indices = NDArray[np.intp]
    Asked = tuple[int, Indices, Floats, Floats]  # of a body: frames, limits and gaps there


@dataclass
class CheckTunnelling(Check):
    """No body's centre goes into a solid by one face and out by the opposite one between two frames."""

    travel: float = 0.5  # of a shape's smallest extent: what goes less far in a frame is seen in it, by its penetration

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The first passage through each object, or one finding for none."""
        motion = evidence.motion
        if len(motion.h) == 0:
            return []
        jointed = {frozenset((joint.parent or joint.fixture, joint.child)) for joint in evidence.world.joints}
        passes = passing(evidence.world)
        moved = lengths(np.diff(motion.com, axis=0))
        most = moved.max(axis=0)
        found: dict[tuple[str, str], Finding] = {}
        for shape in evidence.placed:
            if shape.shape.kind in ("plane", "mesh"):
                continue  # a plane has no other side, and a mesh no known thickness
            if (
                most.max(initial=0.0) + (most[shape.body] if shape.body >= 0 else 0.0)
                <= self.travel * shape.kind.thinnest
            ):
                continue
            far = moved + (moved[:, [shape.body]] if shape.body >= 0 else 0.0)
            k, bodies = np.nonzero(far > self.travel * shape.kind.thinnest)
            apart = np.linalg.norm(motion.com[k, bodies] - shape.position[k], axis=1)
            reaches = apart < shape.radius + far[k, bodies]
            k, bodies = k[reaches], bodies[reaches]
            for i in np.unique(bodies):
                body = evidence.world.bodies[i]
                if body.prim == shape.owner or frozenset((body.prim, shape.owner)) in jointed:
                    continue
                if all(passes((body.prim, own.prim), (shape.owner, shape.shape.prim)) for own in body.shapes):
                    continue
                asked = k[bodies == i]
                passed = asked[self._passes(evidence, int(i), shape, asked)]
                if len(passed):
                    found.setdefault((body.prim, shape.owner), self._finding(evidence, int(i), shape, int(passed[0])))
        return list(found.values()) or [self.passed("No body has passed through a solid between two frames")]

    @staticmethod
    def _passes(evidence: Evidence, i: int, shape: Placed, k: Indices) -> NDArray[np.bool_]:
        """Whether the chord of body i's centre, seen from a shape, goes in and out by opposite faces.

        Seen as the shape is turned halfway: to one that turns with a shape what stands still beside it goes round.
        """
        first, last = shape.rotation[k], shape.rotation[k + 1]
        halfway = first + np.where(np.sum(first * last, axis=1) < 0.0, -1.0, 1.0)[:, None] * last
        halfway /= np.linalg.norm(halfway, axis=1, keepdims=True)
        ends = [
            rotate(conjugate(halfway), evidence.motion.com[frames, i] - shape.position[frames]) for frames in (k, k + 1)
        ]
        half = _inner_half(shape.shape)
        start, way = ends[0], ends[1] - ends[0]
        with np.errstate(divide="ignore", invalid="ignore"):
            one, other = (-half - start) / way, (half - start) / way
        # Along an axis on which it does not move, it is within all the time or never.
        still = np.abs(way) < 1e-12
        within = np.abs(start) < half
        enters = np.where(still, np.where(within, -np.inf, np.inf), np.minimum(one, other))
        leaves = np.where(still, np.where(within, np.inf, -np.inf), np.maximum(one, other))
        into, out = enters.max(axis=1), leaves.min(axis=1)
        opposite = enters.argmax(axis=1) == leaves.argmin(axis=1)
        passes: NDArray[np.bool_] = (into > 0.0) & (out < 1.0) & (into < out) & opposite
        return passes

    def _finding(self, evidence: Evidence, i: int, shape: Placed, k: int) -> Finding:
        body = evidence.world.bodies[i]
        start, end = float(evidence.time[k]), float(evidence.time[k + 1])
        thick = shape.kind.thinnest
        return self.failed(
            f"{body.prim} passes through {shape.owner}, {thick * 1e3:.3g} mm thick, from {start:.3f} to {end:.3f} s",
            prim=body.prim, time=end, span=(start, end),
            value=float(np.linalg.norm(evidence.motion.com[k + 1, i] - evidence.motion.com[k, i])), expected=0.0,
            unit="m", limit_from="its centre goes in by one face and out by the opposite one",
            target=RepairTarget(
                kind="time step", prim=body.prim, parameter="time_step", direction="lower",
                suggested=0.25 * thick / max(float(evidence.motion.speed[k, i]), 1e-9), unit="s",
                why="a step must not cross more than a quarter of what it is to stop at",
            ),
        )  # fmt: skip


def _inner_half(shape: Shape) -> Floats:
    """Half the edges of a box inside a shape, in its own frame [m]."""
    if shape.kind == "box":
        return np.array(shape.size) / 2
    if shape.kind == "sphere":
        return np.full(3, shape.size[0] / np.sqrt(3.0))
    across = shape.size[0] / np.sqrt(2.0)
    return np.array([across, across, shape.size[1] / 2])


@dataclass
class CheckSupport(Check):
    """What the solver presses on has something there to press: no contact without a surface in reach."""

    share: float = 0.01  # of its smallest extent: a contact may be made that much before it touches
    steps: float = 2.0  # the one whose force is told, and one that a contact may be late by
    moments: int = 32  # frames in contact that are looked at

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """The body whose nearest surface is farthest away while it is in contact, by its limit."""
        worst: tuple[float, Finding] | None = None
        if CheckSupport not in evidence.kept:
            evidence.kept[CheckSupport] = self._asked([evidence], evidence)[0]
        for i, frames, limit, gap in cast("list[Asked]", evidence.kept[CheckSupport]):
            at = int(np.argmax(gap / limit))
            if worst is None or gap[at] / limit[at] > worst[0]:
                finding = self._finding(evidence, i, frames[gap > limit], float(gap[at]), float(limit[at]))
                worst = (float(gap[at] / limit[at]), finding)
        return [worst[1]] if worst is not None else []

    def prepare(self, joined: Evidence, copies: Sequence[Evidence]) -> None:
        """The distances in all copies at once."""
        if joined.part is not None:
            for evidence, asked in zip(copies, self._asked(copies, joined.part.whole), strict=True):
                evidence.kept[CheckSupport] = asked

    def _asked(self, copies: Sequence[Evidence], whole: Recorded) -> list[list[Asked]]:
        """Of each copy: each body in contact, in which frames, how far it may be from a shape, and how far it is.

        `whole` has the frames of all copies, one after another.
        """
        found: list[list[Asked]] = [[] for _ in copies]
        for i in np.flatnonzero(~copies[0].motion.kinematic):
            some = []
            for n, evidence in enumerate(copies):
                frames = np.flatnonzero(evidence.motion.touched[:, i])
                frames = frames[_spread(len(frames), self.moments)]
                if len(frames):
                    some.append((n, frames, self._limit(evidence, int(i), frames)))
            if not some:
                continue
            at = np.concatenate([n * len(copies[n].time) + frames for n, frames, _ in some])
            nearest = _nearest(whole, int(i), at, np.concatenate([limit for _, _, limit in some]))
            gaps = np.split(nearest, np.cumsum([len(frames) for _, frames, _ in some])[:-1])
            for (n, frames, limit), gap in zip(some, gaps, strict=True):
                found[n].append((int(i), frames, limit, gap))
        return found

    def _limit(self, evidence: Evidence, i: int, frames: Indices) -> Floats:
        """How far a body may have come from what pressed on it, (n,) [m]."""
        motion = evidence.motion
        surface = motion.surface_speed
        fastest = np.maximum(surface[frames], surface[np.maximum(frames - 1, 0)]).max(axis=1)
        rounding = 4.0 * FLOAT32 * np.abs(motion.com[frames, i]).max(axis=1)
        way = self.steps * 2.0 * (fastest + evidence.gravity * motion.dt) * motion.dt
        limit: Floats = self.share * evidence.solid(i).smallest + way + rounding
        return limit

    def _finding(self, evidence: Evidence, i: int, wrong: Indices, gap: float, limit: float) -> Finding:
        body = evidence.world.bodies[i]
        target = RepairTarget(kind="program", prim=body.prim, why="it is carried by nothing that is there")
        return self.measured(
            f"{body.prim} is pressed on, and the nearest surface is {gap * 1e3:.3g} mm away or more",
            max(gap, 0.0), limit, "m", fine="Where the solver presses, there is something to press", expected=0.0,
            prim=body.prim, time=float(evidence.time[wrong[0]]) if len(wrong) else None,
            span=(float(evidence.time[wrong[0]]), float(evidence.time[wrong[-1]])) if len(wrong) else None,
            limit_from=f"{self.share:g} of its smallest extent, and the way of both in {self.steps:g} time steps",
            target=target,
        )  # fmt: skip


@lru_cache(256)
def _spread(count: int, most: int) -> Indices:
    """Which of so many frames are looked at, where that is not all."""
    found: Indices = np.unique(np.linspace(0, count - 1, min(most, count)).astype(np.intp))
    found.flags.writeable = False
    return found


def _nearest(evidence: Recorded, i: int, frames: Indices, limit: Floats) -> Floats:
    """How far body i is from the nearest other shape at least, (n,) [m]; what is within the limit is not looked at.

    In each frame the shapes are asked in the order in which the balls about them are near.
    """
    nearest, shapes = np.full(len(frames), np.inf), evidence.placed
    radius = np.stack([shape.radii[frames] for shape in shapes], axis=1)
    other = [k for k, shape in enumerate(shapes) if shape.body != i]
    if not other:
        return nearest
    for k, own in ((k, shape) for k, shape in enumerate(shapes) if shape.body == i):
        apart = lengths(own.position[frames][:, None] - evidence.places[frames][:, other])
        apart -= radius[:, k, None] + radius[:, other]
        order = np.argsort(apart, axis=1, kind="stable")
        for rank in order.T:
            bound = apart[np.arange(len(frames)), rank]
            wanted = (nearest > limit) & (bound < nearest)
            if not wanted.any():
                break  # all others are farther
            for k in np.unique(rank[wanted]):
                asked = np.flatnonzero(wanted & (rank == k))
                gap = np.maximum(separation(own, shapes[other[k]], frames[asked]), bound[asked])
                nearest[asked] = np.minimum(nearest[asked], gap)
    return nearest


CHECKS: Checks = (CheckTunnelling, CheckSupport)
