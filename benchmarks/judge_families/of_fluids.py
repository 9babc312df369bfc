"""Faults of fluids, and of what they do to bodies."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.judge_families.drawn import Draw, Sound
from benchmarks.judge_families.family import SHARE, Faulty, family
from benchmarks.judge_families.in_stage import scaled
from benchmarks.judge_families.record import Array, Track, edited, own, simulated, world_of
from benchmarks.judge_families.stepping import Told
from wsim.judge.books.fluids import fluid_books
from wsim.judge.evidence.evidence import Evidence
from wsim.recording.recording import FluidTrack
from wsim.scene.world import World

WATER = "/World/water"
WET = ("still", "floats", "sinks")


def _floor(world: World) -> float:
    box = world.containers[0]
    return box.inner_center[2] - 0.5 * box.inner_size[2]


def _weighed(track: Track, fluid: FluidTrack, world: World, count: int) -> Track:
    """A track with other particles, and with their energies; `count` is how many it had."""
    made = edited(track, **{WATER: fluid})
    volume = world.fluids[0].size[0] * world.fluids[0].size[1] * world.fluids[0].size[2]
    mass = world.fluids[0].density * volume / count
    x, v = fluid.position.astype(np.float64), fluid.velocity.astype(np.float64)
    energies = {
        "energy/kinetic_fluid": 0.5 * mass * (v**2).sum(axis=(1, 2)),
        "energy/potential_fluid": -mass * (x @ np.array(world.gravity)).sum(axis=1),
    }
    return replace(made, scalars={**made.scalars, **energies})


@family((0.02, 0.05, 0.1, 0.2, 0.4), SHARE, WET, seen=False)
def fluid_volume(sound: Sound, size: float, draw: Draw) -> Faulty:
    """A share of the fluid is gone: particles from its top."""
    world, track = world_of(sound.stage), simulated(sound.stage)
    water = track.fluids[WATER]
    count = water.position.shape[1]
    left = np.sort(np.argsort(water.position[-1, :, 2])[: round((1.0 - size) * count)])
    fewer = FluidTrack(water.time, water.position[:, left], water.velocity[:, left], water.density[:, left])
    return Faulty(_weighed(track, fewer, world, count), world)


@family((0.02, 0.05, 0.1, 0.2, 0.4), SHARE, WET, seen=False)
def fluid_level(sound: Sound, size: float, draw: Draw) -> Faulty:
    """The fluid stands higher or lower than its volume says."""
    world, track = world_of(sound.stage), simulated(sound.stage)
    water, floor = track.fluids[WATER], _floor(world)
    position = water.position.copy()
    by = 1.0 + size if draw.sign() > 0 else 1.0 / (1.0 + size)
    position[..., 2] = floor + by * (position[..., 2] - floor)
    return Faulty(_weighed(track, replace(water, position=position), world, position.shape[1]), world)


@family((1.0, 2.5, 5.0, 10.0, 20.0), "deg", ("still",), seen=False)
def fluid_tilt(sound: Sound, size: float, draw: Draw) -> Faulty:
    """The surface at rest is not level."""
    world, track = world_of(sound.stage), simulated(sound.stage)
    water, floor, middle = track.fluids[WATER], _floor(world), world.containers[0].inner_center[0]
    position = water.position.copy()
    depth = world.fluids[0].size[2]
    share = (position[..., 2] - floor) / depth
    position[..., 2] += share * math.tan(math.radians(size)) * (position[..., 0] - middle)
    return Faulty(_weighed(track, replace(water, position=position), world, position.shape[1]), world)


@family((0.003, 0.01, 0.03, 0.1, 0.3), SHARE, WET, seen=False, wrong=0.003)
def leak(sound: Sound, size: float, draw: Draw) -> Faulty:
    """Particles fall through the floor of the tank, one after another."""
    world, track = world_of(sound.stage), simulated(sound.stage)
    water, floor = track.fluids[WATER], _floor(world)
    position, velocity = water.position.astype(np.float64), water.velocity.astype(np.float64)
    count = position.shape[1]
    gone = draw.random.permutation(count)[: max(1, round(size * count))]
    g = np.array(world.gravity)
    for n, k in enumerate(gone):
        since = track.time - track.time[-1] * (0.2 + 0.6 * n / len(gone))
        out = since > 0
        first = int(np.argmax(out))
        start = position[first, k] * [1, 1, 0] + np.array([0, 0, floor])
        position[out, k] = start + 0.5 * g * since[out, None] ** 2
        velocity[out, k] = g * since[out, None]
    made = replace(water, position=position.astype(np.float32), velocity=velocity.astype(np.float32))
    return Faulty(_weighed(track, made, world, count), world)


@dataclass(frozen=True)
class Lifted(Told):
    """The fluid bears the first body more or less than it should, under the surface [N]."""

    force: float
    surface: float

    def __call__(self, t: float, q: Array, qd: Array) -> Array:
        """The wrenches."""
        found = np.zeros((len(q), 6))
        found[0, 2] = self.force * (q[0, 2] < self.surface)
        return found


@dataclass(frozen=True)
class Slowed(Told):
    """The fluid resists the first body more than it should, under the surface [kg/s]."""

    rate: float
    surface: float

    def __call__(self, t: float, q: Array, qd: Array) -> Array:
        """The wrenches."""
        found = np.zeros((len(q), 6))
        found[0, :3] = -self.rate * qd[0, :3] * (q[0, 2] < self.surface)
        return found


def _surface(world: World) -> float:
    return world.fluids[0].center[2] + 0.5 * world.fluids[0].size[2]


@family((0.03, 0.1, 0.2, 0.4, 0.8), SHARE, ("floats", "sinks"))
def fluid_lift(sound: Sound, size: float, draw: Draw) -> Faulty:
    """The fluid bears a body by another share of what it displaces, and says so itself."""
    world = world_of(sound.stage)
    body = world.bodies[0]
    force = draw.sign() * size * world.fluids[0].density * body.volume * -world.gravity[2]
    if sound.mechanism.name == "floating":
        force = draw.sign() * size * body.mass * -world.gravity[2]
    return Faulty(
        simulated(sound.stage, Lifted(force, _surface(world) + 1e3 * (sound.mechanism.name == "floating"))), world
    )


@family((0.03, 0.1, 0.2, 0.4, 0.8), SHARE, ("floats", "sinks"))
def fluid_lift_hidden(sound: Sound, size: float, draw: Draw) -> Faulty:
    """Likewise, and the walls are said to have got the rest, so that the fluid's momentum adds up."""
    faulty = fluid_lift(sound, size, draw)
    books = fluid_books(Evidence(own(faulty.track, faulty.world)))
    walls = faulty.track.frames["wall_impulse"].copy()
    walls[1:] -= books.left
    return replace(faulty, track=replace(faulty.track, frames={**faulty.track.frames, "wall_impulse": walls}))


@family((0.1, 0.3, 1.0, 3.0, 10.0), SHARE, ("sinks",), wrong=1.0)
def fluid_drag(sound: Sound, size: float, draw: Draw) -> Faulty:
    """The fluid resists what sinks by so much more, of the drag of a ball at its greatest speed."""
    world, track = world_of(sound.stage), simulated(sound.stage)
    body = world.bodies[0]
    speed = float(np.linalg.norm(track.qd[:, 0, :3], axis=1).max())
    radius = body.shapes[0].size[0]
    rate = (
        size * 0.5 * 0.47 * world.fluids[0].density * math.pi * radius**2 * speed
    )  # Hoerner, Fluid-Dynamic Drag, 1965
    return Faulty(simulated(sound.stage, Slowed(rate, _surface(world))), world)


@family((0.03, 0.1, 0.2, 0.4, 0.8), SHARE, ("floats", "sinks"))
def fluid_density(sound: Sound, size: float, draw: Draw) -> Faulty:
    """The fluid is denser or lighter than the world says."""
    return scaled(sound, 1.0 + size if draw.sign() > 0 else 1.0 / (1.0 + size), "wsim:density")
