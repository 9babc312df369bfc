"""Energy that contacts feed what they lead to and fro: a little in each interval, by forces that they may give."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.judge.theory import RADIUS, G, ask, ball, record
from wsim.importers.trajectory import from_arrays
from wsim.judge import judge
from wsim.judge.checks.energy import CheckEnergy
from wsim.recording import read
from wsim.scene import Scene
from wsim.sim import Simulation
from wsim.solvers import flight


def across(wide, radius, lean_deg):
    """A marble that is let go on the side of a gutter."""

    def build(scene):
        lean, arm = math.radians(lean_deg), wide - radius
        scene.track("gutter", pieces=[("line", 0.2)], start=(-0.1, 0, 0), profile="round", width=2 * wide,
                    wall=0.9 * wide, thickness=0.003, friction=0.8)  # fmt: skip
        scene.sphere("marble", radius=radius, mass=0.004, friction=0.8,
                     position=(0, -arm * math.sin(lean), wide - arm * math.cos(lean)))  # fmt: skip

    return build


def plank(scene):
    """A plank that is let go askew on a round post, where rolling on it took it."""
    lean, out, aside = math.radians(15.0), 0.055, 0.05 * math.radians(15.0)
    place = out * math.sin(lean) - aside * math.cos(lean), 0, out * math.cos(lean) + aside * math.sin(lean)
    scene.cylinder("post", radius=0.05, height=0.2, axis="Y", static=True, friction=1.0)
    scene.box("plank", size=(0.4, 0.05, 0.01), mass=0.2, friction=1.0, position=place, rotation_deg=(0, 15.0, 0))


def alone(recording):
    """Its poses and velocities, as another engine's would be read."""
    names = np.array([body.prim for body in recording.world.bodies])
    arrays = {"time": recording.time, "body_names": names, "body_q": recording.body_q, "body_qd": recording.body_qd}
    return from_arrays(arrays, recording.world)


@pytest.mark.parametrize(
    ("build", "seconds"),
    [(across(0.02, 0.005, 30.0), 1.5), (plank, 4.0), (across(0.1, 0.01, 40.0), 3.0)],
    ids=["gutter", "plank", "U track"],
)
def test_steps_by_the_mean_velocity_are_found_where_contacts_lead(tmp_path, monkeypatch, build, seconds):
    """They add w^2 h / 2 of the energy a second; the simulator's own steps keep it."""
    scene = Scene()
    scene.simulation(duration=seconds, frame_rate=60.0)
    build(scene)
    stage = scene.save(tmp_path / "stage.usda")

    def verdicts(name):
        Simulation(stage, device="cpu").run(tmp_path / name)
        recording = read(tmp_path / name)
        found = [judge(each).failures for each in (recording, alone(recording))]
        return [sorted({finding.check for finding in failures}) for failures in found]

    assert verdicts("right.rrd") == [[], []]
    monkeypatch.setattr(flight, "EVEN", math.inf)
    assert ["CheckEnergy" in failed for failed in verdicts("wrong.rrd")] == [True, True]


def rolling(draw, gain, seconds=3.0):
    """A ball that rolls to and fro in a round trough, over a run of whose energy `gain` comes from nowhere.

    a'' = -(5 / 7) g sin(a) / R + c a', by Runge and Kutta's fourth order; c gives c a'^2, half of which is lost on
    what height holds: the energy grows by c a second for small swings.
    """
    arm, lean = math.exp(draw.uniform(math.log(0.01), math.log(1.0))), draw.uniform(0.15, 1.2)
    pull = 5.0 / 7.0 * G / arm
    rate = max(draw.choice([24.0, 60.0, 120.0]), 1.5 * math.sqrt(pull))
    feeds, fine = math.log1p(gain) / seconds, 40
    h, count = 1.0 / (rate * fine), round(seconds * rate)

    def slope(y):
        return np.array([y[1], -pull * math.sin(y[0]) + feeds * y[1]])

    y, found = np.array([lean, 0.0]), []
    for k in range(count * fine + 1):
        if k % fine == 0:
            found.append(y)
        one = slope(y)
        two = slope(y + 0.5 * h * one)
        three = slope(y + 0.5 * h * two)
        y = y + h / 6.0 * (one + 2.0 * two + 2.0 * three + slope(y + h * three))
    angle, turning = np.array(found).T
    faster = -pull * np.sin(angle) + feeds * turning
    none = np.zeros_like(angle)
    out = np.stack([none, np.sin(angle), -np.cos(angle)], axis=1)
    way = np.stack([none, np.cos(angle), np.sin(angle)], axis=1)
    pushed = 4.0 * arm * (faster[:, None] * way - turning[:, None] ** 2 * out) + 4.0 * np.array([0.0, 0.0, G])
    spin = np.stack([-arm * turning / RADIUS, none, none], axis=1)
    return record([ball()], arm * out, arm * turning[:, None] * way, np.arange(count + 1) / rate, spin=spin,
                  force=pushed)  # fmt: skip


@pytest.mark.parametrize("pushes", [True, False], ids=["with forces", "poses and velocities"])
@pytest.mark.parametrize("gain", [-0.1, 0.0, 0.02, 0.05, 0.1, 0.2])
def test_what_rolls_to_and_fro_gains_no_more_than_a_hundredth(gain, pushes):
    """In random troughs; what is lost another's rolling resistance may have taken."""
    for seed in range(12):
        run = rolling(np.random.default_rng(seed), gain)
        if not pushes:
            run = replace(run, contact_force=np.zeros_like(run.contact_force))
        assert all(finding.passed for finding in ask(CheckEnergy(), run)) == (gain < 0.02), seed
