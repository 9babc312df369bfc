"""Which of a prompt's words a plan answers for."""

from __future__ import annotations

from typing import Any

import pytest

from tests.agents.flies import BALL, GROUND, MOVES, answer
from wsim.agents.planner import read_plan
from wsim.agents.shorthand import written_out
from wsim.errors import UserError
from wsim.plan.asked.covered import missing, not_checked, told, unasked
from wsim.plan.schema import Plan

PROMPT = "A ball is thrown gently at 1.5 m/s and flies half a metre."
ALL = [
    {"words": "thrown gently at 1.5 m/s", "by": ["ball.velocity"]},
    {"words": "flies half a metre", "by": [0]},
    {"words": "gently", "unchecked": "no number goes with it"},
]


def plan(clauses: list[dict[str, Any]], prompt: str = PROMPT, **more: Any) -> Plan:
    return read_plan(answer(clauses=clauses, **more), prompt)


def test_all_is_tied_and_what_is_not_measured_is_shown() -> None:
    assert missing(plan(ALL)) == []
    assert unasked(plan(ALL)) == ""
    assert not_checked(plan(ALL)) == ["'gently': no number goes with it"]
    assert not_checked(plan(ALL[:2])) == ["'gently': nothing measures it"]  # though it stands within a clause


def test_a_manner_of_its_own_is_tied() -> None:
    assert not_checked(plan([*ALL[:2], {"words": "gently", "by": [0]}])) == []


@pytest.mark.parametrize(
    ("change", "gap"),
    [
        ({"words": "thrown gently", "by": ["ball.velocity"]}, "'1.5 m/s': no clause has it"),
        ({"words": "thrown gently at 1.5 m/s", "by": ["ball.mass"]}, "'thrown': it happens, and no objective"),
        (
            {"words": "thrown gently at 1.5 m/s", "by": [0]},
            "'1.5 m/s': no objective that is named for it has this value",
        ),
    ],
)
def test_what_is_not_tied_keeps_a_world_from_acceptance(change: dict[str, Any], gap: str) -> None:
    made = plan([change, *ALL[1:]])
    assert gap in " ".join(each.line for each in missing(made))
    assert unasked(made).startswith("nothing asks for '")


def test_a_speed_that_the_plan_has_not_is_not_stated() -> None:
    slow = {"words": "thrown gently at 1.5 m/s", "by": ["ball"]}
    assert missing(plan([slow, ALL[1]])) != []  # a bare name sets nothing going
    other = plan([ALL[0], ALL[1]], PROMPT.replace("1.5", "2.5"))
    assert [gap.demand.text for gap in missing(other)] == ["thrown", "2.5 m/s"]  # the clause's words are not there
    ((words, by),) = [("thrown gently at 2.5 m/s", ["ball.velocity"])]
    other = plan([{"words": words, "by": by}, ALL[1]], PROMPT.replace("1.5", "2.5"))
    assert [gap.demand.text for gap in missing(other)] == ["2.5 m/s"]


def test_a_plan_without_clauses_is_asked_nothing() -> None:
    assert told(plan([])) == told(None)


def test_what_cannot_be_simulated_is_not_tied_by_what_can() -> None:
    prompt = "A thrown ball flies half a metre and shatters."
    made = plan([{"words": "flies half a metre and shatters", "by": [0]}], prompt)
    assert unasked(made) == "nothing asks for 'shatters'"
    instead = made.model_copy(update={"stands_in_for": "a ball that shatters"})
    assert (unasked(instead), told(instead).stands_in_for) == ("", "a ball that shatters")
    assert not_checked(instead) == ["'shatters': the world stands in for it"]


def test_a_reason_for_everything_that_happens_is_no_answer() -> None:
    made = plan([{"words": "thrown gently at 1.5 m/s and flies half a metre", "unchecked": "hard to say"}])
    assert unasked(made) == "nothing asks for what happens in it, 'thrown', 'flies'"


@pytest.mark.parametrize(
    ("clause", "message"),
    [
        ({"words": "flies", "by": [1]}, r"clauses\.0\.by: no objective 1; the plan has 1, and they count from 0"),
        (
            {"words": "flies", "by": ["bird"]},
            r"no object, joint, cord, schedule, opening or camera 'bird'",
        ),
        ({"words": "flies", "by": ["ball.mood"]}, r"clauses\.0\.by: ball has no 'mood' that is checked; it has size"),
        ({"words": "flies"}, r'give "by", the objectives and objects that show it, or "unchecked"'),
        ({"words": "flies", "by": [0], "unchecked": "so"}, r'give "by"'),
    ],
)
def test_a_clause_names_what_is_there(clause: dict[str, Any], message: str) -> None:
    with pytest.raises(UserError, match=message):
        plan([clause])


def test_the_second_of_two_like_words_is_another_place() -> None:
    prompt = "A thrown ball flies and flies."
    first = {"words": "flies", "by": [0]}
    assert [gap.demand.first for gap in missing(plan([first], prompt))] == [5]
    assert missing(plan([first, first], prompt)) == []


def test_a_count_is_answered_by_as_many_things() -> None:
    prompt = "Three balls are thrown and fly half a metre."
    balls = [{**BALL, "name": f"ball_{k}", "position": [0, k, 2]} for k in range(3)]
    rest = [{"words": "fly half a metre", "by": [0]}, {"words": "thrown", "by": ["ball_0.velocity"]}]

    def counted(*by: Any) -> list[str]:
        objectives = [{**MOVES, "object": "ball_0"}]
        clauses = [{"words": "Three balls", "by": list(by)}, *rest]
        return [gap.line for gap in missing(plan(clauses, prompt, objects=[GROUND, *balls], objectives=objectives))]

    assert counted("ball_0", "ball_1", "ball_2") == []
    assert counted("ball_0", "ball_1") == ["'Three': fewer things are named for it"]
    assert counted("ball_0") == []  # what is one thing of the plan may be many


def test_a_blow_is_asked_for_as_such() -> None:
    prompt = "A ball hits the ground."
    words = [{"words": "hits", "by": [0]}]
    assert [gap.line for gap in missing(plan(words, prompt))] == [
        "'hits': it is a blow, and no objective that is named for it asks for one: collides_with, touches"
    ]
    for asked in ({"kind": "collides_with"}, {"kind": "rests_on"}):
        objectives = [{**asked, "object": "ball", "ref": "ground"}]
        assert missing(plan(words, prompt, objectives=objectives)) == []


@pytest.mark.parametrize(
    ("formula", "shows"),
    [
        ("collides_with(ball, ground)", True), ("not collides_with(ball, ground)", False),
        ("not never_touches(ball, ground)", False), ("collides_with(ball, ground) or settles(ball)", False),
        ("touches(ball, ground) or collides_with(ball, ground, restitution 0.5)", True),
        ("eventually (touches(ball, ground) and speed_between(ball, 1, 2))", True),
        ("not (not touches(ball, ground) or not speed_between(ball, 1, 2))", True),
    ],
)  # fmt: skip
def test_what_is_denied_or_one_of_several_ways_shows_nothing(formula: str, shows: bool) -> None:
    prompt, words = "A ball hits the ground.", [{"words": "hits", "by": [0]}]
    objectives = [{"kind": "formula", "object": "ball", "sentence": formula}]
    assert (missing(plan(words, prompt, objectives=objectives)) == []) == shows


def test_a_clause_has_words() -> None:
    with pytest.raises(UserError, match="words"):
        plan([{"words": "", "by": [0]}])


PUSH = {
    "name": "shove", "of": "ball", "quantity": "force", "times": [0.5, 2.5], "values": [[0, 30, 40], [0, 0, 0]],
}  # fmt: skip


@pytest.mark.parametrize(
    ("words", "by", "gaps"),
    [
        ("pushed with 50 N for two seconds", ["shove"], []),
        ("pushed with 50 N for two seconds", ["shove.values"], ["two seconds"]),
        ("pushed with 60 N for three seconds", ["shove"], ["60 N", "three seconds"]),
        ("stops after half a second", ["shove"], ["stops"]),  # that is seen, not set
        ("rolls off after half a second", ["shove"], ["rolls"]),
    ],
)
def test_a_schedule_answers_for_what_it_does(words: str, by: list[str], gaps: list[str]) -> None:
    clauses = [{"words": words, "by": by}, {"words": "flies half a metre", "by": [0]}]
    made = plan(clauses, f"A ball is {words} and flies half a metre.", schedules=[PUSH], simulation={"duration": 3})
    assert [gap.demand.text for gap in missing(made)] == gaps


@pytest.mark.parametrize(
    ("spring", "by", "silent"), [(True, [0], []), (False, [0], ["compresses"]), (True, [], ["compresses"])]
)
def test_a_spring_is_compressed_as_no_body_is(spring: bool, by: list[int], silent: list[str]) -> None:
    cord = {"name": "coil", "kind": "spring", "b": "ball", "anchor_a": [0, 0, 3], "stiffness": 100, "rest_length": 1}
    clause = {"words": "the coil compresses", "by": by} if by else {"words": "ball", "by": ["ball"]}
    clauses = [clause, {"words": "flies half a metre", "by": [0]}]
    prompt = "A ball flies half a metre and the coil compresses."
    made = plan(clauses, prompt, **({"cords": [cord]} if spring else {}))
    assert [gap.demand.text for gap in missing(made)] == silent


@pytest.mark.parametrize(("pan", "silent"), [(True, []), (False, ["lands"])])
def test_what_lands_on_a_scale_lands_on_its_pan(pan: bool, silent: list[str]) -> None:
    """It is said of the scale, and a slider ties the pan to that."""
    box = {"primitive": "box", "role": "mechanism", "state": "dynamic", "material": GROUND["material"]}
    parts = [
        {"name": "scale_base", **box, "size": [0.4, 0.4, 0.2], "position": [0, 0, 0.1], "state": "static"},
        {"name": "pan", **box, "size": [0.4, 0.4, 0.02], "position": [0, 0, 0.5]},
    ]
    guide = {"name": "guide", "kind": "slider", "child": "pan", "parent": "scale_base", "axis": "Z"}
    asked = {"kind": "collides_with", "object": "ball", "ref": "pan"}
    clauses = [{"words": "A ball lands on a scale", "by": [0]}]
    made = plan(
        clauses, "A ball lands on a scale.", objects=[GROUND, BALL, *parts], objectives=[asked],
        joints=[guide] if pan else None,
    )  # fmt: skip
    assert [gap.demand.text for gap in missing(made)] == silent


@pytest.mark.parametrize(
    ("always", "until", "silent"),
    [("always", 2.5, []), ("always", 2.35, []), ("always", 1.5, ["two seconds"]), ("eventually", 2.5, ["two seconds"])],
)
def test_a_window_answers_for_how_long_it_holds(always: str, until: float, silent: list[str]) -> None:
    waits = {
        "kind": "formula",
        "object": "ball",
        "sentence": f"{always}[0.5, {until}](speed_between(ball, 0 m/s, 1 mm/s))",
    }
    clauses = [{"words": "A ball waits two seconds", "by": [0]}]
    made = plan(clauses, "A ball waits two seconds.", objectives=[waits], simulation={"duration": 3})
    assert [gap.demand.text for gap in missing(made)] == silent


def test_a_spring_elsewhere_lets_no_ball_be_squeezed() -> None:
    """Nor does one between others make of a stretched ball more than a word."""
    other = {**BALL, "name": "bob", "position": [3, 0, 2]}
    coil = {"name": "coil", "kind": "spring", "b": "bob", "anchor_a": [3, 0, 3], "stiffness": 100, "rest_length": 1}
    clauses = [{"words": "The ball stretches", "by": [0]}]
    made = plan(clauses, "The ball stretches.", objects=[GROUND, BALL, other], cords=[coil])
    assert [gap.demand.text for gap in missing(made)] == ["stretches"]


@pytest.mark.parametrize("struck", ["left_bob", "right_bob"])
def test_two_that_hang_on_one_frame_are_two(struck: str) -> None:
    """Asked is a blow on the right one; that on the left one, which hangs on the same beam, is another."""
    beam = {"name": "beam", "role": "mechanism", "primitive": "box", "size": [2, 0.1, 0.1], "state": "static",
            "position": [0, 0, 2], "material": GROUND["material"]}  # fmt: skip
    bobs = [{**BALL, "name": name, "velocity": [0, 0, 0], "position": [x, 1, 1]}
            for name, x in (("left_bob", -0.5), ("right_bob", 0.5))]  # fmt: skip
    hinges = [{"name": f"{bob['name']}_hinge", "kind": "hinge", "child": bob["name"], "parent": "beam", "axis": "X",
               "anchor": [0, -1, 1]} for bob in bobs]  # fmt: skip
    asked = {"kind": "collides_with", "object": "ball", "ref": struck}
    full = written_out(answer(objects=[GROUND, BALL, beam, *bobs], joints=hinges, objectives=[asked],
                              clauses=[{"words": "The ball hits the right bob", "by": [0]}]))  # fmt: skip
    made = Plan.model_validate(full | {"prompt": "The ball hits the right bob."})
    assert [gap.demand.text for gap in missing(made)] == ([] if struck == "right_bob" else ["hits"])


def test_a_camera_answers_for_the_view() -> None:
    view = {"name": "wide", "eye": [4, -4, 2], "target": [0, 0, 0]}
    clauses = [{"words": "In a wide shot", "by": ["wide"]}, {"words": "flies half a metre", "by": [0]}]
    made = plan(clauses, "In a wide shot a ball flies half a metre.", cameras=[view])
    assert (missing(made), not_checked(made)) == ([], [])
