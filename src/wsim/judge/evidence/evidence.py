"""A recording seen through the judge's eyes: what it holds, and what can be worked out from it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, rotate
from wsim.judge.evidence.containment import alike, pools_of
from wsim.judge.evidence.joints import JointTrack, track_of
from wsim.judge.evidence.motion import Motion
from wsim.judge.evidence.recorded import MissingError, Recorded

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from wsim.judge.verdict import Finding
    from wsim.plan.schema import Plan
    from wsim.recording.recording import FluidTrack, Recording
    from wsim.scene.world import Container, Fluid, Joint

    Floats = NDArray[np.float64]

COLUMN = 2.0  # spacings: width of the columns whose highest particle is the surface
LEVEL_FRAMES = 10  # frames of the window that the surface is read from


@dataclass(frozen=True)
class Level:
    """A fluid's still surface over the final window [m], world."""

    height: float  # from the conserved volume of fluid, and what the bodies displace
    seen: float | None  # from the highest particles; None where bodies cover the surface
    floor: float  # the container's inner floor
    bottom: float  # what it lies on: the floor, or the surface of what is under it


class Evidence(Recorded):
    """Arrays worked out from it when they are first asked for."""

    def __init__(self, recording: Recording, plan: Plan | None = None) -> None:
        super().__init__(recording, plan)
        self._levels: dict[str, Level] = {}
        self._joints: dict[str, JointTrack | None] = {}
        self.of_world: dict[type, list[Finding]] = {}  # what checks say of the world and the plan alone
        self.answers: dict[str, list[Finding]] = {}  # of the plan's objectives, each put to the evidence once

    @staticmethod
    def join(copies: Sequence[Evidence]) -> Evidence | None:
        """Work out at once what several copies of a world have alike.

        Args:
            copies: W of like worlds (`wsim.judge.evidence.alike`), over the same times.

        Returns:
            Evidence whose motion has an axis of copies before that of time; None where what fluid or control gave them
            is recorded.
        """
        Recorded.share_geometry(copies)
        for copy in copies:
            if copy.world is copies[0].world:
                copy.of_world = copies[0].of_world
        if any(copy.recording.applied_impulse is not None for copy in copies):
            return None
        joined = Evidence(copies[0].recording, copies[0].plan)
        joined.part, joined.motion = copies[0].part, Motion.join([copy.motion for copy in copies])
        for n, copy in enumerate(copies):
            joined.motion.part(n, copy.motion)
        return joined

    # ---- bodies
    @cached_property
    def motion(self) -> Motion:
        """What bodies do between frames."""
        return Motion(self)

    def joint(self, joint: Joint) -> JointTrack | None:
        """How a joint holds; None where the recording does not say where its anchors are."""
        if joint.prim not in self._joints:
            self._joints[joint.prim] = track_of(self, joint)
        return self._joints[joint.prim]

    # ---- fluid
    def sound(self, fluid: Fluid) -> float:
        """Numerical speed of sound in a fluid [m/s], which all fluids that are simulated at once share; 0: not told."""
        return float(self.recording.metadata.get("speed_of_sound") or 0.0) or fluid.speed_of_sound

    def level(self, fluid: Fluid) -> Level:
        """The fluid's still surface over the final window; MissingError without particles or container.

        Of several liquids in a container each lies on those whose middle is lower.
        """
        if fluid.prim not in self._levels:
            self._levels[fluid.prim] = self._measure_level(fluid)
        return self._levels[fluid.prim]

    def _measure_level(self, fluid: Fluid) -> Level:
        track, container = self.track(fluid), self.container_of(fluid)
        frames = np.flatnonzero(track.time >= self.window_start - 1e-9)
        if container is None or len(frames) == 0:
            raise MissingError(f"{fluid.prim} has no container, or no particles in the last second: it has no level")
        chosen = frames[np.linspace(0, len(frames) - 1, min(LEVEL_FRAMES, len(frames))).astype(int)]
        floor = container.inner_center[2] - container.inner_size[2] / 2
        same, under = self._beside(fluid, container, chosen)
        own, below = (sum(self._volume_in(container, each, chosen) for each in some) for some in (same, under))
        height = self._level_of_volume(container, floor, below + own)
        bottom = self._level_of_volume(container, floor, below) if under else floor
        return Level(height, self._level_seen(fluid, container, track, chosen, height), floor, bottom)

    def _volume_in(self, container: Container, fluid: Fluid, chosen: NDArray[np.intp]) -> float:
        """What of a fluid a container holds, in the mean of frames [m^3]."""
        inside = 1.0 - self.containment(container, fluid).elsewhere[chosen]
        return fluid.cell * float(np.mean(self.track(fluid).count[chosen] * inside))

    def _beside(self, fluid: Fluid, container: Container, chosen: NDArray[np.intp]) -> tuple[list[Fluid], list[Fluid]]:
        """The fluids of a container that are as dense as one of them, and those that it lies on."""
        own = [each for each in self.world.fluids if each is fluid or self.container_of(each) is container]
        same = [each for each in own if alike(each, fluid)]
        others = [each for each in own if not alike(each, fluid)]
        if not others:
            return same, []
        middle = {each.prim: float(np.nanmean(self.track(each).position[chosen, :, 2])) for each in own}
        return same, [each for each in others if middle[each.prim] < middle[fluid.prim]]

    def _level_of_volume(self, container: Container, floor: float, volume: float) -> float:
        """The height at which the space under the surface, less the bodies in it, holds the volume."""
        area = container.inner_size[0] * container.inner_size[1]
        afloat = []
        for i in range(len(self.world.bodies)):
            position, rotation = self.resting_pose(i)
            p = self.local(container, position)
            if abs(p[0]) <= container.inner_size[0] / 2 and abs(p[1]) <= container.inner_size[1] / 2:
                afloat.append((position[2], [s.turned(rotation) for s in self.solid(i).surfaces]))
        low, high = floor, floor + volume / area + container.inner_size[2]
        for _ in range(40):
            middle = (low + high) / 2
            under = sum(mesh.volume_below(middle - z) for z, meshes in afloat for mesh in meshes)
            if (middle - floor) * area - under < volume:
                low = middle
            else:
                high = middle
        return (low + high) / 2

    def _level_seen(
        self, fluid: Fluid, container: Container, track: FluidTrack, chosen: NDArray[np.intp], height: float
    ) -> float | None:
        """Median over columns and frames of the highest particle, plus half a spacing, away from bodies.

        What stands in the fluid from its floor up, as a gate does, parts it in pools, each with a level of its own:
        then it is their mean, by area, which is what their common volume tells of.
        """
        width = COLUMN * fluid.spacing
        half = np.array(container.inner_size) / 2
        counts = np.maximum(1, np.round(2 * half[:2] / width)).astype(int)
        pools = pools_of(self._dry(container, counts, float(track.time[chosen[-1]]), height))
        tops: list[list[Floats]] = [[] for _ in range(int(pools.max()) + 1)]
        for frame in chosen:
            world = np.asarray(track.position[frame], dtype=np.float64)
            p = self.local(container, world)
            p = p[np.all(np.abs(p[:, :2]) < half[:2], axis=1)]
            cell = np.clip(((p[:, :2] + half[:2]) / (2 * half[:2]) * counts).astype(int), 0, counts - 1)
            top = np.full(int(counts.prod()), -np.inf)
            np.maximum.at(top, cell[:, 0] * counts[1] + cell[:, 1], p[:, 2])
            open_ = np.isfinite(top) & self._open_columns(container, counts, float(track.time[frame]), height, width)
            for k, found in enumerate(tops):
                found.append(top[open_ & (pools.ravel() == k)])
        levels = [np.concatenate(found) for found in tops]
        areas = np.array([np.count_nonzero(pools == k) if len(level) else 0 for k, level in enumerate(levels)])
        if not areas.any():
            return None
        medians = [float(np.median(level)) if len(level) else 0.0 for level in levels]
        return float(np.average(medians, weights=areas)) + fluid.spacing / 2 + container.inner_center[2]

    def _dry(self, container: Container, counts: NDArray[np.intp], time: float, height: float) -> NDArray[np.bool_]:
        """Columns (counts[0], counts[1]) whose middle a solid fills from the floor to above the surface."""
        frame = int(np.argmin(np.abs(self.time - time)))
        grid = _columns(container, counts)
        floor = -container.inner_size[2] / 2
        depth = height - (container.inner_center[2] + floor)
        half = max(size / n for size, n in zip(container.inner_size[:2], counts, strict=True)) / 2
        dry = np.zeros(len(grid), dtype=bool)
        for shape in self.placed:
            if shape.owner == container.prim or shape.shape.kind == "plane":
                continue
            stands = np.ones(len(grid), dtype=bool)
            for level in (0.1, 0.5, 0.9):
                points = np.column_stack([grid, np.full(len(grid), floor + level * depth)])
                at = rotate(np.array(container.rotation), points) + np.array(container.inner_center)
                local = rotate(conjugate(shape.rotation[frame]), at - shape.position[frame])
                stands &= shape.kind.depth(local) > -half
            dry |= stands
        return dry.reshape(*counts)

    def _open_columns(
        self, container: Container, counts: NDArray[np.intp], time: float, height: float, width: float
    ) -> NDArray[np.bool_]:
        """Columns that no body which pierces the surface stands in, (counts[0] * counts[1],)."""
        frame = int(np.argmin(np.abs(self.time - time)))
        grid = _columns(container, counts)
        free = np.ones(len(grid), dtype=bool)
        for i in range(len(self.world.bodies)):
            if self.ends(i)[1][frame] < height - width or self.ends(i)[0][frame] > height + width:
                continue
            solid = self.solid(i)
            q = self.body_q[frame, i]
            points = np.concatenate([rotate(q[3:], surface.vertices) + q[:3] for surface in solid.surfaces])
            p = self.local(container, points)[:, :2]
            free &= ~np.all((grid > p.min(axis=0) - width) & (grid < p.max(axis=0) + width), axis=1)
        return free


def _columns(container: Container, counts: NDArray[np.intp]) -> Floats:
    """The middles of a container's columns in its own frame, (counts[0] * counts[1], 2) [m]."""
    axes = [(np.arange(n) + 0.5) / n * size - size / 2 for n, size in zip(counts, container.inner_size, strict=False)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
