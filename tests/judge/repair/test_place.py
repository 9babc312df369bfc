"""Where a body is to start instead: out of what it starts in by the shortest way, or over what carries it."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.judge.theory import ball, box, ground, record, slab, times, with_world
from wsim.geometry.rotations import rotate
from wsim.judge.evidence.contact import overlaps
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.repair.place import over, overlapping_start
from wsim.scene.world import Container

SOME = times(0.5)


def standing(*bodies, statics=(), containers=()):
    """Bodies that stay where they are said to start."""
    placed = np.stack([np.tile(body.position, (len(SOME), 1)) for body in bodies], axis=1)
    turned = np.stack([np.tile(body.rotation, (len(SOME), 1)) for body in bodies], axis=1)
    zero = np.zeros_like(placed)
    recording = record(list(bodies), placed, zero, SOME, rotation=turned, statics=statics)
    return Evidence(with_world(recording, containers=list(containers)))


def at(body, x, y, z, turn=0.0):
    rotation = (0.0, 0.0, math.sin(turn / 2), math.cos(turn / 2))
    return body.model_copy(update={"position": (x, y, z), "rotation": rotation})


@settings(deadline=None, max_examples=25)
@given(st.floats(0.02, 0.9), st.floats(-1.0, 1.0), st.floats(0.0, 1.5))
def test_a_box_in_the_ground_comes_up_by_as_much(share, x, turn):
    deep = share * 0.2
    evidence = standing(at(box(size=(0.3, 0.2, 0.2)), x, 0.0, 0.1 - deep, turn), statics=[ground()])
    target = overlapping_start(evidence, "/World/box")
    assert (target.parameter, target.direction, target.unit) == ("position", "change", "m")
    assert target.vector == pytest.approx((x, 0.0, 0.1), abs=2e-4)


def test_what_is_in_two_things_at_once_leaves_both():
    """In a corner of the ground and a wall, up alone leaves the wall where it is."""
    wall = slab("wall", (0.2, 2.0, 2.0), (-0.1, 0.0, 1.0))
    evidence = standing(at(box(size=(0.2, 0.2, 0.2)), 0.07, 0.0, 0.1), statics=[ground(), wall])
    assert overlapping_start(evidence, "/World/box").vector == pytest.approx((0.1, 0.0, 0.1), abs=2e-4)


def test_of_two_that_are_in_each_other_the_one_that_is_free_sooner_goes():
    """A cube is 4 cm in a long plank that lies on two blocks: the cube goes up, not the plank aside."""
    blocks = [slab(name, (0.2, 0.3, 0.3), (x, 0.0, 0.15)) for name, x in (("a", -0.4), ("b", 0.4))]
    plank, cube = at(box("plank", (1.0, 0.25, 0.04)), 0, 0, 0.32), at(box("cube", (0.12, 0.12, 0.12)), 0, 0, 0.36)
    target = overlapping_start(standing(plank, cube, statics=[*blocks, ground()]), None)
    assert target.prim == "/World/cube" and target.vector == pytest.approx((0.0, 0.0, 0.4), abs=2e-4)


def test_what_touches_is_left_where_it_is():
    evidence = standing(at(box(size=(0.2, 0.2, 0.2)), 0.0, 0.0, 0.1 - 1e-5), statics=[ground()])
    assert overlapping_start(evidence, "/World/box") is None


@pytest.mark.parametrize("tilt", [0.0, 15.0, 35.0])
def test_what_is_beside_a_board_or_a_ramp_is_put_on_its_middle(tilt):
    half = math.radians(tilt) / 2
    board = slab("board", (1.0, 0.6, 0.1), (2.0, 1.0, 0.6))
    shape = board.shapes[0].model_copy(update={"rotation": (0.0, math.sin(half), 0.0, math.cos(half))})
    board = board.model_copy(update={"shapes": [shape]})
    beside = at(ball(), -1.0, 0.0, 0.3)
    target = over(standing(beside, statics=[board, ground()]), "/World/ball", "/World/board", "so")
    there = np.array(target.vector)
    radius = beside.shapes[0].size[0]
    # A ball that touches the upper face is its radius and half the board's thickness off the board's middle plane.
    normal = rotate(np.array(shape.rotation), np.array([0.0, 0.0, 1.0]))
    assert (there - [2.0, 1.0, 0.6]) @ normal == pytest.approx(radius + 0.05, abs=5e-3)
    assert there[:2] == pytest.approx([2.0, 1.0])
    placed = standing(at(ball(), *target.vector), statics=[board, ground()])
    assert not [pair for pair in overlaps(placed) if pair.depth[0] > 1e-4]


def test_what_is_beside_a_vessel_is_put_into_its_middle():
    vessel = Container(prim="/World/pot", inner_size=(1.0, 1.0, 0.5), inner_center=(3.0, 0.0, 0.35))
    floor = slab("pot", (1.2, 1.2, 0.1), (3.0, 0.0, 0.05))
    high = standing(at(ball(), 0.0, 0.0, 0.8), statics=[floor, ground()], containers=[vessel])
    assert over(high, "/World/ball", "/World/pot", "so").vector == pytest.approx((3.0, 0.0, 0.8))
    low = standing(at(ball(), 0.0, 0.0, 0.05), statics=[floor, ground()], containers=[vessel])
    radius = ball().shapes[0].size[0]
    assert over(low, "/World/ball", "/World/pot", "so").vector == pytest.approx((3.0, 0.0, 0.1 + radius))
    assert over(low, "/World/ball", "/World/ground", "so") is None  # a plane has no middle
