"""Forces that nothing exerts: they act while the right stage is simulated, and the world does not have them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.judge_families.drawn import Draw, Sound, Vector
from benchmarks.judge_families.family import SHARE, Faulty, family, movers
from benchmarks.judge_families.record import Array, simulated, world_of
from wsim.scene.world import World

WEIGHTS = (0.01, 0.03, 0.1, 0.3, 1.0)


def pull_of(world: World) -> float:
    """Gravity, or that of the Earth where there is none [m/s^2]."""
    return float(np.linalg.norm(world.gravity)) or 9.81


@dataclass(frozen=True)
class Steady:
    """A force on one body from one time to another [N], or towards a place."""

    row: int
    force: float
    way: Vector
    start: float
    end: float
    to: Vector | None = None

    def __call__(self, t: float, q: Array, qd: Array) -> Array:
        """The wrenches."""
        found = np.zeros((len(q), 6))
        if self.start <= t < self.end:
            way = np.array(self.way)
            if self.to is not None:
                way = np.array(self.to) - q[self.row, :3]
                way = way / max(float(np.linalg.norm(way)), 1e-9)
            found[self.row, :3] = self.force * way
        return found


@dataclass(frozen=True)
class Turned:
    """A torque on one body [N m]."""

    row: int
    torque: float
    way: Vector
    start: float
    end: float

    def __call__(self, t: float, q: Array, qd: Array) -> Array:
        """The wrenches."""
        found = np.zeros((len(q), 6))
        if self.start <= t < self.end:
            found[self.row, 3:] = self.torque * np.array(self.way)
        return found


@dataclass(frozen=True)
class Dragged:
    """A force against all velocities, or with them: a share of momentum lost each second [1/s]."""

    rates: tuple[float, ...]  # [kg/s], by body
    spins: tuple[float, ...]  # [kg m^2/s]

    def __call__(self, t: float, q: Array, qd: Array) -> Array:
        """The wrenches."""
        return -np.column_stack([qd[:, :3] * np.array(self.rates)[:, None], qd[:, 3:] * np.array(self.spins)[:, None]])


def pushed(sound: Sound, push: object) -> Faulty:
    """A sound world, simulated under a push."""
    return Faulty(simulated(sound.stage, push), world_of(sound.stage))  # type: ignore[arg-type]


def _row(world: World, draw: Draw) -> int:
    return draw.pick(movers(world))


def _steady(sound: Sound, size: float, draw: Draw, way: Vector, seconds: float) -> Faulty:
    world = world_of(sound.stage)
    row, start = _row(world, draw), draw.between(0.05, world.duration - seconds - 0.05)
    force = size * world.bodies[row].mass * pull_of(world)
    return pushed(sound, Steady(row, force, way, round(start, 3), round(start + seconds, 3)))


@family(WEIGHTS, "of the weight", ("single", "rest", "pair", "swings", "spring", "drive", "rope"))
def ghost_force(sound: Sound, size: float, draw: Draw) -> Faulty:
    """A force from nowhere acts on a body for a quarter of a second, in any direction."""
    return _steady(sound, size, draw, draw.direction(), 0.25)


@family(WEIGHTS, "of the weight", ("slides", "rest", "roll"))
def side_force(sound: Sound, size: float, draw: Draw) -> Faulty:
    """A level force from nowhere on what lies, slides or rolls, all run long."""
    x, y = draw.heading()
    return _steady(sound, size, draw, (x, y, 0.0), world_of(sound.stage).duration - 0.11)


@family((0.03, 0.1, 0.2, 0.4, 0.8), SHARE, ("air", "slides", "roll", "swings"))
def side_kick(sound: Sound, size: float, draw: Draw) -> Faulty:
    """A body is kicked sideways within a frame, by a share of its greatest speed."""
    world, track = world_of(sound.stage), simulated(sound.stage)
    row = _row(world, draw)
    speed = float(np.linalg.norm(track.qd[:, row, :3], axis=1).max())
    if speed < 0.05:  # it turns where it is
        speed = 0.05
    start = round(draw.between(0.1, 0.6 * world.duration), 3)
    force = size * speed * world.bodies[row].mass / 0.01
    return pushed(sound, Steady(row, force, draw.direction(), start, start + 0.01))


@family(WEIGHTS, "of the weight", ("air", "rest", "slides", "swings", "roll"))
def pull_towards(sound: Sound, size: float, draw: Draw) -> Faulty:
    """A body is drawn to a point near it all run long, as by a magnet."""
    world = world_of(sound.stage)
    row = _row(world, draw)
    body = world.bodies[row]
    far = 3.0 * max(body.shapes[0].size)
    x, y, z = draw.direction()
    to = (body.position[0] + far * x, body.position[1] + far * y, body.position[2] + far * abs(z))
    return pushed(sound, Steady(row, size * body.mass * pull_of(world), (0, 0, 1), 0.0, 99.0, to))


@family((0.02, 0.05, 0.1, 0.3, 1.0), "of the speed a second", ("air", "swings", "slides", "roll", "spring"), wrong=0.1)
def drag(sound: Sound, size: float, draw: Draw) -> Faulty:
    """Velocities fade as in a syrup that the world does not have."""
    return pushed(sound, _dragged(world_of(sound.stage), size))


@family((0.02, 0.05, 0.1, 0.3, 1.0), "of the speed a second", ("air", "swings", "slides", "roll", "spring"), wrong=0.1)
def boost(sound: Sound, size: float, draw: Draw) -> Faulty:
    """Velocities grow by themselves."""
    return pushed(sound, _dragged(world_of(sound.stage), -size))


def _dragged(world: World, rate: float) -> Dragged:
    rates = tuple(0.0 if body.kinematic else rate * body.mass for body in world.bodies)
    spins = tuple(
        0.0 if body.kinematic else rate * sum(body.inertia[k] for k in (0, 4, 8)) / 3 for body in world.bodies
    )
    return Dragged(rates, spins)


@family((0.01, 0.03, 0.1, 0.3, 1.0), "of the weight", ("air", "spins", "slides", "swings", "roll"))
def ghost_torque(sound: Sound, size: float, draw: Draw) -> Faulty:
    """A torque from nowhere, of a share of the weight on an arm of half the size, turns a body for a quarter second."""
    world = world_of(sound.stage)
    row, start = _row(world, draw), round(draw.between(0.05, world.duration - 0.3), 3)
    body = world.bodies[row]
    torque = size * body.mass * pull_of(world) * 0.5 * max(body.shapes[0].size)
    return pushed(sound, Turned(row, torque, draw.direction(), start, start + 0.25))
