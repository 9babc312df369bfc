"""Faults of the recording: the world is simulated as it should be, and something else is written down."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from benchmarks.judge_worlds.tamper import ROOT, Tamper, row
from wsim.recording import FluidFrame, Frame
from wsim.scene.world import World

Vec3 = tuple[float, float, float]


def _moved(frame: Frame, k: int, offset: np.ndarray | Vec3, velocity: np.ndarray | Vec3 = (0.0, 0.0, 0.0)) -> Frame:
    q, qd = frame.body_q.copy(), frame.body_qd.copy()
    q[k, :3] += np.asarray(offset, dtype=np.float32)
    qd[k, :3] += np.asarray(velocity, dtype=np.float32)
    return replace(frame, body_q=q, body_qd=qd)


@dataclass
class Teleport(Tamper):
    """A body is elsewhere for one frame."""

    name: str
    offset: Vec3  # [m]
    at: float  # [s]
    done: bool = field(default=False, repr=False)

    def frame(self, t: float, frame: Frame, world: World) -> Frame:
        """Move one frame."""
        if self.done or t < self.at:
            return frame
        self.done = True
        return _moved(frame, row(world, self.name), self.offset)


@dataclass
class Displaced(Tamper):
    """A body is elsewhere from some time on."""

    name: str
    offset: Vec3  # [m]
    start: float = 0.0  # [s]

    def frame(self, t: float, frame: Frame, world: World) -> Frame:
        """Move every frame."""
        return frame if t < self.start else _moved(frame, row(world, self.name), self.offset)


@dataclass
class Drift(Tamper):
    """A body creeps away."""

    name: str
    velocity: Vec3  # [m/s]
    start: float = 0.0  # [s]

    def frame(self, t: float, frame: Frame, world: World) -> Frame:
        """Add the way made since the start."""
        if t < self.start:
            return frame
        return _moved(frame, row(world, self.name), np.array(self.velocity) * (t - self.start), self.velocity)


@dataclass
class Jitter(Tamper):
    """A body jumps to and fro from frame to frame."""

    name: str
    amplitude: float  # [m]
    sign: int = field(default=1, repr=False)

    def frame(self, t: float, frame: Frame, world: World) -> Frame:
        """Move by the amplitude, this way and that."""
        self.sign = -self.sign
        return _moved(frame, row(world, self.name), (self.sign * self.amplitude, 0.0, 0.0))


@dataclass
class Late(Tamper):
    """All that bodies do is recorded later; until then they are where they start."""

    seconds: float
    names: tuple[str, ...] = ()  # all, if none
    kept: list[tuple[float, Frame]] = field(default_factory=list, repr=False)

    def frame(self, t: float, frame: Frame, world: World) -> Frame:
        """The frame of an earlier time."""
        self.kept.append((t, frame))
        earlier = max((k for k, (then, _) in enumerate(self.kept) if then <= t - self.seconds + 1e-9), default=0)
        old = self.kept[earlier][1]
        rows = [row(world, name) for name in self.names] or list(range(len(world.bodies)))
        arrays = {}
        for name in ("body_q", "body_qd", "contact_force"):
            array = getattr(frame, name).copy()
            array[rows] = getattr(old, name)[rows]
            arrays[name] = array
        return replace(frame, **arrays)


@dataclass
class Freeze(Tamper):
    """A body hangs where it is for a while, then goes on from there."""

    name: str
    start: float  # [s]
    seconds: float
    pose: np.ndarray | None = field(default=None, repr=False)

    def frame(self, t: float, frame: Frame, world: World) -> Frame:
        """Keep the pose, at rest."""
        if not self.start <= t < self.start + self.seconds:
            return frame
        k = row(world, self.name)
        self.pose = frame.body_q[k].copy() if self.pose is None else self.pose
        q, qd = frame.body_q.copy(), frame.body_qd.copy()
        q[k], qd[k] = self.pose, 0.0
        return replace(frame, body_q=q, body_qd=qd)


@dataclass
class Swap(Tamper):
    """Two bodies change places in the recording, from frame to frame of their ways."""

    first: str
    second: str

    def frame(self, t: float, frame: Frame, world: World) -> Frame:
        """Exchange rows, each from where it starts."""
        i, j = row(world, self.first), row(world, self.second)
        start = {k: np.array(world.bodies[k].position) for k in (i, j)}
        q, qd, force = frame.body_q.copy(), frame.body_qd.copy(), frame.contact_force.copy()
        for k, other in ((i, j), (j, i)):
            q[k] = frame.body_q[other]
            q[k, :3] += (start[k] - start[other]).astype(np.float32)
            qd[k], force[k] = frame.body_qd[other], frame.contact_force[other]
        return replace(frame, body_q=q, body_qd=qd, contact_force=force)


@dataclass
class Scaled(Tamper):
    """From some time on a body makes a share of the way that it makes."""

    name: str
    factor: float
    start: float  # [s]
    origin: np.ndarray | None = field(default=None, repr=False)

    def frame(self, t: float, frame: Frame, world: World) -> Frame:
        """Scale the level way since the start."""
        if t < self.start:
            return frame
        k = row(world, self.name)
        self.origin = frame.body_q[k, :2].copy() if self.origin is None else self.origin
        q, qd = frame.body_q.copy(), frame.body_qd.copy()
        q[k, :2] = self.origin + self.factor * (q[k, :2] - self.origin)
        qd[k] *= self.factor
        return replace(frame, body_q=q, body_qd=qd)


@dataclass
class Fallen(Tamper):
    """A body comes off its joint and falls to the ground."""

    name: str
    start: float  # [s]
    radius: float  # at this height it lies [m]
    pose: tuple[float, np.ndarray, np.ndarray] | None = field(default=None, repr=False)

    def frame(self, t: float, frame: Frame, world: World) -> Frame:
        """A parabola from where it came off."""
        if t < self.start:
            return frame
        k = row(world, self.name)
        if self.pose is None:
            self.pose = (t, frame.body_q[k].copy(), frame.body_qd[k].copy())
        t0, q0, v0 = self.pose
        g, dt = 9.81, t - t0
        height = float(q0[2]) - self.radius
        lands = (float(v0[2]) + math.sqrt(float(v0[2]) ** 2 + 2 * g * max(height, 0.0))) / g
        air = min(dt, lands)
        q, qd, force = frame.body_q.copy(), frame.body_qd.copy(), frame.contact_force.copy()
        q[k] = q0
        q[k, :3] += v0[:3] * air + np.array([0.0, 0.0, -g * air**2 / 2], dtype=np.float32)
        qd[k] = 0.0
        force[k] = (0.0, 0.0, world.bodies[k].mass * g)
        if dt < lands:
            qd[k, :3] = v0[:3] + np.array([0.0, 0.0, -g * dt], dtype=np.float32)
            force[k] = 0.0
        return replace(frame, body_q=q, body_qd=qd, contact_force=force)


@dataclass
class NotTurning(Tamper):
    """A body moves as it does, without turning."""

    name: str

    def frame(self, t: float, frame: Frame, world: World) -> Frame:
        """Keep the first rotation."""
        k = row(world, self.name)
        q, qd = frame.body_q.copy(), frame.body_qd.copy()
        q[k, 3:], qd[k, 3:] = world.bodies[k].rotation, 0.0
        return replace(frame, body_q=q, body_qd=qd)


@dataclass
class Pressed(Tamper):
    """A body's contact force is recorded as another."""

    name: str
    factor: float

    def frame(self, t: float, frame: Frame, world: World) -> Frame:
        """Scale it."""
        force = frame.contact_force.copy()
        force[row(world, self.name)] *= self.factor
        return replace(frame, contact_force=force)


@dataclass
class Leak(Tamper):
    """Water comes out through a wall, a particle at a time, and lies on the ground beside the tank."""

    fluid: str
    share: float  # of the particles, by the end
    start: float  # [s]
    end: float  # [s]

    def frame(self, t: float, frame: Frame, world: World) -> Frame:
        """Put the particles that are out by now on the ground."""
        prim = ROOT + self.fluid
        made = frame.fluids[prim]
        count = len(made.position)
        progress = min(max((t - self.start) / (self.end - self.start), 0.0), 1.0)
        out = np.random.default_rng(7).permutation(count)[: round(self.share * progress * count)]
        if not len(out):
            return frame
        box = next(c for c in world.containers if any(f.prim == prim and f.container == c.prim for f in world.fluids))
        spacing = next(f.spacing for f in world.fluids if f.prim == prim)
        position, velocity = made.position.copy(), made.velocity.copy()
        beyond = box.inner_center[0] + box.inner_size[0] / 2 + 0.02 + 2 * spacing
        position[out, 0] = beyond + spacing * (np.arange(len(out)) % 10)
        position[out, 2] = spacing / 2
        velocity[out] = 0.0
        return replace(frame, fluids={**frame.fluids, prim: FluidFrame(position, velocity, made.density)})


@dataclass
class Squeezed(Tamper):
    """A fluid stands lower than its volume says, as if it were compressed."""

    fluid: str
    factor: float

    def frame(self, t: float, frame: Frame, world: World) -> Frame:
        """Scale heights above the tank's floor, and densities."""
        prim = ROOT + self.fluid
        made = frame.fluids[prim]
        fluid = next(f for f in world.fluids if f.prim == prim)
        floor = fluid.center[2] - fluid.size[2] / 2
        position = made.position.copy()
        position[:, 2] = floor + self.factor * (position[:, 2] - floor)
        density = made.density / np.float32(self.factor)
        return replace(frame, fluids={**frame.fluids, prim: FluidFrame(position, made.velocity, density)})


@dataclass
class Spray(Tamper):
    """One particle shoots out of the water at a speed that nothing gave it."""

    fluid: str
    speed: float  # [m/s]
    at: float  # [s]

    def frame(self, t: float, frame: Frame, world: World) -> Frame:
        """Send the highest particle up, for a tenth of a second."""
        if not self.at <= t < self.at + 0.1:
            return frame
        prim = ROOT + self.fluid
        made = frame.fluids[prim]
        top = int(np.argmax(made.position[:, 2]))
        position, velocity = made.position.copy(), made.velocity.copy()
        position[top, 2] += self.speed * (t - self.at)
        velocity[top] = (0.0, 0.0, self.speed)
        return replace(frame, fluids={**frame.fluids, prim: FluidFrame(position, velocity, made.density)})
