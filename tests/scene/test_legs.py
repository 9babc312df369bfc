"""Lines of straight legs and arcs: where they go, against circles."""

import math
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wsim.scene import Arc, Legs, SceneError

TURNS = st.tuples(st.floats(0.5, 50.0), st.floats(-720.0, 720.0).filter(lambda angle: abs(angle) > 0.1))


def test_a_half_circle_ends_beside_where_it_began():
    """Of 10 m to the left: 20 m to the left, and back the way it came; to the right the other way."""
    legs = Legs((1.0, 2.0), 90.0, [(1.0, 7.0), Arc(10.0, 180.0), (-19.0, 0.0), Arc(5.0, -90.0)])
    assert np.array(legs.ends()) == pytest.approx(
        np.array([(1.0, 7.0), (-19.0, 7.0), (-19.0, 0.0), (-24.0, -5.0)]), abs=1e-9
    )
    line = legs.line()
    over = line[line[:, 1] > 7.0 + 1e-9]
    assert np.hypot(over[:, 0] + 9.0, over[:, 1] - 7.0) == pytest.approx(np.full(len(over), 10.0), rel=1e-9)
    assert np.linalg.norm(np.diff(line, axis=0), axis=1).max() <= 0.5 + 1e-9


@given(st.floats(-360.0, 360.0), st.lists(TURNS, min_size=1, max_size=4))
def test_arcs_follow_each_other_without_a_kink(heading, turns):
    """No piece turns from the one before by more than 5 degrees; the last goes on as all angles say, to half of it."""
    line = Legs((3.0, -4.0), heading, [Arc(*turn) for turn in turns]).line()
    way = np.diff(line, axis=0)
    bend = np.diff(np.unwrap(np.arctan2(way[:, 1], way[:, 0])))
    assert np.abs(bend).max(initial=0.0) <= math.radians(5.0) + 1e-6
    last = math.radians(heading + sum(angle for _, angle in turns)) - math.atan2(way[-1, 1], way[-1, 0])
    assert abs(math.remainder(last, 2.0 * math.pi)) <= math.radians(2.5) + 1e-6
    length = sum(radius * math.radians(abs(angle)) for radius, angle in turns)
    assert np.linalg.norm(way, axis=1).sum() == pytest.approx(length, rel=1e-3)


def test_a_stretch_says_how_long_it_is_and_where_it_goes():
    """A quarter of 8 m, then back at an angle of atan2(-3, 4) to +X."""
    arc, back = Legs((0.0, 0.0), 0.0, [Arc(8.0, 90.0), (12.0, 5.0)]).stretches()
    assert (arc.enters, arc.leaves, arc.length) == pytest.approx((0.0, 0.5 * math.pi, 4.0 * math.pi))
    assert (back.enters, back.leaves, back.length) == pytest.approx((*[math.atan2(-3.0, 4.0)] * 2, 5.0))


@pytest.mark.parametrize(
    ("legs", "says"),
    [
        ([], "legs has none; give a point or an Arc"),
        ([Arc(0.0, 90.0)], "legs[0].radius = 0 must be >= 0.1 m"),
        ([Arc(5.0, 0.0)], "legs[0].angle_deg = 0 turns by nothing"),
        ([(5.0, 0.0), Arc(10.0, 1e-6)], "legs[1].angle_deg = 1e-06 makes an arc of 1.7e-07 m; leave it out"),
        ([Arc(500.0, 900.0), Arc(500.0, 900.0)], "legs[1] ends 15708 m along the line, which is 10000 m long at most"),
        ([Arc(5.0, math.nan)], "legs[0].angle_deg = nan must be finite"),
        ([(5.0, 0.0), (5.0, 0.0)], "legs[1] = (5.0, 0.0) is where the leg before it ends"),
        ([(1.0, 2.0, 3.0)], "legs[0] = (1.0, 2.0, 3.0) has 3 numbers"),
        (5.0, "legs"),
    ],
)
def test_what_is_no_leg_is_named(legs, says):
    with pytest.raises(SceneError, match=re.escape(says)):
        Legs((0.0, 0.0), 0.0, legs).line()
