"""Poses alone: what lasts is found by second differences, and what is sound stays so."""

import numpy as np
import pytest

from tests.judge.theory import EDGE, RADIUS, G, ask, bouncing, sliding, swinging, thrown
from wsim.importers.trajectory import from_arrays
from wsim.judge.checks.forces import CheckForces


def poses_of(recording, lifted=0.0):
    """Its poses, with velocities left out."""
    q = np.array(recording.body_q, dtype=np.float64)
    q[..., 2] += lifted
    names = np.array([body.prim for body in recording.world.bodies])
    return from_arrays({"time": recording.time, "body_names": names, "body_q": q}, recording.world)


def failed(recording):
    return [finding.message for finding in ask(CheckForces(), recording) if not finding.passed]


SOUND = {
    "slides": lambda: sliding(0.5 * G), "flies": thrown, "bounces": lambda: bouncing(0.7),
    "swings": lambda: swinging(0.0), "stands": lambda: sliding(0.0, 0.0),
}  # fmt: skip


@pytest.mark.parametrize("name", SOUND)
def test_what_is_sound_is_accepted(name):
    assert failed(poses_of(SOUND[name]())) == []


@pytest.mark.parametrize("share", [0.5, 0.8, 1.25, 2.0])
def test_another_friction_is_found(share):
    assert failed(poses_of(sliding(share * 0.5 * G)))


def test_what_hovers_is_found():
    """By a fifth of its size, and by half its radius."""
    assert failed(poses_of(sliding(0.0, 0.0), lifted=0.2 * EDGE))
    assert failed(poses_of(sliding(0.5 * G), lifted=0.5 * RADIUS))


def test_another_gravity_is_found():
    assert failed(poses_of(thrown(g=0.9 * G)))


def test_a_swing_that_gains_is_found():
    assert failed(poses_of(swinging(0.5)))
