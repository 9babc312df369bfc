"""Mechanisms that contacts press, and those that whirl: by the fourth order, in parts; MuJoCo in C."""

import math
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.struck_mechanisms import SECONDS, build, recorded, wrong
from tests.judge.theory import ask
from tests.sim.struck_worlds import Books
from wsim.judge.books.balance import Books as Balance
from wsim.judge.checks.forces import CheckForces
from wsim.judge.checks.recorded import CheckRecordedForces
from wsim.judge.evidence.evidence import Evidence


def test_a_pendulum_on_a_cart_on_ice_leaves_the_centre_of_mass_where_it_is(tmp_path):
    """By steps of the first order it went 2.8 mm in 3 s. Friction of zero is 1e-5, which gives 2e-4 N at most."""

    def cart(scene):
        scene.ground(friction=0.0)
        cart = scene.box("cart", size=(0.3, 0.2, 0.1), mass=1.0, position=(0, 0, 0.05), friction=0.0)
        bob = scene.sphere("bob", radius=0.04, mass=1.0, position=(0.3, 0, 1.0), friction=0.0)
        scene.joint_revolute("hinge", cart, bob, anchor=(0, 0, 1.0), axis="Y")

    books = Books(tmp_path, cart, 3.0)
    pose = books.simulation.state.body_q.numpy()[books.simulation.built.bodies]
    assert np.abs(books.v[:, 0, 0]).max() > 0.5  # it swings
    assert pose[:, 0].mean() == pytest.approx(0.15, abs=2e-5)
    assert books.gain[1] < 1e-6


def test_two_marbles_on_a_hinge_keep_their_energy_across_a_gutter(tmp_path):
    """A push that is held over a step gave them 60 % in 3 s, as their way turns it meanwhile."""

    def pair(scene):
        wide, radius, lean = 0.02, 0.005, math.radians(30)
        scene.track("gutter", pieces=[("line", 0.2)], start=(-0.1, 0, 0), profile="round", width=2 * wide, wall=0.018,
                    thickness=0.003, friction=0.8)  # fmt: skip
        y, z = -(wide - radius) * math.sin(lean), wide - (wide - radius) * math.cos(lean)
        one, two = (
            scene.sphere(name, radius=radius, mass=0.004, position=(x, y, z), friction=0.8)
            for name, x in (("one", -0.01), ("two", 0.01))
        )
        scene.joint_revolute("hinge", one, two, anchor=(0, y, z), axis="X")

    assert Books(tmp_path, pair, 3.0).gain[1] < 0.05


@pytest.mark.parametrize(("seed", "most"), [(29, 1e-4), (38, 3e-4), (43, 3e-4), (54, 1e-4)])
def test_links_that_whirl_gain_nothing(tmp_path, seed, most):
    """Cables of light links and a load, and chains on an edge, e = 0 and 1: a step gave 2 %, 0.2 %, 0.1 %, and in the
    last world no number."""
    assert Books(tmp_path, lambda scene: build(scene, seed), SECONDS).gain[0] < most


@pytest.mark.parametrize("seed", [4, 14, 19, 25, 29, 39])
def test_what_is_recorded_of_a_blow_moves_what_hangs_together(tmp_path, seed):
    """In the step of a blow what joints gave was taken as it was at the step's start: up to 75 N were missing."""
    found = ask(CheckRecordedForces(), recorded(tmp_path, seed))
    assert [finding.message for finding in found if not finding.passed] == []


@pytest.mark.parametrize("seed", [4, 10, 17, 29, 53])
def test_sound_worlds_are_accepted(tmp_path, seed):
    """Of sixty such worlds 41 were rejected: frames do not tell how links whip about in and after a blow."""
    assert [finding.message for finding in wrong(recorded(tmp_path, seed))] == []


@pytest.mark.parametrize("seed", [5, 30])
def test_a_push_that_nothing_gives_is_found_beside_a_blow(tmp_path, seed):
    """A link has half of its speed more from the frame on in which it is hit."""
    recording = recorded(tmp_path, seed)
    books = Balance.of(Evidence(recording))
    k, i = (int(n) for n in np.argwhere(books.hit & [body.prim.find("link") > 0 for body in recording.world.bodies])[0])
    body_qd = recording.body_qd.copy()
    body_qd[k + 1 :, i, :3] *= 1.5
    pushed = replace(recording, body_qd=body_qd)
    for check in (CheckForces(), CheckRecordedForces()):
        assert any(not finding.passed for finding in ask(check, pushed)), check
