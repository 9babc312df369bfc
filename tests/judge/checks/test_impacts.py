"""Blows by closed form: bodies part by the restitution that their pair states, or the check says so."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.judge.theory import EDGE, RADIUS, ask, ball, bouncing, box, ground, only, record, times, with_world
from wsim.judge.checks.impacts import CheckRestitution


def stated(recording, restitution):
    """The same motion where both surfaces state a restitution."""

    def bouncy(thing):
        shapes = [shape.model_copy(update={"restitution": restitution}) for shape in thing.shapes]
        return thing.model_copy(update={"shapes": shapes})

    world = recording.world
    return with_world(
        recording, bodies=[bouncy(b) for b in world.bodies], statics=[bouncy(static) for static in world.statics]
    )


@given(
    real=st.floats(0.0, 1.0), said=st.floats(0.0, 1.0), height=st.floats(0.3, 5.0), rate=st.sampled_from([24.0, 60.0])
)
@settings(max_examples=25, deadline=None)
def test_a_bounce_is_accepted_where_it_is_as_stated_and_nowhere_else(real, said, height, rate):
    findings = ask(CheckRestitution(), stated(bouncing(real, 1.5, height, rate), said))
    assert all(finding.passed for finding in ask(CheckRestitution(), stated(bouncing(real, 1.5, height, rate), real)))
    # What is to rebound for less than a frame may have bounced twice: no single blow is to be seen.
    approach = np.sqrt(2.0 * 9.81 * height)
    if abs(real - said) >= 0.1 and 2.0 * min(real, said) * approach / 9.81 > 2.0 / rate:
        finding = only(findings)
        assert not finding.passed
        assert finding.value / finding.expected == pytest.approx(real / said, rel=0.06)


def meeting(before, after, mass=4.0, gap=0.5, seconds=1.0):
    """Two balls on a line, weightless, that meet and go on at other speeds."""
    t = times(seconds)
    when = gap / (before[0] - before[1])
    x = [np.where(t < when, start + v * t, start + v * when + u * (t - when))
         for start, v, u in zip((0.0, gap + 2.0 * RADIUS), before, after, strict=True)]  # fmt: skip
    v = [np.where(t < when, a, b) for a, b in zip(before, after, strict=True)]
    place, speed = (np.stack([np.stack([each, 0 * t, 0 * t], axis=1) for each in rows], axis=1) for rows in (x, v))
    recording = record([ball("one", mass), ball("two", mass)], place, speed, t)
    return with_world(recording, gravity=(0.0, 0.0, 0.0))


@pytest.mark.parametrize(("after", "restitution", "sound"), [
    ((0.0, 2.0), 1.0, True), ((0.5, 1.5), 0.5, True), ((1.0, 1.0), 0.0, True),
    ((0.5, 1.5), 0.8, False), ((-0.2, 2.2), 1.0, False), ((1.0, 1.0), 0.5, False), ((0.0, 2.0), 0.5, False),
])  # fmt: skip
def test_two_balls_part_as_their_restitution_has_it(after, restitution, sound):
    finding = only(ask(CheckRestitution(), stated(meeting((2.0, 0.0), after), restitution)))
    assert finding.passed is sound


def test_what_is_gained_and_what_is_lost_are_told_apart():
    gained, lost = (
        only(ask(CheckRestitution(), stated(meeting((2.0, 0.0), after), 0.5))) for after in ((0.0, 2.0), (0.9, 1.1))
    )
    assert (gained.target.direction, lost.target.direction) == ("lower", "raise")


@pytest.mark.parametrize(("spin", "asked"), [(0.0, 1), (3.0, 0)])
def test_a_box_that_turns_is_no_blow_of_two_points(spin, asked):
    """One edge parts while the other still comes: Newton's law holds for a point, which the frames do not show."""
    t = times(0.5)
    turning = np.stack([0 * t, spin + 0 * t, 0 * t], axis=1)
    place = np.stack([0 * t, 0 * t, EDGE / 2 + np.where(t < 0.255, 3.0 * (0.255 - t), 0.0)], axis=1)
    speed = np.stack([0 * t, 0 * t, np.where(t < 0.255, -3.0, 0.0)], axis=1)
    recording = record([box()], place, speed, t, spin=turning, statics=[ground()])
    assert len(ask(CheckRestitution(), with_world(recording, gravity=(0.0, 0.0, 0.0)))) == asked
