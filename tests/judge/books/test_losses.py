"""What is lost is as wrong as what is gained: energy that nothing takes leaves a force that nothing gives."""

import numpy as np
import pytest

from tests.judge.theory import RADIUS, ask, ball, ground, record, swinging, times, with_world
from wsim.judge.checks.forces import CheckForces


def flying(loss):
    """A ball without gravity that keeps exp(-loss t) of its energy; its velocity goes with its places."""
    t = times(1.0, 60.0)
    rate = loss / 2.0
    way = 3.0 * (t if rate == 0.0 else (1.0 - np.exp(-rate * t)) / rate)
    return along(way, 3.0 * np.exp(-rate * t), t, height=2.0, spin=0.0)


def rolling(loss):
    """A ball on the ground that rolls on and keeps exp(-loss t) of its energy; its surfaces state no resistance."""
    t = times(1.0, 60.0)
    rate = loss / 2.0
    way = 2.0 * (t if rate == 0.0 else (1.0 - np.exp(-rate * t)) / rate)
    return along(way, 2.0 * np.exp(-rate * t), t, height=RADIUS, spin=1.0 / RADIUS)


def along(way, speed, t, height, spin):
    none = 0.0 * t
    angle = spin * way / 2.0
    gravity = {"statics": [ground()]} if spin else {}
    made = record(
        [ball()], np.stack([way, none, none + height], 1), np.stack([speed, none, none], 1), t,
        rotation=np.stack([none, np.sin(angle), none, np.cos(angle)], 1),
        spin=np.stack([none, spin * speed, none], 1), **gravity,
    )  # fmt: skip
    return made if spin else with_world(made, gravity=(0.0, 0.0, 0.0))


MOTIONS = {"swings": lambda loss: swinging(-loss), "flies": flying, "rolls": rolling}


def off(recording):
    return [finding.message for finding in ask(CheckForces(), recording) if not finding.passed]


@pytest.mark.parametrize("name", MOTIONS)
def test_a_tenth_of_its_energy_a_second_goes_nowhere(name):
    assert off(MOTIONS[name](0.0)) == []
    assert off(MOTIONS[name](0.1)) != []


def test_five_per_cent_a_swing_go_nowhere():
    """In a swing of 1.6 s: 3 % a second."""
    assert off(swinging(-0.03)) != []
