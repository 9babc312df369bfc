"""A block on a spring without gravity: its amplitude goes with exp(-c t / 2 m), of the damping c that is stated."""

import math

import numpy as np
import pytest

from tests.judge.theory import ask, box, record, times, with_world
from wsim.judge.checks.forces import CheckForces
from wsim.scene.world import Guide, Spring

MASS, STIFFNESS, LONG, START = 4.0, 160.0, 1.0, 0.3  # [kg], [N/m], [m], [m]


def swinging(damping, stated):
    """It swings as `damping` [N s/m] has it, in a world that states another."""
    t = times(2.0, 60.0)
    decay = damping / (2.0 * MASS)
    omega = math.sqrt(STIFFNESS / MASS - decay**2)
    fade, none = START * np.exp(-decay * t), 0.0 * t
    way = fade * np.cos(omega * t)
    speed = -fade * (decay * np.cos(omega * t) + omega * np.sin(omega * t))
    made = record([box()], np.stack([LONG + way, none, none], 1), np.stack([speed, none, none], 1), t)
    ends = [Guide(position=(0, 0, 0)), Guide(body="/World/box", owner="/World/box", position=(0, 0, 0))]
    coil = Spring(
        prim="/World/coil", path=ends, radius=0.01, stiffness=STIFFNESS, damping=stated, rest_length=LONG
    )  # fmt: skip
    return with_world(made, springs=[coil], gravity=(0.0, 0.0, 0.0))


def accepted(recording):
    return all(finding.passed for finding in ask(CheckForces(), recording))


@pytest.mark.parametrize("damping", [0.0, 2.0, 8.0])
def test_what_is_damped_as_stated_is_accepted(damping):
    assert accepted(swinging(damping, damping))


@pytest.mark.parametrize(("damping", "stated"), [(2.0, 2.3), (2.0, 1.7), (8.0, 9.2), (0.0, 1.0)])
def test_another_damping_is_found(damping, stated):
    """15 % more or less than stated."""
    assert not accepted(swinging(damping, stated))


def test_a_fifth_of_the_amplitude_lost_is_found():
    """In a second, where no damping is stated: exp(-c / 2 m) = 0.8."""
    assert not accepted(swinging(-2.0 * MASS * math.log(0.8), 0.0))
