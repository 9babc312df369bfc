"""What is wrong with a drive is told by how its joint moved: x'' = k (p - x) - c x' - load, in closed form."""

import math

import numpy as np
import pytest

from tests.judge.theory import UPRIGHT, box, record, times
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.repair.drive import by_drive, stronger, to_point
from wsim.scene.world import Joint, Motor

MASS = 4.0
PRIM = "/World/block"


def on_a_rail(motor, x, effort=None, seconds=3.0):
    """A block whose way along x is told, on a rail with a motor."""
    t = times(seconds)
    way = x(t)
    place = np.stack([way, 0.0 * t, 0.0 * t + 0.5], axis=1)
    speed = np.stack([np.gradient(way, t), 0.0 * t, 0.0 * t], axis=1)
    rail = Joint(prim="/World/rail", kind="prismatic", parent=None, child=PRIM, axis="X", drive=motor,
                 parent_anchor=(0.0, 0.0, 0.5), child_anchor=(0.0, 0.0, 0.0))  # fmt: skip
    scalars = {} if effort is None else {"drive/rail": np.full(len(t), effort)}
    return Evidence(record([box("block", mass=MASS)], place, speed, t, joints=[rail], scalars=scalars))


def damped(k, c, p):
    """The way of an overdamped block from 0 to p."""
    root = math.sqrt(c**2 - 4.0 * k * MASS)
    fast, slow = (-c - root) / (2 * MASS), (-c + root) / (2 * MASS)
    return lambda t: p * (1.0 - (fast * np.exp(slow * t) - slow * np.exp(fast * t)) / (fast - slow))


def test_a_drive_at_its_limit_is_to_be_as_strong_as_its_gains_ask():
    motor = Motor(position=0.4, stiffness=500.0, damping=50.0, max_effort=20.0)
    evidence = on_a_rail(motor, lambda t: 0.0 * t, effort=20.0)
    target = by_drive(evidence, PRIM, None, "")
    assert (target.parameter, target.direction, target.current) == ("drive.max_force", "raise", 20.0)
    assert target.suggested == pytest.approx(1.1 * 500.0 * 0.4) and target.unit == "N"
    # Where its gains ask for no more than it has, a greater bound does nothing.
    assert stronger(evidence.world.joints[0], motor.model_copy(update={"max_effort": 300.0})).suggested is None


def test_a_drive_that_is_too_slow_is_to_be_stiffer_so_that_it_gets_there():
    k, c, p = 10.0, 60.0, 0.5
    target = by_drive(on_a_rail(Motor(position=p, stiffness=k, damping=c), damped(k, c, p)), PRIM, None, "")
    assert (target.parameter, target.direction) == ("drive.stiffness", "raise")
    assert damped(target.suggested, c, p)(np.array([3.0]))[0] == pytest.approx(p, rel=0.02)


def test_a_drive_that_its_load_holds_short_is_to_be_as_much_stiffer():
    """At rest it is off by load / k: with k' = k off / (0.02 p) by a fiftieth."""
    k, p, off = 100.0, 0.5, 0.2
    motor = Motor(position=p, stiffness=k, damping=40.0)
    target = by_drive(on_a_rail(motor, lambda t: (p - off) * np.minimum(t, 1.0)), PRIM, None, "")
    assert target.parameter == "drive.stiffness"
    assert k * off / target.suggested == pytest.approx(0.02 * p)


def test_a_drive_that_swings_is_to_be_damped_critically():
    """Of a block on a spring of k = m w^2 that is 2 m w."""
    k, p = 400.0, 0.3
    w = math.sqrt(k / MASS)
    motor = Motor(position=p, stiffness=k, damping=1.0)
    target = by_drive(on_a_rail(motor, lambda t: p - p * np.cos(w * t)), PRIM, None, "")
    assert (target.parameter, target.direction) == ("drive.damping", "raise")
    assert target.suggested == pytest.approx(2.0 * MASS * w, rel=0.05)


def test_a_drive_that_gets_where_it_is_set_to_is_to_be_set_elsewhere():
    k, c, p = 400.0, 100.0, 0.5
    evidence = on_a_rail(Motor(position=p, stiffness=k, damping=c), damped(k, c, p))
    target = by_drive(evidence, PRIM, 1.6, "")
    assert (target.parameter, target.direction, target.suggested) == ("drive.position", "raise", pytest.approx(0.8))
    assert by_drive(evidence, PRIM, None, "").suggested is None
    there = to_point(evidence, PRIM, np.array([0.8, 0.0, 0.5]), None)
    assert (there.parameter, there.suggested) == ("drive.position", pytest.approx(0.8))


def test_a_motor_is_to_be_as_fast_as_the_point_is_far_round():
    """A pin on a wheel about Y, a quarter turn from the lowest point, that is to be there after half a second."""
    t = times(1.0)
    angle = -1.0 * t
    place = np.stack([0.4 * np.cos(angle), 0.0 * t, 1.0 - 0.4 * np.sin(angle)], axis=1)
    zero = 0.0 * t
    turn = np.stack([zero, np.sin(angle / 2), zero, np.cos(angle / 2)], axis=1)
    speed = np.gradient(place, t, axis=0)
    axle = Joint(prim="/World/axle", kind="revolute", parent=None, child="/World/pin", axis="Y",
                 parent_anchor=(0.0, 0.0, 1.0), child_anchor=(-0.4, 0.0, 0.0), parent_turn=UPRIGHT,
                 drive=Motor(velocity=-1.0, damping=5.0))  # fmt: skip
    evidence = Evidence(record([box("pin", (0.1, 0.1, 0.1))], place, speed, t, rotation=turn, joints=[axle]))
    target = to_point(evidence, "/World/pin", np.array([0.0, 0.0, 0.6]), (0.4, 0.6))
    assert (target.parameter, target.unit) == ("drive.velocity", "rad/s")
    assert target.suggested == pytest.approx(math.pi, rel=0.01)  # a quarter turn the other way in half a second
    # Where its own speed would do the other way round, it is that.
    later = to_point(evidence, "/World/pin", np.array([0.0, 0.0, 0.6]), (1.0, 1.6))
    assert later.suggested == pytest.approx(1.0)
