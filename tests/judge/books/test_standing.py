"""What stands is carried by what touches it; a gap that one interval could close carries nothing for many."""

import numpy as np
import pytest

from tests.judge.theory import EDGE, G, ask, ball, box, edited, ground, record, resting, times
from wsim.judge.checks.forces import CheckForces


def off(recording):
    return [finding for finding in ask(CheckForces(), recording) if not finding.passed]


def lifted(by):
    return edited(resting(), "body_q", (slice(None), 0, 2), by)


@pytest.mark.parametrize("gap", [0.0, 1e-5])
def test_what_stands_on_the_ground_is_sound(gap):
    assert off(lifted(gap)) == []


@pytest.mark.parametrize("gap", [5e-4, 2e-3, 4e-3])
def test_what_hovers_by_less_than_it_would_fall_in_a_frame_is_found(gap):
    """At 30 frames a second that is 5.4 mm; its whole weight is missing."""
    found = off(lifted(gap))
    assert found[-1].value == pytest.approx(4.0 * G, rel=0.01)
    assert "too far away" in found[-1].message


def test_what_may_be_carried_by_what_goes_by_is_not_asked():
    """A ball that rolls along under a hovering box may hold it up, where the frames do not show it."""
    t = times(1.0)
    none = 0.0 * t
    places = np.stack([np.stack([none, none, none + EDGE / 2 + 2e-3], 1), np.stack([t - 0.5, none, none + 0.1], 1)], 1)
    speeds = np.stack([np.zeros((len(t), 3)), np.stack([none + 1.0, none, none], 1)], 1)
    recording = record([box(), ball()], places, speeds, t, statics=[ground()])
    assert not any("too far away" in finding.message for finding in off(recording))
