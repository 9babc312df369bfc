"""The time step under which a loaded chain holds."""

import math

import numpy as np
import pytest

from tests.sim.test_bodies import G, Run
from wsim.errors import UserError
from wsim.scene import Scene
from wsim.scene.describe import describe
from wsim.sim.cable_steps import cable_limits

LENGTH, LINKS, RADIUS = 0.6, 12, 0.1


def hang(scene, load, lean=0.0, **cable):
    """A ball on a cable."""
    way = np.array([math.sin(lean), 0.0, -math.cos(lean)])
    end, place = ([float(x) for x in np.array([0, 0, 2.0]) + far * way] for far in (LENGTH, LENGTH + RADIUS))
    scene.sphere("load", radius=RADIUS, mass=load, position=place)
    fields = {"anchor_a": (0, 0, 2), "anchor_b": end, "length": LENGTH, "links": LINKS, "mass_per_length": 0.1}
    scene.cable("c", None, "load", **fields | cable)


@pytest.fixture
def limits(tmp_path):
    """The limits of what a function builds."""

    def of(build):
        scene = Scene()
        build(scene)
        return cable_limits(describe(scene.save(tmp_path / "stage.usda")))

    return of


def test_the_step_is_one_over_the_fastest_swing_of_a_link(limits):
    """omega^2 = T l / I: 12 T / (m l) of a thin rod, here of a capsule, whose ends make it a little slower."""
    found = limits(lambda scene: hang(scene, 100.0))
    step, own, mass = min(found.values()), LENGTH / LINKS, 0.1 * LENGTH / LINKS
    pull = G * (100.0 + 0.1 * LENGTH)
    thin = math.sqrt(mass * own / (12.0 * pull))
    assert thin < step < 1.5 * thin
    assert min(found, key=found.__getitem__).startswith("the pull on /World/c")
    assert min(limits(lambda scene: hang(scene, 400.0)).values()) == pytest.approx(0.5 * step, rel=1e-3)


def test_what_is_held_on_both_sides_has_no_known_pull(limits):
    assert limits(lambda scene: scene.cable("c", None, None, anchor_a=(0, 0, 2), anchor_b=(1, 0, 2), length=1.2)) == {}


def over_a_post(scene, left, right):
    """A cable half round a post, a weight at either end."""
    ring, hang = 0.108, 0.19
    scene.cylinder("post", radius=0.1, height=0.3, axis="Y", static=True, friction=0.435)
    turn = [(ring * math.cos(a), 0, ring * math.sin(a)) for a in np.linspace(math.pi, 0, 37)]
    for name, x, mass in (("left", -ring, left), ("right", ring, right)):
        scene.box(name, size=(0.04, 0.04, 0.04), mass=mass, position=(x, 0, -hang - 0.02))
    scene.cable("c", "left", "right", anchor_a=(-ring, 0, -hang), anchor_b=(ring, 0, -hang), through=turn, links=16,
                mass_per_length=0.1, radius=0.008, friction=0.435)  # fmt: skip


def test_over_a_post_the_heavier_weight_pulls_and_the_post_turns_links_back_as_well(limits):
    """omega^2 = 2 T l / I: the step is 1 / sqrt(2) of that of the same link with as much below it."""
    length = (0.19 * 2 + math.pi * 0.108) / 16  # of its links, about
    mass = 0.1 * length
    found = limits(lambda scene: over_a_post(scene, 0.5, 2.0))
    thin = math.sqrt(mass * length / (24.0 * G * 2.0))
    assert thin < min(found.values()) < 1.5 * thin
    assert min(found.values()) == pytest.approx(min(limits(lambda s: over_a_post(s, 2.0, 2.0)).values()), rel=1e-6)


def test_a_load_that_no_step_can_follow_is_refused(limits):
    """It says which link, how much hangs there, how much may, and what else to do."""
    with pytest.raises(
        UserError, match=r"c_\d+: 1e\+05 kg on a link of 0.005 kg .* at most .* mass_per_length .* rope"
    ):
        limits(lambda scene: hang(scene, 1e5))


@pytest.mark.parametrize("touching", [False, True])
def test_a_chain_under_a_thousand_newtons_holds(tmp_path, touching):
    """20,000 times the mass of a link, let go at 50 degrees: it is no longer than it was, and keeps its energy.

    Where anything in the world touches, steps are of the first order, and its energy swings by about h v g.
    """

    def build(scene):
        hang(scene, 100.0, math.radians(50.0))
        if touching:
            scene.ground()
            scene.box("brick", size=(0.2, 0.2, 0.2), density=500, position=(3, 0, 0.1))

    run = Run(tmp_path, "cpu", build, 0.2)
    far = np.linalg.norm(run.q["load"][:, :3] - [0, 0, 2], axis=1)
    assert far.max() < LENGTH + RADIUS + 2e-4
    energy = G * run.q["load"][:, 2] + 0.5 * (run.v["load"] ** 2).sum(axis=1)
    energy += 0.5 * 0.4 * RADIUS**2 * (run.w["load"] ** 2).sum(axis=1)
    assert np.ptp(energy) < 2e-3 * G * LENGTH
