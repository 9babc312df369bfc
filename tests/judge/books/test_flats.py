"""Cylinders that stand or lie on what is round or flat, and boxes' faces: where they touch follows from geometry."""

import numpy as np
import pytest

from tests.judge.theory import box, record, times
from wsim.judge.books.flats import flats
from wsim.judge.books.touching import Touching
from wsim.judge.evidence.evidence import Evidence

R, H, POST = 0.02, 0.06, 0.03  # radius and length of the cylinder, radius of the post [m]
REACH = 1e-4  # [m]
LYING = (np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))  # its axis along Y
UPRIGHT = (0.0, 0.0, 0.0, 1.0)


def solid(kind, size, name):
    body = box(name)
    return body.model_copy(update={"shapes": [body.shapes[0].model_copy(update={"kind": kind, "size": size})]})


def touching(lower, upper, places, turn):
    t = times(0.1)
    place = np.tile(places, (len(t), 1, 1))
    rotation = np.tile([UPRIGHT, turn], (len(t), 1, 1))
    evidence = Evidence(record([lower, upper], place, np.zeros_like(place), t, rotation=rotation))
    return Touching.of(evidence).at(evidence.body_q[0], REACH)


@pytest.mark.parametrize(("turn", "half"), [(LYING, R), (UPRIGHT, H / 2)])
def test_it_touches_a_dome_at_its_top(turn, half):
    """Wherever along its side, or on its end, a search comes out."""
    top = POST + 0.05
    post = solid("capsule", (POST, 0.1), "post")
    found = touching(post, solid("cylinder", (R, H), "roller"), [(0, 0, 0), (0, 0.005, top + half)], turn)
    off = np.linalg.norm(found.point - (0.0, 0.0, top), axis=1)
    assert off.min() < 1e-4
    best = int(np.argmin(off))
    assert found.gap[best] == pytest.approx(0.0, abs=1e-6)
    assert found.normal[best] == pytest.approx([0.0, 0.0, 1.0], abs=1e-5)


@pytest.mark.parametrize(
    "lower", [solid("box", (0.2, 0.2, 0.1), "table"), solid("cylinder", (0.1, 0.1), "table")], ids=["box", "disc"]
)
@pytest.mark.parametrize(("turn", "half", "wide", "long"), [(UPRIGHT, H / 2, R, R), (LYING, R, 0.0, H / 2)])
def test_it_bears_on_all_that_it_stands_on(lower, turn, half, wide, long):
    found = touching(lower, solid("cylinder", (R, H), "roller"), [(0, 0, 0), (0.01, 0, 0.05 + half)], turn)
    near = np.sqrt(2.0 * R * REACH)  # so far beside its line a side is as near
    for axis, middle, extent in ((0, 0.01, wide), (1, 0.0, long)):
        assert found.point[:, axis].min() == pytest.approx(middle - extent, abs=near)
        assert found.point[:, axis].max() == pytest.approx(middle + extent, abs=near)


def test_it_bears_on_nothing_beside_the_edge():
    """Half of it is over the edge of a table: what is beyond touches nothing."""
    table, roller = solid("box", (0.2, 0.2, 0.1), "table"), solid("cylinder", (R, H), "roller")
    found = touching(table, roller, [(0, 0, 0), (0.1, 0, 0.05 + H / 2)], UPRIGHT)
    assert len(found) and found.point[:, 0].max() <= 0.1 + 1e-6


@pytest.mark.parametrize("apart", [0.0, 5e-5])
def test_a_face_on_a_face_bears_at_its_corners(apart):
    """Whatever a search finds of it, here one point in the middle."""
    below, above = solid("box", (0.2, 0.2, 0.1), "below"), solid("box", (0.1, 0.1, 0.02), "above")
    places = [np.array((0.0, 0.0, 0.0, *UPRIGHT)), np.array((0.02, 0.0, 0.06 + apart, *UPRIGHT))]
    shapes = [below.shapes[0], above.shapes[0]]
    found = flats(np.array([[0, 1]]), np.array([[0.0, 0.0, 1.0]]), shapes, places.__getitem__)
    touch = found.gap < REACH
    corners = {tuple(point) for point in found.point[touch][:, :2].round(6)}
    assert corners == {(x, y) for x in (-0.03, 0.07) for y in (-0.05, 0.05)}
    assert found.gap[touch] == pytest.approx(apart, abs=1e-9)
    assert found.normal[touch] == pytest.approx(np.tile([0.0, 0.0, 1.0], (touch.sum(), 1)))
