"""Worlds of one geometry: surfaces and starts may differ, sizes and places of what stands still may not.

Of one form: these may, too.
"""

import pytest

from tests.judge.theory import ball, box, ground, record, times
from wsim.judge.evidence.alike import alike, same_form, same_geometry


def world(thing, friction=0.5):
    t = times(0.1)
    place = [[[0.0, 0.0, 1.0]]] * len(t)
    return record([thing], place, [[[0.0] * 3]] * len(t), t, statics=[ground(friction)]).world


@pytest.mark.parametrize(
    ("other", "same", "geometry", "form"),
    [
        (world(box(mass=5.0)), True, True, True),
        (world(box(friction=0.3)), False, True, True),
        (world(box(), friction=0.2), False, True, True),
        (world(box(velocity=(1.0, 0.0, 0.0))), False, True, True),
        (world(box(size=(0.3, 0.3, 0.3))), False, False, True),
        (world(box(kinematic=True)), False, False, False),
        (world(ball()), False, False, False),
    ],
)
def test_what_may_differ(other, same, geometry, form):
    one = world(box())
    assert same_form(one, other) is form
    assert alike(one, other) is same
    assert same_geometry(one, other) is geometry
