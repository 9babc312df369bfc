"""What rolls, and what comes to roll."""

from __future__ import annotations

import math

import numpy as np
from pxr import Gf, UsdPhysics

from benchmarks.rigid_cases.case import Bench, G, case
from wsim.scene import Scene


def _down(bench: Bench, kind: str, k: float) -> tuple[float, float]:
    """How far a round body of radius 0.1 m, I = (k - 1) m R², rolls down a ramp of 15° in 1 s, and should [m]."""
    lean = math.radians(15.0)
    place = (0.2 * math.sin(lean) - 2 * math.cos(lean), 0, 0.2 * math.cos(lean) + 2 * math.sin(lean))

    def build(scene: Scene) -> None:
        scene.box("ramp", size=(6, 1, 0.2), rotation_deg=(0, 15, 0), static=True)
        if kind == "sphere":
            scene.sphere("round", radius=0.1, mass=2.0, position=place)
            return
        round_ = scene.cylinder("round", radius=0.1, height=0.3, axis="Y", mass=2.0, position=place)
        if kind == "hoop":
            api = UsdPhysics.MassAPI.Apply(scene.stage.GetPrimAtPath(round_.path))
            api.CreateDiagonalInertiaAttr(Gf.Vec3f(0.025, 0.02, 0.025))
            api.CreatePrincipalAxesAttr(Gf.Quatf(1.0))
            api.CreateCenterOfMassAttr(Gf.Vec3f(0.0))

    track, expected = bench.run(build, 1.0), 0.5 * G * math.sin(lean) / k
    bench.show("way [m]", track.time, track.drift(), expected * track.time**2)
    return track.moved(), expected


@case("m")
def ball_down_a_ramp(bench: Bench) -> tuple[float, float]:
    """A ball rolls g sin α t² / (2 · 7/5) in 1 s at 15°."""
    return _down(bench, "sphere", 7 / 5)


@case("m")
def cylinder_down_a_ramp(bench: Bench) -> tuple[float, float]:
    """A cylinder rolls g sin α t² / (2 · 3/2)."""
    return _down(bench, "cylinder", 3 / 2)


@case("m")
def hoop_down_a_ramp(bench: Bench) -> tuple[float, float]:
    """A cylinder whose mass is at its rim, I = m R², rolls g sin α t² / (2 · 2)."""
    return _down(bench, "hoop", 2.0)


def _ball(bench: Bench, speed: float, spin: float, friction: float, seconds: float) -> tuple[float, float]:
    """The speed with which a ball ends that comes to roll, and should: (5 v + 2 R ω) / 7."""

    def build(scene: Scene) -> None:
        scene.ground()
        scene.sphere("ball", radius=0.1, density=600, position=(0, 0, 0.1), velocity=(speed, 0, 0), friction=friction,
                     angular_velocity_deg=(0, math.degrees(spin), 0))  # fmt: skip

    track = bench.run(build, seconds)
    expected = (5 * speed + 2 * 0.1 * spin) / 7
    bench.show("v [m/s]", track.time, track.velocity("ball")[:, 0],
               np.maximum(speed - friction * G * track.time, expected))  # fmt: skip
    return float(track.velocity("ball")[-1, 0]), expected


@case("m/s")
def slip_to_roll(bench: Bench) -> tuple[float, float]:
    """A ball that starts sliding at 3 m/s comes to roll at 5/7 v."""
    return _ball(bench, 3.0, 0.0, 0.2, 1.0)


@case("m/s")
def backspin(bench: Bench) -> tuple[float, float]:
    """A ball at 2 m/s with 80 rad/s of backspin comes back at (5 v - 2 R ω) / 7."""
    return _ball(bench, 2.0, -80.0, 0.5, 1.0)


@case("m/s")
def pure_roll_goes_on(bench: Bench) -> tuple[float, float]:
    """A ball that rolls at 1 m/s still does after 3 s: nothing resists rolling."""
    return _ball(bench, 1.0, 10.0, 0.5, 3.0)
