"""What is in a bucket, a crate or a cart: any hollow thing, still or moving, upright or tilted."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as some

from tests.judge.language.conftest import about_axis, moving, shape, solid, still
from tests.judge.language.test_place import one
from wsim.geometry.rotations import rotate
from wsim.judge.evidence.recorded import MissingError
from wsim.scene.world import Shape, World

WALL = 0.02
WIDE, HIGH = 0.4, 0.5  # outside [m]


def crate() -> list[Shape]:
    """A floor and four walls, open at the top, about the origin in the middle of its bottom."""
    half = (WIDE - WALL) / 2
    floor = shape("box", WIDE, WIDE, WALL, position=(0.0, 0.0, WALL / 2))
    walls = [
        shape("box", *((WALL, WIDE) if x else (WIDE, WALL)), HIGH, position=(x * half, y * half, HIGH / 2))
        for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1))
    ]
    return [floor, *walls]


def world(vessel_moves: bool) -> World:
    ball = solid("ball", shape("sphere", 0.05))
    if vessel_moves:
        vessel = solid("crate", shape("box", WIDE, WIDE, WALL)).model_copy(update={"shapes": crate()})
        return World(bodies=[ball, vessel])
    vessel = still("crate", shape("box", 1.0, 1.0, 1.0)).model_copy(update={"shapes": crate()})
    return World(bodies=[ball], statics=[vessel])


def test_a_ball_is_in_a_crate_as_deep_as_its_walls_say():
    inside = moving(world(False), np.zeros(1), np.array([[0.1, 0.0, 0.2]]))
    assert one("contained_in(ball, crate, 0 m)", inside).margin[0] == pytest.approx(0.2 - 0.1 - 0.05)
    over = moving(world(False), np.zeros(1), np.array([[0.0, 0.0, 0.48]]))  # it looks out by 3 cm
    assert one("contained_in(ball, crate, 0 m)", over).margin[0] == pytest.approx(-0.03)
    assert one("stays_inside(ball, crate)", over).satisfied[0]
    beside = moving(world(False), np.zeros(1), np.array([[0.3, 0.0, 0.2]]))
    assert one("stays_inside(ball, crate)", beside).margin[0] == pytest.approx(-0.1)


@settings(max_examples=25, deadline=None)
@given(
    angle=some.floats(-math.pi, math.pi), axis=some.sampled_from("xyz"),
    at=some.tuples(*[some.floats(-5.0, 5.0)] * 3), local=some.tuples(*[some.floats(-0.3, 0.6)] * 3),
)  # fmt: skip
def test_a_crate_that_is_carried_and_tilted_holds_what_it_held(angle, axis, at, local):
    q = about_axis(axis, np.array([angle]))
    place = np.array(at) + rotate(q, np.array([local]))
    poses = np.concatenate([np.broadcast_to(q, (1, 1, 4))[:, :, None], q[None, :, None]], axis=2)
    signals = moving(world(True), np.zeros(1), place, np.array([at]), q=poses)
    x, y, z = local
    room = min(WIDE / 2 - abs(x), WIDE / 2 - abs(y), z, HIGH - z) - 0.05
    assert one("contained_in(ball, crate, 0 m)", signals).margin[0] == pytest.approx(room, abs=1e-4)


@pytest.mark.parametrize("name", ["block", "ball"])
def test_what_is_solid_holds_nothing(name):
    block = still("block", shape("box", 1.0, 1.0, 1.0))
    signals = moving(
        World(bodies=[solid("ball", shape("sphere", 0.05))], statics=[block]), np.zeros(1), np.zeros((1, 3))
    )
    with pytest.raises(MissingError, match="not hollow"):
        one(f"contained_in(ball, {name})", signals)
