"""Wheeled vehicles on level ground, in a bend and on a slope."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.rigid_cases.case import Array, Bench, G, Track, case
from wsim.scene import Scene, Vehicle
from wsim.scene.vehicle_spec import CORNERS, VehicleSpec, preset

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
