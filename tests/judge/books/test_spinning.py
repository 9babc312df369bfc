"""What spins on the floor is slowed where it touches: at a cube's corners, or round a drum's rim."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.judge.theory import EDGE, G, ask, box, ground, record, times
from wsim.judge.checks.forces import CheckForces

FRICTION = 0.5
# Four corners, each with a quarter of the weight at half the diagonal; I = m a^2 / 6.
SLOWING = FRICTION * G * (EDGE / math.sqrt(2.0)) / (EDGE**2 / 6.0)  # [rad/s^2]


def spinning(rate, slowing, seconds=None):
    """A cube that turns about the upright at `rate` [rad/s], and is slowed by `slowing` [rad/s^2]."""
    until = min(0.9 * rate / slowing if slowing else 1.0, 1.0) if seconds is None else seconds
    t = times(until, 240.0)
    none = 0.0 * t
    angle, w = rate * t - slowing * t**2 / 2.0, rate - slowing * t
    return record(
        [box(friction=FRICTION)], np.stack([none, none, none + EDGE / 2], 1), np.zeros((len(t), 3)), t,
        rotation=np.stack([none, none, np.sin(angle / 2), np.cos(angle / 2)], 1),
        spin=np.stack([none, none, w], 1), statics=[ground(FRICTION)],
    )  # fmt: skip


@settings(max_examples=12, deadline=None)
@given(st.floats(8.0, 30.0))
def test_friction_at_the_corners_explains_it(rate):
    assert all(finding.passed for finding in ask(CheckForces(), spinning(rate, SLOWING)))


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.85, 1.15, 2.0])
@pytest.mark.parametrize("rate", [3.0, 20.0])
def test_what_spins_on_or_is_slowed_otherwise_is_found(rate, share):
    until = 0.5 if share * SLOWING == 0.0 else min(0.9 * rate / (share * SLOWING), 0.5)
    found = ask(CheckForces(), spinning(rate, share * SLOWING, until))
    assert not all(finding.passed for finding in found)
