import math
from itertools import pairwise

import pytest

from wsim.errors import UserError
from wsim.plan.layout import check_clear
from wsim.rules.grammar import NotUnderstood
from wsim.rules.planner import plan

MAIN = "Three wooden blocks float on the water in a glass tank while a steel ball drops in and sinks."


def objectives(prompt: str) -> list[tuple[str, str, str | None]]:
    return [(o.kind, o.object, o.ref) for o in plan(prompt).objectives]


def test_the_main_prompt():
    made = plan(MAIN)
    assert [o.name for o in made.objects] == [
        "ground", "tank", "water", "wooden_block_1", "wooden_block_2", "steel_ball", "wooden_block_3",
    ]  # fmt: skip
    tank, water, ball = made.object("tank"), made.object("water"), made.object("steel_ball")
    assert tank.size == (1.2, 0.51, 0.45)
    assert water.relation("FREE-SURFACE-AT").value == 0.3
    assert made.simulation.spacing == 0.03 and made.simulation.duration == 3.5
    assert ball.pose.position[2] - ball.size[0] == pytest.approx(0.02 + 0.3 + 0.15)
    assert ball.material.density == 7850.0
    for k in (1, 2, 3):
        block = made.object(f"wooden_block_{k}")
        assert block.pose.position[2] - 0.07 == pytest.approx(0.325)
        assert block.size[2] >= 4.5 * made.simulation.spacing
    assert objectives(MAIN) == [
        *(("floats", f"wooden_block_{k}", "water") for k in (1, 2, 3)),
        ("rests_on", "steel_ball", "tank"),
        ("stays_inside", "water", "tank"),
    ]
    assert made.cameras[0].name == "side" and made.cameras[0].eye[2] > 0.32
    assert plan(MAIN) == made


def test_neighbours_and_walls_are_more_than_two_spacings_away():
    made = plan(MAIN)
    spans = [(-0.7, -0.6), (0.6, 0.7)]
    for item in made.objects[3:]:
        half = item.size[0] if item.primitive == "sphere" else item.size[0] / 2
        spans.append((item.pose.position[0] - half, item.pose.position[0] + half))
    spans.sort()
    assert all(b[0] - a[1] > 2 * made.simulation.spacing for a, b in pairwise(spans))


def test_what_was_left_open_is_an_assumption():
    said = {(a.subject, a.choice) for a in plan(MAIN).assumptions}
    assert ("water", "0.3 m deep") in said
    assert ("a steel ball", "dropped from 0.15 m above the water") in said
    assert ("three wooden blocks", "0.2 x 0.2 x 0.14 m") in said
    assert ("scene", "3.5 s long") in said
    precise = plan("A 20 cm oak cube is dropped from 0.5 m above the ground")
    assert not any("dropped" in a.choice or a.choice.startswith("of ") for a in precise.assumptions)


@pytest.mark.parametrize(
    ("prompt", "expected"),
    [
        (
            "a cork ball and an iron ball in a tank of water",
            [("floats", "cork_ball", "water"), ("rests_on", "iron_ball", "tank"), ("stays_inside", "water", "tank")],
        ),
        (
            "There is a tank of water. Two oak logs float in it, and a large lead ball sinks to the bottom.",
            [("floats", "oak_log_1", "water"), ("floats", "oak_log_2", "water"), ("rests_on", "lead_ball", "tank"),
             ("stays_inside", "water", "tank")],
        ),
        ("A tank filled with water stands on the ground.", [("stays_inside", "water", "tank")]),
        ("A tank holds water", [("stays_inside", "water", "tank")]),
        (
            "a concrete cylinder is submerged in the water",
            [("submerged", "concrete_cylinder", "water"), ("stays_inside", "water", "tank")],
        ),
        ("a ball lies on the ground", [("rests_on", "ball", "ground")]),
        ("A box falls onto the ground", [("rests_on", "box", "ground")]),
        ("A ball rolls on the floor", [("stays_on", "ball", "ground")]),
        (
            "A tower of 2 boxes stands on the ground",
            [("rests_on", "box_1", "ground"), ("stays_on", "box_2", "box_1")],
        ),
        (
            "Two boxes are stacked on the ground",
            [("rests_on", "box_1", "ground"), ("stays_on", "box_2", "box_1")],
        ),
        ("A ball knocks over a stack of five boxes", [("topples", "box_5", None)]),
        ("A ball rolls into a stack of five boxes and knocks it over", [("topples", "box_5", None)]),
        ("A ball hits a stack of five boxes and it falls over", [("topples", "box_5", None)]),
        ("A red ball hits the tower of 2 blocks", [("collides_with", "red_ball", "block_1")]),
        ("A box drops onto a block", [("rests_on", "block", "ground"), ("rests_on", "box", "block")]),
        (
            "A wooden cube and a red ball drop onto the ground",
            [("rests_on", "wooden_cube", "ground"), ("rests_on", "red_ball", "ground")],
        ),
    ],
)  # fmt: skip
def test_objectives(prompt, expected):
    assert objectives(prompt) == expected


def test_counts_materials_colours_and_sizes():
    made = plan("Two small red pine blocks and a 0.3 m ice ball float on the water")
    block, ball = made.object("red_pine_block_2"), made.object("ice_ball")
    assert block.size == pytest.approx((0.14, 0.14, 0.098)) and block.material.density == 500.0
    assert block.material.color[0] > 3 * block.material.color[1]
    assert ball.size == (0.15,) and ball.material.density == 917.0
    assert plan("a large box on the ground").object("box").size == pytest.approx((0.3, 0.3, 0.3))
    assert plan("12 cork balls float in a tank").object("cork_ball_12")


def test_what_was_named_before_is_meant_again():
    made = plan("A tank of water. A wooden block floats on the water and the wooden block is in the tank.")
    assert [o.name for o in made.objects if o.role == "rigid_body"] == ["wooden_block"]
    made = plan("A cork ball and an iron ball in a tank of water")
    assert [o.name for o in made.objects if o.role == "container"] == ["tank"]


@pytest.mark.parametrize(
    ("prompt", "words"),
    [
        ("A wooden block floats slowly in a tank", ["slowly"]),
        ("Three purple elephants juggle", ["elephants", "juggle"]),
        ("A ball in a tank of ketchup", ["ketchup"]),
        ("a wooden ball floats red", ["red"]),
        ("a tank floats", ["a tank floats"]),
        ("a steel tank holds water", ["a steel tank"]),
        ("a red red ball on the ground", ["red ball on the ground"]),
        ("the ball hits it", ["it"]),
        ("", [""]),
        ("and , then", ["and , then"]),
    ],
)
def test_what_is_not_understood_is_named(prompt, words):
    with pytest.raises(NotUnderstood) as caught:
        plan(prompt)
    assert caught.value.words == words
    assert "wsim plan --words" in str(caught.value) and "--planner-model" in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("prompt", "words"),
    [
        ("a ball floats and sinks in water", "cannot both float and sink"),
        ("a ball on the ground floats", "in the water and on the ground"),
        ("0 balls on the ground", "1 to 24"),
        ("99 balls on the ground", "1 to 24"),
        ("a 30 m ball sinks in water", "outside 0.02 to 5 m"),
        ("a stack of five boxes floats", "not in water"),
        ("a box rolls into a stack of five boxes", "rolls balls, barrels"),
        ("a 2 cm ball and a 4 m ball sink in water", "particles"),
        ("a tank of water and a water tank", "one tank"),
        ("a box and a ball drop onto a block", "one thing, or a stack, on another"),
    ],
)
def test_what_cannot_be_built_is_refused(prompt, words):
    with pytest.raises(UserError, match=words):
        plan(prompt)


def test_physics_against_the_prompt_is_planned_as_said_and_warned_of():
    made = plan("A steel block floats in a tank of water")
    assert ("floats", "steel_block", "water") in objectives("A steel block floats in a tank of water")
    assert any(a.choice.startswith("warning: steel, 7850 kg/m^3, in water") for a in made.assumptions)
    assert not any(a.choice.startswith("warning") for a in plan(MAIN).assumptions)


@pytest.mark.parametrize(
    "prompt",
    [MAIN, "Ten small cork balls float in water and a gold ball drops in", "A large ball sinks in a tank",
     "A 4 cm ice cube floats in a tank of water", "24 wooden blocks float in a tank"],
)  # fmt: skip
def test_tanks_fit_their_things_at_any_scale(prompt):
    made = plan(prompt)
    check_clear(made)
    tank, spacing = made.object("tank"), made.simulation.spacing
    level = made.object("water").relation("FREE-SURFACE-AT").value
    count = tank.size[0] * tank.size[1] * level / spacing**3
    assert 300 < count <= 40_000
    for length in (tank.size[0], tank.size[1], level):
        assert length / spacing == pytest.approx(round(length / spacing), abs=1e-6)
    for item in made.objects:
        if item.role == "rigid_body":
            assert level > 2 * max(item.size[-1], item.size[0] if item.primitive == "sphere" else 0)
    displaced = sum(math.prod(o.size) for o in made.objects if o.primitive == "box")
    assert tank.size[2] > level + displaced / (tank.size[0] * tank.size[1])


def test_a_ramp_alone_is_a_scene():
    assert plan("A ramp").simulation.duration == 1.0
    assert plan("A ramp and a ball").simulation.duration == 3.0
