"""What a recording says, as it says it: times, poses, who is who, and which line made it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import mean_rotation, upwards
from wsim.geometry.shapes import Solid
from wsim.judge.evidence.containment import Containment, falls_beside, local
from wsim.judge.evidence.final_window import final_window
from wsim.judge.evidence.placed import as_parts, placed_shapes, placed_together
from wsim.judge.evidence.stacked import Stacked, stacked
from wsim.judge.evidence.vessels import strayed
from wsim.scene.world import Shape

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.placed import Placed
    from wsim.plan.schema import Plan, PlanObject
    from wsim.recording.recording import FluidTrack, Recording
    from wsim.scene.world import Body, Container, Fluid, Static, World

    Floats = NDArray[np.float64]


class MissingError(LookupError):
    """What a check needs is not in the recording."""


@dataclass(frozen=True)
class Part:
    """Some frames of many copies' frames, which stand one after another."""

    whole: Whole
    frames: slice


def _solid(body: Body) -> Solid[Shape]:
    return Solid(body.shapes or [_stand_in(body)])


def _stand_in(body: Body) -> Shape:
    """A ball of a body's mass about its centre that turns as hard as the body does: I = 2/5 m r^2 on the mean."""
    moment = max(float(np.trace(np.reshape(body.inertia, (3, 3)))) / 3.0, 0.0)
    radius = math.sqrt(2.5 * moment / body.mass) if body.mass > 0.0 else 0.0
    return Shape(prim=body.prim, kind="sphere", size=(radius,), position=body.com, collides=False)


class Recorded:
    """Times, poses, shapes and who is who. T frames, B bodies in the order of `world.bodies`."""

    def __init__(self, recording: Recording, plan: Plan | None = None) -> None:
        self.recording = recording
        self.plan = plan
        self.world = recording.world
        self.time: Floats = np.asarray(recording.time, dtype=np.float64)
        self.body_q: Floats = np.asarray(recording.body_q, dtype=np.float64)
        self.body_qd: Floats = np.asarray(recording.body_qd, dtype=np.float64)
        self._solids: dict[int, Solid[Shape]] = {}
        self._containments: dict[tuple[str, str], Containment] = {}
        self._strayed: dict[str, Floats] = {}
        self._ends: dict[int, tuple[Floats, Floats]] = {}
        self.kept: dict[object, object] = {}  # what several checks work out alike, by its class, and of what
        self.part: Part | None = None  # of many copies of this world, where it is one of them

    # ---- time
    @cached_property
    def window_start(self) -> float:
        """When the final window begins [s]."""
        first, last = float(self.time[0]), float(self.time[-1])
        span = last - first
        return last - final_window(span)

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

    @cached_property
    def up(self) -> Floats:
        """Against gravity (3,): what heights are along; +Z where there is none."""
        return upwards(self.world.gravity)

    @property
    def varied(self) -> bool:
        """Whether a parameter of the program was set to another value than its own."""
        return any(parameter.value != parameter.default for parameter in self.world.parameters)

    def planned(self, prim: str) -> PlanObject | None:
        """The plan's object that a prim is made of, or a part of."""
        return self._owners.get(prim)

    @cached_property
    def _owners(self) -> dict[str, PlanObject]:
        items = self.plan.objects if self.plan is not None else []
        return {self.prim(name): item for item in reversed(items) for name in item.prims}

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
        return self._lines.get(prim) if prim is not None else None

    @cached_property
    def _lines(self) -> dict[str, str | None]:
        world = self.world
        made = [*world.fluids, *world.joints, *world.cords, *world.statics, *world.bodies]
        return {item.prim: item.line for item in made}

    @staticmethod
    def _listed(prims: list[str]) -> str:
        return ", ".join(prims) if prims else "none"

    # ---- bodies
    def solid(self, i: int) -> Solid[Shape]:
        """A body's shapes; of one without any, as between two joints of a robot, a ball that nothing touches."""
        if i not in self._solids:
            alike = self.part is not None and not self.part.whole.varies(i)
            self._solids[i] = self.part.whole.solid(i) if self.part and alike else _solid(self.world.bodies[i])
        return self._solids[i]

    def ends(self, i: int) -> tuple[Floats, Floats]:
        """Height of a body's lowest and highest point, (T,) each [m]."""
        if self.part is not None:
            low, high = self.part.whole.ends(i)
            return low[self.part.frames], high[self.part.frames]
        if i not in self._ends:
            low, high = self.solid(i).reach(self.body_q[:, i, 3:], self.up)
            z = self.body_q[:, i, :3] @ self.up
            self._ends[i] = (z + low, z + high)
        return self._ends[i]

    def resting_pose(self, i: int) -> tuple[Floats, Floats]:
        """A body's mean position (3,) and rotation (4,) over the final window."""
        q = self.body_q[self.window, i]
        return q[:, :3].mean(axis=0), mean_rotation(q[:, 3:])

    def velocity_scale(self, length: float) -> float:
        """The speed sqrt(g L) that gravity gives over a length [m/s]."""
        return math.sqrt(max(self.gravity, 1e-9) * length)

    @cached_property
    def placed(self) -> list[Placed]:
        """All colliding shapes through time, those of bodies first."""
        if self.part is not None:
            return as_parts(self.part.whole.placed, self.world, self.part.frames)
        return placed_shapes(self.world, self.body_q)

    @cached_property
    def places(self) -> Floats:
        """Where all colliding shapes are, (T, shapes, 3) [m]."""
        found = [shape.position for shape in self.placed]
        return np.stack(found, axis=1) if found else np.zeros((len(self.time), 0, 3))

    @staticmethod
    def share_geometry(copies: Sequence[Recorded]) -> None:
        """Let copies of a world, of T frames each, work out at once what is of each frame by itself: all geometry."""
        recording, count = copies[0].recording, len(copies[0].time)
        body_q = np.concatenate([copy.body_q for copy in copies])
        whole = Whole(
            replace(recording, time=np.arange(len(body_q), dtype=np.float64), body_q=body_q),
            [copy.world for copy in copies],
        )
        for n, copy in enumerate(copies):
            copy.part = Part(whole, slice(n * count, (n + 1) * count))

    # ---- fluid
    def container_of(self, fluid: Fluid) -> Container | None:
        """The tank that a fluid fills."""
        return self.container(fluid.container) if fluid.container is not None else None

    local = staticmethod(local)

    def containment(self, container: Container, fluid: Fluid) -> Containment:
        """Which particles a container holds, to a spacing; worked out once. MissingError."""
        key = container.prim, fluid.prim
        if key not in self._containments:
            position, taps = self.track(fluid).position, self.world.taps
            self._containments[key] = Containment.of(
                container, position, fluid.spacing, bool(taps), falls_beside(container, taps)
            )
        return self._containments[key]

    def outside(self, fluid: Fluid) -> Floats:
        """Share of a fluid's particles more than a spacing outside its container, at each of its frames, (T,).

        Above the open rim a particle is still inside as long as it is over the container.
        """
        container = self.container_of(fluid)
        if container is not None:
            return self.containment(container, fluid).outside
        if fluid.volume is None:
            return np.zeros(len(self.track(fluid).time))
        if fluid.prim not in self._strayed:
            self._strayed[fluid.prim] = self._outside_of_vessel(fluid)
        return self._strayed[fluid.prim]

    def _outside_of_vessel(self, fluid: Fluid) -> Floats:
        """Of a fluid in a vessel that is no tank, the share that is beside it or under it; MissingError."""
        track, prim = self.track(fluid), fluid.container or ""
        still = self.static(prim)
        if still is not None:
            shapes, pose = still.shapes, np.tile([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], (len(track.time), 1))
        else:
            i = self.index(prim)
            frames = np.abs(self.time[:, None] - track.time).argmin(axis=0)
            shapes, pose = self.world.bodies[i].shapes, self.body_q[frames, i].astype(np.float64)
        moves, tapped = still is None, bool(self.world.taps)
        found = strayed(shapes, pose, track.position, fluid.spacing, self.up, moves, tapped).sum(axis=1)
        return np.asarray(found / np.maximum(track.count, 1))


class Whole(Recorded):
    """The frames of several copies one after another, of bodies that may be of other sizes in each."""

    def __init__(self, recording: Recording, worlds: Sequence[World]) -> None:
        """Of copies that are of one form (`wsim.judge.evidence.alike.same_form`)."""
        super().__init__(recording)
        self._worlds = worlds
        self._stacks: dict[int, Solid[Shape]] = {}

    @cached_property
    def placed(self) -> list[Placed]:
        """All colliding shapes through all frames."""
        return placed_together(self._worlds, self.body_q)

    def solid(self, i: int) -> Solid[Shape]:
        """A body's shapes, of each frame."""
        if i not in self._stacks:
            shapes = [_solid(world.bodies[i]).shapes for world in self._worlds]
            count = len(self.time) // len(self._worlds)
            self._stacks[i] = Solid([stacked(each, count) for each in zip(*shapes, strict=True)])
        return self._stacks[i]

    def varies(self, i: int) -> bool:
        """Whether a body is of another size in some copy."""
        return any(isinstance(shape, Stacked) for shape in self.solid(i).shapes)
