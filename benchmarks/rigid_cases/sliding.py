"""Coulomb's friction: what slides, what stops, what stays."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.rigid_cases.case import STILL, Bench, G, Track, case
from wsim.scene import Scene


def _box(bench: Bench, friction: float, speed: float, seconds: float) -> Track:
    def build(scene: Scene) -> None:
        scene.ground()
        scene.box("box", size=(0.2, 0.2, 0.2), density=600, position=(0, 0, 0.1), velocity=(speed, 0, 0),
                  friction=friction)  # fmt: skip

    return bench.run(build, seconds)


def on_ramp(bench: Bench, degrees: float, friction: float, size: tuple[float, float, float], seconds: float) -> Track:
    """A box that is let go on a ramp which falls towards +X."""
    lean = math.radians(degrees)
    up = 0.1 + 0.5 * size[2]

    def build(scene: Scene) -> None:
        scene.box("ramp", size=(8, 1, 0.2), rotation_deg=(0, degrees, 0), static=True)
        scene.box("box", size=size, density=600, position=(up * math.sin(lean), 0, up * math.cos(lean)),
                  rotation_deg=(0, degrees, 0), friction=friction)  # fmt: skip

    return bench.run(build, seconds)


def _slide(bench: Bench, degrees: float, friction: float, seconds: float) -> tuple[float, float]:
    """How far a box slides down a ramp, and should: g (sin α - μ cos α) t² / 2, or 0 [m]."""
    lean = math.radians(degrees)
    track = on_ramp(bench, degrees, friction, (0.2, 0.2, 0.2), seconds)
    known = 0.5 * G * max(math.sin(lean) - friction * math.cos(lean), 0.0)
    bench.show("way [m]", track.time, track.drift(), known * track.time**2)
    return track.moved(), known * seconds**2


def _stop(bench: Bench, track: Track, speed: float, friction: float) -> tuple[float, float]:
    """How far a box at a speed has come when it stands, and should: v² / (2 μ g) [m]."""
    slows = friction * G
    held = np.minimum(track.time, speed / slows)
    bench.show("x [m]", track.time, track.position("box")[:, 0], speed * held - 0.5 * slows * held**2)
    return float(track.position("box")[-1, 0]), speed**2 / (2 * slows)


@case("m")
def slide_to_stop(bench: Bench) -> tuple[float, float]:
    """A box at 3 m/s, friction 0.4, stops after v² / (2 μ g)."""
    return _stop(bench, _box(bench, 0.4, 3.0, 1.5), 3.0, 0.4)


@case("m", 2e-3, "steps of second order have it but for the last one")
def small_slide(bench: Bench) -> tuple[float, float]:
    """A box of 1 cm at 0.44 m/s, friction 0.4, stops after v² / (2 μ g), 2.5 cm."""

    def build(scene: Scene) -> None:
        scene.ground(friction=0.4)
        scene.box("box", size=(0.01, 0.01, 0.0025), position=(0, 0, 0.00125), friction=0.4, velocity=(0.443, 0, 0))

    track = bench.run(build, 0.2)
    return float(track.position("box")[-1, 0]), 0.443**2 / (2 * 0.4 * G)


@case("m", 1e-4, "a rigid box does not leave the ground")
def slide_stays_down(bench: Bench) -> tuple[float, float]:
    """The same box at 5 m/s rises by 0 while it slides."""
    track = _box(bench, 0.4, 5.0, 1.5)
    rise = track.position("box")[:, 2] - 0.1
    bench.show("rise [m]", track.time, rise, 0.0)
    return float(rise.max()), 0.0


@case("m/s", 1e-3, "the least friction that MuJoCo has is 1e-5")
def frictionless_slide(bench: Bench) -> tuple[float, float]:
    """A box at 2 m/s without friction still has 2 m/s after 2 s."""
    track = _box(bench, 0.0, 2.0, 2.0)
    bench.show("v [m/s]", track.time, track.velocity("box")[:, 0], 2.0)
    return float(track.velocity("box")[-1, 0]), 2.0


@case("m", 1e-4, STILL)
def ramp_below_friction(bench: Bench) -> tuple[float, float]:
    """A box on a ramp 1° below atan μ moves by 0 in 2 s."""
    return _slide(bench, math.degrees(math.atan(0.364)) - 1.0, 0.364, 2.0)


@case("m")
def ramp_above_friction(bench: Bench) -> tuple[float, float]:
    """1° above atan μ it slides g (sin α - μ cos α) t² / 2 in 2 s."""
    return _slide(bench, math.degrees(math.atan(0.364)) + 1.0, 0.364, 2.0)


@case("m")
def ramp_acceleration(bench: Bench) -> tuple[float, float]:
    """At 30° and μ = 0.2 it slides g (sin α - μ cos α) t² / 2 in 1 s."""
    return _slide(bench, 30.0, 0.2, 1.0)


@case("rad/s²")
def yaw_of_a_drum(bench: Bench) -> tuple[float, float]:
    """A drum that spins on its end slows by 2 μ g / R: it stands on a ring, I = m R² / 2."""

    def build(scene: Scene) -> None:
        scene.ground()
        scene.cylinder("drum", radius=0.3, height=0.4, density=500, position=(0, 0, 0.2), friction=0.3,
                       angular_velocity_deg=(0, 0, math.degrees(10.0)))  # fmt: skip

    track = bench.run(build, 0.3)
    bench.show("ω [rad/s]", track.time, track.spin("drum")[:, 2], 10.0 - 2.0 * G * track.time)
    return float(10.0 - track.spin("drum")[-1, 2]) / 0.3, 2.0 * 0.3 * G / 0.3


@case("m/s")
def block_on_a_board(bench: Bench) -> tuple[float, float]:
    """A block slid onto a board on ice shares its speed: both end at m v / (m + M), here v / 4."""

    def build(scene: Scene) -> None:
        scene.ground(friction=0.0)
        scene.box("board", size=(3, 0.5, 0.1), mass=9.0, position=(0, 0, 0.05))
        scene.box("block", size=(0.2, 0.2, 0.2), mass=3.0, position=(-1, 0, 0.2), velocity=(2, 0, 0), friction=0.3)

    track = bench.run(build, 1.0)
    speed = track.velocity("board")[:, 0]
    bench.show("v [m/s]", track.time, speed, np.minimum(0.3 * 3 / 9 * G * track.time, 0.5))
    return float(speed[-1]), 0.5


@case("m")
def weaker_friction_counts(bench: Bench) -> tuple[float, float]:
    """A box of μ = 0.8 on ice of 0.1 slides v² / (2 · 0.1 g) at 1.5 m/s."""

    def build(scene: Scene) -> None:
        scene.ground(friction=0.1)
        scene.box("box", size=(0.2, 0.2, 0.2), density=600, position=(0, 0, 0.1), velocity=(1.5, 0, 0), friction=0.8)

    return _stop(bench, bench.run(build, 2.0), 1.5, 0.1)
