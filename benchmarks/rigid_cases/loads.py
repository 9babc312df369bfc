"""Loads on what stands, slides, turns or is driven."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.rigid_cases.case import STILL, Bench, G, approach, case
from wsim.scene import Drive, Scene


@case("m", 1e-3, STILL)
def heavy_on_light(bench: Bench) -> tuple[float, float]:
    """A ton on a box of 1 kg: both move by 0 in 2 s."""

    def build(scene: Scene) -> None:
        scene.ground()
        scene.box("light", size=(0.2, 0.2, 0.2), mass=1.0, position=(0, 0, 0.1))
        scene.box("heavy", size=(0.4, 0.4, 0.4), mass=1000.0, position=(0, 0, 0.4))

    track = bench.run(build, 2.0)
    bench.show("moved [m]", track.time, track.drift(), 0.0)
    return track.moved(), 0.0


@case("m")
def groove(bench: Bench) -> tuple[float, float]:
    """A log that slides along a groove of 90° stops after v² / (2 √2 μ g): its two sides press more than its weight."""

    def build(scene: Scene) -> None:
        up = 0.05 * math.sqrt(2.0)
        for name, side in (("left", 1.0), ("right", -1.0)):
            # The faces meet at y = z = 0 and rise to both sides.
            middle = (0, side * (0.5 + 0.1) / math.sqrt(2.0), (0.5 - 0.1) / math.sqrt(2.0))
            scene.box(name, size=(6, 1, 0.2), position=middle, rotation_deg=(side * 45, 0, 0), static=True)
        scene.cylinder("log", radius=0.05, height=0.4, axis="X", mass=2.0, position=(-1, 0, up), velocity=(2, 0, 0),
                       friction=0.3)  # fmt: skip

    track, slows = bench.run(build, 1.2), math.sqrt(2.0) * 0.3 * G
    held = np.minimum(track.time, 2.0 / slows)
    bench.show("way [m]", track.time, track.drift(), 2.0 * held - 0.5 * slows * held**2)
    return track.moved(), 4.0 / (2 * math.sqrt(2.0) * 0.3 * G)


@case("rad/s")
def bounded_torque(bench: Bench) -> tuple[float, float]:
    """A motor of at most 2 N m spins a wheel of 0.225 kg m² up to τ t / I in 1 s."""

    def build(scene: Scene) -> None:
        scene.cylinder("wheel", radius=0.3, height=0.1, axis="Y", mass=5.0, position=(0, 0, 1))
        scene.joint_revolute("axle", None, "wheel", anchor=(0, 0, 1), axis="Y",
                             drive=Drive(velocity=36000.0, damping=1.0, max_force=2.0))  # fmt: skip

    track = bench.run(build, 1.0)
    bench.show("ω [rad/s]", track.time, track.spin("wheel")[:, 1], 2.0 / 0.225 * track.time)
    return float(track.spin("wheel")[-1, 1]), 2.0 / 0.225


@case("s")
def bounded_torque_of_a_stiff_motor(bench: Bench) -> tuple[float, float]:
    """A motor of 0.025 N m at most, c h / I = 5, has its wheel at 2.5 rad/s in I ω / τ."""
    inertia, torque, speed, step = 0.5 * 1.0 * 0.1**2, 0.025, 2.5, 1.25e-3

    def build(scene: Scene) -> None:
        scene.cylinder("wheel", radius=0.1, height=0.05, mass=1.0, position=(0, 0, 1))
        motor = Drive(velocity=math.degrees(speed), damping=5.0 * inertia / step, max_force=torque)
        scene.joint_revolute("axle", None, "wheel", axis="Z", drive=motor)

    track = bench.run(build, 0.6)
    spin = track.spin("wheel")[:, 2]
    return float(np.interp(0.99 * speed, spin, track.time)) / 0.99, inertia * speed / torque


@case("m")
def sag(bench: Bench) -> tuple[float, float]:
    """5 kg on a drive of 1000 N/m, 100 N s/m comes to rest m g / k below its target."""

    def build(scene: Scene) -> None:
        scene.box("load", size=(0.2, 0.2, 0.2), mass=5.0, position=(0, 0, 1))
        scene.joint_prismatic("rail", None, "load", axis="Z", drive=Drive(stiffness=1000.0, damping=100.0))

    track = bench.run(build, 2.0)
    sunk = 1.0 - track.position("load")[:, 2]
    bench.show("sag [m]", track.time, sunk, 5 * G / 1000 * approach(track.time, 5.0, 1000.0, 100.0))
    return float(sunk[-1]), 5 * G / 1000


@case("m")
def slider_stop(bench: Bench) -> tuple[float, float]:
    """A slider that falls to its stop goes 0.3 m and no farther."""

    def build(scene: Scene) -> None:
        scene.box("load", size=(0.2, 0.2, 0.2), mass=5.0, position=(0, 0, 1))
        scene.joint_prismatic("rail", None, "load", axis="Z", limits=(-0.3, 0.1))

    track = bench.run(build, 1.0)
    fallen = 1.0 - track.position("load")[:, 2]
    bench.show("fallen [m]", track.time, fallen, np.minimum(0.5 * G * track.time**2, 0.3))
    return float(fallen.max()), 0.3


@case("rad/s", 0.02, "it has leaned by a degree")
def seesaw(bench: Bench) -> tuple[float, float]:
    """A seesaw with 3 kg at 0.3 m and 1 kg at 0.6 m turns at g Σ m d t / I after 0.1 s."""

    def build(scene: Scene) -> None:
        scene.box("plank", size=(2, 0.3, 0.04), mass=4.0, position=(0, 0, 1))
        scene.joint_revolute("hinge", None, "plank", anchor=(0, 0, 1), axis="Y")
        for name, mass, x in (("near", 3.0, 0.3), ("far", 1.0, -0.6)):
            scene.box(name, size=(0.1, 0.1, 0.1), mass=mass, position=(x, 0, 1.07), friction=1.0)

    inertia = 4.0 * (2.0**2 + 0.04**2) / 12
    inertia += sum(m * (0.1**2 / 6 + d**2 + 0.07**2) for m, d in ((3.0, 0.3), (1.0, 0.6)))
    track = bench.run(build, 0.1)
    bench.show("ω [rad/s]", track.time, track.spin("plank")[:, 1], G * (0.9 - 0.6) * track.time / inertia)
    return float(track.spin("plank")[-1, 1]), G * (0.9 - 0.6) * 0.1 / inertia


@case("m/s", 2e-3, "the slip is sought to 3e-4 m/s")
def belt_does_not_slip(bench: Bench) -> tuple[float, float]:
    """A crate that has the speed of its belt slips on it by 0 from then on."""

    def build(scene: Scene) -> None:
        scene.box("belt", size=(8, 1, 0.2), position=(0, 0, 0.1), kinematic=True, velocity=(1, 0, 0))
        scene.box("crate", size=(0.3, 0.3, 0.3), density=300, position=(0, 0, 0.35), velocity=(1, 0, 0))

    track = bench.run(build, 2.0)
    slip = np.linalg.norm(track.velocity("crate") - (1, 0, 0), axis=1)
    bench.show("slip [m/s]", track.time, slip, 0.0)
    return float(slip.max()), 0.0
