"""Ropes: simulated as one world has them, judged as another states them, and motions that no rope gives."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.judge.test_turned import simulated
from tests.judge.theory import G, ask, ball, record, times, with_world
from wsim.judge.books.balance import Balance
from wsim.judge.checks.forces import CheckForces
from wsim.judge.evidence.evidence import Evidence
from wsim.scene.world import Guide, Rope


def atwood(scene):
    scene.cylinder("wheel", radius=0.2, height=0.1, axis="Y", position=(0, 0, 2), static=True)
    scene.box("heavy", size=(0.1,) * 3, mass=2.0, position=(-0.2, 0, 1.5))
    scene.box("light", size=(0.1,) * 3, mass=1.0, position=(0.2, 0, 0.8))
    scene.rope("rope", "heavy", "light", around=["wheel"])


def tackle(scene):
    """Three bodies on one rope: a block hangs in it between two weights."""
    for name, x in (("one", 0.0), ("other", 0.4)):
        scene.cylinder(name, radius=0.1, height=0.1, axis="Y", position=(x, 0, 2), static=True)
    scene.cylinder("block", radius=0.1, height=0.1, axis="Y", position=(0.2, 0, 1), mass=1.0)
    scene.box("left", size=(0.1,) * 3, mass=1.0, position=(-0.1, 0, 1.5))
    scene.box("right", size=(0.1,) * 3, mass=0.7, position=(0.5, 0, 1.2))
    scene.rope("rope", "left", "right", around=["one", ("block", "under"), "other"])


def bob(scene):
    start = math.radians(60.0)
    scene.sphere("bob", radius=0.02, mass=1.0, position=(math.sin(start), 0, -math.cos(start)))
    scene.rope("rope", None, "bob", anchor_a=(0, 0, 0))


def crate(scene):
    """It hangs off its centre: the rope turns it."""
    scene.box("crate", size=(0.3, 0.2, 0.2), mass=3, position=(0.3, 0, -1))
    scene.rope("rope", None, "crate", anchor_a=(0.5, 0.1, 0), anchor_b=(0.4, 0.08, -0.95))


def flung(scene):
    """Two balls fly apart until the rope between them is taut."""
    scene.sphere("one", radius=0.05, mass=1, position=(0, 0, 1), velocity=(1, 0, 0))
    scene.sphere("two", radius=0.05, mass=2, position=(0.5, 0, 1), velocity=(0, 2, 1))
    scene.rope("rope", "one", "two", length=0.7)


def sled(scene):
    """A weight draws a sled along the ground, over a wheel."""
    scene.ground()
    scene.cylinder("wheel", radius=0.1, height=0.1, axis="Y", position=(1.5, 0, 0.9), static=True)
    scene.box("sled", size=(0.2,) * 3, mass=2, position=(0, 0, 0.1), friction=0.3)
    scene.box("weight", size=(0.1,) * 3, mass=1.5, position=(1.6, 0, 0.7))
    scene.rope("rope", "sled", "weight", anchor_a=(0.1, 0, 0.1), around=["wheel"])


def off(recording):
    return [finding.message for finding in ask(CheckForces(), recording) if not finding.passed]


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The recording of what a function builds, 0.6 s of it, under another gravity; each is made once."""
    kept = {}

    def recorded(build, gravity=(0.0, 0.0, -G)):
        def heavy(scene):
            scene.simulation(gravity=gravity)
            build(scene)

        if (build, gravity) not in kept:
            kept[build, gravity] = simulated(tmp_path_factory.mktemp("run"), heavy, 0.6)
        return kept[build, gravity]

    return recorded


WORLDS = [atwood, tackle, bob, crate, flung, sled]


@pytest.mark.parametrize("build", WORLDS)
def test_what_hangs_in_a_rope_has_its_forces(run, build):
    recording = run(build)
    assert Balance(Evidence(recording, None)).books().judged.all()
    assert off(recording) == []


@pytest.mark.parametrize("build", [atwood, bob])
def test_a_tenth_of_gravity_is_missed(run, build):
    weak = with_world(run(build, (0.0, 0.0, -0.9 * G)), gravity=(0.0, 0.0, -G))
    assert off(weak) != []


@pytest.mark.parametrize("build", [crate, sled])
def test_a_pull_of_a_tenth_of_the_weight_is_found(run, build):
    """From the side, across the plane that some of them move in."""
    pulled = with_world(run(build, (0.0, 0.1 * G, -G)), gravity=(0.0, 0.0, -G))
    assert off(pulled) != []


@pytest.mark.parametrize(("build", "name"), [(atwood, "light"), (tackle, "block"), (tackle, "right"), (sled, "weight")])
def test_a_mass_a_tenth_off_is_found(run, build, name):
    recording = run(build)
    bodies = [
        body.model_copy(update={"mass": 1.1 * body.mass}) if body.prim.endswith(name) else body
        for body in recording.world.bodies
    ]
    assert off(with_world(recording, bodies=bodies)) != []


# ---- motions that are made by hand
def held(place, length=1.0):
    """A ball that stays in one place, on a rope from the origin."""
    t, none = times(1.0), np.zeros((31, 3))
    rope = Rope(prim="/World/rope", path=[Guide(position=(0, 0, 0)), Guide(body="/World/ball", position=(0, 0, 0))],
                length=length, radius=0.006)  # fmt: skip
    return with_world(record([ball()], none + place, none, t), ropes=[rope])


def test_a_rope_bears_what_hangs_in_it():
    assert off(held((0, 0, -1.0))) == []


@pytest.mark.parametrize("place", [(0, 0, 1.0), (0, 0, -0.99), (math.sin(0.1), 0, -math.cos(0.1))])
def test_a_rope_neither_pushes_nor_holds_where_it_is_slack_nor_aside(place):
    """Above its anchor; 1 % short of its length; 0.1 rad off the plumb, where a tenth of the weight is not borne."""
    assert off(held(place)) != []


def swung(drag, length=0.6):
    """A bob on a rope by Runge and Kutta, whose drag takes a share of its speed a second; nobody states a step."""
    t = times(1.2, 60.0)
    found = solve_ivp(lambda _, y: (y[1], -G / length * math.sin(y[0]) - drag * y[1]), (0.0, t[-1]), (1.2, 0.0),
                      t_eval=t, rtol=1e-10, atol=1e-12)  # fmt: skip
    angle, rate = found.y
    none = 0.0 * t
    place = length * np.stack([np.sin(angle), none, -np.cos(angle)], 1)
    speed = length * rate[:, None] * np.stack([np.cos(angle), none, np.sin(angle)], 1)
    made = record([ball()], place, speed, t)
    ends = [Guide(position=(0, 0, 0)), Guide(body="/World/ball", owner="/World/ball", position=(0, 0, 0))]
    rope = Rope(prim="/World/rope", path=ends, radius=0.01, length=length)
    return replace(with_world(made, ropes=[rope], time_step=0.0), metadata={"velocities": "own", "complete": True})


@pytest.mark.parametrize(("drag", "count"), [(0.0, 0), (0.1, 1), (0.2, 1)])
def test_a_drag_of_a_tenth_a_second_is_found_where_nobody_states_the_step(drag, count):
    """A step of 5 ms, the coarsest, turns the rope's pull by less than a frame of 17 ms would."""
    assert len(off(swung(drag))) == count
