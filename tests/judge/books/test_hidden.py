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


def swaying(change, moved):
    """A box on a box that changes its speed by such steps [m/s]; the lower one is `moved` [m] and told at rest."""
    t = times(1.0)
    above = np.cumsum(change(np.arange(len(t))))
    way = np.cumsum(above) * (t[1] - t[0])
    none = 0.0 * t
    under = np.where(np.arange(len(t)) > AT, moved, 0.0)
    place = np.stack([np.stack([under, none, none + EDGE / 2], 1), np.stack([way, none, none + 1.5 * EDGE], 1)], 1)
    velocity = np.zeros((len(t), 2, 3))
    velocity[:, 1, 0] = above
    return Evidence(record([box("low"), box("high")], place, velocity, t, statics=[ground()]))


def test_what_sways_under_a_box_may_have_had_what_that_lost():
    """Its momentum went through the box below, once: no faster than 4 mm/s, of a box as heavy."""
    speed = hidden(swaying(lambda k: np.where(k == 0, 4e-3, np.where(k == AT + 1, -4e-3, 0.0)), 3e-5))
    assert speed[AT, 0] == pytest.approx(4e-3)
    assert np.all(np.delete(speed[:, 0], AT) < 1e-6)


def test_what_slows_evenly_above_it_hides_nothing():
    """A friction that lasts is no jolt: nothing under it comes and goes."""
    speed = hidden(swaying(lambda k: np.where(k == 0, 0.2, -4e-3), 3e-5))
    assert np.all(speed[1:-1, 0] < 1e-6)
