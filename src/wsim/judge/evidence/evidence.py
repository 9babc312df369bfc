"""A recording seen through the judge's eyes: what it holds, and what can be worked out from it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.evidence.contact import placed_shapes
from wsim.judge.evidence.geometry import Solid, conjugate, mean_rotation, rotate
from wsim.judge.evidence.joints import JointTrack, track_of
from wsim.judge.evidence.motion import Motion

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.contact import Placed
    from wsim.plan.schema import Plan
    from wsim.recording.recording import FluidTrack, Recording
    from wsim.scene.world import Body, Container, Fluid, Joint, Static

    Floats = NDArray[np.float64]

WINDOW = 1.0  # means are taken over the last second [s],
WINDOW_SHARE = 0.25  # or this share of a longer run,
WINDOW_MOST = 0.5  # but never over more than this share
COLUMN = 2.0  # spacings: width of the columns whose highest particle is the surface
LEVEL_FRAMES = 10  # frames of the window that the surface is read from


class MissingError(LookupError):
    """What a check needs is not in the recording."""


@dataclass(frozen=True)
class Level:
    """A fluid's still surface over the final window [m], world."""

    height: float  # from the conserved volume of fluid, and what the bodies displace
    seen: float | None  # from the highest particles; None where bodies cover the surface
    floor: float  # the container's inner floor


class Evidence:
    """Lazily derived arrays. T frames, B bodies in the order of `world.bodies`."""

    def __init__(self, recording: Recording, plan: Plan | None = None) -> None:
        self.recording = recording
        self.plan = plan
        self.world = recording.world
        self.time: Floats = np.asarray(recording.time, dtype=np.float64)
        self.body_q: Floats = np.asarray(recording.body_q, dtype=np.float64)
        self.body_qd: Floats = np.asarray(recording.body_qd, dtype=np.float64)
        self._solids: dict[int, Solid] = {}
        self._levels: dict[str, Level] = {}
        self._joints: dict[str, JointTrack | None] = {}
        self._ends: dict[int, tuple[Floats, Floats]] = {}

    # ---- time
    @cached_property
    def window_start(self) -> float:
        """When the final window begins [s]."""
        first, last = float(self.time[0]), float(self.time[-1])
        span = last - first
        return last - min(max(WINDOW, WINDOW_SHARE * span), WINDOW_MOST * span)

    @cached_property
    def window(self) -> NDArray[np.bool_]:
        """Frames of the final window, (T,)."""
        return self.time >= self.window_start - 1e-9

    def last(self, seconds: float) -> NDArray[np.bool_]:
        """Frames of the last seconds, (T,)."""
        return self.time >= self.time[-1] - seconds - 1e-9

    def since(self, wrong: NDArray[np.bool_]) -> float | None:
        """When the last unbroken stretch of `wrong` (T,) that reaches the end began [s]; None if the end is right."""
        if not wrong[-1]:
            return None
        right = np.flatnonzero(~wrong)
        return float(self.time[right[-1] + 1 if len(right) else 0])

    def earliest(self, *times: float | None) -> float:
        """The first of some times that is known, or the start of the final window [s]."""
        return next((time for time in times if time is not None), self.window_start)

    # ---- who is who
    @cached_property
    def gravity(self) -> float:
        """The strength of gravity [m/s^2]."""
        return float(np.linalg.norm(self.world.gravity))

    @staticmethod
    def prim(name: str) -> str:
        """The prim of a plan's object."""
        return f"/World/{name}"

    def index(self, prim: str) -> int:
        """The row of a body; MissingError naming the known ones."""
        for i, body in enumerate(self.world.bodies):
            if body.prim == prim:
                return i
        raise MissingError(f"the world has no body {prim}; it has {self._listed([b.prim for b in self.world.bodies])}")

    def body(self, prim: str) -> Body:
        """A body by prim; MissingError."""
        return self.world.bodies[self.index(prim)]

    def static(self, prim: str) -> Static | None:
        """A static object by prim."""
        return next((static for static in self.world.statics if static.prim == prim), None)

    def container(self, prim: str) -> Container | None:
        """A container by prim."""
        return next((container for container in self.world.containers if container.prim == prim), None)

    def fluid(self, prim: str) -> Fluid:
        """A fluid by its prim or its container's; MissingError."""
        for fluid in self.world.fluids:
            if prim in (fluid.prim, fluid.container):
                return fluid
        raise MissingError(f"the world has no fluid {prim}; it has {self._listed([f.prim for f in self.world.fluids])}")

    def track(self, fluid: Fluid) -> FluidTrack:
        """A fluid's particles through time; MissingError."""
        track = self.recording.fluids.get(fluid.prim)
        if track is None or len(track.time) == 0 or track.position.shape[1] == 0:
            raise MissingError(f"the recording has no particles of {fluid.prim}")
        return track

    def line(self, prim: str | None) -> str | None:
        """The program's line that made a prim."""
        lines = {item.prim: item.line for item in self.world.fluids}
        lines |= {item.prim: item.line for item in self.world.joints}
        lines |= {item.prim: item.line for item in self.world.statics}
        lines |= {item.prim: item.line for item in self.world.bodies}
        return lines.get(prim) if prim is not None else None

    @staticmethod
    def _listed(prims: list[str]) -> str:
        return ", ".join(prims) if prims else "none"

    # ---- bodies
    @cached_property
    def motion(self) -> Motion:
        """What bodies do between frames."""
        return Motion(self)

    @cached_property
    def placed(self) -> list[Placed]:
        """All colliding shapes through time, those of bodies first."""
        return placed_shapes(self)

    def joint(self, joint: Joint) -> JointTrack | None:
        """How a joint holds; None where the recording does not say where its anchors are."""
        if joint.prim not in self._joints:
            self._joints[joint.prim] = track_of(self, joint)
        return self._joints[joint.prim]

    def solid(self, i: int) -> Solid:
        """A body's shapes."""
        if i not in self._solids:
            self._solids[i] = Solid(self.world.bodies[i])
        return self._solids[i]

    def ends(self, i: int) -> tuple[Floats, Floats]:
        """Height of a body's lowest and highest point, (T,) each [m]."""
        if i not in self._ends:
            low, high = self.solid(i).reach(self.body_q[:, i, 3:])
            z = self.body_q[:, i, 2]
            self._ends[i] = (z + low, z + high)
        return self._ends[i]

    def resting_pose(self, i: int) -> tuple[Floats, Floats]:
        """A body's mean position (3,) and rotation (4,) over the final window."""
        q = self.body_q[self.window, i]
        return q[:, :3].mean(axis=0), mean_rotation(q[:, 3:])

    def velocity_scale(self, length: float) -> float:
        """The speed sqrt(g L) that gravity gives over a length [m/s]."""
        return math.sqrt(max(self.gravity, 1e-9) * length)

    # ---- fluid
    def container_of(self, fluid: Fluid) -> Container | None:
        """The container that a fluid fills."""
        return self.container(fluid.container) if fluid.container is not None else None

    @staticmethod
    def local(container: Container, points: Floats) -> Floats:
        """Points (..., 3) in a container's frame, its inner box centred on the origin [m]."""
        q = np.array(container.rotation, dtype=np.float64)
        shifted = points - np.array(container.inner_center)
        if np.array_equal(q, [0.0, 0.0, 0.0, 1.0]):
            return shifted
        return rotate(conjugate(q), shifted)

    def outside(self, fluid: Fluid) -> Floats:
        """Share of a fluid's particles more than a spacing outside its container, at each of its frames, (T,).

        Above the open rim a particle is still inside as long as it is over the container.
        """
        container = self.container_of(fluid)
        track = self.track(fluid)
        if container is None:
            return np.zeros(len(track.time))
        return np.array([self.strayed(container, fluid, frame).mean() for frame in track.position])

    def strayed(self, container: Container, fluid: Fluid, points: Floats) -> NDArray[np.bool_]:
        """Which of a fluid's particles (N, 3) are more than a spacing outside a container, (N,)."""
        p = self.local(container, points)
        half = np.array(container.inner_size) / 2 + fluid.spacing
        strayed: NDArray[np.bool_] = (np.abs(p[:, 0]) > half[0]) | (np.abs(p[:, 1]) > half[1]) | (p[:, 2] < -half[2])
        return strayed

    def level(self, fluid: Fluid) -> Level:
        """The fluid's still surface over the final window; MissingError without particles or container."""
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
        # A particle stands for its cell of the lattice that fills the fluid's box at the start.
        cells = math.prod(max(1, round(length / fluid.spacing)) for length in fluid.size)
        inside = 1.0 - float(np.mean([self.strayed(container, fluid, track.position[f]).mean() for f in chosen]))
        volume = math.prod(fluid.size) / cells * track.position.shape[1] * inside
        height = self._level_of_volume(container, floor, volume)
        return Level(height, self._level_seen(fluid, container, track, chosen, height), floor)

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
        """Median over columns and frames of the highest particle, plus half a spacing, away from bodies."""
        width = COLUMN * fluid.spacing
        half = np.array(container.inner_size) / 2
        counts = np.maximum(1, np.round(2 * half[:2] / width)).astype(int)
        tops = []
        for frame in chosen:
            world = np.asarray(track.position[frame], dtype=np.float64)
            p = self.local(container, world)
            p = p[np.all(np.abs(p[:, :2]) < half[:2], axis=1)]
            cell = np.clip(((p[:, :2] + half[:2]) / (2 * half[:2]) * counts).astype(int), 0, counts - 1)
            top = np.full(int(counts.prod()), -np.inf)
            np.maximum.at(top, cell[:, 0] * counts[1] + cell[:, 1], p[:, 2])
            open_ = np.isfinite(top) & self._open_columns(container, counts, float(track.time[frame]), height, width)
            tops.append(top[open_])
        found = np.concatenate(tops) if tops else np.zeros(0)
        if len(found) == 0:
            return None
        return float(np.median(found)) + fluid.spacing / 2 + container.inner_center[2]

    def _open_columns(
        self, container: Container, counts: NDArray[np.intp], time: float, height: float, width: float
    ) -> NDArray[np.bool_]:
        """Columns that no body which pierces the surface stands in, (counts[0] * counts[1],)."""
        frame = int(np.argmin(np.abs(self.time - time)))
        axes = [
            (np.arange(n) + 0.5) / n * size - size / 2 for n, size in zip(counts, container.inner_size, strict=False)
        ]
        grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
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
