"""Blows on what can turn, on what is driven, and one after another."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.rigid_cases.case import STILL, Bench, G, bounces, case, step_at
from wsim.scene import Scene


@case("m/s")
def paddle(bench: Bench) -> tuple[float, float]:
    """A ball at -2 m/s meets a kinematic paddle at u = 1 m/s, e = 0.5, and leaves at u + e (u - v)."""

    def build(scene: Scene) -> None:
        scene.simulation(gravity=(0, 0, 0))
        scene.box("paddle", size=(0.1, 0.5, 0.5), position=(-0.3, 0, 0), kinematic=True, velocity=(1, 0, 0))
        scene.sphere("ball", radius=0.1, mass=1.0, position=(0.3, 0, 0), velocity=(-2, 0, 0), restitution=0.5)

    track = bench.run(build, 0.5)
    speed = track.velocity("ball")[:, 0]
    bench.show("v [m/s]", track.time, speed, step_at(track.time, 0.15, -2.0, 2.5))
    return float(speed[-1]), 1 + 0.5 * 3


@case("m")
def flat_box_bounce(bench: Bench) -> tuple[float, float]:
    """A box that falls flat by 1 m rises e² · 1 m on its four corners, e = 0.5."""

    def build(scene: Scene) -> None:
        scene.ground()
        scene.box("box", size=(0.2, 0.2, 0.2), density=600, position=(0, 0, 1.1), restitution=0.5)

    track = bench.run(build, 0.9)
    height = track.position("box")[:, 2] - 0.1
    bench.show("height [m]", track.time, height, bounces(track.time, 1.0, 0.5))
    return float(height[50:].max()), 0.25


@case("J/kg")
def elastic_bounces(bench: Bench) -> tuple[float, float]:
    """After five elastic bounces a ball has the energy of its fall, g · 1 m, at its apex."""

    def build(scene: Scene) -> None:
        scene.ground()
        scene.sphere("ball", radius=0.1, density=600, position=(0, 0, 1.1), restitution=1.0)

    track = bench.run(build, 5.0)
    energy = G * (track.position("ball")[:, 2] - 0.1) + 0.5 * track.velocity("ball")[:, 2] ** 2
    bench.show("energy [J/kg]", track.time, energy, G)
    fifth = track.time > 9.2 * math.sqrt(2.0 / G)  # bounces are at 1, 3, ... 9 times the time of the fall
    return float(energy[fifth][np.abs(track.velocity("ball")[fifth, 2]).argmin()]), G


@case("s")
def bounce_series(bench: Bench) -> tuple[float, float]:
    """From 1 m, e = 0.5, a ball falls below 2 mm for good after √(2 h / g) (1 + 2 (e + e² + e³ + e⁴)), less 8 ms."""

    def build(scene: Scene) -> None:
        scene.ground()
        scene.sphere("ball", radius=0.1, density=600, position=(0, 0, 1.1), restitution=0.5)

    track = bench.run(build, 1.8, rate=800.0)
    last = 0.5**8  # [m], the last apex above 2 mm
    less = (math.sqrt(2 * G * last) - math.sqrt(2 * G * (last - 2e-3))) / G
    height = track.position("ball")[:, 2] - 0.1
    bench.show("height [m]", track.time, height, bounces(track.time, 1.0, 0.5))
    high = np.flatnonzero(height > 2e-3)
    return float(track.time[high[-1]]), math.sqrt(2 / G) * (1 + 2 * (0.5 + 0.25 + 0.125 + 0.0625)) - less


@case("rad/s")
def struck_door(bench: Bench) -> tuple[float, float]:
    """A ball that hits a door at d from its hinge, e = 0.5, turns it at (1 + e) m v d / (I + m d²)."""

    def build(scene: Scene) -> None:
        scene.simulation(gravity=(0, 0, 0))
        scene.box("door", size=(0.8, 0.05, 2.0), mass=20.0, position=(0.4, 0, 1.0), friction=0.0, restitution=0.5)
        scene.joint_revolute("hinge", None, "door", anchor=(0, 0, 1.0), axis="Z")
        scene.sphere("ball", radius=0.1, mass=2.0, position=(0.6, -0.5, 1.0), velocity=(0, 4, 0))

    inertia = 20.0 * ((0.8**2 + 0.05**2) / 12 + 0.4**2)
    expected = 1.5 * 2 * 4 * 0.6 / (inertia + 2 * 0.6**2)
    track = bench.run(build, 0.2)
    spin = track.spin("door")[:, 2]
    bench.show("ω [rad/s]", track.time, spin, step_at(track.time, 0.375 / 4, 0.0, expected))
    return float(spin[-1]), expected


@case("rad/s")
def struck_rod(bench: Bench) -> tuple[float, float]:
    """A rod adrift, hit d from its middle at e = 1, spins at J d / I, J = 2 v / (1/m + 1/M + d²/I)."""

    def build(scene: Scene) -> None:
        scene.simulation(gravity=(0, 0, 0))
        scene.box("rod", size=(1.0, 0.1, 0.1), mass=3.0, friction=0.0, restitution=1.0)
        scene.sphere("ball", radius=0.05, mass=1.0, position=(0.4, -0.5, 0), velocity=(0, 3, 0))

    inertia = 3.0 * (1.0 + 0.1**2) / 12
    blow = 2 * 3.0 / (1.0 + 1 / 3 + 0.4**2 / inertia)
    track = bench.run(build, 0.2)
    spin = track.spin("rod")[:, 2]
    bench.show("ω [rad/s]", track.time, spin, step_at(track.time, 0.4 / 3, 0.0, blow * 0.4 / inertia))
    return float(spin[-1]), blow * 0.4 / inertia


@case("m/s", 0.02, "the balls start 5 mm apart and meet a little after the ground")
def ball_on_ball(bench: Bench) -> tuple[float, float]:
    """A light ball on a heavy one, elastic, dropped together by 0.5 m, leaves at (3 M - m) / (M + m) √(2 g h)."""

    def build(scene: Scene) -> None:
        scene.ground(restitution=1.0)
        scene.sphere("heavy", radius=0.1, mass=2.0, position=(0, 0, 0.6), restitution=1.0)
        scene.sphere("light", radius=0.05, mass=0.1, position=(0, 0, 0.755), restitution=1.0)

    track = bench.run(build, 0.4, rate=800.0)
    speed, met, expected = track.velocity("light")[:, 2], math.sqrt(1.0 / G), (6 - 0.1) / 2.1 * math.sqrt(G)
    known = np.where(track.time < met, -G * track.time, expected - G * (track.time - met))
    bench.show("v [m/s]", track.time, speed, known)
    return float(speed.max()), expected


@case("m", 1e-3, STILL)
def bouncy_stack(bench: Bench) -> tuple[float, float]:
    """Five boxes of e = 0.8 in a stack move by 0 in 2 s."""

    def build(scene: Scene) -> None:
        scene.ground()
        for k in range(5):
            scene.box(f"b{k}", size=(0.2, 0.2, 0.2), density=600, position=(0, 0, 0.1 + 0.2 * k), restitution=0.8)

    track = bench.run(build, 2.0)
    bench.show("moved [m]", track.time, track.drift(), 0.0)
    return track.moved(), 0.0


@case("m", 1e-3, "it does not leave the ground")
def bouncy_slide(bench: Bench) -> tuple[float, float]:
    """A box of e = 0.8 that slides at 5 m/s rises by 0."""

    def build(scene: Scene) -> None:
        scene.ground()
        scene.box("box", size=(0.2, 0.2, 0.2), density=600, position=(0, 0, 0.1), velocity=(5, 0, 0), restitution=0.8)

    track = bench.run(build, 1.5)
    bench.show("rise [m]", track.time, track.position("box")[:, 2] - 0.1, 0.0)
    return float((track.position("box")[:, 2] - 0.1).max()), 0.0


@case("m", 1e-3, "a rolling ball does not hop")
def bouncy_roll(bench: Bench) -> tuple[float, float]:
    """A ball of e = 0.9 that slips at 3 m/s, then rolls, rises by 0."""

    def build(scene: Scene) -> None:
        scene.ground()
        scene.sphere("ball", radius=0.1, density=600, position=(0, 0, 0.1), velocity=(3, 0, 0), restitution=0.9)

    track = bench.run(build, 1.5)
    bench.show("rise [m]", track.time, track.position("ball")[:, 2] - 0.1, 0.0)
    return float((track.position("ball")[:, 2] - 0.1).max()), 0.0
