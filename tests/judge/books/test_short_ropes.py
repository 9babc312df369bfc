"""Ropes and chains that swing faster than frames tell, and hands that draw them: right ones and wrong ones."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.judge.theory import G, with_world
from wsim.judge import judge
from wsim.judge.books.led import led_work
from wsim.judge.evidence.evidence import Evidence
from wsim.recording import read
from wsim.scene import Scene
from wsim.sim import Simulation

SHORT, START = 0.012, math.radians(71.0)


def bob(scene):
    """On 12 mm, by 71 degrees: five swings a second, of which 24 frames show five poses each."""
    place = (SHORT * math.sin(START), 0, -SHORT * math.cos(START))
    scene.sphere("bob", radius=0.1 * SHORT, density=2000.0, position=place)
    scene.rope("rope", None, "bob", anchor_a=(0, 0, 0))


def off_centre(scene):
    """A box of 10 cm that hangs by a corner on 15 cm, and rocks as it swings."""
    scene.box("box", size=(0.1, 0.07, 0.08), density=700.0, position=(0.1, -0.02, -0.14))
    scene.rope("rope", None, "box", anchor_a=(0, 0, 0), anchor_b=(0.13, 0, -0.1))


def chain(scene):
    """A light ball on a chain of 14 links, let go aside: it rocks on the last link, 15 times a second."""
    way = np.array([math.sin(0.8), 0, -math.cos(0.8)])
    scene.sphere("load", radius=0.05, mass=0.05, position=tuple(0.45 * way))
    scene.cable("c", None, "load", anchor_a=(0, 0, 0), anchor_b=tuple(0.4 * way), links=14, radius=0.004,
                mass_per_length=0.4)  # fmt: skip


def drawn(scene):
    """A hand draws a rope over a wheel, and so a weight up, which swings."""
    scene.cylinder("wheel", radius=0.1, height=0.1, axis="Y", position=(0, 0, 2), static=True)
    scene.box("hand", size=(0.05,) * 3, position=(0.5, 0, 1.5), kinematic=True, velocity=(0.4, 0, -0.2))
    scene.sphere("weight", radius=0.05, mass=1.0, position=(-0.25, 0, 1.2))
    scene.rope("rope", "hand", "weight", around=["wheel"])


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The recording of what a function builds, 0.7 s of it at 24 frames a second; each is made once."""
    kept = {}

    def recorded(build, gravity=(0.0, 0.0, -G)):
        if (build, gravity) not in kept:
            folder, scene = tmp_path_factory.mktemp("run"), Scene()
            scene.simulation(duration=0.7, frame_rate=24.0, gravity=gravity)
            build(scene)
            Simulation(scene.save(folder / "stage.usda"), "cpu").run(folder / "run.rrd")
            kept[build, gravity] = read(folder / "run.rrd")
        return kept[build, gravity]

    return recorded


def failing(recording):
    return {finding.check for finding in judge(recording).failures}


BUILDS = [bob, off_centre, chain, drawn]


@pytest.mark.parametrize("build", BUILDS)
def test_a_right_one_is_accepted(run, build):
    assert failing(run(build)) == set()


def test_the_bob_swings_as_a_pendulum_does(run):
    """To 2 % of a radian in four swings, by Runge and Kutta."""
    recording = run(bob)
    swing = solve_ivp(lambda _, y: [y[1], -G / SHORT * math.sin(y[0])], (0, 0.71), [START, 0.0], rtol=1e-9,
                      t_eval=recording.time)  # fmt: skip
    place = recording.body_q[:, 0].astype(float)
    assert np.arctan2(place[:, 0], -place[:, 2]) == pytest.approx(swing.y[0], abs=0.02)


@pytest.mark.parametrize("build", BUILDS)
@pytest.mark.parametrize("gravity", [(0.0, 0.0, -0.97 * G), (0.0, 0.05 * G, -G)], ids=["weak", "aside"])
def test_gravity_that_is_a_little_off_is_found(run, build, gravity):
    assert failing(with_world(run(build, gravity), gravity=(0.0, 0.0, -G))) != set()


@pytest.mark.parametrize("build", [bob, off_centre, drawn])
def test_a_tenth_of_the_tension_is_missed(run, build):
    ties = run(build).ties
    less = replace(ties, cords=0.9 * ties.cords)
    assert "CheckRecordedForces" in failing(replace(run(build), ties=less))


@pytest.mark.parametrize("build", [bob, off_centre, drawn])
def test_a_rope_that_is_a_fiftieth_longer_than_stated_is_found(run, build):
    recording = run(build)
    ropes = [rope.model_copy(update={"length": rope.length / 1.02}) for rope in recording.world.ropes]
    assert "CheckRopes" in failing(with_world(recording, ropes=ropes))


def test_what_a_hand_gives_by_a_rope_is_the_energy_that_the_weight_gains(run):
    """But for what was lost as the rope was jerked at the start."""
    evidence = Evidence(run(drawn), None)
    motion, given = evidence.motion, led_work(evidence)
    gained = (motion.kinetic + motion.potential)[:, 1]
    assert np.diff(gained)[1:] == pytest.approx(np.diff(given[:, 0])[1:], abs=0.01 * np.ptp(gained))
    assert np.diff(gained)[0] < np.diff(given[:, 0])[0]


def test_a_hand_whose_rope_did_less_than_the_weight_gained_is_found(run):
    ties = run(drawn).ties
    less = ties.cords.copy()
    less[:, 0, :3] *= 0.9  # on the hand alone: nothing but the energy asks for that
    assert "CheckEnergy" in failing(replace(run(drawn), ties=replace(ties, cords=less)))
