"""Joints: pendulums, loops, stops and drives."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.rigid_cases.case import EXACT, Bench, G, Track, approach, case, elliptic_k, period, swing
from wsim.scene import Drive, Scene


@case("s")
def large_swing(bench: Bench) -> tuple[float, float]:
    """A bob on a rod swings by 120° each way in 4 √(I / (m g l)) K(sin 60°)."""
    start = math.radians(120.0)

    def build(scene: Scene) -> None:
        scene.sphere("bob", radius=0.1, density=600, position=(math.sin(start), 0, -math.cos(start)))
        scene.joint_revolute("hinge", None, "bob", anchor=(0, 0, 0), axis="Y")

    track = bench.run(build, 6.0)
    bench.show("x [m]", track.time, track.position("bob")[:, 0], np.sin(swing(track.time, start, 1.004)))
    return period(track.time, track.position("bob")[:, 0]), 4 * math.sqrt(1.004 / G) * elliptic_k(math.sin(start / 2))


@case("s")
def conical_pendulum(bench: Bench) -> tuple[float, float]:
    """A small bob on a ball joint goes round at 40° in 2 π √(l cos θ / g)."""
    lean = math.radians(40.0)
    rate = math.sqrt(G / math.cos(lean))

    def build(scene: Scene) -> None:
        place = (math.sin(lean), 0, -math.cos(lean))
        scene.sphere("bob", radius=0.01, density=6000, position=place, velocity=(0, rate * place[0], 0),
                     angular_velocity_deg=(0, 0, math.degrees(rate)))  # fmt: skip
        scene.joint_spherical("pivot", None, "bob", anchor=(0, 0, 0))

    track = bench.run(build, 4.0)
    bench.show("y [m]", track.time, track.position("bob")[:, 1], math.sin(lean) * np.sin(rate * track.time))
    return period(track.time, track.position("bob")[:, 1]), 2 * math.pi / rate


@case("of m g l", 1e-4, "steps of the fourth order")
def double_pendulum(bench: Bench) -> tuple[float, float]:
    """The energy of a double pendulum that starts level changes by 0 in 4 s."""

    def build(scene: Scene) -> None:
        for k in (1, 2):
            scene.sphere(f"b{k}", radius=0.1, mass=1.0, position=(k * 1.0, 0, 0))
        scene.joint_revolute("h1", None, "b1", anchor=(0, 0, 0), axis="Y")
        scene.joint_revolute("h2", "b1", "b2", anchor=(1, 0, 0), axis="Y")

    track = bench.run(build, 4.0)
    energy = sum(
        G * track.position(b)[:, 2]
        + 0.5 * (track.velocity(b) ** 2).sum(axis=1)
        + 0.5 * 0.4 * 0.01 * (track.spin(b) ** 2).sum(axis=1)
        for b in ("b1", "b2")
    )
    bench.show("ΔE / (m g l)", track.time, (energy - energy[0]) / G, 0.0)
    return float(np.abs(energy - energy[0]).max() / G), 0.0


@case("s")
def parallelogram(bench: Bench) -> tuple[float, float]:
    """A bar on two equal links swings by 30° in 4 √(J / (M g l)) K(sin 15°): a loop of four hinges."""
    lean, length, bar, link = math.radians(30.0), 1.0, 2.0, 0.5
    dx, dz = math.sin(lean), math.cos(lean)

    def build(scene: Scene) -> None:
        for name, x, y in (("left", 0.0, 0.1), ("right", 0.8, -0.1)):
            scene.box(name, size=(0.04, 0.02, length), mass=link, position=(x + 0.5 * dx, y, -0.5 * dz),
                      rotation_deg=(0, -30, 0))  # fmt: skip
        scene.box("bar", size=(0.8, 0.04, 0.04), mass=bar, position=(0.4 + dx, 0, -dz))
        scene.joint_revolute("a", None, "left", anchor=(0, 0.1, 0), axis="Y")
        scene.joint_revolute("b", "left", "bar", anchor=(dx, 0, -dz), axis="Y")
        scene.joint_revolute("c", "bar", "right", anchor=(0.8 + dx, 0, -dz), axis="Y")
        scene.joint_revolute("d", None, "right", anchor=(0.8, -0.1, 0), axis="Y")

    track = bench.run(build, 4.5)
    inertia = bar * length**2 + 2 * link * (length**2 / 3 + 0.04**2 / 12)
    angle = swing(track.time, lean, inertia / ((bar + link) * length))
    bench.show("x [m]", track.time, track.position("bar")[:, 0] - 0.4, length * np.sin(angle))
    expected = 4 * math.sqrt(inertia / ((bar + link) * G * length)) * elliptic_k(math.sin(lean / 2))
    return period(track.time, track.position("bar")[:, 0] - 0.4), expected


def _crank(bench: Bench) -> Track:
    """A crank of 0.3 m that falls from 60° above level drives a slider through a rod of 1 m."""
    up = math.radians(60.0)
    pin = np.array([0.3 * math.cos(up), 0.3 * math.sin(up)])
    cross = pin[0] + math.sqrt(1.0 - pin[1] ** 2)
    tilt = math.degrees(math.atan2(pin[1], cross - pin[0]))

    def build(scene: Scene) -> None:
        scene.box("slider", size=(0.1, 0.1, 0.1), mass=0.5, position=(cross, 0, 0))
        scene.box("rod", size=(1.0, 0.02, 0.02), mass=0.3, position=(0.5 * (pin[0] + cross), 0.15, 0.5 * pin[1]),
                  rotation_deg=(0, tilt, 0))  # fmt: skip
        scene.box("crank", size=(0.3, 0.02, 0.04), mass=3.0, position=(0.5 * pin[0], 0.3, 0.5 * pin[1]),
                  rotation_deg=(0, -60, 0))  # fmt: skip
        scene.joint_prismatic("guide", None, "slider", axis="X")
        scene.joint_revolute("wrist", "slider", "rod", anchor=(cross, 0.15, 0), axis="Y")
        scene.joint_revolute("pin", "rod", "crank", anchor=(pin[0], 0.3, pin[1]), axis="Y")
        scene.joint_revolute("shaft", None, "crank", anchor=(0, 0.3, 0), axis="Y")

    return bench.run(build, 2.0)


@case("m", 1e-3, "the loop is closed by a constraint, not by coordinates")
def crank_slider(bench: Bench) -> tuple[float, float]:
    """The slider is at r cos φ + √(l² - r² sin² φ) for the crank's angle φ, to 0."""
    track = _crank(bench)
    phi = math.radians(60.0) - track.angle("crank", 1)
    place = 0.3 * np.cos(phi) + np.sqrt(1.0 - (0.3 * np.sin(phi)) ** 2)
    bench.show("slider [m]", phi, track.position("slider")[:, 0], place, "crank [rad]")
    return float(np.abs(track.position("slider")[:, 0] - place).max()), 0.0


@case("J", 0.02, "the loop is closed by a constraint that yields a little")
def crank_slider_energy(bench: Bench) -> tuple[float, float]:
    """Its energy stays what it started with."""
    track = _crank(bench)
    masses = {"slider": (0.5, 0.0), "rod": (0.3, 0.3 * (1.0 + 0.02**2) / 12),
              "crank": (3.0, 3.0 * (0.3**2 + 0.04**2) / 12)}  # fmt: skip
    energy = sum(
        m * G * track.position(b)[:, 2]
        + 0.5 * m * (track.velocity(b) ** 2).sum(axis=1)
        + 0.5 * i * (track.spin(b) ** 2).sum(axis=1)
        for b, (m, i) in masses.items()
    )
    bench.show("energy [J]", track.time, energy, energy[0])
    worst = int(np.abs(energy - energy[0]).argmax())
    return float(energy[worst]), float(energy[0])


@case("rad", 0.0127, "0.01 rad beyond its stop")
def door_stop(bench: Bench) -> tuple[float, float]:
    """A door at 3 rad/s goes to its stop at 45° and no farther."""

    def build(scene: Scene) -> None:
        scene.simulation(gravity=(0, 0, 0))
        scene.box("door", size=(0.8, 0.05, 2.0), density=600, position=(0.4, 0, 1.0), velocity=(0, 1.2, 0),
                  angular_velocity_deg=(0, 0, math.degrees(3.0)))  # fmt: skip
        scene.joint_revolute("hinge", None, "door", anchor=(0, 0, 1.0), axis="Z", limits_deg=(0, 45))

    track = bench.run(build, 1.0)
    bench.show("angle [rad]", track.time, track.angle("door", 2), np.minimum(3.0 * track.time, math.pi / 4))
    return float(track.angle("door", 2).max()), math.pi / 4


@case("rad/s", 1e-3, EXACT)
def flywheel(bench: Bench) -> tuple[float, float]:
    """A flywheel on a hinge keeps the 10 rad/s of its start for 2 s."""

    def build(scene: Scene) -> None:
        scene.cylinder("wheel", radius=0.3, height=0.1, axis="Y", mass=5.0, position=(0, 0, 1),
                       angular_velocity_deg=(0, math.degrees(10.0), 0))  # fmt: skip
        scene.joint_revolute("axle", None, "wheel", anchor=(0, 0, 1), axis="Y")

    track = bench.run(build, 2.0)
    bench.show("ω [rad/s]", track.time, track.spin("wheel")[:, 1], 10.0)
    return float(track.spin("wheel")[-1, 1]), 10.0


def _slider(bench: Bench, drive: Drive, mass: float, seconds: float) -> Track:
    def build(scene: Scene) -> None:
        scene.simulation(gravity=(0, 0, 0))
        scene.box("cart", size=(0.1, 0.1, 0.1), mass=mass)
        scene.joint_prismatic("rail", None, "cart", axis="X", drive=drive)

    track = bench.run(build, seconds)
    if drive.stiffness:
        way = approach(track.time, mass, drive.stiffness, drive.damping)
        bench.show("x [m]", track.time, track.position("cart")[:, 0], drive.position * way)
    else:
        speed = drive.velocity * (1 - np.exp(-drive.damping / mass * track.time))
        bench.show("v [m/s]", track.time, track.velocity("cart")[:, 0], speed)
    return track


@case("s")
def spring_period(bench: Bench) -> tuple[float, float]:
    """A cart of 2 kg on a drive of 200 N/m swings in 2 π √(m / k)."""
    track = _slider(bench, Drive(position=0.1, stiffness=200.0), 2.0, 4.0)
    return period(track.time, track.position("cart")[:, 0] - 0.1), 2 * math.pi * math.sqrt(2.0 / 200.0)


@case("m")
def spring_swing(bench: Bench) -> tuple[float, float]:
    """Undamped, it still swings out to twice its target, 0.2 m, in the fourth second."""
    track = _slider(bench, Drive(position=0.1, stiffness=200.0), 2.0, 4.0)
    return float(track.position("cart")[300:, 0].max()), 0.2


@case("m")
def stiff_drive_on_a_light_cart(bench: Bench) -> tuple[float, float]:
    """A drive of 2000 N/m, 10 N s/m brings a cart of 10 g to its target, 0.1 m, and holds it."""
    track = _slider(bench, Drive(position=0.1, stiffness=2000.0, damping=10.0), 0.01, 0.5)
    return float(np.abs(track.position("cart")[-20:, 0]).max()), 0.1


@case("m/s")
def fast_drive_on_a_light_cart(bench: Bench) -> tuple[float, float]:
    """A drive of 1000 N s/m, which would stop 10 g in 10 μs, keeps a cart at its target, 0.5 m/s."""
    track = _slider(bench, Drive(velocity=0.5, damping=1000.0), 0.01, 0.5)
    return float(np.abs(track.velocity("cart")[-20:, 0]).max()), 0.5
