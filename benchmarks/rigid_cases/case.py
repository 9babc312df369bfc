"""What a case of rigid motion is, and how one is run."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from wsim.scene import Scene
from wsim.sim import Simulation

Array = np.ndarray
G = 9.81  # [m/s^2]
Build = Callable[[Scene], None]


@dataclass(frozen=True)
class Track:
    """How the bodies of a run moved: `position`, `velocity`, … take a body's name and give a row a frame."""

    time: Array  # [s], (frames,)
    body_q: Array  # (frames, bodies, 7)
    body_qd: Array  # (frames, bodies, 6)
    index: dict[str, int]

    def position(self, name: str) -> Array:
        """Of a body's origin [m], (frames, 3)."""
        return self.body_q[:, self.index[name], :3]

    def turn(self, name: str) -> Array:
        """Quaternions xyzw, (frames, 4)."""
        return self.body_q[:, self.index[name], 3:]

    def velocity(self, name: str) -> Array:
        """Of the centre of mass [m/s], (frames, 3)."""
        return self.body_qd[:, self.index[name], :3]

    def spin(self, name: str) -> Array:
        """In the world's axes [rad/s], (frames, 3)."""
        return self.body_qd[:, self.index[name], 3:]

    def angle(self, name: str, axis: int) -> Array:
        """Turned about one of the world's axes since the start [rad], without jumps, (frames,)."""
        turn = self.turn(name)
        x, w = turn[:, axis], turn[:, 3]
        half = np.unwrap(2.0 * np.arctan2(x, w))
        return half - half[0]

    def axes(self, name: str) -> Array:
        """Rotation matrices, (frames, 3, 3); the columns are the body's axes."""
        x, y, z, w = self.turn(name).astype(float).T
        rows = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
        return np.moveaxis(np.array(rows), -1, 0)

    def drift(self) -> Array:
        """How far any body's origin is from its start at most [m], (frames,)."""
        return np.linalg.norm(self.body_q[:, :, :3] - self.body_q[0, :, :3], axis=2).max(axis=1)

    def moved(self) -> float:
        """How far any body's origin ended from its start [m]."""
        return float(self.drift()[-1])

    def at(self, values: Array, time: float) -> float:
        """A row of numbers at a time."""
        return float(np.interp(time, self.time, values))


@dataclass(frozen=True)
class Curve:
    """What a case measured over the time or a parameter, and what is known of it there."""

    names: tuple[str, str]  # of the axes, with their units
    x: Array
    measured: Array
    known: Array | float


class Bench:
    """Runs worlds on one device, of several copies the first.

    Attributes:
        step: The longest time step that they took [s].
        curve: For the case's picture, if it has one.
    """

    def __init__(self, device: str, worlds: int = 1) -> None:
        self.device, self.worlds, self.step = device, worlds, 0.0
        self.curve: Curve | None = None

    def show(self, name: str, x: Array, measured: Array, known: Array | float, along: str = "t [s]") -> None:
        """Leave a curve for the case's picture: `measured` and what is known, over `x`."""
        self.curve = Curve((along, name), x, measured, known)

    def run(
        self, build: Build, seconds: float, *, rate: float = 100.0, step: float | None = None, exactly: bool = False
    ) -> Track:
        """Build a world, simulate it, and note all bodies `rate` times a second.

        Args:
            build: Fills a scene.
            seconds: To simulate.
            rate: Frames a second.
            step: Upper bound of the time step [s].
            exactly: Take `step` even where it is longer than what the simulator would take.
        """
        scene = Scene()
        scene.simulation(frame_rate=rate)
        build(scene)
        with tempfile.TemporaryDirectory() as folder:
            stage = scene.save(Path(folder) / "case.usda")
            simulation = Simulation(stage, device=self.device, world_count=self.worlds, time_step=step)
        if exactly and step:
            simulation.substeps = round(1.0 / rate / step)
            simulation.dt = 1.0 / rate / simulation.substeps
        self.step = max(self.step, simulation.dt)
        frames = [self._frame(simulation)]
        for _ in range(round(seconds * rate)):
            simulation.advance_frame()
            frames.append(self._frame(simulation))
        if problems := simulation.problems():
            raise RuntimeError("; ".join(problems))
        index = {
            body.prim.rsplit("/", 1)[1]: int(k)
            for body, k in zip(simulation.world.bodies, simulation.built.bodies, strict=True)
        }
        poses, speeds = (np.array([frame[k] for frame in frames], dtype=float) for k in range(2))
        return Track(np.arange(len(frames)) / rate, poses, speeds, index)

    @staticmethod
    def _frame(simulation: Simulation) -> tuple[Array, Array]:
        return simulation.state.body_q.numpy().copy(), simulation.state.body_qd.numpy().copy()


@dataclass(frozen=True)
class Case:
    """A motion whose answer is known; `run` gives the measured value and the expected one."""

    name: str
    says: str  # the answer and its formula, from the docstring
    unit: str
    reach: float  # of the expected value, or in the unit where that is zero
    why: str  # the reach is not 1 %
    run: Callable[[Bench], tuple[float, float]]

    def bound(self, expected: float) -> float:
        """Largest error that counts as reached, in the unit."""
        return self.reach * (abs(expected) or 1.0)

    def reached(self, value: float, expected: float) -> bool:
        """Whether a measured value is near enough."""
        return math.isfinite(value) and abs(value - expected) <= self.bound(expected)


def case(
    unit: str, reach: float = 0.01, why: str = "", name: str = ""
) -> Callable[[Callable[[Bench], tuple[float, float]]], Case]:
    """Make a case of a function; its docstring says what is known and from where."""

    def make(run: Callable[[Bench], tuple[float, float]]) -> Case:
        says = " ".join((run.__doc__ or "").split())
        return Case(name or run.__name__, says, unit, reach, why, run)

    return make


def elliptic_k(modulus: float) -> float:
    """Complete elliptic integral of the first kind, by the arithmetic-geometric mean (Gauss 1799)."""
    a, b = 1.0, math.sqrt(1.0 - modulus**2)
    while abs(a - b) > 1e-15:
        a, b = 0.5 * (a + b), math.sqrt(a * b)
    return math.pi / (2.0 * a)


def period(time: Array, values: Array) -> float:
    """Mean time between rising crossings of zero [s]."""
    k = np.flatnonzero((values[:-1] < 0.0) & (values[1:] >= 0.0))
    crossings = time[k] - values[k] * (time[k + 1] - time[k]) / (values[k + 1] - values[k])
    return float(np.diff(crossings).mean()) if len(crossings) > 1 else math.nan


def step_at(time: Array, when: float, before: float, after: float) -> Array:
    """What jumps at a blow."""
    return np.where(time < when, before, after)


def bounces(time: Array, height: float, restitution: float) -> Array:
    """Height [m] of what falls from `height` [m] and bounces by Newton's law of impact."""
    after, found = math.sqrt(2.0 * height / G), height - 0.5 * G * time**2
    speed = math.sqrt(2.0 * G * height)
    while restitution and after < time[-1] and speed > 1e-3:
        speed *= restitution
        found = np.where(time >= after, speed * (time - after) - 0.5 * G * (time - after) ** 2, found)
        after += 2.0 * speed / G
    return np.maximum(found, 0.0)


def swing(time: Array, angle: float, length: float, rate: float = 0.0) -> Array:
    """Angles of a pendulum of a reduced length [m] let go at `angle` [rad] and `rate` [rad/s] (Runge and Kutta)."""

    def change(state: Array) -> Array:
        return np.array([state[1], -G / length * math.sin(state[0])])

    state, found = np.array([angle, rate]), [angle]
    for h in np.diff(time):
        for _ in range(10):
            a = change(state)
            b = change(state + 0.05 * h * a)
            c = change(state + 0.05 * h * b)
            state = state + h / 60 * (a + 2 * b + 2 * c + change(state + 0.1 * h * c))
        found.append(float(state[0]))
    return np.array(found)


def approach(time: Array, mass: float, stiffness: float, damping: float) -> Array:
    """The way of a damped spring to its new length, from 0 to 1."""
    root = np.emath.sqrt(complex(damping**2 - 4 * stiffness * mass))
    a, b = (-damping + root) / (2 * mass), (-damping - root) / (2 * mass)
    return np.real(1 - (a * np.exp(b * time) - b * np.exp(a * time)) / (a - b))


STILL = "at rest: nothing is to move"
EXACT = "what is kept is kept to float32"
