"""Blows of many worlds are looked for at once: each world has those that it has by itself."""

import numpy as np

from tests.judge.checks.test_impacts import meeting, stated
from tests.judge.theory import bouncing
from wsim.judge.books.impacts import Blow, blows
from wsim.judge.checks.impacts import CheckRestitution
from wsim.judge.evidence.evidence import Evidence


def worlds():
    """Balls on the ground, of other restitutions and heights."""
    return [stated(bouncing(e, 1.5, height), e) for e, height in ((0.3, 1.0), (0.5, 0.7), (0.8, 1.6), (0.0, 0.0))]


def test_each_world_has_the_blows_that_it_has_alone():
    alone = [blows([Evidence(recording)])[0] for recording in worlds()]
    together = blows([Evidence(recording) for recording in worlds()])
    assert together == alone
    assert [len(found) > 0 for found in alone] == [True, True, True, False]
    assert [found[0].restitution for found in together[:3]] == [0.3, 0.5, 0.8]


def test_points_of_either_body_are_its_own():
    """Of pairs that meet at other times, too, where one course of each is followed for all."""
    pairs = [stated(meeting((2.0, 0.0), (0.5, 1.5), gap=gap), 0.5) for gap in (0.3, 0.5, 0.9)]
    found = blows([Evidence(recording) for recording in pairs])
    assert [blow.interval for (blow,) in found] == sorted({blow.interval for (blow,) in found})
    assert np.allclose([[blow.approach, blow.parting] for (blow,) in found], [[2.0, 1.0]] * 3)


def test_the_check_has_them_before_it_asks_each_world():
    evidence = [Evidence(recording) for recording in worlds()]
    CheckRestitution().prepare_similar(evidence)
    assert [each.kept[Blow] for each in evidence] == blows([Evidence(recording) for recording in worlds()])
