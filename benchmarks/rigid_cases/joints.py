"""Joints that rub, are geared, break, close loops, and how far they give."""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from benchmarks.rigid_cases.case import Bench, Case, G, case
from wsim.scene import Drive, Scene

JERK = "at rest but for the jerk of a motor that starts at its full speed"


@case("s")
def friction_stops_a_flywheel(bench: Bench) -> tuple[float, float]:
    """Dry friction of 2 N m in its axle stops a wheel of 0.2 kg m² at 10 rad/s after I ω / τ."""
    inertia, spin, torque = 0.5 * 10.0 * 0.2**2, 10.0, 2.0

    def build(scene: Scene) -> None:
        turning = (0.0, 0.0, math.degrees(spin))
        wheel = scene.cylinder("wheel", radius=0.2, height=0.05, mass=10.0, angular_velocity_deg=turning)
        scene.joint_revolute("axle", None, wheel, axis="Z", friction=torque)

    track = bench.run(build, 1.5)
    speed = track.spin("wheel")[:, 2]
    half = np.searchsorted(-speed, -0.5 * spin)  # the line through two of its points ends where it stops
    return float(track.time[half] * spin / (spin - speed[half])), inertia * spin / torque


@case("rad/s", reach=1e-4, why="at rest: nothing is to move")
def friction_holds_a_flywheel(bench: Bench) -> tuple[float, float]:
    """Once it has stopped it turns by 0, under 0.99 of the friction."""

    def build(scene: Scene) -> None:
        arm = scene.box("arm", size=(1.0, 0.05, 0.05), mass=2.0, position=(0.5, 0.0, 1.0))
        scene.joint_revolute("hinge", None, arm, anchor=(0, 0, 1), axis="Y", friction=2.0 * G * 0.5 / 0.99)

    return float(np.abs(bench.run(build, 1.0).spin("arm")).max()), 0.0


@case("rad")
def friction_in_a_pendulum(bench: Bench) -> tuple[float, float]:
    """A pendulum whose hinge rubs loses 4 τ / (m g l) of its amplitude a period, here in six half swings from 10°."""
    torque, start = 0.02, math.radians(10.0)

    def build(scene: Scene) -> None:
        place = (0.5 * math.sin(start), 0.0, 2.0 - 0.5 * math.cos(start))
        turn = (0.0, -math.degrees(start), 0.0)
        rod = scene.box("rod", size=(0.02, 0.02, 1.0), mass=1.0, position=place, rotation_deg=turn)
        scene.joint_revolute("hinge", None, rod, anchor=(0, 0, 2), axis="Y", friction=torque)

    angle = bench.run(build, 5.3).angle("rod", 1)
    angle = start - angle
    turns = [abs(b) for a, b, c in zip(angle, angle[1:], angle[2:], strict=False) if (b - a) * (c - b) < 0.0]
    return start - turns[5], 6 * 2.0 * torque / (1.0 * G * 0.5)


TRAIN = (0.1, 0.2, 0.15)  # radii [m] of wheels of 20 kg/m each


def _train(scene: Scene) -> None:
    x = 0.0
    for k, r in enumerate(TRAIN):
        x += r + TRAIN[k - 1] if k else 0.0
        wheel = scene.cylinder(f"w{k}", radius=r, height=0.05, mass=20.0 * r, position=(x, 0.0, 1.0))
        motor = Drive(velocity=1e5, damping=1e-3, max_force=1.0) if k == 0 else None
        scene.joint_revolute(f"j{k}", None, wheel, axis="Z", drive=motor)
    for k in range(2):
        scene.gear(f"g{k}", f"j{k}", f"j{k + 1}", ratio=-TRAIN[k] / TRAIN[k + 1])


@case("rad/s")
def gear_train_inertia(bench: Bench) -> tuple[float, float]:
    """1 N m on the first of three wheels that mesh turns it at τ t / Σ I (r₁ / r)² after 0.5 s."""
    inertia = sum(0.5 * 20.0 * r * r**2 * (TRAIN[0] / r) ** 2 for r in TRAIN)
    return float(bench.run(_train, 0.5).spin("w0")[-1, 2]), 0.5 / inertia


@case("", reach=1e-3, why="a gear has no play")
def gear_train_ratio(bench: Bench) -> tuple[float, float]:
    """The third turns as the first does, by r₁ / r₃."""
    track = bench.run(_train, 0.5)
    return float(track.spin("w2")[-1, 2] / track.spin("w0")[-1, 2]), TRAIN[0] / TRAIN[2]


@case("m/s")
def rack_and_pinion(bench: Bench) -> tuple[float, float]:
    """A rack of 3 kg on a pinion of 2 kg, pushed with 6 N, has F t / (M + I / r²) after 1 s."""

    def build(scene: Scene) -> None:
        pinion = scene.cylinder("pinion", radius=0.1, height=0.05, mass=2.0, position=(0.0, 0.0, 1.0))
        rack = scene.box("rack", size=(1.0, 0.05, 0.05), mass=3.0, position=(0.0, 0.125, 1.0))
        push = Drive(velocity=1e3, damping=0.02, max_force=6.0)
        scene.joint_revolute("axle", None, pinion, axis="Z")
        scene.joint_prismatic("rail", None, rack, axis="X", drive=push)
        scene.gear("teeth", "axle", "rail", ratio=-0.1)

    return float(bench.run(build, 1.0).velocity("rack")[-1, 0]), 6.0 / (3.0 + 0.5 * 2.0)


def _pendulum_that_breaks(share: float) -> float:
    """Strength [N] as a share of m (g + v² / l), at the bottom of a swing from level: 3 m g."""
    return share * 3.0 * G


def _broke(bench: Bench, share: float) -> float:
    def build(scene: Scene) -> None:
        bob = scene.sphere("bob", radius=0.02, mass=1.0, position=(1.0, 0.0, 2.0))
        most = _pendulum_that_breaks(share)
        scene.joint_spherical("pin", None, bob, anchor=(0.0, 0.0, 2.0), break_force=most)

    place = bench.run(build, 1.5).position("bob") - np.array([0.0, 0.0, 2.0])
    return float(np.linalg.norm(place, axis=1).max() > 1.05)


@case("", reach=0.0, why="exact")
def link_below_its_strength(bench: Bench) -> tuple[float, float]:
    """A bob let go level pulls with 3 m g at the bottom: a link of 1.01 of that holds, 1 for one that breaks."""
    return _broke(bench, 1.01), 0.0


@case("", reach=0.0, why="exact")
def link_above_its_strength(bench: Bench) -> tuple[float, float]:
    """A link of 0.99 of that breaks."""
    return _broke(bench, 0.99), 1.0


@case("m", reach=3e-4, why=JERK)
def driven_crank_slider(bench: Bench) -> tuple[float, float]:
    """A driven crank, a rod and a slider that rubs: the piston is at r cos φ + √(l² - r² sin² φ), to 0."""
    r, length = 0.1, 0.4

    def build(scene: Scene) -> None:
        crank = scene.box("crank", size=(r, 0.02, 0.02), mass=0.2, position=(r / 2, 0.0, 1.0))
        rod = scene.box("rod", size=(length, 0.02, 0.02), mass=0.2, position=(r + length / 2, 0.05, 1.0))
        piston = scene.box("piston", size=(0.1, 0.1, 0.1), mass=0.5, position=(r + length, 0.2, 1.0))
        motor = Drive(velocity=360.0, damping=5.0)
        scene.joint_revolute("axle", None, crank, anchor=(0.0, 0.0, 1.0), axis="Y", drive=motor)
        scene.joint_revolute("pin", crank, rod, anchor=(r, 0.0, 1.0), axis="Y")
        scene.joint_revolute("wrist", rod, piston, anchor=(r + length, 0.0, 1.0), axis="Y")
        scene.joint_prismatic("rail", None, piston, axis="X", friction=2.0)

    track = bench.run(build, 1.0)
    angle = track.angle("crank", 1)
    reach = r * np.cos(angle) + np.sqrt(length**2 - (r * np.sin(angle)) ** 2)
    return float(np.abs(track.position("piston")[:, 0] - reach).max()), 0.0


@case("m", reach=1e-4, why="at rest: nothing is to move")
def weld_under_a_ton(bench: Bench) -> tuple[float, float]:
    """A joint that may break, a metre from the middle of a ton, gives by 0."""

    def build(scene: Scene) -> None:
        load = scene.box("load", size=(0.5, 0.5, 0.5), mass=1000.0, position=(1.0, 0.0, 2.0))
        scene.joint_fixed("weld", None, load, anchor=(0.0, 0.0, 2.0), break_force=1e6)

    return bench.run(build, 1.0).moved(), 0.0


def _beyond_the_stop(bench: Bench, speed: float) -> tuple[float, float]:
    def build(scene: Scene) -> None:
        scene.simulation(gravity=(0.0, 0.0, 0.0))
        cart = scene.box("cart", size=(0.2, 0.2, 0.2), mass=20.0, velocity=(speed, 0.0, 0.0))
        scene.joint_prismatic("rail", None, cart, axis="X", limits=(-0.1, 0.5))

    return float(bench.run(build, 0.5 / speed + 0.1).position("cart")[:, 0].max()) - 0.5, 0.0


def _stops() -> tuple[Case, ...]:
    says = "A slider that meets its stop at {:g} m/s goes 0 beyond it."
    speeds = (1.0, 10.0, 30.0)
    runs = [partial(_beyond_the_stop, speed=speed) for speed in speeds]
    why = "1.2e-7 s times the speed: the impedance of a row"
    return tuple(
        Case(f"stop_at_{speed:g}", says.format(speed), "m", 2e-7 * speed, why, run)
        for speed, run in zip(speeds, runs, strict=True)
    )


STOPS = _stops()
