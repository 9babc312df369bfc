"""Predicates of place, posture and speed on paths that theory gives."""

import math

import numpy as np
import pytest

from tests.judge.language.conftest import about_axis, moving, shape, solid, times
from wsim.judge.evidence.recorded import MissingError
from wsim.judge.language import evaluate, parse
from wsim.judge.language.measure import MEASURERS
from wsim.plan.schema.formula import VOCABULARY, Ordered
from wsim.scene.world import World

TIME = times(2.0, 10.0)
X, Y, Z = np.eye(3)


def one(text, signals):
    found = evaluate(parse(text), signals)
    assert found.margin.shape == found.satisfied.shape == (signals.count,)
    return found


def ball_and_box(world, ball, box=(0.0, 3.0, 0.2), **given):
    return moving(world, TIME, np.broadcast_to(ball, (len(TIME), 3)), np.broadcast_to(box, (len(TIME), 3)), **given)


def test_every_predicate_is_measured():
    assert set(MEASURERS) | {Ordered} == set(VOCABULARY.values())


def test_reaches_a_point(tank_world):
    # At 0.5 m/s from the origin it is 0.02 m short of (1.02, 0, 0) at 2 s.
    signals = ball_and_box(tank_world, 0.5 * TIME[:, None] * X)
    found = one("reaches(ball, (1.02, 0, 0), 0.05 m)", signals)
    assert found.margin[0] == pytest.approx(0.03) and found.moment[0] == 2.0 and found.units == ["m"]
    assert one("reaches(ball, (1.1, 0, 0), 5 cm)", signals).margin[0] == pytest.approx(-0.05)
    assert one("reaches(ball, (1.02, 0, 0))", signals).margin[0] == pytest.approx(0.1 - 0.02)


def test_reaches_an_object(tank_world):
    signals = ball_and_box(tank_world, [0.7, 0.0, 0.5])  # its surface is 0.2 m from the wall's
    assert one("reaches(ball, wall, 0.25 m)", signals).margin[0] == pytest.approx(0.05)
    assert one("reaches(ball, wall, 0.15 m)", signals).margin[0] == pytest.approx(-0.05)


def test_stays_within_a_point_and_an_object(tank_world):
    signals = ball_and_box(tank_world, TIME[:, None] * X, TIME[:, None] * X + 0.5 * Y)
    assert one("stays_within(ball, (0, 0, 0), radius 2.5 m)", signals).margin[0] == pytest.approx(0.5)
    assert one("stays_within(ball, (0, 0, 0), radius 1.5 m)", signals).margin[0] == pytest.approx(-0.5)
    assert one("stays_within(ball, box, radius 0.6 m)", signals).margin[0] == pytest.approx(0.1)
    assert one("stays_within(ball, tank, radius 5 m)", signals).moment[0] == 0.0


def test_contained_in_a_turned_tank(tank_world):
    # 45 degrees about Z: the ball at 0.5 m from the middle along X has 0.5 - 0.5 cos 45 - 0.1 of room.
    inside = ball_and_box(tank_world, [5.5, 0.0, 0.35])
    assert one("contained_in(ball, tank, 0 m)", inside).margin[0] == pytest.approx(0.4 - 0.5 / math.sqrt(2))
    # By itself it may be in a wall by 5 % of its size.
    assert one("contained_in(ball, tank)", inside).margin[0] == pytest.approx(0.4 - 0.5 / math.sqrt(2) + 0.01)
    # A box of 0.2 m turned with the tank needs 0.1; upright in the world it needs 0.1 sqrt 2, and 0.2 to rim and floor.
    turned = ball_and_box(tank_world, [0, 0, 0.1], [5.0, 0.0, 0.35], q=about_axis("z", np.full(1, math.pi / 4)))
    assert one("contained_in(box, tank, 0 m)", turned).margin[0] == pytest.approx(0.05)
    rim = ball_and_box(tank_world, [5.0, 0.0, 0.55])
    assert one("contained_in(ball, tank, 0 m)", rim).margin[0] == pytest.approx(-0.05)
    assert one("stays_inside(ball, tank)", rim).satisfied[0]
    with pytest.raises(MissingError, match="no container, and not hollow either; containers are /World/tank"):
        one("contained_in(ball, wall)", rim)


@pytest.mark.parametrize(("axis", "room"), [("x", 0.05), ("y", 0.05), ("z", 0.05)])
def test_contained_in_turns_every_axis(tank_world, axis, room):
    # The long side of the box, 0.4 m, up (z), or along the tank's own y or x after a turn about its x or y.
    straight = tank_world.containers[0].model_copy(update={"rotation": (0.0, 0.0, 0.0, 1.0)})
    world = tank_world.model_copy(update={"containers": [straight]})
    turn = about_axis(axis, np.full(1, 0.0 if axis == "z" else math.pi / 2))
    place = [5.25 if axis == "y" else 5.0, 0.25 if axis == "x" else 0.0, 0.35]
    signals = ball_and_box(world, [0, 0, 0.1], place, q=turn)
    assert one("contained_in(box, tank, 0 m)", signals).margin[0] == pytest.approx(room)


def test_stays_inside_is_the_way_to_the_nearest_wall(tank_world):
    signals = ball_and_box(tank_world, np.array([5.0, 0.0, 0.35]) + 0.1 * TIME[:, None] * X)
    assert one("stays_inside(ball, tank)", signals).margin[0] == pytest.approx(0.25)  # to the floor
    out = ball_and_box(tank_world, np.array([5.0, 0.0, 0.35]) + TIME[:, None] * X)
    found = one("stays_inside(ball, tank)", out)
    assert found.margin[0] == pytest.approx(0.5 - 2.0 / math.sqrt(2)) and found.moment[0] == 2.0


def test_all_shapes_of_a_body_are_to_be_contained(tank_world):
    straight = tank_world.containers[0].model_copy(update={"rotation": (0.0, 0.0, 0.0, 1.0)})
    ends = [shape("sphere", 0.1, position=(x, 0.0, 0.0)) for x in (-0.2, 0.2)]
    bar = solid("bar", ends[0]).model_copy(update={"shapes": ends})
    world = tank_world.model_copy(update={"bodies": [bar], "containers": [straight]})
    for x in (5.1, 4.9):
        signals = moving(world, TIME, np.broadcast_to([x, 0.0, 0.35], (len(TIME), 3)))
        assert one("contained_in(bar, tank, 0 m)", signals).margin[0] == pytest.approx(0.5 - 0.1 - 0.3)
    for place, room in (([5.4, 0.3, 0.35], 0.1), ([4.7, -0.45, 0.35], 0.05), ([5.0, 0.0, 0.13], 0.03)):
        signals = moving(world, TIME, np.broadcast_to(place, (len(TIME), 3)))
        assert one("stays_inside(bar, tank)", signals).margin[0] == pytest.approx(room)


def test_beside_other_units_a_distance_counts_as_a_share_of_its_limit(tank_world):
    signals = ball_and_box(tank_world, [0.0, 0.0, 0.0])
    for text, share in (
        ("reaches(ball, (0.04, 0, 0), 0.05 m) and settles(ball, 1 m/s)", 0.2),
        ("touches(ball, wall, 1 m) and settles(ball, 1 m/s)", 0.1),
        ("stays_within(ball, (0.6, 0, 0), 0.8 m) and settles(ball, 1 m/s)", 0.25),
        ("never_touches(ball, wall, 0.6 m) and settles(ball, 1 m/s)", 0.5),
        ("not crosses(ball, x, at 0.1 m) and settles(ball, 1 m/s)", 0.5),
    ):
        found = one(text, signals)
        assert found.units == ["m"] and found.robustness[0] == pytest.approx(share), text


def test_upright_is_the_tilt_from_the_start(tank_world):
    angle = np.radians(np.linspace(0.0, 12.0, len(TIME)))
    q = np.zeros((len(TIME), 2, 4))
    q[:, 0, 3] = 1.0
    q[:, 1] = about_axis("x", angle)
    signals = ball_and_box(tank_world, [0, 0, 0.1], q=q)
    assert one("upright(box, 15 deg)", signals).margin[0] == pytest.approx(3.0)
    assert one("upright(box, 10 deg)", signals).margin[0] == pytest.approx(-2.0)
    # Its middle, 0.2 m up, is over its edge, 0.1 m away, at atan(1 / 2).
    assert one("upright(box)", signals).margin[0] == pytest.approx(math.degrees(math.atan(0.5)) - 12.0)
    assert one("always[0, 1](upright(box, 10 deg))", signals).margin[0] == pytest.approx(4.0)
    with pytest.raises(MissingError, match="a ball has no upright"):
        one("upright(ball)", signals)


def test_a_body_of_several_shapes_tips_about_their_common_edge():
    feet = [shape("box", 0.2, 0.2, 0.2, position=(x, y, 0.0)) for x in (-0.1, 0.1) for y in (-0.1, 0.1)]
    world = World(bodies=[solid("table", feet[0]).model_copy(update={"shapes": feet})])
    signals = moving(world, TIME, np.zeros((len(TIME), 3)))
    assert one("upright(table)", signals).margin[0] == pytest.approx(math.degrees(math.atan2(0.2, 0.1)))


def test_upright_does_not_mind_a_turn_about_the_vertical(tank_world):
    signals = ball_and_box(tank_world, [0, 0, 0.1], q=about_axis("z", TIME)[:, None])
    assert one("upright(box, 10 deg)", signals).margin[0] == pytest.approx(10.0)


def test_speed_between_has_two_sides(tank_world):
    signals = ball_and_box(tank_world, 1.5 * TIME[:, None] * Y)
    assert one("speed_between(ball, 1 m/s, 3 m/s)", signals).margin[0] == pytest.approx(0.5)
    assert one("speed_between(ball, 1 m/s, 1.75 m/s)", signals).margin[0] == pytest.approx(0.25)
    assert one("speed_between(ball, 2 m/s, 3 m/s)", signals).margin[0] == pytest.approx(-0.5)
    assert one("speed_between(ball, 0 m/s, 1.4 m/s)", signals).margin[0] == pytest.approx(-0.1)


def test_crosses_from_either_side(tank_world):
    there = ball_and_box(tank_world, 0.5 * TIME[:, None] * X)
    back = ball_and_box(tank_world, X - 0.5 * TIME[:, None] * X)
    assert one("crosses(ball, x, at 0.75 m)", there).margin[0] == pytest.approx(0.25)
    assert one("crosses(ball, x, at 0.75 m)", back).margin[0] == pytest.approx(0.75)
    assert one("crosses(ball, x, at 1.25 m)", there).margin[0] == pytest.approx(-0.25)
    assert one("crosses(ball, x, at -0.25 m)", back).margin[0] == pytest.approx(-0.25)
    assert one("crosses(ball, y, at 1 m)", there).margin[0] == pytest.approx(-1.0)
    assert one("crosses(ball, x, at 0 m)", there).satisfied[0]


CORNER = "follows_path(ball, [(0, 0, 0), (1, 0, 0), (1, 1, 0)], 0.1 m)"


def test_follows_a_path_with_a_corner(tank_world):
    way = np.where(TIME[:, None] <= 1.0, TIME[:, None] * X, X + (TIME[:, None] - 1.0) * Y)
    assert one(CORNER, ball_and_box(tank_world, way)).margin[0] == pytest.approx(0.1)
    assert one(CORNER, ball_and_box(tank_world, way + 0.04 * Z)).margin[0] == pytest.approx(0.06)
    off = one(CORNER, ball_and_box(tank_world, way + 0.15 * Z))
    assert off.margin[0] == pytest.approx(-0.05)


def test_a_path_is_followed_to_its_end_and_in_order(tank_world):
    parked = ball_and_box(tank_world, [0.5, 0.0, 0.0])
    assert one(CORNER, parked).margin[0] == pytest.approx(0.1 - 0.5)
    halfway = ball_and_box(tank_world, 0.5 * TIME[:, None] * X)
    assert one(CORNER, halfway).margin[0] == pytest.approx(0.1 - 1.0)
    backwards = np.where(TIME[:, None] <= 1.0, X + (1.0 - TIME[:, None]) * Y, (2.0 - TIME[:, None]) * X)
    assert not one(CORNER, ball_and_box(tank_world, backwards)).satisfied[0]
    # A loop is not done before it is run: at the start it is at its end too.
    loop = "follows_path(ball, [(0, 0, 0), (1, 0, 0), (0, 0, 0)], 0.1 m)"
    assert not one(loop, ball_and_box(tank_world, [0.0, 0.0, 0.0])).satisfied[0]
    assert one(loop, ball_and_box(tank_world, np.minimum(TIME, 2.0 - TIME)[:, None] * X)).satisfied[0]


def test_a_fast_body_passes_a_point_between_two_frames(tank_world):
    signals = ball_and_box(tank_world, 4.0 * (TIME[:, None] + 0.05) * X)  # 0.4 m a frame, 0.2 m off the points
    assert one("follows_path(ball, [(0.4, 0, 0), (8, 0, 0)], 0.3 m)", signals).margin[0] == pytest.approx(0.3 - 0.2)
    between = one("follows_path(ball, [(0.2, 0, 0), (4, 0, 0), (8.2, 0, 0)], 0.1 m)", signals)
    assert between.margin[0] == pytest.approx(0.1)


def test_worlds_are_judged_each_by_itself(tank_world):
    speeds = np.array([0.2, 0.6, 1.0])
    paths = speeds[:, None, None] * TIME[None, :, None] * X
    signals = moving(tank_world, TIME, paths, np.broadcast_to([0.0, 3.0, 0.2], paths.shape))
    found = one("crosses(ball, x, at 1 m)", signals)
    assert found.margin == pytest.approx(2 * speeds - 1.0)
    assert found.satisfied.tolist() == [False, True, True]
    path = one("follows_path(ball, [(0, 0, 0), (1.2, 0, 0)], 0.1 m)", signals)
    assert path.satisfied.tolist() == [False, True, False]


def test_a_body_needs_a_shape_of_the_right_kind():
    world = World(bodies=[solid("box", shape("box", 1.0, 1.0, 1.0))])
    signals = moving(world, TIME, np.zeros((len(TIME), 3)))
    with pytest.raises(MissingError, match="not round"):
        one("rolls_without_slip(box)", signals)
