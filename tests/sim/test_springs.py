"""Springs and dampers against closed forms: in C where one world is on a CPU, in Warp where it is not."""

import math
from functools import partial

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.sim.cord_runs import period, run
from wsim.errors import UserError
from wsim.judge import judge
from wsim.recording import read
from wsim.scene import Scene
from wsim.sim import Simulation

G = 9.81
BOTH = pytest.mark.parametrize("worlds", [1, 2])


@pytest.fixture(params=["cpu", pytest.param("cuda:0", marks=pytest.mark.cuda)])
def simulate(request, tmp_path):
    """A run of what a function builds, on each device."""
    return partial(run, tmp_path, request.param)


def test_a_weight_bobs_with_the_period_of_its_spring(simulate):
    def build(scene):
        scene.box("weight", size=(0.1,) * 3, mass=2.0, position=(0, 0, 1))
        scene.spring("spring", None, "weight", anchor_a=(0, 0, 2), stiffness=200.0)

    _, q, _ = simulate(build, 6.5)
    z = q["weight"][:, 2] - (1.0 - 2.0 * G / 200.0)
    assert period(z) == pytest.approx(2 * math.pi * math.sqrt(2.0 / 200.0), rel=1e-4)
    assert z.min() == pytest.approx(-2.0 * G / 200.0, rel=1e-3)
    assert z[-70:].max() == pytest.approx(2.0 * G / 200.0, rel=1e-3)  # after ten periods as far as at first


@BOTH
def test_a_weight_bobs_beside_a_crate_as_it_does_alone(simulate, worlds):
    """A step that solves contacts is no reason for the spring's force to be half a step late."""

    def build(scene):
        scene.ground()
        scene.box("crate", size=(0.2,) * 3, position=(1, 0, 0.1))
        scene.sphere("weight", radius=0.02, mass=1.0, position=(0, 0, 1))
        scene.spring("spring", None, "weight", anchor_a=(0, 0, 1.55), stiffness=3000.0, rest_length=0.5)

    _, q, _ = simulate(build, 0.3, worlds)
    z = q["weight"][:, 2] - 1.0
    drawn = 0.05 - G / 3000.0
    theory = drawn * (1.0 - np.cos(math.sqrt(3000.0) * np.arange(len(z)) / 100.0))
    assert np.abs(z - theory).max() < 2e-5


@BOTH
def test_a_free_pair_swings_by_its_reduced_mass(simulate, worlds):
    def build(scene):
        scene.simulation(gravity=(0, 0, 0))
        scene.sphere("one", radius=0.05, mass=1.0, position=(0, 0, 0))
        scene.sphere("two", radius=0.05, mass=3.0, position=(1, 0, 0))
        scene.spring("spring", "one", "two", stiffness=300.0, rest_length=0.9)

    seconds = 3.0 if worlds == 1 else 0.2
    _, q, _ = simulate(build, seconds, worlds)
    apart = q["two"][:, 0] - q["one"][:, 0] - 0.9
    theory = 0.1 * np.cos(math.sqrt(300.0 / 0.75) * np.arange(len(apart)) / 100.0)
    assert np.abs(apart - theory).max() < 1e-4
    centre = (q["one"] + 3.0 * q["two"]) / 4.0
    assert np.abs(centre - centre[0]).max() < 1e-5


def test_a_damper_takes_the_swing_out_as_theory_has_it(simulate):
    def build(scene):
        scene.simulation(gravity=(0, 0, 0))
        scene.box("weight", size=(0.1,) * 3, mass=2.0, position=(0, 0, 1))
        scene.spring("spring", None, "weight", anchor_a=(0, 0, 0), stiffness=200.0, damping=4.0, rest_length=0.9)

    _, q, _ = simulate(build, 2.0)
    time = np.arange(201) / 100.0
    rate, omega = 4.0 / (2 * 2.0), math.sqrt(200.0 / 2.0 - 1.0)
    theory = 0.1 * np.exp(-rate * time) * (np.cos(omega * time) + rate / omega * np.sin(omega * time))
    assert np.abs(q["weight"][:, 2] - 0.9 - theory).max() < 1e-3


@BOTH
def test_a_damper_alone_slows_a_body(simulate, worlds):
    def build(scene):
        scene.simulation(gravity=(0, 0, 0))
        scene.box("weight", size=(0.1,) * 3, mass=2.0, position=(1, 0, 0), velocity=(1, 0, 0))
        scene.spring("damper", None, "weight", anchor_a=(0, 0, 0), stiffness=0.0, damping=3.0)

    seconds = 1.0 if worlds == 1 else 0.1
    _, _, v = simulate(build, seconds, worlds)
    assert v["weight"][-1, 0] == pytest.approx(math.exp(-3.0 / 2.0 * seconds), rel=1e-5)


@BOTH
def test_a_strong_damper_shortens_the_step(simulate, worlds):
    """One that takes the speed away in 2 ms lets the weight down at m g / c."""

    def build(scene):
        scene.box("weight", size=(0.05,) * 3, mass=0.01, position=(0, 0, 1))
        scene.spring("damper", None, "weight", anchor_a=(0, 0, 2), stiffness=0.0, damping=5.0)

    dt, _, v = simulate(build, 0.02, worlds)
    assert 0.9 * 5e-4 < dt <= 5e-4  # a quarter of m / c
    assert v["weight"][-1, 2] == pytest.approx(-0.01 * G / 5.0, rel=1e-3)


def test_a_stiff_spring_shortens_the_step_and_keeps_its_energy(simulate):
    """A hundred periods at omega = 1000 / s: its speed is what is left of its energy."""

    def build(scene):
        scene.simulation(gravity=(0, 0, 0))
        scene.box("weight", size=(0.1,) * 3, mass=1.0, position=(0, 0, 1))
        scene.spring("spring", None, "weight", anchor_a=(0, 0, 0), stiffness=1e6, rest_length=0.99)

    dt, q, v = simulate(build, 0.63, rate=1000.0)
    assert dt == pytest.approx(0.25e-3)
    energy = 0.5 * v["weight"][:, 2] ** 2 + 0.5e6 * (q["weight"][:, 2] - 0.99) ** 2
    assert energy[-1] == pytest.approx(50.0, rel=0.01)  # a part in 6e5 a step is lost at omega dt = 1 / 4


@pytest.mark.parametrize(
    ("stiffness", "damping", "message"),
    [
        (1e8, 0.0, r"stiffness = 1e\+08 N/m .* at most 6.3e\+05 N/m, or more mass"),
        (0.0, 1e3, r"damping = 1000 N s/m .* at most 25 N s/m, or more mass"),
    ],
)
def test_a_spring_that_no_step_can_follow_is_refused_with_the_stiffest(tmp_path, stiffness, damping, message):
    scene = Scene()
    scene.box("chip", size=(0.01,) * 3, mass=1e-3, position=(0, 0, 1))
    scene.spring("spring", None, "chip", anchor_a=(0, 0, 2), stiffness=stiffness, damping=damping)
    with pytest.raises(UserError, match="/World/spring: " + message):
        Simulation(scene.save(tmp_path / "stage.usda"), "cpu")


def test_the_judge_knows_a_spring_and_sees_one_that_is_switched_off(tmp_path):
    scene = Scene()
    scene.simulation(duration=1.0, frame_rate=100.0)
    scene.box("weight", size=(0.1,) * 3, mass=2.0, position=(0, 0, 1))
    scene.spring("spring", None, "weight", anchor_a=(0, 0, 2), stiffness=200.0, damping=2.0)
    stage = scene.save(tmp_path / "stage.usda")
    Simulation(stage, "cpu").run(tmp_path / "right.rrd")
    right = judge(read(tmp_path / "right.rrd"))
    assert right.failures == []
    assert {"CheckEnergy", "CheckForces"} <= {finding.check for finding in right.findings}

    off = Simulation(stage, "cpu")
    off.rigid.solver.mj_model.tendon_stiffness[:] = 0.0
    off.run(tmp_path / "off.rrd")
    wrong = {finding.check for finding in judge(read(tmp_path / "off.rrd")).failures}
    assert {
        "CheckEnergy",
        "CheckRecordedTies",
    } <= wrong  # what is recorded of it explains the motion, but is not its law


def bounces_on_a_spring(stiffness, heavy, light, drop, times):
    """Heights of a plate on a spring, at rest at 1 m, and of an elastic ball, its radius 5 cm, that falls on it."""
    found, state, start = np.zeros((len(times), 2)), np.array([1.0, 1.1 + drop, 0.0, 0.0]), 0.0

    def falls(_, y):
        return [y[2], y[3], -stiffness * (y[0] - 1.0) / heavy, -G]

    def gap(_, y):
        return y[1] - y[0] - 0.1

    gap.terminal, gap.direction = True, -1
    while start < times[-1]:
        way = solve_ivp(falls, (start, times[-1]), state, events=gap, rtol=1e-11, atol=1e-12, dense_output=True)
        flies = (times >= start) & (times <= way.t[-1])
        found[flies] = way.sol(times[flies])[:2].T
        start, (z, _, u, v) = way.t[-1], way.y[:, -1]
        both = (heavy * u + light * v) / (heavy + light)
        state = np.array([z, z + 0.1 + 1e-13, 2.0 * both - u, 2.0 * both - v])
    return found


@pytest.mark.parametrize(("stiffness", "heavy", "light", "drop"), [(200, 2.0, 1.0, 0.5), (1000, 1.0, 0.5, 0.3)])
def test_a_ball_bounces_on_what_hangs_in_a_spring(tmp_path, stiffness, heavy, light, drop):
    """Where the two meet within a step decides how fast the plate is then: the ball was 14 and 174 mm off in 2 s."""

    def build(scene):
        scene.box("plate", size=(0.3, 0.3, 0.1), mass=heavy, position=(0, 0, 1), restitution=1.0, friction=0.0)
        rest = 0.5 - heavy * G / stiffness
        scene.spring("spring", None, "plate", stiffness=stiffness, rest_length=rest, anchor_a=(0, 0, 1.5))
        at = {"position": (0, 0, 1.1 + drop), "restitution": 1.0, "friction": 0.0}
        scene.sphere("ball", radius=0.05, mass=light, **at)

    _, q, _ = run(tmp_path, "cpu", build, 2.0)
    known = bounces_on_a_spring(stiffness, heavy, light, drop, np.arange(201) / 100.0)
    assert q["plate"][:, 2] == pytest.approx(known[:, 0], abs=1e-3)
    assert q["ball"][:, 2] == pytest.approx(known[:, 1], abs=1e-3)
