"""A stop and a rope hold what comes to their end, and throw nothing back."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.judge.theory import RADIUS, ask, ball, box, record, times, with_world
from wsim.judge.checks.catches import CheckCatches
from wsim.scene.world import Guide, Joint, Rope

WHEN, SPEED = 0.5125, 2.0  # [s], [rad/s] or [m/s]


def turned_back(share):
    """A door without weight that comes to its stop, and goes back at a share of its speed."""
    t = times(1.0, 60.0)
    since = t - WHEN
    angle = SPEED * np.where(since < 0.0, since, -share * since)
    rate = SPEED * np.where(since < 0.0, 1.0, -share)
    none, long = 0.0 * t, 0.4
    place = long * np.stack([np.cos(angle), np.sin(angle), none], 1)
    hinge = Joint(
        prim="/World/hinge", kind="revolute", parent=None, child="/World/door", axis="Z", parent_anchor=(0, 0, 0),
        child_anchor=(-long, 0, 0), low=-2.0, high=0.0,
    )  # fmt: skip
    made = record(
        [box("door", (2 * long, 0.04, 0.3))], place, rate[:, None] * np.stack([-place[:, 1], place[:, 0], none], 1), t,
        rotation=np.stack([none, none, np.sin(angle / 2), np.cos(angle / 2)], 1), spin=np.stack([none, none, rate], 1),
        joints=[hinge],
    )  # fmt: skip
    return with_world(made, gravity=(0.0, 0.0, 0.0))


def pulled_back(share):
    """A ball without weight that comes to the end of its rope, and goes back at a share of its speed."""
    t = times(1.0, 60.0)
    since, none = t - WHEN, 0.0 * t
    way = 3.0 + SPEED * np.where(since < 0.0, since, -share * since)
    rate = SPEED * np.where(since < 0.0, 1.0, -share)
    made = record([ball()], np.stack([way, none, none], 1), np.stack([rate, none, none], 1), t)
    ends = [Guide(position=(0, 0, 0)), Guide(body="/World/ball", owner="/World/ball", position=(-RADIUS, 0, 0))]
    rope = Rope(prim="/World/rope", path=ends, radius=0.01, length=3.0 - RADIUS)
    return with_world(made, ropes=[rope], gravity=(0.0, 0.0, 0.0))


def failed(recording):
    return [finding.message for finding in ask(CheckCatches(), recording) if not finding.passed]


@pytest.mark.parametrize("motion", [turned_back, pulled_back])
def test_what_comes_to_its_end_stays_there(motion):
    assert failed(motion(0.0)) == []
    for share in (0.1, 0.5, 1.0):
        assert len(failed(motion(share))) == 1


def test_a_pendulum_leaves_its_stop_as_its_weight_takes_it():
    """A rod is let go from rest at its stop: what takes it away is gravity."""
    t = times(0.5, 60.0)
    angle, none = 1.2 * np.cos(3.0 * t) - 1.2, 0.0 * t  # small beside a turn: near enough to what gravity does
    place = np.stack([0.4 * np.cos(angle), 0.4 * np.sin(angle), none], 1)
    rate = -3.6 * np.sin(3.0 * t)
    hinge = Joint(
        prim="/World/hinge", kind="revolute", parent=None, child="/World/rod", axis="Z", parent_anchor=(0, 0, 0),
        child_anchor=(-0.4, 0, 0), low=-math.pi, high=0.0,
    )  # fmt: skip
    made = record(
        [box("rod", (0.8, 0.04, 0.04))], place, rate[:, None] * np.stack([-place[:, 1], place[:, 0], none], 1), t,
        rotation=np.stack([none, none, np.sin(angle / 2), np.cos(angle / 2)], 1), spin=np.stack([none, none, rate], 1),
        joints=[hinge],
    )  # fmt: skip
    assert failed(made) == []


def test_what_comes_nearer_by_less_than_places_are_rounded_to_is_no_catch():
    """At rest at its stop a rod's rate is noise of either sign: of 1e-5 rad/s it goes by a quarter of rounding."""
    made = turned_back(0.0)
    rate, back = 1.5e-5, 4.7e-7  # for two frames each, so that nothing else shows that may have turned it
    for scale, count in ((1.0, 0), (10.0, 1)):
        noise = np.zeros_like(made.body_qd)
        noise[38:40, 0, 1], noise[40:42, 0, 1] = 0.4 * rate * scale, -0.4 * back * scale
        noise[38:40, 0, 5], noise[40:42, 0, 5] = rate * scale, -back * scale
        assert len(failed(replace(made, body_qd=made.body_qd + noise))) == count
