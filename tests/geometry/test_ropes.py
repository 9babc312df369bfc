"""The straight parts of ropes against the length of their way: a taut rope pulls by T times the way's gradient."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wsim.geometry.ropes import Stop, path_length, strands


def any_way(seed, groove):
    """Two points, each on its side of a cylinder of any axis, with a point before it."""
    rng = np.random.default_rng(seed)
    axis, side = rng.normal(size=(2, 3))
    axis /= np.linalg.norm(axis)
    side -= (side @ axis) * axis
    along = np.cross(axis, side / np.linalg.norm(side))
    down, lean = -0.4 * side / np.linalg.norm(side), rng.uniform(-0.3, 0.3, (2, 3))
    places = [down + along + lean[0], np.zeros(3), down - along + lean[1]]
    return [rng.normal(size=3) * 3.0, *places], 0.3, axis, side, groove


def stops(places, radius, axis, side, groove):
    points = [np.asarray(place)[None] for place in places]
    return [Stop(points[0]), Stop(points[1]), Stop(points[2], radius, axis[None], side[None], groove), Stop(points[3])]


@pytest.mark.parametrize("groove", [False, True])
@pytest.mark.parametrize("seed", range(6))
def test_strands_pull_by_the_gradient_of_the_length(seed, groove):
    """Of each stop's place; on the cylinder what both strands pull, and without a moment about its axis."""
    places, *rest = any_way(seed, groove)
    pulls = np.zeros((4, 3))
    moment = np.zeros(3)
    for strand in strands(stops(places, *rest)):
        pulls[strand.stops[0]] += strand.along[0]
        pulls[strand.stops[1]] -= strand.along[0]
        for stop, at, way in zip(strand.stops, (strand.start, strand.end), (1.0, -1.0), strict=True):
            if stop == 2:
                moment += np.cross(at[0] - places[2], way * strand.along[0])
    for k in range(4):
        for axis in range(3):
            ends = []
            for step in (-1e-6, 1e-6):
                moved = [place.copy() for place in map(np.asarray, places)]
                moved[k][axis] += step
                ends.append(path_length(stops(moved, *rest))[0])
            assert pulls[k, axis] == pytest.approx(-(ends[1] - ends[0]) / 2e-6, abs=1e-6)
    assert moment @ rest[1] == pytest.approx(0.0, abs=1e-9)


def test_strands_of_a_rope_that_leaves_its_cylinder():
    """At one moment it lies on it, at the other it passes by, and pulls nowhere on it."""
    ends = np.array([[[-1.0, 0.0, -0.5], [-1.0, 0.0, 0.5]], [[1.0, 0.0, -0.5], [1.0, 0.0, 0.5]]])
    way = [Stop(ends[0]), Stop(np.zeros((2, 3)), 0.2, np.array([[0.0, 1.0, 0.0]] * 2), np.array([[0.0, 0.0, 1.0]] * 2)),
           Stop(ends[1])]  # fmt: skip
    first, second = strands(way)
    on_it = second.along - first.along
    assert on_it[1] == pytest.approx(0.0, abs=1e-12)
    assert on_it[0, 2] < -0.5
    assert np.linalg.norm(first.end[0]) == pytest.approx(0.2, abs=1e-9)


def just_so_long(reaches, radius, gap):
    """A way past a cylinder at `gap` from its rim, from one reach before it to another after, in closed form."""
    if gap >= 0.0:
        return sum(reaches)
    high, total = radius + gap, 0.0
    for reach in reaches:
        strand = np.sqrt(reach**2 + gap * (high + radius))
        turn = np.arcsin(-gap * (high + radius) / (radius * reach + high * strand))
        total += reach + gap * (high + radius) / (strand + reach) + radius * turn
    return total


@settings(deadline=None)
@given(
    radius=st.floats(0.01, 1.0),
    before=st.floats(0.3, 30.0),
    after=st.floats(0.3, 30.0),
    power=st.floats(-16.0, -2.0),
    side=st.sampled_from([-1.0, 0.0, 1.0]),
    angle=st.floats(0.0, 6.3),
    centre=st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0)),
)
def test_a_rope_that_just_touches_a_cylinder_is_straight(radius, before, after, power, side, angle, centre):
    """From either side, and where rounding decides on which."""
    gap, reaches = side * radius * 10.0**power, (radius * before, radius * after)
    across, along = np.array([np.cos(angle), np.sin(angle), 0.0]), np.array([-np.sin(angle), np.cos(angle), 0.0])
    middle = np.array([*centre, 0.0])
    ends = [(middle + (radius + gap) * across + x * along)[None] for x in (-reaches[0], reaches[1])]
    post = Stop(middle[None], radius, np.array([[0.0, 0.0, 1.0]]), across[None])
    way = [Stop(ends[0]), post, Stop(ends[1])]
    assert path_length(way)[0] == pytest.approx(just_so_long(reaches, radius, gap), rel=1e-10)
    first, second = strands(way)
    turn = 2.0 * 10.0**power / min(before, after, 1.0)
    assert float(first.along[0] @ second.along[0]) == pytest.approx(1.0, abs=turn**2 + 1e-9)
