"""Bodies that go where their velocity takes them, and what they carry."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.rigid_cases.case import Bench, G, Track, case, step_at
from wsim.scene import Scene


def _belt(bench: Bench, seconds: float) -> float:
    def build(scene: Scene) -> None:
        scene.box("belt", size=(8, 1, 0.2), position=(0, 0, 0.1), kinematic=True, velocity=(1, 0, 0))
        scene.box("crate", size=(0.3, 0.3, 0.3), density=300, position=(0, 0, 0.35), friction=0.2)

    track = bench.run(build, seconds)
    bench.show("v [m/s]", track.time, track.velocity("crate")[:, 0], np.minimum(0.2 * G * track.time, 1.0))
    return float(track.velocity("crate")[-1, 0])


@case("m/s")
def belt_speeds_a_crate_up(bench: Bench) -> tuple[float, float]:
    """A crate set on a belt at 1 m/s has μ g t after 0.25 s."""
    return _belt(bench, 0.25), 0.2 * G * 0.25


@case("m/s")
def belt_carries_a_crate(bench: Bench) -> tuple[float, float]:
    """After v / (μ g) it goes with the belt, at 1 m/s."""
    return _belt(bench, 1.5), 1.0


def _table(bench: Bench, spin: float) -> Track:
    """A small box that starts with a turntable, half a metre from its axis."""

    def build(scene: Scene) -> None:
        turning = {"angular_velocity_deg": (0, 0, math.degrees(spin))}
        scene.cylinder("table", radius=1.0, height=0.2, position=(0, 0, 0.1), kinematic=True, **turning)
        scene.box("box", size=(0.1, 0.1, 0.1), density=600, position=(0.5, 0, 0.25), velocity=(0, 0.5 * spin, 0),
                  friction=0.5, **turning)  # fmt: skip

    return bench.run(build, 2.0)


@case("m")
def turntable_keeps_its_load(bench: Bench) -> tuple[float, float]:
    """Where ω² r is below μ g a box stays at its radius, 0.5 m, for 2 s."""
    track = _table(bench, 2.0)
    radius = np.linalg.norm(track.position("box")[:, :2], axis=1)
    bench.show("radius [m]", track.time, radius, 0.5)
    return float(radius[-1]), 0.5


@case("rad")
def turntable_turns_its_load(bench: Bench) -> tuple[float, float]:
    """The box goes round with it by ω t = 4 rad."""
    track = _table(bench, 2.0)
    bench.show("turned [rad]", track.time, track.angle("box", 2), 2.0 * track.time)
    return float(track.angle("box", 2)[-1]), 4.0


@case("", 0.0, "yes or no")
def turntable_throws_its_load(bench: Bench) -> tuple[float, float]:
    """Where ω² r is above μ g the box is gone after 2 s: 1 for yes."""
    return float(np.linalg.norm(_table(bench, 4.0).position("box")[-1, :2]) > 1.0), 1.0


@case("m/s")
def plough(bench: Bench) -> tuple[float, float]:
    """A plough at 1 m/s pushes a crate over the ground at its own speed."""

    def build(scene: Scene) -> None:
        scene.ground()
        scene.box("plough", size=(0.2, 1, 0.4), position=(-0.5, 0, 0.21), kinematic=True, velocity=(1, 0, 0))
        scene.box("crate", size=(0.3, 0.3, 0.3), density=600, position=(0, 0, 0.15), friction=0.5)

    track = bench.run(build, 1.5)
    bench.show("v [m/s]", track.time, track.velocity("crate")[:, 0], step_at(track.time, 0.25, 0.0, 1.0))
    return float(track.velocity("crate")[-1, 0]), 1.0


@case("m")
def plough_goes_its_way(bench: Bench) -> tuple[float, float]:
    """A kinematic body at 1 m/s goes v t whatever it meets: here a crate of 2 t."""

    def build(scene: Scene) -> None:
        scene.ground()
        scene.box("plough", size=(0.2, 1, 0.4), position=(-0.5, 0, 0.21), kinematic=True, velocity=(1, 0, 0))
        scene.box("crate", size=(1, 1, 1), mass=2000, position=(0.5, 0, 0.5), friction=0.8)

    track = bench.run(build, 1.5)
    way = track.position("plough")[:, 0] - track.position("plough")[0, 0]
    bench.show("way [m]", track.time, way, track.time)
    return float(way[-1]), 1.5
