"""Rolling and spinning are resisted, and a pair of objects may have a law of its own; each against theory."""

import math
import tempfile
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from wsim.scene import Scene
from wsim.sim import Simulation
from wsim.sim.contacts import surfaces_of

G, R = 9.81, 0.1


def _run(device, build, seconds, worlds=1):
    """Where the first world's first body is at the end, its velocity, its spin, and the simulation."""
    scene = Scene()
    build(scene)
    with tempfile.TemporaryDirectory() as folder:
        simulation = Simulation(scene.save(Path(folder) / "stage.usda"), device, worlds)
    while simulation.time < seconds - 1e-9:
        simulation.step()
    assert simulation.problems() == []
    body = simulation.built.bodies[0]
    pose, twist = (simulation.state.body_q.numpy()[body], simulation.state.body_qd.numpy()[body])
    return pose[:3].astype(float), twist[:3].astype(float), twist[3:].astype(float), simulation


@pytest.fixture(params=["cpu", pytest.param("cuda:0", marks=pytest.mark.cuda)])
def simulate(request):
    """A run of what a function builds, on each device."""
    return partial(_run, request.param)


def _ball(scene, **options):
    scene.sphere("ball", radius=R, mass=2.0, **({"position": (0, 0, R)} | options))


@pytest.mark.parametrize(("kind", "k", "worlds"), [("ball", 7 / 5, 1), ("ball", 7 / 5, 2), ("log", 3 / 2, 1)])
def test_what_rolls_stops(simulate, kind, k, worlds):
    """The torque C R N stops it after k v^2 / (2 C g), k = 1 + I / (m R^2)."""
    rolling, speed = 0.08, 0.3

    def build(scene):
        scene.ground(rolling_friction=rolling, friction=1.0)
        start = {"velocity": (speed, 0, 0), "angular_velocity_deg": (0, math.degrees(speed / R), 0)}
        if kind == "ball":
            _ball(scene, **start)
        else:
            scene.cylinder("log", radius=R, height=0.3, axis="Y", mass=2.0, position=(0, 0, R), **start)

    place, velocity, spin, _ = simulate(build, 1.3 * k * speed / (rolling * G), worlds)
    assert place[0] == pytest.approx(k * speed**2 / (2 * rolling * G), rel=0.01)
    assert np.abs(velocity).max() < 1e-4 and np.abs(spin).max() < 1e-3


@pytest.mark.parametrize(("steep", "worlds"), [(0.5, 1), (4.0, 1), (0.5, 2)])
def test_a_ball_on_a_slope(simulate, steep, worlds):
    """It stays where the slope is below C, and rolls down at 5/7 g (sin - C cos) above."""
    rolling = 0.02
    lean = steep * math.atan(rolling)

    def build(scene):
        degrees = math.degrees(lean)
        scene.box("slope", size=(4, 1, 0.2), rotation_deg=(0, degrees, 0), static=True)
        _ball(scene, position=(0.2 * math.sin(lean), 0, 0.2 * math.cos(lean)), rolling_friction=rolling)

    place, *_ = simulate(build, 1.0, worlds)
    came = math.hypot(place[0] - 0.2 * math.sin(lean), place[2] - 0.2 * math.cos(lean))
    if steep < 1.0:
        assert came < 2e-5
    else:
        assert came == pytest.approx(5 / 14 * G * (math.sin(lean) - rolling * math.cos(lean)), rel=0.01)


@pytest.mark.parametrize("worlds", [1, 2])
def test_a_ball_that_spins_upright_slows(simulate, worlds):
    """By pi mu C R N / I, and it stays where it is."""

    def build(scene):
        scene.ground()
        _ball(scene, angular_velocity_deg=(0, 0, math.degrees(5.0)), friction=0.4, rolling_friction=0.02)

    place, _, spin, _ = simulate(build, 0.6, worlds)
    assert spin[2] == pytest.approx(5.0 - 2.5 * math.pi * 0.4 * 0.02 * G * 0.6 / R, rel=0.01)
    assert np.abs(place - (0, 0, R)).max() < 1e-5


def test_a_drum_on_its_end_does_not_roll(simulate):
    """Its flat end has no radius to roll by: it slows as a ring does, by 2 mu g / R, whatever its coefficient."""

    def build(scene):
        scene.ground(rolling_friction=0.2)
        scene.cylinder("drum", radius=0.3, height=0.5, mass=20.0, position=(0, 0, 0.25), friction=0.1,
                       angular_velocity_deg=(0, 0, math.degrees(6.0)))  # fmt: skip

    _, _, spin, _ = simulate(build, 0.4)
    assert spin[2] == pytest.approx(6.0 - 2 * 0.1 * G / 0.3 * 0.4, rel=0.01)


@pytest.mark.parametrize("worlds", [1, 2])
def test_a_barrel_rolling_on_a_pallet_comes_to_rest(simulate, worlds):
    """On its side, at 0.2 rad/s: without resistance it rolls on for ever."""

    def build(scene):
        scene.cylinder("barrel", radius=0.3, height=0.9, axis="Y", mass=56.0, position=(0, 0, 0.32),
                       velocity=(0.06, 0, 0), angular_velocity_deg=(0, math.degrees(0.2), 0))  # fmt: skip
        for k in range(2):
            scene.box(f"plank_{k}", size=(1.2, 0.1, 0.02), position=(0, 0.5 * k - 0.25, 0.01), static=True)
            scene.contact("barrel", f"plank_{k}", rolling=0.01)

    place, _, spin, _ = simulate(build, 1.2, worlds)
    assert place[0] == pytest.approx(1.5 * 0.06**2 / (2 * 0.01 * G), rel=0.02)  # first order in the step
    assert np.abs(spin).max() < 1e-3


def test_two_round_bodies_roll_by_both_radii(simulate):
    """Two balls: rho = C / (1/R1 + 1/R2), half of that on a plane for equal radii."""

    def build(scene):
        _ball(scene, rolling_friction=0.05)
        scene.sphere("other", radius=R, position=(0, 0, 3 * R), static=True)
        scene.box("slab", size=(1, 1, 0.1), position=(2, 0, 0), static=True)

    *_, simulation = simulate(build, 0.0)
    surfaces = surfaces_of(simulation.model, simulation.built.worlds)
    assert surfaces.curvature[0].tolist() == pytest.approx([1 / R, 1 / R, 0.0])
    assert surfaces.law[..., 2].max() == 0.05


def test_a_pair_has_its_own_friction(simulate):
    def build(scene):
        scene.ground(friction=0.9)
        scene.box("box", size=(0.4,) * 3, mass=10.0, position=(0, 0, 0.2), velocity=(1, 0, 0), friction=0.9)
        scene.contact("box", "ground", friction=0.2)

    place, velocity, *_ = simulate(build, 0.6)
    assert place[0] == pytest.approx(1.0 / (2 * 0.2 * G), rel=0.01)
    assert np.abs(velocity).max() < 1e-4


@pytest.mark.parametrize("worlds", [1, 2])
def test_a_pair_has_its_own_restitution(simulate, worlds):
    """And only that pair: the other ball, of the same material, does not bounce."""

    def build(scene):
        scene.ground()
        for k, name in enumerate(("bouncy", "dead")):
            scene.sphere(name, radius=R, mass=1.0, position=(k, 0, 0.3 + R), restitution=0.1)
        scene.contact("ground", "bouncy", restitution=0.8)

    fall = math.sqrt(2 * 0.3 / G)
    place, *_, simulation = simulate(build, fall * (1 + 0.8), worlds)
    assert place[2] - R == pytest.approx(0.64 * 0.3, rel=0.02)
    other = simulation.state.body_q.numpy()[simulation.built.bodies[1]]
    assert other[2] - R < 0.02 * 0.3


def test_worlds_without_resistance_keep_three_rows(simulate):
    def build(scene):
        scene.ground(rolling_friction=0.3)
        scene.box("box", size=(0.4,) * 3, mass=10.0, position=(0, 0, 0.2))

    *_, simulation = simulate(build, 0.0)
    assert simulation.model.mujoco.condim.numpy().tolist() == [3, 3]


def test_only_what_rolls_gets_six_rows(simulate):
    def build(scene):
        scene.ground(rolling_friction=0.3)
        _ball(scene)
        scene.box("box", size=(0.4,) * 3, mass=10.0, position=(1, 0, 0.2))

    *_, simulation = simulate(build, 0.0)
    rows = dict(zip(simulation.model.shape_label, simulation.model.mujoco.condim.numpy().tolist(), strict=True))
    assert {label.split("/")[2]: count for label, count in rows.items()} == {"ground": 3, "ball": 6, "box": 3}
