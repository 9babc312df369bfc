"""Faults of a hand: poses are changed, and the velocities with them, so that the two agree."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.judge_families.drawn import Draw, Sound
from benchmarks.judge_families.family import SHARE, Faulty, family, movers, size_of
from benchmarks.judge_families.record import Array, Track, cut, edited, simulated, world_of
from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.scene.world import World


def _base(sound: Sound) -> tuple[World, Track, Array, Array]:
    track = simulated(sound.stage)
    return world_of(sound.stage), track, track.q.astype(np.float64), track.qd.astype(np.float64)


def _about(way: Array, angle: Array) -> Array:
    """Quaternions (T, 4) of turns by angles (T,) about one direction."""
    half = 0.5 * angle[:, None]
    return np.concatenate([np.sin(half) * way, np.cos(half)], axis=1)


def _smooth(time: Array, start: float, seconds: float) -> tuple[Array, Array]:
    """From 0 to 1 with no jump of the velocity, and its rate [1/s]."""
    x = np.clip((time - start) / seconds, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x), np.where((x > 0) & (x < 1), 6.0 * x * (1.0 - x) / seconds, 0.0)


@family((0.01, 0.03, 0.1, 0.3, 1.0), "of the body's size", ("rest", "slides", "roll"), hand=True)
def hover(sound: Sound, size: float, draw: Draw) -> Faulty:
    """What lies, slides or rolls does so above the ground, all run long."""
    world, track, q, _ = _base(sound)
    up = -np.array(world.gravity) / np.linalg.norm(world.gravity)
    for k in movers(world):
        q[:, k, :3] += size * size_of(world, k) * up
    return Faulty(edited(track, q), world)


@family((0.01, 0.03, 0.1, 0.3, 0.9), "of the body's size", ("rest", "slides"), hand=True)
def sunk(sound: Sound, size: float, draw: Draw) -> Faulty:
    """What lies or slides is in the ground, all run long."""
    world, track, q, _ = _base(sound)
    up = -np.array(world.gravity) / np.linalg.norm(world.gravity)
    for k in movers(world):
        q[:, k, :3] -= size * min(world.bodies[k].shapes[0].size) * up
    return Faulty(edited(track, q), world)


@family((0.1, 0.2, 0.4, 0.6, 0.9), "of the greatest speed", ("slides",), hand=True, but=("surface", "pair"), wrong=0.1)
def sticking(sound: Sound, size: float, draw: Draw) -> Faulty:
    """What slides stops dead, at a share of its greatest speed."""
    world, track, q, qd = _base(sound)
    speed = np.linalg.norm(qd[:, 0, :3], axis=1)
    after = np.arange(len(speed)) >= 5  # a body that never moved would be as it should
    stop = int(np.argmin(np.abs(speed - size * speed.max()) + np.where(after, 0.0, np.inf)))
    taken = float(np.linalg.norm(world.gravity)) * (track.time[1] - track.time[0])  # in a frame, at a friction of 1
    if speed[stop] > 2.0 * taken:  # what is slower friction may stop
        q[stop:, 0], qd[stop:, 0] = q[stop, 0], 0.0
    return Faulty(edited(track, q, qd), world)


@family((0.003, 0.01, 0.03, 0.1, 0.3), "of the body's size", ("rest",), hand=True, wrong=0.02)
def creeping(sound: Sound, size: float, draw: Draw) -> Faulty:
    """What lies still is shifted along what it lies on, slowly, by the end of the run by so much."""
    world, track, q, qd = _base(sound)
    k = movers(world)[-1]
    way = rotate(q[0, k, 3:], np.array([0.0, 1.0, 0.0]))
    far, rate = size * size_of(world, k), 1.0 / track.time[-1]
    q[:, k, :3] += far * rate * track.time[:, None] * way
    qd[:, k, :3] += far * rate * way
    return Faulty(edited(track, q, qd), world)


@family((0.03, 0.1, 0.2, 0.4, 0.8), SHARE, ("roll",), hand=True)
def slipping(sound: Sound, size: float, draw: Draw) -> Faulty:
    """What rolls turns slower than it rolls, or faster."""
    world, track, q, qd = _base(sound)
    k, by = movers(world)[0], 1.0 + draw.sign() * size
    return Faulty(edited(track, *_turned(q, qd, k, by * np.ones(len(q)), track.time)), world)


@family((0.03, 0.1, 0.2, 0.4, 0.8), SHARE, ("spins",), hand=True)
def spin(sound: Sound, size: float, draw: Draw) -> Faulty:
    """What flies comes to turn faster or slower while it flies, by a share."""
    world, track, q, qd = _base(sound)
    by, _ = _smooth(track.time, 0.3 * track.time[-1], 0.3 * track.time[-1])
    return Faulty(edited(track, *_turned(q, qd, 0, 1.0 + draw.sign() * size * by, track.time)), world)


def _turned(q: Array, qd: Array, k: int, by: Array, time: Array) -> tuple[Array, Array]:
    """Poses and velocities of a body whose spin is scaled (T,); its turns are the integral of that."""
    steps = np.diff(time)
    turn = multiply(q[1:, k, 3:], conjugate(q[:-1, k, 3:]))
    turn *= np.where(turn[:, 3:] < 0.0, -1.0, 1.0)
    half = np.arctan2(np.linalg.norm(turn[:, :3], axis=1), turn[:, 3])
    way = turn[:, :3] / np.maximum(np.linalg.norm(turn[:, :3], axis=1, keepdims=True), 1e-12)
    for n in range(len(steps)):
        more = _about(way[n], np.array([2.0 * half[n] * 0.5 * (by[n] + by[n + 1])]))[0]
        q[n + 1, k, 3:] = multiply(more, q[n, k, 3:])
    qd[:, k, 3:] *= by[:, None]
    return q, qd


@family((0.02, 0.05, 0.1, 0.2, 0.5), SHARE, ("air", "slides", "swings", "spring"), hand=True, but=("spins",))
def time_stretch(sound: Sound, size: float, draw: Draw) -> Faulty:
    """The motion is played faster or slower."""
    world, track, _, _ = _base(sound)
    rate = 1.0 + size if draw.sign() > 0 else 1.0 / (1.0 + size)
    count = int((rate * track.time <= track.time[-1]).sum())
    return Faulty(cut(played(track, rate * track.time, rate), count), world)


def played(track: Track, at: Array, rate: Array | float) -> Track:
    """A track at other moments, its velocities scaled."""
    q, qd = (np.array(array, dtype=np.float64) for array in (track.q, track.qd))
    k = np.clip(np.searchsorted(track.time, at, side="right") - 1, 0, len(track.time) - 2)
    part = ((at - track.time[k]) / (track.time[k + 1] - track.time[k]))[:, None, None]
    ends = q[k + 1].copy()
    ends[..., 3:] *= np.where((ends[..., 3:] * q[k][..., 3:]).sum(axis=-1, keepdims=True) < 0.0, -1.0, 1.0)
    span = (track.time[k + 1] - track.time[k])[:, None, None]
    poses = (1 - part) * q[k] + part * ends
    # Cubic between the frames, as the velocities have it: straight lines would give themselves away.
    v0, v1 = qd[k][..., :3] * span, qd[k + 1][..., :3] * span
    p0, p1, x = q[k][..., :3], ends[..., :3], part
    poses[..., :3] = ((2 * x**3 - 3 * x**2 + 1) * p0 + (x**3 - 2 * x**2 + x) * v0 + (3 * x**2 - 2 * x**3) * p1
                      + (x**3 - x**2) * v1)  # fmt: skip
    poses[..., 3:] /= np.linalg.norm(poses[..., 3:], axis=-1, keepdims=True)
    rates = np.broadcast_to(np.asarray(rate, dtype=np.float64), at.shape)[:, None, None]
    return edited(track, poses, rates * ((1 - part) * qd[k] + part * qd[k + 1]))


@family((0.1, 0.25, 0.5, 1.0, 3.0), SHARE, ("pair",), hand=True)
def swapped(sound: Sound, size: float, draw: Draw) -> Faulty:
    """Of two bodies that hit each other, one is so much heavier; the world says that it is the other."""
    from benchmarks.judge_families.in_stage import altered

    ratio = 1.0 + size

    def change(heavier: str, lighter: str, stage: object) -> None:
        density = stage.GetPrimAtPath(lighter).GetAttribute("physics:density").Get()  # type: ignore[attr-defined]
        stage.GetPrimAtPath(heavier).GetAttribute("physics:density").Set(density * ratio)  # type: ignore[attr-defined]

    first, second = (body.prim for body in world_of(sound.stage).bodies)
    one = altered(sound.stage, lambda stage: change(first, second, stage))
    light = world_of(altered(sound.stage, lambda stage: change(first, second, stage)))
    masses = [light.bodies[1].mass, light.bodies[0].mass]
    return Faulty(simulated(one), _weighing(light, masses))


def _weighing(world: World, masses: list[float]) -> World:
    bodies = [
        body.model_copy(update={"mass": mass, "inertia": tuple(mass / body.mass * entry for entry in body.inertia)})
        for body, mass in zip(world.bodies, masses, strict=True)
    ]
    return world.model_copy(update={"bodies": bodies})


@family((0.01, 0.03, 0.1, 0.3, 1.0), "of the body's size", ("air", "slides", "rest", "swings"), hand=True, wrong=0.1)
def shifted(sound: Sound, size: float, draw: Draw) -> Faulty:
    """A body is moved aside within a tenth of a second, smoothly, and goes on as it did."""
    world, track, q, qd = _base(sound)
    k, way = draw.pick(movers(world)), np.array(draw.direction())
    by, rate = _smooth(track.time, draw.between(0.1, 0.5) * track.time[-1], 0.1)
    far = size * size_of(world, k)
    q[:, k, :3] += far * by[:, None] * way
    qd[:, k, :3] += far * rate[:, None] * way
    return Faulty(edited(track, q, qd), world)


@family((1.0, 2.5, 5.0, 10.0, 20.0), "deg", ("air", "slides", "rest", "spins"), hand=True)
def tipped(sound: Sound, size: float, draw: Draw) -> Faulty:
    """A body is turned a little within a tenth of a second, smoothly, and goes on as it did."""
    world, track, q, qd = _base(sound)
    k, way = draw.pick(movers(world)), np.array(draw.direction())
    by, rate = _smooth(track.time, draw.between(0.1, 0.5) * track.time[-1], 0.1)
    angle = math.radians(size)
    turn = _about(way, angle * by)
    q[:, k, 3:] = multiply(turn, q[:, k, 3:])
    qd[:, k, 3:] = rotate(turn, qd[:, k, 3:]) + angle * rate[:, None] * way
    return Faulty(edited(track, q, qd), world)


@family((0.01, 0.03, 0.1, 0.3, 1.0), "of the body's size", ("joint",), hand=True, wrong=0.1)
def joint_apart(sound: Sound, size: float, draw: Draw) -> Faulty:
    """A body drifts out of its joint, slowly, by the end of the run by so much."""
    world, track, q, qd = _base(sound)
    k, rate = draw.pick(movers(world)), 1.0 / track.time[-1]
    way = np.array([0.0, 1.0, 0.0])
    far = size * size_of(world, k)
    q[:, k, :3] += far * rate * track.time[:, None] * way
    qd[:, k, :3] += far * rate * way
    return Faulty(edited(track, q, qd), world)


# ---- fakes: what was recorded is of something else
@family((0.05, 0.1, 0.25, 0.5, 1.0), "of the run", ("slides", "bounce", "impacts"), hand=True, wrong=0.25,
        but=("surface",))  # fmt: skip
def backwards(sound: Sound, size: float, draw: Draw) -> Faulty:
    """The end of the motion is its beginning, played backwards from its middle on: what was lost comes back."""
    world, track, _, _ = _base(sound)
    end = track.time[-1]
    turn = end * (1.0 - size)
    if size == 1.0:
        return Faulty(played(track, end - track.time, -1.0), world)
    back = track.time > turn
    at = np.where(back, np.maximum(2.0 * turn - track.time, 0.0), track.time)
    return Faulty(played(track, at, np.where(back, -1.0, 1.0)), world)


@family((1.0, 2.0, 4.0, 8.0, 16.0), "frames", ("air", "slides", "swings", "roll"), hand=True, wrong=2.0)
def frames_repeated(sound: Sound, size: float, draw: Draw) -> Faulty:
    """A frame is recorded again some times, with its velocities; then it goes on from there."""
    world, track, q, qd = _base(sound)
    speed = np.linalg.norm(qd[..., :3], axis=2).max(axis=1)
    fast = np.flatnonzero(speed[:-20] > 0.3 * speed.max())
    start, count = int(fast[draw.whole(0, len(fast) - 1)]), round(size)
    rows = np.arange(len(q))
    rows = np.where(rows <= start, rows, np.maximum(rows - count, start))
    return Faulty(edited(track, q[rows], qd[rows]), world)


@family((0.03, 0.1, 0.2, 0.4, 0.8), SHARE, ("air", "slides", "swings", "roll"), hand=True)
def velocities_scaled(sound: Sound, size: float, draw: Draw) -> Faulty:
    """The velocities are not those of the poses, but so much larger or smaller."""
    world, track, _, qd = _base(sound)
    qd *= 1.0 + draw.sign() * size
    return Faulty(edited(track, qd=qd), world)


@family((1.0, 2.0, 4.0, 8.0, 16.0), "frames", ("air", "slides", "swings", "roll"), hand=True, wrong=2.0)
def velocities_late(sound: Sound, size: float, draw: Draw) -> Faulty:
    """The velocities are those of the motion some frames before, as of another run."""
    world, track, _, qd = _base(sound)
    return Faulty(edited(track, qd=qd[np.maximum(np.arange(len(qd)) - round(size), 0)]), world)


@family((0.03, 0.1, 0.2, 0.4, 0.8), SHARE, ("bounce", "roll", "rest", "impacts"), hand=True, seen=False)
def body_scaled(sound: Sound, size: float, draw: Draw) -> Faulty:
    """The world says that a body is larger than what moved, or smaller, and as heavy."""
    world, track, _, _ = _base(sound)
    k, by = draw.pick(movers(world)), 1.0 + draw.sign() * size
    body = world.bodies[k]
    shapes = [shape.model_copy(update={"size": tuple(by * edge for edge in shape.size)}) for shape in body.shapes]
    changes = {"shapes": shapes, "volume": by**3 * body.volume, "inertia": tuple(by**2 * e for e in body.inertia)}
    bodies = [body.model_copy(update=changes) if n == k else each for n, each in enumerate(world.bodies)]
    return Faulty(track, world.model_copy(update={"bodies": bodies}))
