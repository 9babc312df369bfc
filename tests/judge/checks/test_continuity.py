"""Places by velocities where something pulls hard between two frames."""

import math

import numpy as np
import pytest

from tests.judge.test_turned import simulated
from tests.judge.theory import EDGE, RATE, G, ask, box, edited, record, times, with_world
from wsim.judge import judge
from wsim.judge.checks.continuity import CheckContinuity


def pressed(scene):
    """A ball that a spring presses to an elastic floor by up to 100 m/s^2, so that it bounces at 6 m/s in a frame."""
    scene.simulation(gravity=(0, 0, -1.6))
    scene.ground(restitution=1)
    scene.sphere("ball", radius=0.05, mass=1, position=(0, 0, 0.3), restitution=1)
    scene.spring("spring", None, "ball", stiffness=200, rest_length=1.2, anchor_a=(0, 0, 1), anchor_b=(0, 0, 0.3))


def failed(recording):
    return [finding.message for finding in ask(CheckContinuity(), recording) if not finding.passed]


def test_a_ball_that_a_spring_presses_bounces_within_a_frame(tmp_path):
    recording = simulated(tmp_path, pressed, 0.7)
    assert failed(recording) == []
    assert failed(edited(recording, "body_q", (slice(30, None), 0, 2), 0.3)) != []
    spring = recording.world.springs[0]
    for by in (0.9, 1.1):
        other = spring.model_copy(update={"stiffness": by * spring.stiffness})
        assert judge(with_world(recording, springs=[other])).status == "rejected"


def landed(turn, caught=3.0):
    """A cube that falls to a slope, and lies turned at the next frame; it came with so many metres a second."""
    t = times(0.5)
    falls = np.arange(len(t)) < len(t) // 2
    last = t[falls][-1]
    speed = np.where(falls, -caught - G * (t - last), 0.0)
    height = np.where(falls, caught * (last - t) - 0.5 * G * (t - last) ** 2, -0.5 * caught / RATE)
    about = 0.5 * np.where(falls, 0.0, turn)
    rotation = np.column_stack([0.0 * t, np.sin(about), 0.0 * t, np.cos(about)])
    along = np.column_stack([0.0 * t, 0.0 * t, np.ones_like(t)])
    return record([box()], height[:, None] * along, speed[:, None] * along, t, rotation=rotation)


# What a cube comes with, m u^2 / 2, turns it by u / k a second at most, k = edge / sqrt(6); u has a fall besides.
# What a fall over an edge turns it by is g h^2 / r.
FASTEST = (3.0 + G / RATE) * math.sqrt(6.0) / EDGE / RATE + G / (0.5 * EDGE) / RATE**2 + 1e-3


@pytest.mark.parametrize(("turn", "found"), [(0.3, False), (0.99 * FASTEST, False), (1.1 * FASTEST, True)])
def test_what_is_caught_on_a_corner_turns_till_it_lies(turn, found):
    assert bool(failed(landed(turn))) == found


def test_what_nothing_catches_turns_by_its_velocity_alone():
    at_rest, turned = landed(0.0), (0.0, math.sin(0.15), 0.0, math.cos(0.15) - 1.0)
    assert failed(at_rest) == []
    assert any("turns by" in each for each in failed(edited(at_rest, "body_q", (-3, 0, slice(3, 7)), turned)))
    assert any("turns by" in each for each in failed(edited(at_rest, "body_q", (3, 0, slice(3, 7)), turned)))
