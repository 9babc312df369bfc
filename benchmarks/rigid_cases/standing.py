"""What stands, what tips, what topples."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.rigid_cases.case import STILL, Bench, G, Track, case
from benchmarks.rigid_cases.sliding import on_ramp
from wsim.scene import Scene

TALL = (0.2, 0.2, 0.6)  # tips where the slope is above 1/3, 18.4°


def _lean(track: Track, name: str) -> np.ndarray:
    """By how much a body has leaned over from how it started [deg], (frames,)."""
    axes = track.axes(name)[:, :, 2]
    return np.degrees(np.arccos(np.minimum(1.0, axes @ axes[0])))


def _leant(bench: Bench, track: Track, name: str, known: float) -> tuple[float, float]:
    """By how much a body has leaned over in the end, and should [deg]."""
    bench.show("lean [deg]", track.time, _lean(track, name), known)
    return float(_lean(track, name)[-1]), known


def _still(bench: Bench, track: Track) -> tuple[float, float]:
    """How far anything is from where it started, and should: 0 [m]."""
    bench.show("moved [m]", track.time, track.drift(), 0.0)
    return track.moved(), 0.0


@case("m", 1e-3, STILL)
def stack_of_ten(bench: Bench) -> tuple[float, float]:
    """Ten boxes in a stack move by 0 in 2 s."""

    def build(scene: Scene) -> None:
        scene.ground()
        for k in range(10):
            scene.box(f"b{k}", size=(0.2, 0.2, 0.2), density=600, position=(0, 0, 0.1 + 0.2 * k))

    return _still(bench, bench.run(build, 2.0))


@case("", 0.0, "a count")
def dominoes(bench: Bench) -> tuple[float, float]:
    """A row of ten dominoes falls, 10 of 10, when the first is tipped by 6.5°, beyond t / h."""

    def build(scene: Scene) -> None:
        scene.ground()
        lean = math.radians(6.5)
        height = 0.1 * math.cos(lean) + 0.01 * math.sin(lean)
        scene.box("d0", size=(0.02, 0.1, 0.2), density=600, position=(0, 0, height), rotation_deg=(0, 6.5, 0))
        for k in range(1, 10):
            scene.box(f"d{k}", size=(0.02, 0.1, 0.2), density=600, position=(0.08 * k, 0, 0.1))

    track = bench.run(build, 2.0)
    return float(sum(_lean(track, f"d{k}")[-1] > 30.0 for k in range(10))), 10.0


@case("deg", 0.02, "it comes to lie while it may still slide a little")
def tips_before_it_slides(bench: Bench) -> tuple[float, float]:
    """A tall box on a slope of 20°, above w / h = 1/3 and below μ = 0.6, tips over by 90°."""
    return _leant(bench, on_ramp(bench, 20.0, 0.6, TALL, 3.0), "box", 90.0)


@case("deg", 0.1, STILL)
def stands_below_tipping(bench: Bench) -> tuple[float, float]:
    """At 17° it stands: 0°."""
    return _leant(bench, on_ramp(bench, 17.0, 0.6, TALL, 2.0), "box", 0.0)


@case("deg", 0.1, "it slides flat")
def slides_before_it_tips(bench: Bench) -> tuple[float, float]:
    """With μ = 0.2, below w / h, it slides and leans by 0°, at 17°."""
    return _leant(bench, on_ramp(bench, 17.0, 0.2, TALL, 1.5), "box", 0.0)


def _plank(bench: Bench, beyond: float, seconds: float) -> Track:
    """A plank of 2 m on a table's edge at x = 0, its middle `beyond` it [m]."""

    def build(scene: Scene) -> None:
        scene.box("table", size=(2, 1, 1), position=(-1, 0, -0.5), static=True)
        scene.box("plank", size=(2, 0.2, 0.04), density=600, position=(beyond, 0, 0.02), friction=1.0)

    return bench.run(build, seconds)


@case("deg", 0.1, STILL)
def plank_stays(bench: Bench) -> tuple[float, float]:
    """A plank whose middle is 2 cm within the table's edge stays: 0° in 2 s."""
    return _leant(bench, _plank(bench, -0.02, 2.0), "plank", 0.0)


@case("rad/s")
def plank_tips(bench: Bench) -> tuple[float, float]:
    """0.2 m beyond it turns about the edge: I ω² / 2 = m g (d sin θ + t (1 - cos θ) / 2), at 5°."""
    track = _plank(bench, 0.2, 0.5)
    angle = track.angle("plank", 1)
    k = int(np.flatnonzero(angle > math.radians(5.0))[0])
    inertia = (2.0**2 + 0.04**2) / 12 + 0.2**2 + 0.02**2
    fall = np.maximum(0.2 * np.sin(angle) + 0.02 * (1 - np.cos(angle)), 0.0)
    known = np.sqrt(2 * G * fall / inertia)
    bench.show("ω [rad/s]", angle[: k + 1], track.spin("plank")[: k + 1, 1], known[: k + 1], "angle [rad]")
    return float(track.spin("plank")[k, 1]), float(known[k])


@case("rad/s")
def topple(bench: Bench) -> tuple[float, float]:
    """A leaning column falls about its foot's edge: I ω² / 2 = m g r (cos θ₀ - cos θ), at 40° from balance."""
    half, balance = math.hypot(0.1, 0.5), math.atan2(0.1, 0.5)
    start = balance + math.radians(5.0)

    def build(scene: Scene) -> None:
        scene.ground()
        place = (half * math.sin(start - balance), 0, half * math.cos(start - balance))
        scene.box("column", size=(0.2, 0.2, 1.0), density=600, position=place, friction=1.0,
                  rotation_deg=(0, math.degrees(start), 0))  # fmt: skip

    track = bench.run(build, 1.5)
    lean = track.angle("column", 1) + start - balance
    k = int(np.flatnonzero(lean > math.radians(40.0))[0])
    inertia = (0.2**2 + 1.0**2) / 12 + half**2
    known = np.sqrt(np.maximum(2 * G * half * (math.cos(start - balance) - np.cos(lean)), 0.0) / inertia)
    bench.show("ω [rad/s]", lean[: k + 1], track.spin("column")[: k + 1, 1], known[: k + 1], "lean [rad]")
    return float(track.spin("column")[k, 1]), float(known[k])


@case("m", 1e-3, STILL)
def loaded_beam(bench: Bench) -> tuple[float, float]:
    """A beam on two blocks and a load twice as heavy on it move by 0 in 2 s."""

    def build(scene: Scene) -> None:
        for name, x in (("s1", -0.5), ("s2", 0.5)):
            scene.box(name, size=(0.2, 0.6, 0.2), position=(x, 0, 0.1), static=True)
        scene.box("beam", size=(1.2, 0.3, 0.1), density=600, position=(0, 0, 0.25))
        scene.box("load", size=(0.3, 0.3, 0.3), density=2000, position=(0, 0, 0.45))

    return _still(bench, bench.run(build, 2.0))
