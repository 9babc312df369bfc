"""Wheeled vehicles on level ground, in a bend and on a slope."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.rigid_cases.case import Array, Bench, G, Track, case
from wsim.scene import Scene, Vehicle
from wsim.scene.vehicle_spec import VehicleSpec, preset

KIND = "hmmwv"


def rear_axle(track: Track, spec: VehicleSpec) -> Array:
    """The middle of the rear axle [m], (frames, 2)."""
    ahead = track.axes("truck")[:, :2, 0]
    return track.position("truck")[:, :2] - 0.5 * spec.wheelbase * ahead


def circle(points: Array) -> float:
    """Radius of the circle that fits points (n, 2) best, by least squares (Kåsa 1976) [m]."""
    rows = np.column_stack([2.0 * points, np.ones(len(points))])
    x, y, rest = np.linalg.lstsq(rows, (points**2).sum(axis=1), rcond=None)[0]
    return math.sqrt(rest + x * x + y * y)


def on_the_level(speed: float = 0.0, **asked: float) -> tuple[VehicleSpec, object]:
    """A build of a truck on the ground that is asked to drive, steer or brake."""
    spec = preset(KIND)

    def build(scene: Scene) -> None:
        scene.ground()
        _ask(scene.vehicle("truck", spec, speed=speed), asked)

    return spec, build


def _ask(truck: Vehicle, asked: dict[str, float]) -> None:
    for what, value in asked.items():
        getattr(truck, what)(value)


@case("m", why="the body of the truck is where it was put: springs carry it from the start")
def truck_rests(bench: Bench) -> tuple[float, float]:
    """A truck at rest stays at its height on its springs: height of its centre of mass, h."""
    spec, build = on_the_level()
    track = bench.run(build, 0.5)
    return float(track.position("truck")[-1, 2] + spec.com[2]), spec.com[2]


@case("m/s^2")
def truck_launches(bench: Bench) -> tuple[float, float]:
    """A truck speeds up by (n T / r - f m g) / (m + 4 I / r²), T by its engine's power at 10 m/s."""
    spec, build = on_the_level(drive=10.0)
    track, force = bench.run(build, 1.5), len(spec.driven_corners) * spec.wheel_torque(10.0) / spec.wheel_radius
    speed = track.velocity("truck")[:, 0]
    expected = (force - spec.rolling * spec.mass * G) / spec.effective_mass
    bench.show("v [m/s]", track.time, speed, expected * track.time)
    return track.at(speed, 1.5) - track.at(speed, 0.5), expected


@case("m", reach=0.05, why="wheels take a time to lock, and the body pitches")
def truck_stops(bench: Bench) -> tuple[float, float]:
    """A truck at 10 m/s whose brakes lock slides v² / (2 μ g)."""
    spec, build = on_the_level(10.0, brake=1.0)
    track = bench.run(build, 1.6)
    bench.show("v [m/s]", track.time, track.velocity("truck")[:, 0],
               np.maximum(10.0 - spec.friction * G * track.time, 0.0))  # fmt: skip
    return track.moved(), 10.0**2 / (2.0 * spec.friction * G)


@case("m", reach=0.03, why="tyres slip a little, and the steering yields")
def truck_turns(bench: Bench) -> tuple[float, float]:
    """A truck at 2 m/s, its wheels at 15°, turns with the radius L / tan 15° of its rear axle's middle."""
    spec, build = on_the_level(2.0, drive=2.0, steer=15.0)
    track = bench.run(build, 5.0, rate=50.0)
    return circle(rear_axle(track, spec)[75:]), spec.turning_radius(15.0)


@case("m", reach=0.03, why="tyres slip a little, and the body rolls")
def truck_corners(bench: Bench) -> tuple[float, float]:
    """A truck in a bend at 0.6 of the speed's square that friction bears, v² = 0.6 μ g R, keeps L / tan 10°."""
    radius = preset(KIND).turning_radius(10.0)
    speed = math.sqrt(0.6 * preset(KIND).friction * G * radius)
    spec, build = on_the_level(speed, drive=speed, steer=10.0)
    track = bench.run(build, 2.5, rate=50.0)
    return circle(rear_axle(track, spec)[60:]), radius


@case("m", reach=0.01, why="it is to stay")
def truck_holds_on_a_slope(bench: Bench) -> tuple[float, float]:
    """A truck with its brakes on stays on a slope of 15° for 5 s, once its springs have settled."""
    track = bench.run(on_a_slope, 5.5)
    wheel = track.position("truck_wheel_front_left")
    return float(np.linalg.norm(wheel[-1] - wheel[50])), 0.0


def on_a_slope(scene: Scene, lean: float = 15.0) -> None:
    """A truck with its brakes on, nose up a slope."""
    sine, cosine = math.sin(math.radians(lean)), math.cos(math.radians(lean))
    scene.box("ramp", size=(20, 8, 1), rotation_deg=(0, -lean, 0), static=True, position=(0.5 * sine, 0, -0.5 * cosine))
    scene.vehicle("truck", KIND, pitch_deg=-lean).brake()
