"""A vehicle drives: on what, how far and how fast, and what must come of it."""

from __future__ import annotations

import math

import pytest

from wsim.errors import UserError
from wsim.judge.language import sentence
from wsim.plan.layout.land import survey
from wsim.program.compose import compose
from wsim.program.validator import validate
from wsim.rules.grammar import NotUnderstood
from wsim.rules.lexicon import lexicon
from wsim.rules.planner import plan
from wsim.scene.vehicle_spec import preset, presets

SAYS = "An off-road vehicle of the HMMWV class drives 100 m over rough ground with rocks, trees and a hill."


@pytest.fixture(scope="module")
def made():
    return plan(SAYS)


def test_it_is_a_vehicle_on_rough_ground_with_a_hill(made) -> None:
    assert [(item.name, item.primitive) for item in made.objects] == [
        ("ground", "terrain"), ("rock", "scatter"), ("tree", "scatter"), ("hmmwv", "vehicle"),
    ]  # fmt: skip
    ground, rock, tree, vehicle = made.objects
    assert [layer.kind for layer in ground.built.layers] == ["noise", "hill", "level", "level"]
    assert vehicle.built.vehicle == "hmmwv" and (rock.built.count, tree.built.count) == (60, 25)
    assert [each.message for each in validate(compose(made), made)] == []
    assert made.steps[0].title == "ground" and made.steps[-2].title == "drive"
    assert {name for step in made.steps for name in step.objects} == {item.name for item in made.objects}


def test_it_stands_level_on_the_ground_and_heads_along_its_way(made) -> None:
    ground, vehicle = made.objects[0], made.objects[-1]
    land, (x, y, z) = survey(ground), vehicle.pose.position
    yaw = math.radians(vehicle.pose.rotation_deg[2])
    wheels = [
        land.height(x + a * math.cos(yaw) - b * math.sin(yaw), y + a * math.sin(yaw) + b * math.cos(yaw))
        for a, b in map(preset("hmmwv").place, ("front_left", "front_right", "rear_left", "rear_right"))
    ]
    assert z == pytest.approx(land.height(x, y), abs=1e-6)
    assert wheels == pytest.approx([z] * 4, abs=1e-3)
    ax, ay = vehicle.registration.actuation[0].route[0]
    bearing = math.atan2(ay - y, ax - x)
    assert abs(bearing - yaw) < math.radians(15.0)  # a spline begins a little beside its chord


def test_what_must_happen_is_measured(made) -> None:
    asked = [sentence(objective.formula) for objective in made.objectives]
    assert asked[0] == "moves(hmmwv, least 100 m, front)"
    hill = next(layer for layer in made.objects[0].built.layers if layer.kind == "hill")
    top = survey(made.objects[0]).height(*hill.position)
    assert top > 0.9 * hill.height and f"{top:.3f}".rstrip("0") in asked[1]
    assert asked[2].count(" then ") == 4
    assert asked[3] == "touches_only(hmmwv, ground)"
    assert asked[4] == "upright(hmmwv, within 35 deg)"
    assert asked[5] == "finally[1](speed_between(hmmwv, low 0 m/s, high 0.1 m/s))"


def test_its_way_is_as_long_as_it_says_and_there_is_time_for_it(made) -> None:
    vehicle = made.objects[-1]
    start, goal = vehicle.pose.position, vehicle.registration.actuation[0].route[-1]
    assert goal[0] - start[0] == pytest.approx(101.0)
    assert 101.0 / 8.0 + 8.0 / 2.0 / 2.0 + 8.0 / 3.0 / 2.0 < made.simulation.duration < 25.0


@pytest.mark.parametrize(
    ("says", "kind", "layers", "speed"),
    [
        ("A car drives 30 m along a road and stops.", "car", ["noise", "level", "level", "road"], 10.0),
        ("A golf cart drives 20 m at 3 m/s", "cart", None, 3.0),
        ("A truck drives forward for 60 m on the ground", "truck", None, 8.0),
        ("A buggy drives 80 m over a hill", "polaris", ["hill", "level", "level"], 7.0),
        ("There is a jeep that drives over uneven terrain past 5 boulders", "hmmwv", ["noise", "level", "level"], 8.0),
    ],
)
def test_it_is_said_in_other_words(says: str, kind: str, layers: list[str] | None, speed: float) -> None:
    said = plan(says)
    vehicle, ground = said.objects[-1], said.objects[0]
    assert (vehicle.built.vehicle, vehicle.registration.actuation[0].speed) == (kind, speed)
    assert (ground.primitive == "ground") == (layers is None)
    assert layers is None or [layer.kind for layer in ground.built.layers] == layers
    assert [each.message for each in validate(compose(said), said)] == []


@pytest.mark.parametrize(
    ("says", "problem"),
    [
        ("A car drives 500 m", "500 m is outside 10 to 200 m"),
        ("A car drives 50 m at 40 m/s", "40 m/s is outside 1 to 15 m/s"),
        ("A red car drives 50 m", "drives one vehicle as it was made"),
        ("Two cars drive 50 m", "drives one vehicle as it was made"),
        ("A car drives 20 m over a hill", "20 m is too short for 'a hill'"),
        ("A car drives 50 m over rough ground and a ball rolls", "lets a vehicle drive on a road"),
        ("A car drives 50 m with red rocks", "lets a vehicle drive on a road"),
        ("A car drives 50 m in a tank of water", "lets a vehicle drive over land, not there"),
        ("A ball drives 50 m", "lets a vehicle drive, but not this"),
        ("A car stands on the ground", "lets a vehicle drive over land, and nothing else"),
        ("A ball rolls over a hill", "lets things go down a ramp|knows these words"),
        ("A car drives 50 m to the left", "not in this order"),
        ("A car drives 50 m onto a table", "not in this order"),
    ],
)
def test_what_it_would_leave_out_is_refused(says: str, problem: str) -> None:
    with pytest.raises((UserError, NotUnderstood), match=problem):
        plan(says)


def test_its_kinds_are_those_of_the_scene() -> None:
    nouns = {noun.key: noun for noun in lexicon().nouns.values() if noun.family == "vehicle"}
    assert {*nouns} == {*presets()}
    for kind, noun in nouns.items():
        assert noun.size == (preset(kind).length, preset(kind).width, preset(kind).height)


@pytest.mark.parametrize(
    ("says", "why"),
    [
        ("A truck drives 30 m over a rock.", "over land"),
        ("A car drives 50 m on a tree.", "over land"),
        ("A car drives 50 m past a hill.", "past things"),
        ("A car drives 30 m and then drives 40 m.", "once"),
        ("A car drives 30 m. It drives 20 m.", "once"),
        ("A truck drives 100 m for 3 s and stops.", "too short"),
    ],
)
def test_what_it_would_not_do_is_refused_and_not_read_otherwise(says: str, why: str) -> None:
    with pytest.raises((NotUnderstood, UserError), match=why):
        plan(says)


def test_a_time_that_suffices_is_kept() -> None:
    assert plan("A truck drives 100 m for 60 s and stops.").simulation.duration == 60.0


@pytest.mark.parametrize("over", ["a road", "a hill at 5 m/s", "rough ground", "the ground"])
def test_it_drives_across_what_it_drives_over(over: str) -> None:
    assert plan(f"A car drives across {over}.").objects[-1].primitive == "vehicle"
