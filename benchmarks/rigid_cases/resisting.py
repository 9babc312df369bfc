"""What resists rolling and spinning, and the law of a pair."""

from __future__ import annotations

import math

from benchmarks.rigid_cases.case import STILL, Bench, G, case
from wsim.scene import Scene

C, R = 0.01, 0.1
LEAN = math.degrees(math.atan(C))


def _roll(bench: Bench, kind: str, rolling: float) -> float:
    """How far a round body comes that starts rolling at 0.5 m/s [m]."""

    def build(scene: Scene) -> None:
        scene.ground()
        options = {"mass": 2.0, "position": (0, 0, R), "velocity": (0.5, 0, 0), "rolling_friction": rolling,
                   "angular_velocity_deg": (0, math.degrees(0.5 / R), 0)}  # fmt: skip
        if kind == "ball":
            scene.sphere("round", radius=R, **options)
        else:
            scene.cylinder("round", radius=R, height=0.3, axis="Y", **options)

    return bench.run(build, 0.8 / (rolling * G)).moved()


@case("m")
def rolls_to_a_stop(bench: Bench) -> tuple[float, float]:
    """A ball of C = 0.01 that rolls at 0.5 m/s stops after 7/5 v² / (2 C g)."""
    return _roll(bench, "ball", C), 1.4 * 0.25 / (2 * C * G)


@case("m")
def rolls_to_a_stop_on_rubber(bench: Bench) -> tuple[float, float]:
    """The same with C = 0.05, a tenth of its friction."""
    return _roll(bench, "ball", 0.05), 1.4 * 0.25 / (2 * 0.05 * G)


@case("m")
def log_rolls_to_a_stop(bench: Bench) -> tuple[float, float]:
    """A log of C = 0.01 stops after 3/2 v² / (2 C g)."""
    return _roll(bench, "log", C), 1.5 * 0.25 / (2 * C * G)


def _slope(bench: Bench, degrees: float) -> float:
    """How far a ball of C = 0.01 rolls from rest on a slope in 2 s [m]."""
    lean = math.radians(degrees)

    def build(scene: Scene) -> None:
        scene.box("slope", size=(6, 1, 0.2), rotation_deg=(0, degrees, 0), static=True)
        at = (0.2 * math.sin(lean), 0, 0.2 * math.cos(lean))
        scene.sphere("ball", radius=R, mass=2.0, position=at, rolling_friction=C)

    return bench.run(build, 2.0).moved()


@case("m", 1e-3, STILL)
def stays_below_its_resistance(bench: Bench) -> tuple[float, float]:
    """On a slope of half of atan C the ball moves by 0 in 2 s."""
    return _slope(bench, 0.5 * LEAN), 0.0


@case("m")
def rolls_above_its_resistance(bench: Bench) -> tuple[float, float]:
    """At five times atan C it rolls 5/7 g (sin α - C cos α) t² / 2 in 2 s."""
    lean = math.radians(5 * LEAN)
    return _slope(bench, 5 * LEAN), 5 / 7 * G * (math.sin(lean) - C * math.cos(lean)) * 2.0


@case("rad/s")
def spinning_ball_slows(bench: Bench) -> tuple[float, float]:
    """A ball that spins upright at 5 rad/s has lost 5/2 π μ C g t / R of it in 2 s, μ = 0.3."""

    def build(scene: Scene) -> None:
        scene.ground()
        scene.sphere("ball", radius=R, mass=2.0, position=(0, 0, R), angular_velocity_deg=(0, 0, math.degrees(5.0)),
                     friction=0.3, rolling_friction=C)  # fmt: skip

    spin = bench.run(build, 2.0).spin("ball")[-1, 2]
    return float(spin), 5.0 - 2.5 * math.pi * 0.3 * C * G * 2.0 / R


@case("rad/s", 1e-3, STILL)
def barrel_on_a_pallet(bench: Bench) -> tuple[float, float]:
    """A barrel that stands on planks and turns at 0.2 rad/s turns by 0 after 1 s."""

    def build(scene: Scene) -> None:
        scene.ground()
        for k in range(5):
            scene.box(f"plank_{k}", size=(1.2, 0.1, 0.02), position=(0, 0.25 * (k - 2), 0.11), mass=1.5)
        for k in range(3):
            scene.box(f"bearer_{k}", size=(0.1, 1.1, 0.1), position=(0.5 * (k - 1), 0, 0.05), mass=4.0)
        scene.cylinder("barrel", radius=0.3, height=0.9, position=(0, 0, 0.57), mass=100.0,
                       angular_velocity_deg=(0, 0, math.degrees(0.2)))  # fmt: skip

    return float(abs(bench.run(build, 1.0).spin("barrel")[-1, 2])), 0.0


@case("m")
def friction_of_a_pair(bench: Bench) -> tuple[float, float]:
    """A box and a floor of μ = 0.8 whose pair has 0.2 slide v² / (2 · 0.2 g) at 2 m/s."""

    def build(scene: Scene) -> None:
        scene.ground(friction=0.8)
        scene.box("box", size=(0.4,) * 3, mass=10.0, position=(0, 0, 0.2), velocity=(2, 0, 0), friction=0.8)
        scene.contact("box", "ground", friction=0.2)

    return bench.run(build, 1.5).moved(), 4.0 / (2 * 0.2 * G)


@case("m")
def restitution_of_a_pair(bench: Bench) -> tuple[float, float]:
    """A ball of e = 0.2 whose pair with the ground has 0.8 comes back to 0.8² of 1 m."""

    def build(scene: Scene) -> None:
        scene.ground(restitution=0.2)
        scene.sphere("ball", radius=R, mass=1.0, position=(0, 0, 1.0 + R), restitution=0.2)
        scene.contact("ground", "ball", restitution=0.8)

    track = bench.run(build, 1.0, rate=400.0)
    return float(track.position("ball")[200:, 2].max() - R), 0.64
