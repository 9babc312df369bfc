"""What a drive and dry friction give at most, where frames do not tell what they give."""

import math

import numpy as np
import pytest

from tests.judge.theory import UPRIGHT, G, ask, box, record, times
from wsim.judge.checks.forces import CheckForces
from wsim.scene.world import Body, Joint, Motor, Shape

MASS, ARM = 2.0, 0.3  # [kg], [m] from the hinge to the centre of mass
LOAD = MASS * G * ARM  # [N m]
INERTIA, CAP = 0.02, 0.2  # of a wheel [kg m^2], [N m]


def accepted(recording):
    return all(finding.passed for finding in ask(CheckForces(), recording))


def held(**fields):
    """An arm that stands out level from its hinge."""
    t = times(1.0, 60.0)
    place = np.tile([ARM, 0.0, 1.0], (len(t), 1))
    hinge = Joint(
        prim="/World/hinge", kind="revolute", parent=None, child="/World/arm", axis="Y", parent_anchor=(0, 0, 1),
        child_anchor=(-ARM, 0, 0), **fields,
    )  # fmt: skip
    return record([box("arm", (2 * ARM, 0.06, 0.06), MASS)], place, np.zeros((len(t), 3)), t, joints=[hinge])


@pytest.mark.parametrize(("share", "stands"), [(2.0, True), (1.02, True), (0.93, False), (0.5, False)])
def test_nothing_holds_more_than_its_most(share, stands):
    """By a drive so stiff that its error is below rounding, or by dry friction."""
    stiff = Motor(stiffness=1e5, damping=1e4, max_effort=share * LOAD)
    assert accepted(held(drive=stiff)) == stands
    assert accepted(held(friction=share * LOAD)) == stands


def test_a_drive_without_bound_holds_anything():
    assert accepted(held(drive=Motor(stiffness=1e5, damping=1e4)))


def hung(kind, **strength):
    """A box below a joint, its centre of mass beside it: it pulls with its weight, and a weld is bent by it, too."""
    t, off = times(1.0, 60.0), ARM if kind == "fixed" else 0.0
    joint = Joint(
        prim="/World/hook", kind=kind, parent=None, child="/World/load", parent_anchor=(0, 0, 2.0),
        child_anchor=(-off, 0, 0.5), closing=True, **strength,
    )  # fmt: skip
    place = np.tile([off, 0.0, 1.5], (len(t), 1))
    return record([box("load", mass=MASS)], place, np.zeros((len(t), 3)), t, joints=[joint])


@pytest.mark.parametrize(("share", "holds"), [(1.02, True), (0.96, False), (0.5, False)])
def test_what_may_break_bears_no_more_than_its_strength(share, holds):
    """The load is m g, and m g ARM about the weld's anchor; 0.01 of the strength is the solver's, 0.02 g the books'."""
    assert accepted(hung("spherical", break_force=share * MASS * G)) == holds
    assert accepted(hung("fixed", break_force=share * MASS * G)) == holds
    assert accepted(hung("fixed", break_torque=share * LOAD)) == holds


def spun_up(share, target=5.0):
    """A wheel that a motor, far faster than the frames, spins up by `share` of its greatest effort."""
    t = times(1.0, 60.0)
    speed_up = share * CAP / INERTIA
    when = target / speed_up
    rate = np.where(t < when, speed_up * t, target)
    angle = np.where(t < when, speed_up * t**2 / 2, target * (t - when / 2))
    none = 0.0 * t
    shape = Shape(prim="/World/wheel/g", kind="cylinder", size=(0.25, 0.05))
    wheel = Body(
        prim="/World/wheel", mass=1.0, volume=math.pi * 0.25**2 * 0.05, inertia=tuple(np.diag([INERTIA] * 3).ravel()),
        position=(0, 0, 0), rotation=UPRIGHT, shapes=[shape],
    )  # fmt: skip
    axle = Joint(
        prim="/World/axle", kind="revolute", parent=None, child="/World/wheel", axis="Z", parent_anchor=(0, 0, 1),
        child_anchor=(0, 0, 0), drive=Motor(damping=1e3, velocity=target, max_effort=CAP),
    )  # fmt: skip
    return record(
        [wheel], np.tile([0.0, 0.0, 1.0], (len(t), 1)), np.zeros((len(t), 3)), t, joints=[axle],
        rotation=np.stack([none, none, np.sin(angle / 2), np.cos(angle / 2)], 1),
        spin=np.stack([none, none, rate], 1),
    )  # fmt: skip


@pytest.mark.parametrize("share", [0.5, 0.8, 0.9, 1.1, 1.25, 4.0])
def test_a_stiff_drive_at_its_most_gives_that(share):
    assert accepted(spun_up(1.0))
    assert not accepted(spun_up(share))
