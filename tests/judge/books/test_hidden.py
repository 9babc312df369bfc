"""A box that a ball sets going and friction stops before the next frame has moved, and no frame shows its speed."""

import numpy as np
import pytest

from tests.judge.theory import EDGE, RADIUS, ask, ball, box, ground, record, times
from wsim.judge.books.hidden import hidden
from wsim.judge.checks.continuity import CheckContinuity
from wsim.judge.evidence.evidence import Evidence

SPEED, BACK, AT = 3.0, -1.0, 10  # [m/s]; the interval of the blow
SHARE = 0.5  # of the interval, after which the blow comes


def struck(moved, beside=0.0, back=BACK):
    """A ball that flies at a box and comes off it; the box is `moved` [m] by the next frame, and stands again."""
    t = times(1.0)
    after = np.arange(len(t)) > AT
    blow = t[AT] + SHARE * (t[1] - t[0])
    way = np.where(after, back * (t - blow), SPEED * (t - blow))
    none = 0.0 * t
    place = np.stack([np.stack([way - RADIUS - EDGE / 2, none + beside, none + RADIUS], 1),
                      np.stack([np.where(after, moved, 0.0), none, none + EDGE / 2], 1)], 1)  # fmt: skip
    velocity = np.zeros((len(t), 2, 3))
    velocity[:, 0, 0] = np.where(after, back, SPEED)
    return record([ball(), box()], place, velocity, t, statics=[ground()])


def drifts(recording):
    return not ask(CheckContinuity(), recording)[2].passed


def test_a_box_that_was_hit_and_stopped_has_moved():
    """It may have had the ball's momentum: 4 m/s of a box as heavy as the ball, for 1 / 30 s at most."""
    speed = hidden(Evidence(struck(2e-3)))
    assert speed[AT, 1] == pytest.approx(SPEED - BACK, rel=0.1)
    assert np.all(np.delete(speed[:, 1], AT) < 0.01)
    assert not drifts(struck(2e-3))


def test_a_box_that_nothing_hits_has_not():
    assert drifts(struck(2e-3, back=SPEED, beside=1.0))  # the ball flies past
    assert drifts(struck(2e-3, beside=5.0))  # and comes off something else


def test_it_goes_no_farther_than_its_speed_takes_it():
    assert not all(finding.passed for finding in ask(CheckContinuity(), struck(0.3)))
