"""What a course may err by: a body that spins about another axis than its own speeds up another way by then."""

import numpy as np
import pytest

from tests.judge.theory import RADIUS, ball, record, times
from wsim.judge.books.courses import Courses
from wsim.judge.evidence.evidence import Evidence

RATE, PRECESSES, SPIN = 60.0, 8.0, 2.0  # [Hz], [rad/s], [rad/s]


def going_round(evidence_of):
    """A ball whose rates go round, with a blow in interval 5 that nothing shows."""
    t = times(0.2, RATE)
    spin = SPIN * np.stack([np.cos(evidence_of * t), np.sin(evidence_of * t), 0.0 * t], 1)
    evidence = Evidence(record([ball()], np.tile((0.0, 0.0, 5.0 * RADIUS), (len(t), 1)), np.zeros((len(t), 3)), t,
                               spin=spin))  # fmt: skip
    changed = np.zeros((len(t) - 1, 1), dtype=bool)
    changed[5] = True
    return Courses([evidence], changed)


@pytest.mark.parametrize(("side", "share"), [(0, 1.0), (0, 0.3), (1, 0.0), (1, 0.7)])
def test_it_is_what_the_rates_go_round_by(side, share):
    """The course keeps one rate of change, SPIN P; that has gone round by P t: the second order, known to an eighth."""
    courses = going_round(PRECESSES)
    h, when = 1.0 / RATE, share / RATE
    true = SPIN * np.array([np.cos(PRECESSES * (5 * h + when)), np.sin(PRECESSES * (5 * h + when)), 0.0])
    error = np.linalg.norm(courses.at(5, side, when).w[0] - true)
    assert np.linalg.norm(courses.off(5, side, when)[0, 3:]) == pytest.approx(error, rel=0.125)


def test_what_speeds_up_evenly_has_no_error():
    courses = going_round(0.0)
    assert np.abs(courses.off(5, 0, 0.01)).max() == np.abs(courses.off(5, 1, 0.01)).max() == 0.0
