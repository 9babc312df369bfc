"""The straight parts of ropes against the length of their way: a taut rope pulls by T times the way's gradient."""

import numpy as np
import pytest

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
