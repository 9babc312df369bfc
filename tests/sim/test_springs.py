"""Springs and dampers against closed forms: in C where one world is on a CPU, in Warp where it is not."""

import math
from functools import partial

import numpy as np
import pytest

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


@BOTH
def test_a_weight_bobs_with_the_period_of_its_spring(simulate, worlds):
    def build(scene):
        scene.box("weight", size=(0.1,) * 3, mass=2.0, position=(0, 0, 1))
        scene.spring("spring", None, "weight", anchor_a=(0, 0, 2), stiffness=200.0)

    _, q, _ = simulate(build, 6.5, worlds)
    z = q["weight"][:, 2] - (1.0 - 2.0 * G / 200.0)
    assert period(z) == pytest.approx(2 * math.pi * math.sqrt(2.0 / 200.0), rel=1e-4)
    assert z.min() == pytest.approx(-2.0 * G / 200.0, rel=1e-3)
    assert z[-70:].max() == pytest.approx(2.0 * G / 200.0, rel=1e-3)  # after ten periods as far as at first


@BOTH
def test_a_free_pair_swings_by_its_reduced_mass(simulate, worlds):
    def build(scene):
        scene.simulation(gravity=(0, 0, 0))
        scene.sphere("one", radius=0.05, mass=1.0, position=(0, 0, 0))
        scene.sphere("two", radius=0.05, mass=3.0, position=(1, 0, 0))
        scene.spring("spring", "one", "two", stiffness=300.0, rest_length=0.9)

    _, q, _ = simulate(build, 3.0, worlds)
    apart = q["two"][:, 0] - q["one"][:, 0] - 0.9
    assert period(apart) == pytest.approx(2 * math.pi * math.sqrt(0.75 / 300.0), rel=1e-4)
    centre = (q["one"] + 3.0 * q["two"]) / 4.0
    assert np.abs(centre - centre[0]).max() < 1e-5


@BOTH
def test_a_damper_takes_the_swing_out_as_theory_has_it(simulate, worlds):
    def build(scene):
        scene.simulation(gravity=(0, 0, 0))
        scene.box("weight", size=(0.1,) * 3, mass=2.0, position=(0, 0, 1))
        scene.spring("spring", None, "weight", anchor_a=(0, 0, 0), stiffness=200.0, damping=4.0, rest_length=0.9)

    _, q, _ = simulate(build, 2.0, worlds)
    time = np.arange(201) / 100.0
    rate, omega = 4.0 / (2 * 2.0), math.sqrt(200.0 / 2.0 - 1.0)
    theory = 0.1 * np.exp(-rate * time) * (np.cos(omega * time) + rate / omega * np.sin(omega * time))
    assert np.abs(q["weight"][:, 2] - 0.9 - theory).max() < 1e-3  # a hundredth: steps of the first order in Warp


@BOTH
def test_a_damper_alone_slows_a_body(simulate, worlds):
    def build(scene):
        scene.simulation(gravity=(0, 0, 0))
        scene.box("weight", size=(0.1,) * 3, mass=2.0, position=(1, 0, 0), velocity=(1, 0, 0))
        scene.spring("damper", None, "weight", anchor_a=(0, 0, 0), stiffness=0.0, damping=3.0)

    _, _, v = simulate(build, 1.0, worlds)
    assert v["weight"][-1, 0] == pytest.approx(math.exp(-3.0 / 2.0), rel=2e-3)


@BOTH
def test_an_overdamped_spring_is_stable(simulate, worlds):
    """A damper that would stop 10 g in 10 microseconds lets it down at m g / c."""

    def build(scene):
        scene.box("weight", size=(0.05,) * 3, mass=0.01, position=(0, 0, 1))
        scene.spring("damper", None, "weight", anchor_a=(0, 0, 2), stiffness=0.0, damping=1000.0)

    _, _, v = simulate(build, 0.2, worlds)
    assert v["weight"][-1, 2] == pytest.approx(-0.01 * G / 1000.0, rel=0.01)


def test_a_stiff_spring_shortens_the_step_and_keeps_its_energy(simulate):
    """A hundred periods at omega = 1000 / s; the amplitude is what is left of the energy."""

    def build(scene):
        scene.simulation(gravity=(0, 0, 0))
        scene.box("weight", size=(0.1,) * 3, mass=1.0, position=(0, 0, 1))
        scene.spring("spring", None, "weight", anchor_a=(0, 0, 0), stiffness=1e6, rest_length=0.99)

    dt, q, _ = simulate(build, 0.63, rate=4000.0)
    assert dt <= 0.25e-3
    z = q["weight"][:, 2] - 0.99
    assert np.abs(z[-300:]).max() == pytest.approx(0.01, rel=5e-3)
    assert period(z, 4000.0) == pytest.approx(2 * math.pi / 1000.0, rel=1e-4)


def test_a_spring_that_no_step_can_follow_is_refused_with_the_stiffest(tmp_path):
    scene = Scene()
    scene.box("chip", size=(0.01,) * 3, mass=1e-3, position=(0, 0, 1))
    scene.spring("spring", None, "chip", anchor_a=(0, 0, 2), stiffness=1e8)
    with pytest.raises(UserError, match=r"/World/spring: stiffness = 1e\+08 N/m .* at most 6.2e\+05 N/m, or more mass"):
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
    assert {"CheckEnergy", "CheckSprings"} <= {finding.check for finding in right.findings}

    off = Simulation(stage, "cpu")
    off.rigid.solver.mj_model.tendon_stiffness[:] = 0.0
    off.run(tmp_path / "off.rrd")
    wrong = {finding.check for finding in judge(read(tmp_path / "off.rrd")).failures}
    assert {"CheckEnergy", "CheckSprings"} <= wrong
