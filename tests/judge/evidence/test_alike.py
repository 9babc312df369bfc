"""Worlds of one geometry: surfaces and starts may differ, sizes and places of what stands still may not."""

import pytest

from tests.judge.theory import ball, box, ground, record, times
from wsim.judge.evidence.alike import alike, same_geometry


def world(thing, friction=0.5):
    t = times(0.1)
    place = [[[0.0, 0.0, 1.0]]] * len(t)
    return record([thing], place, [[[0.0] * 3]] * len(t), t, statics=[ground(friction)]).world


@pytest.mark.parametrize(
    ("other", "same", "geometry"),
    [
        (world(box(mass=5.0)), True, True),
        (world(box(friction=0.3)), False, True),
        (world(box(), friction=0.2), False, True),
        (world(box(velocity=(1.0, 0.0, 0.0))), False, True),
        (world(box(size=(0.3, 0.3, 0.3))), False, False),
        (world(box(kinematic=True)), False, False),
        (world(ball()), False, False),
    ],
)
def test_what_may_differ(other, same, geometry):
    one = world(box())
    assert alike(one, other) is same
    assert same_geometry(one, other) is geometry
