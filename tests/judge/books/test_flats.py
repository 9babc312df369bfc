"""Cylinders that stand or lie on what is round or flat, and boxes' faces: where they touch follows from geometry."""

import numpy as np
import pytest

from tests.judge.theory import box, ground, record, times
from wsim.geometry.rotations import matrices
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


@pytest.mark.parametrize("gap", [0.0, 0.013])
@pytest.mark.parametrize("aside", [0.0, 0.0031, 0.009])
def test_a_roller_across_two_boxes_bears_to_the_end_of_each(gap, aside):
    """Where they meet, too: there two belts that run against each other hold it without turning it."""
    roller = solid("cylinder", (R, H), "roller")
    for side in (-1, 1):
        table = solid("box", (0.2, 0.2, 0.1), "table")
        found = touching(table, roller, [(0, side * (0.1 + gap / 2), 0), (0.01, aside, 0.05 + R)], LYING)
        inner, outer = side * gap / 2, aside + side * H / 2
        low, high = sorted((inner, outer))
        assert found.point[:, 1].min() == pytest.approx(low, abs=1e-6)
        assert found.point[:, 1].max() == pytest.approx(high, abs=1e-6)
        assert np.abs(found.gap).max() < 1e-6


@pytest.mark.parametrize("apart", [0.0, 5e-5])
def test_a_face_on_a_face_bears_at_its_corners(apart):
    """Whatever a search finds of it, here one point in the middle."""
    below, above = solid("box", (0.2, 0.2, 0.1), "below"), solid("box", (0.1, 0.1, 0.02), "above")
    places = [np.array((0.0, 0.0, 0.0, *UPRIGHT)), np.array((0.02, 0.0, 0.06 + apart, *UPRIGHT))]
    shapes = [below.shapes[0], above.shapes[0]]
    found = flats(np.array([[0, 1]]), np.array([[0.0, 0.0, 1.0]]), np.array([0]), shapes, np.array([places]))
    touch = found.gap < REACH
    corners = {tuple(point) for point in found.point[touch][:, :2].round(6)}
    assert corners == {(x, y) for x in (-0.03, 0.07) for y in (-0.05, 0.05)}
    assert found.gap[touch] == pytest.approx(apart, abs=1e-9)
    assert found.normal[touch] == pytest.approx(np.tile([0.0, 0.0, 1.0], (touch.sum(), 1)))


def test_a_disc_bears_all_along_an_edge_across_it():
    """A cylinder's end lies on a box's edge, at a quarter turn from its faces: along the chord."""
    lean = np.array([0.0, np.sin(np.pi / 8), 0.0, np.cos(np.pi / 8)])
    table, roller = solid("box", (0.2, 0.2, 0.2), "table"), solid("cylinder", (R, H), "roller")
    way, off = np.array([1.0, 0.0, 1.0]) / np.sqrt(2.0), 0.5 * R
    middle = np.array([0.1, 0.0, 0.1]) + 0.5 * H * way + off * np.array([1.0, 0.0, -1.0]) / np.sqrt(2.0)
    found = touching(table, roller, [(0, 0, 0), tuple(middle)], lean)
    chord = np.sqrt(R**2 - off**2)
    assert found.point[:, 1].min() == pytest.approx(-chord, abs=1e-4)
    assert found.point[:, 1].max() == pytest.approx(chord, abs=1e-4)
    assert found.point[:, [0, 2]] == pytest.approx(np.full((len(found), 2), 0.1), abs=1e-4)


def test_a_disc_that_overhangs_a_box_bears_to_its_edges():
    """Where its rim crosses them, a tenth of its radius inside, on two sides."""
    inside = 0.9 * R
    table, roller = solid("box", (0.2, 0.2, 0.1), "table"), solid("cylinder", (R, H), "roller")
    found = touching(table, roller, [(0, 0, 0), (0.1 - inside, 0.1 - inside, 0.05 + H / 2)], UPRIGHT)
    cross = 0.1 - inside + np.sqrt(R**2 - inside**2)
    for corner in ((0.1, cross), (cross, 0.1)):
        assert np.linalg.norm(found.point[:, :2] - corner, axis=1).min() < 1e-6


def test_a_side_bears_all_along_an_edge():
    """As long as the shorter of both."""
    table, roller = solid("box", (0.2, 0.04, 0.2), "table"), solid("cylinder", (R, H), "roller")
    middle = 0.1 + R / np.sqrt(2.0)
    found = touching(table, roller, [(0, 0, 0), (middle, 0.0, middle)], LYING)
    near = found.gap < 1e-6
    assert found.point[near][:, 1].min() == pytest.approx(-0.02, abs=1e-6)
    assert found.point[near][:, 1].max() == pytest.approx(0.02, abs=1e-6)
    assert abs(found.normal[near] @ np.array([1.0, 0.0, 1.0])) == pytest.approx(
        np.full(near.sum(), np.sqrt(2.0)), rel=1e-4
    )


def test_a_drum_that_hardly_leans_bears_on_all_its_rim():
    """It wobbles round it within an interval."""
    t, turn = times(0.1), (np.sin(5e-4), 0.0, 0.0, np.cos(5e-4))
    drum, height = solid("cylinder", (R, H), "drum"), 0.5 * H * np.cos(1e-3) + R * np.sin(1e-3)
    place = np.tile((0.0, 0.0, height), (len(t), 1))
    evidence = Evidence(record([drum], place, 0.0 * place, t, rotation=turn * np.ones((len(t), 4)), statics=[ground()]))
    found = Touching.of(evidence).at(evidence.body_q[0], REACH)
    angle = np.sort(np.arctan2(found.point[:, 1], found.point[:, 0]))
    assert np.diff(angle, append=angle[0] + 2.0 * np.pi).max() < 0.5
    assert found.gap == pytest.approx(found.surface(1)[:, 2], abs=1e-6)


@pytest.mark.parametrize("reach", [1e-4, 0.03, 0.1])
def test_the_nearest_point_is_found_from_far_and_near(reach):
    """Of a capsule that lies across a drum's rim: a wide search had its normal 9 degrees off, and other points."""
    (radius, tall), (thick, long) = (0.132446, 0.484408), (0.130292, 0.260584)
    places = np.array([(0.414718, 0.054552, 0.254298), (0.299197, 0.03791, 0.638096)])
    turns = np.array([(0.01149, 0.049089, -0.064063, 0.996672), (-0.648508, -0.233593, -0.190809, 0.698902)])
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    line = np.linspace(-0.5, 0.5, 20001)[:, None] * long * matrices(turns[1])[:, 2] + places[1] - places[0]
    own = line @ matrices(turns[0])
    across = np.linalg.norm(own[:, :2], axis=1)
    inside = np.column_stack(
        [own[:, :2] * np.minimum(1.0, radius / across)[:, None], np.clip(own[:, 2], -0.5 * tall, 0.5 * tall)]
    )
    apart = np.linalg.norm(own - inside, axis=1)
    nearest = int(np.argmin(apart))
    way = matrices(turns[0]) @ (own - inside)[nearest] / apart[nearest]
    drop = apart[nearest] - thick
    places[1] -= drop * way
    t = times(0.1)
    evidence = Evidence(
        record([solid("cylinder", (radius, tall), "drum"), solid("capsule", (thick, long), "log")],
               np.tile(places, (len(t), 1, 1)), np.zeros((len(t), 2, 3)), t,
               rotation=np.tile(turns, (len(t), 1, 1)))
    )  # fmt: skip
    found = Touching.of(evidence).at(evidence.body_q[0], reach)
    best = int(np.argmin(found.gap))
    assert found.gap[best] == pytest.approx(0.0, abs=1e-6)
    assert found.normal[best] * (1.0 if found.one[best] == 0 else -1.0) == pytest.approx(way, abs=1e-3)


def side_by_side(skew):
    """Two capsules, one on the other, that touch at one end and whose axes go apart by an angle from there."""
    low, high = solid("capsule", (R, H), "low"), solid("capsule", (R, H), "high")
    turn = np.array([np.cos(skew / 2), np.sin(skew / 2), np.sin(skew / 2), np.cos(skew / 2)]) * np.sqrt(0.5)
    t, axis = times(0.1), np.array([-np.sin(skew), np.cos(skew), 0.0])
    place = np.tile([(0.0, 0.0, 0.0), 0.5 * H * (axis - (0.0, 1.0, 0.0)) + (0.0, 0.0, 2 * R)], (len(t), 1, 1))
    rotation = np.tile([LYING, turn], (len(t), 1, 1))
    evidence = Evidence(record([low, high], place, np.zeros_like(place), t, rotation=rotation))
    return Touching.of(evidence).at(evidence.body_q[0], 1e-3)


@pytest.mark.parametrize("skew", [1e-6, 0.003, 0.05])
def test_capsules_side_by_side_bear_at_both_ends(skew):
    """They are apart by (s l)^2 / 4 r at one end, s their angle, l their length."""
    found = side_by_side(skew)
    for end, gap in ((-0.5 * H, 0.0), (0.5 * H, (skew * H) ** 2 / (4.0 * R))):
        there = np.abs(found.point[:, 1] - end) < 0.02 * H
        assert there.any()
        assert np.abs(found.gap[there]).max() == pytest.approx(gap, rel=0.05, abs=2e-6)


def test_capsules_across_each_other_touch_in_one_point():
    found = side_by_side(0.5)
    assert found.point == pytest.approx(np.tile((0.0, -0.5 * H, R), (len(found), 1)), abs=1e-4)
