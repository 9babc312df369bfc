"""Motion that a world states: moving surfaces, rolling starts, kinematic paths; each against theory."""

import math
from functools import partial

import numpy as np
import pytest

from tests.sim.test_bodies import Run
from wsim.geometry.paths import Curve
from wsim.scene import Scene
from wsim.sim import Simulation

G = 9.81
BOTH = pytest.mark.parametrize("worlds", [1, 2])  # MuJoCo in C, and in Warp


@pytest.fixture(params=["cpu", pytest.param("cuda:0", marks=pytest.mark.cuda)])
def simulate(request, tmp_path):
    """A run of what a function builds, on each device."""
    return partial(Run, tmp_path, request.param)


@BOTH
def test_a_conveyor_speeds_a_crate_up_and_carries_it(simulate, worlds):
    """By mu g t, and then at its own speed; the belt stays, and is turned: its own X is the world's Y."""

    def build(scene):
        belt = scene.box("belt", size=(6, 1, 0.2), position=(0, 0, 0.1), rotation_deg=(0, 0, 90), static=True)
        scene.surface_velocity(belt, velocity=(1, 0, 3))  # what points out of it does nothing
        scene.box("crate", size=(0.3, 0.3, 0.3), density=300, position=(0, -2, 0.35), friction=0.2)

    run = simulate(build, 0.8, worlds)
    speed = run.v["crate"][:, 1]
    early = round(0.25 / run.dt) - 1
    assert speed[early] == pytest.approx(0.2 * G * 0.25, rel=0.005)
    assert speed[-1] == pytest.approx(1.0, rel=1e-4)
    assert np.abs(run.q["crate"][:, 2] - 0.35).max() < 1e-4 and np.abs(run.v["crate"][:, 0]).max() < 1e-4


@BOTH
def test_a_ball_on_a_treadmill(simulate, worlds):
    """Set down at rest it comes to 2/7 of the belt's speed; rolling against the belt at its speed it stays."""

    def build(scene):
        belt = scene.box("belt", size=(6, 2, 0.2), position=(0, 0, 0.1), static=True)
        scene.surface_velocity(belt, velocity=(2, 0, 0))
        scene.sphere("set_down", radius=0.1, density=600, position=(-2, -0.5, 0.3), friction=0.3)
        scene.sphere("runner", radius=0.1, density=600, position=(1, 0.5, 0.3), friction=0.3,
                     angular_velocity_deg=(0, -math.degrees(20), 0))  # fmt: skip

    run = simulate(build, 0.6, worlds)
    assert run.v["set_down"][-1, 0] == pytest.approx(4 / 7, rel=0.005)
    assert np.abs(run.q["runner"][:, 0] - 1.0).max() < 1e-3


@BOTH
def test_a_belt_on_a_body_pushes_it_along(simulate, worlds):
    """A crawler of m on ice pushes a slab of M off backwards: their momenta are opposite, their slip is the belt's."""

    def build(scene):
        scene.ground(friction=0.0)
        slab = scene.box("slab", size=(4, 1, 0.2), mass=30, position=(0, 0, 0.1), friction=0.5)
        crawler = scene.box("crawler", size=(0.4, 0.4, 0.2), mass=10, position=(0, 0, 0.3), friction=0.5)
        scene.surface_velocity(crawler, velocity=(-1, 0, 0))
        assert slab.kind == "body"

    run = simulate(build, 0.4, worlds)
    assert run.v["crawler"][-1, 0] == pytest.approx(0.75, rel=0.01)
    assert run.v["slab"][-1, 0] == pytest.approx(-0.25, rel=0.01)


@pytest.mark.parametrize(("kind", "k"), [("sphere", 7 / 5), ("cylinder", 3 / 2), ("capsule", None)])
def test_what_starts_rolling_keeps_its_speed(simulate, kind, k):
    """On the level it goes on at v; up a ramp it is slowed by g sin(a) / k from the start."""
    angle = math.radians(10.0)

    def build(scene):
        scene.ground()
        scene.box("ramp", size=(6, 4, 0.2), position=(0, 5, 1), rotation_deg=(0, -10, 0), static=True)
        up = np.array((math.cos(angle), 0.0, math.sin(angle)))
        on = np.array((0, 5, 1)) + 0.2 * np.array((-math.sin(angle), 0.0, math.cos(angle)))
        size = {"radius": 0.1} if kind == "sphere" else {"radius": 0.1, "height": 0.3, "axis": "Y"}
        make = getattr(scene, kind)
        make("flat", position=(0, 0, 0.1), velocity=(3, 0, 0), rolling=True, **size)
        make("climbs", position=on, velocity=2 * up, rolling=True, **size)

    run = simulate(build, 0.4)
    assert run.v["flat"][-1, 0] == pytest.approx(3.0, rel=1e-4)
    assert run.w["flat"][-1, 1] == pytest.approx(30.0, rel=1e-4)
    if k:
        slowed = 2.0 - np.linalg.norm(run.v["climbs"][-1])
        assert slowed == pytest.approx(G * math.sin(angle) / k * run.simulation.time, rel=0.01)


@BOTH
def test_a_lift_goes_through_its_keys_and_carries(simulate, worlds):
    """Up, a wait, and back: its load stays on it at any acceleration below g, and its place is exact at the keys."""

    def build(scene):
        lift = scene.box("lift", size=(1, 1, 0.1), position=(0, 0, 0.5), kinematic=True)
        scene.path(lift, times=(0, 0.5, 0.7, 1.2), positions=((0, 0, 0.5), (0, 0, 0.8), (0, 0, 0.8), (0, 0, 0.5)))
        scene.box("load", size=(0.3,) * 3, density=600, position=(0, 0, 0.7))

    run = simulate(build, 1.3, worlds)
    for time, height in ((0.5, 0.8), (0.6, 0.8), (0.7, 0.8), (1.2, 0.5), (1.3, 0.5)):
        assert run.q["lift"][round(time / run.dt) - 1, 2] == pytest.approx(height, abs=2e-6)
    apart = run.q["load"][:, 2] - run.q["lift"][:, 2]
    assert np.abs(apart - 0.2).max() < 2e-4
    early = round(0.25 / run.dt) - 1  # halfway up: 3/2 of the mean speed
    assert run.v["load"][early, 2] == pytest.approx(0.9, rel=0.005)


@BOTH
def test_a_velocity_carries_as_far_as_it_says(simulate, worlds):
    """Straight on, and round about a slanting axis: summed in single precision they came 1e-5 m and 6e-6 off."""
    spin = np.array((0.1, 0.2, 0.7))

    def build(scene):
        scene.box("deck", size=(1, 1, 0.1), position=(0, 0, 0.15), kinematic=True, velocity=(0.5, 0, 0))
        turns = {"velocity": (0.1, 0, 0), "angular_velocity_deg": tuple(np.degrees(spin))}
        scene.box("turns", size=(1, 1, 0.1), position=(0, 3, 0.15), kinematic=True, **turns)

    run = simulate(build, 2.0, worlds)
    t, rate = run.dt * np.arange(1, len(run.q["deck"]) + 1), np.linalg.norm(spin)
    turn = np.column_stack([np.sin(0.5 * rate * t)[:, None] * spin / rate, np.cos(0.5 * rate * t)])
    assert np.abs(run.q["deck"] - np.outer(t, (0.5, 0, 0)) - (0, 0, 0.15)).max() < 1e-7
    assert np.abs(run.q["turns"] - np.outer(t, (0.1, 0, 0)) - (0, 3, 0.15)).max() < 2e-7
    assert np.abs(run.turn["turns"] - turn).max() < 1e-7


@BOTH
def test_a_velocity_may_change_and_a_place_may_be_stated_anew(tmp_path, worlds):
    """Each step goes by the velocity that the state has then, from where the state is."""
    scene = Scene()
    scene.box("deck", size=(1, 1, 0.1), position=(0, 0, 0.15), kinematic=True, velocity=(0.5, 0, 0))
    simulation = Simulation(scene.save(tmp_path / "stage.usda"), "cpu", worlds)
    state, deck = simulation.state, simulation.built.bodies[0]
    way = 0.0
    for k in range(600):
        if k == 200:
            for speeds in (state.body_qd.numpy()[deck], state.joint_qd.numpy()):  # of a CPU's arrays
                speeds[:3] = (0.3, 0.0, 0.0)
        if k == 400:
            for places in (state.body_q.numpy()[deck], state.joint_q.numpy()):
                places[0] = 7.0
            way = 7.0
        simulation.step()
        way += (0.5 if k < 200 else 0.3) * simulation.dt
        assert state.body_q.numpy()[deck, 0] == pytest.approx(way, abs=5e-7)


@BOTH
def test_a_turning_plate_carries_round(simulate, worlds):
    """A plate that swings to and fro about the vertical takes its load along; the path repeats."""

    def build(scene):
        plate = scene.box("plate", size=(1, 1, 0.1), position=(0, 0, 0.5), kinematic=True)
        scene.path(plate, times=(0, 0.5, 1), rotations_deg=((0, 0, 0), (0, 0, 40), (0, 0, 0)), repeat=True)
        scene.box("load", size=(0.2,) * 3, density=600, position=(0.2, 0, 0.65), friction=0.8)

    run = simulate(build, 1.5, worlds)
    end = run.q["load"][-1]
    assert math.degrees(math.atan2(end[1], end[0])) == pytest.approx(40.0, abs=0.5)
    assert np.linalg.norm(end[:2]) == pytest.approx(0.2, abs=2e-3)


@BOTH
def test_a_piston_pushes_and_leaves(simulate, worlds):
    """It gives what it hits its own speed, e = 0, slows, and what slides without friction goes on at that."""

    def build(scene):
        scene.ground(friction=0.0)
        piston = scene.box("piston", size=(0.2, 0.4, 0.2), position=(0, 0, 0.11), kinematic=True)
        times = (0, 0.2, 0.4, 0.6, 0.8)
        scene.path(piston, times=times, positions=[(x, 0, 0.11) for x in (0, 0.1, 0.3, 0.5, 0.6)])
        scene.box("puck", size=(0.2,) * 3, density=600, position=(0.4, 0, 0.1))

    run = simulate(build, 1.2, worlds)
    assert run.v["piston"][round(0.5 / run.dt) - 1, 0] == pytest.approx(1.0 + 1 / 12, rel=0.02)
    assert run.v["puck"][-1, 0] == pytest.approx(run.v["piston"][:, 0].max(), rel=0.01)
    assert np.abs(run.v["piston"][-1]).max() == 0.0 and run.q["piston"][-1, 0] == pytest.approx(0.6, abs=1e-6)


@BOTH
def test_what_a_kinematic_body_weighs_does_not_matter_to_what_it_meets(simulate, worlds):
    """A ball of 300 kg leaves a paddle of 10 g at u + e (u - v); a ton stays on a lift of 10 g."""

    def build(scene):
        light = {"kinematic": True, "mass": 0.01}
        scene.box("paddle", size=(0.1, 0.5, 0.5), position=(0, 0, 2), velocity=(1, 0, 0), restitution=0.5, **light)
        scene.sphere("ball", radius=0.2, mass=300, position=(0.35, 0, 2), velocity=(-2, 0, 0), restitution=0.5)
        scene.box("lift", size=(1, 1, 0.1), position=(3, 0, 0.5), velocity=(0, 0, 0.5), **light)
        scene.box("load", size=(0.4,) * 3, mass=1000, position=(3, 0, 0.75))

    run = simulate(build, 0.2, worlds)
    assert run.v["ball"][-1, 0] == pytest.approx(2.5, rel=1e-3)
    assert run.q["load"][-1, 2] - run.q["lift"][-1, 2] == pytest.approx(0.25, abs=2e-4)


def slid(path, friction, seconds, steps=200_000):
    """Where a block is that Coulomb's friction takes along on a plate which goes along X, (steps + 1,) [m]."""
    h = seconds / steps
    times = np.arange(steps + 1) * h % path.times[-1]
    piece = np.minimum(np.searchsorted(path.times, times, side="right") - 1, len(path.times) - 2)
    since = times - path.times[piece]
    plate = sum(path.place[piece, k, 0] * since**k for k in range(4))
    v, x, most = 0.0, [0.0], friction * G * h
    for speed in (np.diff(plate) / h).tolist():
        v += min(max(speed - v, -most), most)
        x.append(x[-1] + v * h)
    return np.array(x)


@pytest.mark.parametrize(
    ("amplitude", "rate", "friction", "time_step"), [(0.05, 2.0, 0.3, 6.25e-4), (0.1, 1.5, 0.2, None)]
)
def test_a_block_slides_on_a_plate_that_is_shaken(tmp_path, amplitude, rate, friction, time_step):
    """By up to 0.46 m in 2 s. Held to the end of each step in which its slip turns round it came 2.8 and 3.2 mm off."""
    phase = np.linspace(0.0, 2.0 * np.pi, 9)
    along = amplitude * (np.sin(phase) + 0.4 * np.sin(2.0 * phase + 0.7) - 0.4 * math.sin(0.7))
    along[-1] = along[0] = 0.0
    places, times = [(float(x), 0.0, 0.5) for x in along], tuple(phase / (2.0 * np.pi * rate))
    path = Curve.through(times, places, [(0, 0, 0, 1)] * len(times), repeat=True)

    def build(scene):
        plate = scene.box("plate", size=(2, 1, 0.1), position=(0, 0, 0.5), kinematic=True, friction=friction)
        scene.path(plate, times=times, positions=places, repeat=True)
        scene.box("block", size=(0.2, 0.2, 0.1), mass=1.0, position=(0, 0, 0.6), friction=friction)

    run = Run(tmp_path, "cpu", build, 2.0, time_step=time_step)
    theory = slid(path, friction, 2.0)
    at = np.minimum(np.arange(1, len(run.q["block"]) + 1) * run.dt / 2.0, 1.0) * (len(theory) - 1)
    assert np.abs(run.q["block"][:, 0] - np.interp(at, np.arange(len(theory)), theory)).max() < 1e-3
