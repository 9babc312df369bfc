"""Motion through key frames: exact at the keys, without a jump of velocity, without overshoot."""

import numpy as np
import pytest

from wsim.geometry.paths import Curve, exponential, logarithm
from wsim.geometry.rotations import conjugate, multiply

TIMES = np.array([0.0, 0.7, 1.0, 2.5, 3.0])
PLACES = np.array([[0, 0, 0], [1, 0, 2], [1, 1, 2], [3, -1, 2.5], [0, 0, 0]], dtype=float)
TURNS = exponential(np.array([[0, 0, 0], [0.4, 0, 2.0], [1.0, -1.0, 0.5], [0.2, 0.1, -1.5], [0, 0, 0]]))


def velocity(curve, time, h=1e-6):
    """Velocity and angular velocity in the turned axes, by differences."""
    (x0, q0), (x1, q1) = curve.pose(time - h), curve.pose(time + h)
    return np.concatenate([x1 - x0, logarithm(multiply(conjugate(q0), q1))]) / (2 * h)


@pytest.mark.parametrize("repeat", [False, True])
def test_it_meets_the_keys_and_its_velocity_does_not_jump(repeat):
    curve = Curve.through(TIMES, PLACES, TURNS, repeat)
    for time, place, turn in zip(TIMES, PLACES, TURNS, strict=True):
        x, q = curve.pose(time)
        assert np.abs(x - place).max() < 1e-12
        assert abs(abs(q @ turn) - 1.0) < 1e-12
        if repeat and time == 0.0:
            continue  # it starts at speed, and comes round to that
        before, after = (velocity(curve, time + side) for side in (-1e-4, 1e-4))
        assert np.abs(before - after).max() < 0.05
    if not repeat:
        assert np.abs(velocity(curve, 1e-4)).max() < 0.01 and np.abs(curve.pose(9.0)[0]).max() < 1e-12
    else:
        assert np.abs(curve.pose(3.0 + 1.3)[0] - curve.pose(1.3)[0]).max() < 1e-9


def test_what_waits_stands_still_and_nothing_overshoots():
    curve = Curve.through([0, 1, 2, 3], [[0, 0, 0], [0, 0, 1], [0, 0, 1], [0, 0, 3]], [[0, 0, 0, 1]] * 4)
    heights = np.array([curve.pose(t)[0][2] for t in np.linspace(0, 3, 301)])
    assert np.abs(heights[100:201] - 1.0).max() < 1e-12
    assert np.diff(heights).min() > -1e-12


def test_equal_steps_are_one_speed():
    keys = np.arange(6.0)
    turns = exponential(np.outer(keys, [0, 0, 0.5]))
    curve = Curve.through(keys, np.outer(keys, [2.0, 0, 0]), turns)
    assert velocity(curve, 2.5) == pytest.approx([2, 0, 0, 0, 0, 0.5], abs=1e-6)
    assert max(curve.speeds()[0][1:-1]) == pytest.approx(2.0) and max(curve.speeds()[1][1:-1]) == pytest.approx(0.5)


@pytest.mark.parametrize("repeat", [False, True])
def test_its_velocity_is_the_rate_of_its_pose(repeat):
    curve, h = Curve.through(TIMES, PLACES, TURNS, repeat), 1e-6
    for time in (1e-3, 0.3, 0.8, 1.7, 2.9, *((3.4, 5.0) if repeat else ())):
        (x0, q0), (x1, q1) = curve.pose(time - h), curve.pose(time + h)
        v, w = curve.velocity(time)
        assert v == pytest.approx((x1 - x0) / (2 * h), abs=1e-6)
        assert w == pytest.approx(logarithm(multiply(q1, conjugate(q0))) / (2 * h), abs=1e-6)
    before, after = curve.velocity(-0.1), curve.velocity(9.1)
    assert not np.any(before) and (repeat or not np.any(after))
