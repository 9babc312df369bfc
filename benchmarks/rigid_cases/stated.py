"""Motion that a world states: belts, key frames, rolling starts."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.rigid_cases.case import Bench, G, Track, case
from wsim.scene import Scene


def _conveyor(bench: Bench, seconds: float, angle: float = 0.0, friction: float = 0.2) -> Track:
    """A crate at rest on a belt that runs at 1 m/s, up a slope of `angle` degrees."""
    lean = math.radians(angle)

    def build(scene: Scene) -> None:
        belt = scene.box("belt", size=(8, 1, 0.2), rotation_deg=(0, -angle, 0), static=True)
        scene.surface_velocity(belt, velocity=(1, 0, 0))
        at = (-0.25 * math.sin(lean), 0, 0.25 * math.cos(lean))
        scene.box(
            "crate", size=(0.3, 0.3, 0.3), density=300, position=at, rotation_deg=(0, -angle, 0), friction=friction
        )

    return bench.run(build, seconds)


def _along(track: Track, angle: float) -> float:
    lean = math.radians(angle)
    return float(track.velocity("crate")[-1] @ (math.cos(lean), 0.0, math.sin(lean)))


@case("m/s")
def conveyor_speeds_a_crate_up(bench: Bench) -> tuple[float, float]:
    """A crate set on a belt whose surface runs at 1 m/s has μ g t after 0.25 s."""
    return _along(_conveyor(bench, 0.25), 0.0), 0.2 * G * 0.25


@case("m/s")
def conveyor_carries_a_crate(bench: Bench) -> tuple[float, float]:
    """After v / (μ g) it goes with the belt, at 1 m/s."""
    return _along(_conveyor(bench, 1.0), 0.0), 1.0


@case("m")
def conveyor_way(bench: Bench) -> tuple[float, float]:
    """Until then it falls behind by v² / (2 μ g): after 1 s it has come v t less that."""
    return float(_conveyor(bench, 1.0).position("crate")[-1, 0]), 1.0 - 1.0 / (2 * 0.2 * G)


@case("m/s")
def inclined_belt_carries(bench: Bench) -> tuple[float, float]:
    """Up a slope of 20°, below atan μ = 31°, it comes to the belt's 1 m/s as well."""
    return _along(_conveyor(bench, 1.0, 20.0, 0.6), 20.0), 1.0


@case("m/s")
def steep_belt_does_not(bench: Bench) -> tuple[float, float]:
    """Up 20° with μ = 0.2 it slips down, by g (sin α - μ cos α) t after 0.5 s."""
    lean = math.radians(20.0)
    return _along(_conveyor(bench, 0.5, 20.0, 0.2), 20.0), -G * (math.sin(lean) - 0.2 * math.cos(lean)) * 0.5


def _treadmill(bench: Bench, spin: float) -> float:
    """A ball's speed after 1 s on a belt at 2 m/s."""

    def build(scene: Scene) -> None:
        belt = scene.box("belt", size=(8, 1, 0.2), position=(0, 0, 0.1), static=True)
        scene.surface_velocity(belt, velocity=(2, 0, 0))
        scene.sphere("ball", radius=0.1, density=600, position=(0, 0, 0.3), friction=0.3,
                     angular_velocity_deg=(0, math.degrees(spin), 0))  # fmt: skip

    return float(bench.run(build, 1.0).velocity("ball")[-1, 0])


@case("m/s")
def ball_on_a_treadmill(bench: Bench) -> tuple[float, float]:
    """A ball set on a belt at v comes to roll on it, at 2/7 v."""
    return _treadmill(bench, 0.0), 4 / 7


@case("m/s", 0.002, "at rest: nothing is to move")
def runner_on_a_treadmill(bench: Bench) -> tuple[float, float]:
    """One that rolls against the belt, at v / r, keeps its place: its speed is 0."""
    return _treadmill(bench, -20.0), 0.0


def _lift(bench: Bench) -> Track:
    """A lift that rises by 1 m in 1 s from rest to rest, waits 0.2 s, and comes down; with a load."""

    def build(scene: Scene) -> None:
        lift = scene.box("lift", size=(1, 1, 0.1), position=(0, 0, 0.5), kinematic=True)
        heights = (0.5, 1.5, 1.5, 0.5)
        scene.path(lift, times=(0, 1, 1.2, 2.2), positions=[(0, 0, z) for z in heights])
        scene.box("load", size=(0.3, 0.3, 0.3), density=600, position=(0, 0, 0.7))

    return bench.run(build, 2.4)


@case("m")
def lift_meets_its_keys(bench: Bench) -> tuple[float, float]:
    """A lift on key frames is at its key, 1.5 m, at 1.1 s."""
    track = _lift(bench)
    return track.at(track.position("lift")[:, 2], 1.1), 1.5


@case("m/s")
def lift_speed(bench: Bench) -> tuple[float, float]:
    """Halfway between two keys at rest its load goes at 3/2 of the mean speed, 1 m/s."""
    track = _lift(bench)
    return track.at(track.velocity("load")[:, 2], 0.5), 1.5


@case("m", 0.001, "at rest: nothing is to move")
def lift_keeps_its_load(bench: Bench) -> tuple[float, float]:
    """Its load, slower than falling, leaves it by 0."""
    track = _lift(bench)
    return float(np.abs(track.position("load")[:, 2] - track.position("lift")[:, 2] - 0.2).max()), 0.0


@case("deg")
def swung_plate_turns_its_load(bench: Bench) -> tuple[float, float]:
    """A plate that a repeating path turns to 40° and back has turned its load by 40° at the third half of a turn."""

    def build(scene: Scene) -> None:
        plate = scene.box("plate", size=(1, 1, 0.1), position=(0, 0, 0.5), kinematic=True)
        scene.path(plate, times=(0, 0.5, 1), rotations_deg=((0, 0, 0), (0, 0, 40), (0, 0, 0)), repeat=True)
        scene.box("load", size=(0.2, 0.2, 0.2), density=600, position=(0.2, 0, 0.65), friction=0.8)

    return math.degrees(float(bench.run(build, 1.5).angle("load", 2)[-1])), 40.0


@case("m/s")
def piston_shoves_a_puck(bench: Bench) -> tuple[float, float]:
    """A piston on a path that goes 0.6 m in 0.6 s leaves a puck on ice, e = 0, at its greatest speed, 1.5 m/s."""

    def build(scene: Scene) -> None:
        scene.ground(friction=0.0)
        piston = scene.box("piston", size=(0.2, 0.4, 0.2), position=(0, 0, 0.11), kinematic=True)
        scene.path(piston, times=(0, 0.6, 1.2), positions=((0, 0, 0.11), (0.6, 0, 0.11), (0, 0, 0.11)))
        scene.box("puck", size=(0.2, 0.2, 0.2), density=600, position=(0.21, 0, 0.1))

    return float(bench.run(build, 1.0).velocity("puck")[-1, 0]), 1.5


@case("m/s")
def rolling_start(bench: Bench) -> tuple[float, float]:
    """A cylinder that starts rolling at 3 m/s still has 3 m/s after 2 s, not 2/3 of it."""

    def build(scene: Scene) -> None:
        scene.ground()
        scene.cylinder("log", radius=0.1, height=0.4, axis="Y", density=600, position=(0, 0, 0.1),
                       velocity=(3, 0, 0), rolling=True)  # fmt: skip

    return float(bench.run(build, 2.0).velocity("log")[-1, 0]), 3.0
