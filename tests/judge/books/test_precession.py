"""A gyroscope that a ball joint holds: it precesses as its weight turns its spin (Goldstein, Classical Mechanics, 5.7)."""

import math

import numpy as np
import pytest

from tests.judge.theory import UPRIGHT, G, ask, record, times
from wsim.geometry.rotations import multiply
from wsim.judge.checks.forces import CheckForces
from wsim.scene.world import Body, Joint, Shape

MASS, RADIUS, ARM, SPIN = 1.0, 0.15, 0.1, 200.0  # [kg], [m], [m] from the pivot, [rad/s]
AXIAL = 0.5 * MASS * RADIUS**2
ACROSS = 0.25 * MASS * RADIUS**2 + MASS * 0.01**2 / 12.0


def gyroscope(share):
    """A level disk that goes round its pivot at `share` of the rate m g l / (I w) that holds it level."""
    t = times(1.0, 120.0)
    rate = share * MASS * G * ARM / (AXIAL * SPIN)
    round_, own, none = rate * t, SPIN * t, 0.0 * t
    axis = np.stack([np.cos(round_), np.sin(round_), none], 1)
    tip = np.tile([0.0, math.sin(math.pi / 4), 0.0, math.cos(math.pi / 4)], (len(t), 1))  # its Z is along the axle
    yaw = np.stack([none, none, np.sin(round_ / 2), np.cos(round_ / 2)], 1)
    roll = np.stack([none, none, np.sin(own / 2), np.cos(own / 2)], 1)
    shape = Shape(prim="/World/disk/g", kind="cylinder", size=(RADIUS, 0.01))
    disk = Body(
        prim="/World/disk", mass=MASS, volume=math.pi * RADIUS**2 * 0.01, shapes=[shape], position=(0, 0, 0),
        inertia=tuple(np.diag([ACROSS, ACROSS, AXIAL]).ravel()), rotation=UPRIGHT,
    )  # fmt: skip
    pivot = Joint(
        prim="/World/pivot", kind="spherical", parent=None, child="/World/disk", parent_anchor=(0, 0, 1),
        child_anchor=(0, 0, -ARM),
    )  # fmt: skip
    return record(
        [disk], ARM * axis + [0.0, 0.0, 1.0], rate * ARM * np.stack([-axis[:, 1], axis[:, 0], none], 1), t,
        rotation=multiply(multiply(yaw, tip), roll), spin=SPIN * axis + [0.0, 0.0, rate], joints=[pivot],
    )  # fmt: skip


def accepted(recording):
    return all(finding.passed for finding in ask(CheckForces(), recording))


@pytest.mark.parametrize("share", [0.8, 0.88, 0.95, 1.05, 1.12, 1.2])
def test_another_rate_is_found(share):
    assert accepted(gyroscope(1.0))
    assert not accepted(gyroscope(share))
