"""Vehicles as they move, against theory; the longer runs are in `benchmarks/rigid_cases/vehicles.py`."""

import math

import numpy as np
import pytest

from benchmarks.rigid_cases.case import Bench, G
from benchmarks.rigid_cases.vehicles import circle, on_a_slope, on_the_level, rear_axle
from wsim.recording.contacts import shapes_of
from wsim.scene import Scene
from wsim.sim import Simulation


@pytest.fixture(params=["cpu", pytest.param("cuda:0", marks=pytest.mark.cuda)])
def bench(request):
    return Bench(request.param)


def test_it_rests_on_its_springs(bench):
    """They carry its weight from the start: nothing sinks, by 0.1 mm."""
    _, build = on_the_level()
    track = bench.run(build, 0.2)
    assert track.drift().max() < 1e-4


def test_its_wheels_bear_their_shares(tmp_path):
    """Of the Polaris 43 % is on the front axle."""
    scene = Scene()
    scene.simulation(frame_rate=20.0)
    scene.ground()
    vehicle = scene.vehicle("v", "polaris")
    simulation = Simulation(scene.save(tmp_path / "v.usda"), device="cpu")
    simulation.rigid.keep_contacts()
    simulation.advance_frame()
    pushes = simulation.rigid.take_contacts()
    shapes = [shape.prim for shape in shapes_of(simulation.world)]
    for corner, wheel in vehicle.wheels.items():
        rows = [any(shapes[k].startswith(f"{wheel.path}/") for k in pair) for pair in pushes.pair]
        push = float(pushes.sums[rows, 3].sum()) * 20.0
        assert push == pytest.approx(vehicle.spec.load(corner, G), rel=0.01)


def test_it_speeds_up_by_the_engines_power(bench):
    """F / (m + 4 I / r²), F by the power at the speed asked for, less what rolling resists."""
    spec, build = on_the_level(drive=10.0)
    track = bench.run(build, 0.6)
    push = spec.engine_power / 10.0 - spec.rolling * spec.mass * G
    speed = track.velocity("truck")[:, 0]
    assert (speed[60] - speed[30]) / 0.3 == pytest.approx(push / spec.effective_mass, rel=0.01)


@pytest.mark.parametrize("step", [None, 0.3e-3])
def test_it_stops_with_locked_wheels(bench, step):
    """Within 5 % of v² / (2 mu g), at half the time step as well."""
    spec, build = on_the_level(10.0, brake=1.0)
    track = bench.run(build, 1.3, step=step)
    assert track.velocity("truck")[-1, 0] == pytest.approx(0.0, abs=0.1)
    moved = track.position("truck")[-1, 0] - track.position("truck")[0, 0]
    assert moved == pytest.approx(10.0**2 / (2.0 * spec.friction * G), rel=0.05)


def test_it_drives_the_circle_of_its_steering(bench):
    """The middle of the rear axle goes round at L / tan(angle), within 3 %, to the left."""
    spec, build = on_the_level(2.0, drive=2.0, steer=20.0)
    track = bench.run(build, 3.0, rate=50.0)
    points = rear_axle(track, spec)[50:]
    assert circle(points) == pytest.approx(spec.turning_radius(20.0), rel=0.03)
    assert points[-1, 1] > 0.0
    assert np.linalg.norm(points[-1] - points[0]) > 2.5


def test_brakes_hold_it_on_a_slope(bench):
    """Once its springs have settled no wheel creeps: by less than 0.1 mm a second, 0.5 mm in 5 s."""
    track = bench.run(on_a_slope, 1.5)
    wheel = track.position("truck_wheel_rear_left")
    assert np.linalg.norm(wheel[-1] - wheel[0]) < 0.01
    assert np.linalg.norm(wheel[150] - wheel[50]) < 1e-4


def test_it_coasts_down_by_what_rolling_resists(bench):
    """f m g / (m + 4 I / r²)."""
    spec, build = on_the_level(5.0)
    speed = bench.run(build, 0.6).velocity("truck")[:, 0]
    slowed = spec.rolling * spec.mass * G / spec.effective_mass
    assert (speed[10] - speed[60]) / 0.5 == pytest.approx(slowed, rel=0.03)
    assert math.isfinite(speed[-1])
