"""A robot patrols an office: its rooms have no two things in each other, and its way has room on both sides."""

from __future__ import annotations

import itertools
import math

import pytest

from wsim.errors import UserError
from wsim.judge.language import sentence
from wsim.plan.layout.bodies import around
from wsim.program.compose import compose
from wsim.program.validator import validate
from wsim.rules.planner import plan
from wsim.rules.scenes import office as rooms
from wsim.rules.scenes.office import FREE, ROUTE, TUCKED, check_way, office

SAYS = "A Go2 robot dog patrols an office and comes back."
WIDTH = 0.38  # of a Go2 [m]


@pytest.fixture(scope="module")
def made():
    return plan(SAYS)


def test_it_is_an_office(made) -> None:
    pieces = [item for item in made.objects if item.primitive == "asset"]
    assert len(pieces) == 26
    assert {"desk", "chair", "table", "shelf", "cabinet", "whiteboard"} <= {item.built.asset for item in pieces}
    assert {"door", "jamb_left", "lintel", "wall_back", "partition_left"} <= {item.name for item in made.objects}
    assert [camera.name for camera in made.cameras] == ["above", "desks", "meeting"]
    problems = [each.message for each in validate(compose(made), made)]
    assert all("not on this machine yet" in each for each in problems), problems  # where it is pulled there are none


def test_no_two_things_are_in_each_other(made) -> None:
    """But the front of a chair, which is under its table; they are along the axes, so that their boxes tell."""
    boxes = {item.name: around(item) for item in made.objects if item.pose is not None and item.primitive != "ground"}
    for (one, a), (two, b) in itertools.combinations(boxes.items(), 2):
        deep = min(min(a.high[k], b.high[k]) - max(a.low[k], b.low[k]) for k in range(3))
        tucked = {one.split("_")[0], two.split("_")[0]} & {"desk", "table"} and "chair" in one + two
        assert deep <= (TUCKED if tucked else 0.0) + 1e-4, (one, two)  # places are rounded to that
    inside = [boxes[name] for name in boxes if not name.startswith(("wall", "partition", "jamb", "lintel"))]
    assert all(box.low[0] > -5.0 and box.high[0] < 5.0 and box.low[1] > -3.2 and box.high[1] < 3.2 for box in inside)


def test_its_way_has_room_on_both_sides(monkeypatch: pytest.MonkeyPatch) -> None:
    check_way(office(), WIDTH)
    with pytest.raises(UserError, match=r"the office's jamb_right is 0\.45 m from the robot's way .* needs 0\.50 m"):
        check_way(office(), 2 * (0.5 - FREE))
    monkeypatch.setitem(rooms.FREE_STANDING, "table", ("table", (3.2, 0.2), 90.0))
    with pytest.raises(UserError, match="the office's table is"):
        check_way(office(), WIDTH)


def test_what_must_happen_is_measured(made) -> None:
    (*_, robot) = made.objects
    (walk,) = robot.registration.actuation
    assert (robot.primitive, robot.built.robot, walk.policy, walk.speed) == ("robot", "go2", "go2_walk", 0.8)
    assert [point[:2] for point in walk.route] == list(ROUTE[1:]) and walk.route[-1] == (*ROUTE[0], 0.0)
    asked = [sentence(objective.formula) for objective in made.objectives]
    assert asked[0].count(" then ") == len(ROUTE) - 2 and asked[0].count("within 0.25 m") == len(ROUTE) - 1
    assert asked[1] == "touches_only(go2, ground)"
    assert "upright(go2, within 20 deg)" in asked[2]
    assert asked[3] == "finally[2](stays_within(go2, (-2.9, -1.6, 0.32), radius 0.1 m))"


@pytest.mark.parametrize(
    "says",
    ["A 40 kg Go2 patrols an office.", "A red robot dog patrols an office.", "A wooden robot dog patrols an office.",
     "A Go2 1 m above the ground patrols an office.", "A Go2 patrols a large office.", "A Go2 patrols a 20 m office.",
     "A Go2 patrols two offices.", "A Go2 patrols an office with water."],
)  # fmt: skip
def test_what_it_would_leave_out_is_refused(says: str) -> None:
    with pytest.raises(UserError, match=r"a robot is as it was made|furnishes one office itself"):
        plan(says)


@pytest.mark.parametrize(
    ("says", "speed"),
    [
        ("A robot dog walks round an office at 0.5 m/s and returns", 0.5),
        ("A quadruped walks through an office", 0.8),
        ("The Unitree Go2 patrols the office, then comes home.", 0.8),
    ],
)
def test_it_is_said_in_other_words(says: str, speed: float) -> None:
    said = plan(says)
    assert said.objects[-1].registration.actuation[0].speed == speed
    length = sum(math.dist(a, b) for a, b in itertools.pairwise(ROUTE))
    assert length / speed < said.simulation.duration < 1.3 * length / speed + 6.0
    assert said.simulation.frame_rate == 25.0
