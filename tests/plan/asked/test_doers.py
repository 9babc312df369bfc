"""A verb's objectives are about those that it is said of, and about each of as many as it says."""

from __future__ import annotations

import pytest

from tests.plan.asked.prompts import Case
from wsim.plan.asked.covered import missing

BALLS: list[int | str] = ["ball_1", "ball_2", "ball_3"]


def said(prompt: str, objectives: tuple[str, ...], clauses: dict[str, list[int | str]]) -> str:
    """What is objected to of parties and numbers."""
    lines = [gap.line for gap in missing(Case(prompt, objectives, clauses).unchecked())]
    return " ".join(line for line in lines if "it is said of" in line)


@pytest.mark.parametrize(
    ("prompt", "wrong", "right", "clauses"),
    [
        ("The box topples.", ("drops(ball)",), ("drops(box)",), {"topples": [0]}),
        ("The box hits the ball and the ball falls.", ("collides_with box ball", "drops(box)"),
         ("collides_with box ball", "drops(ball)"), {"hits": [0], "falls": [1]}),
        ("The ball rolls past the crate.", ("rolls(box)",), ("rolls(ball)",), {"rolls": [0], "The ball": ["ball"]}),
        ("The cart moves on and the crate slides away.", ("moves cart", "moves cart"), ("moves cart", "moves crate"),
         {"moves": [0], "slides": [1], "the crate": ["crate"]}),
        ("The box does not topple.", ("upright(crate)",), ("upright(box)",), {"does not topple": [0], "box": ["box"]}),
    ],
)  # fmt: skip
def test_what_is_asked_of_another_shows_nothing(
    prompt: str, wrong: tuple[str, ...], right: tuple[str, ...], clauses: dict[str, list[int | str]]
) -> None:
    clauses = clauses | {"The": ["box"]} if "box" in prompt else clauses
    assert "and the objectives that are named for it are about" in said(prompt, wrong, clauses)
    assert said(prompt, right, clauses) == ""


@pytest.mark.parametrize(
    ("prompt", "asked", "left"),
    [
        ("Three balls fall.", (1,), "ball_2"), ("Three balls fall.", (1, 2), "ball_3"),
        ("Three balls fall.", (1, 2, 3), ""),
        ("All the balls fall.", (2, 3), "ball_1"), ("The three balls fall.", (2, 3), "ball_1"),
        ("The balls fall.", (2,), ""), ("A ball falls.", (2,), ""),  # no number of three is said
        ("Two of three balls fall.", (1, 2), ""), ("Only one of the three balls falls.", (2,), ""),
        ("Neither of the balls falls.", (1, 2), "ball_3"), ("None of the balls falls.", (1, 2, 3), ""),
    ],
)  # fmt: skip
def test_as_many_are_asked_for_as_are_said(prompt: str, asked: tuple[int, ...], left: str) -> None:
    text = "not drops(ball_{})" if prompt.startswith("N") else "drops(ball_{})"
    verb = "falls" if "falls" in prompt else "fall"
    clauses: dict[str, list[int | str]] = {verb: list(range(len(asked))), prompt.split()[0]: BALLS}
    if "three" in prompt:
        clauses["three"] = BALLS
    found = said(prompt, tuple(text.format(k) for k in asked), clauses)
    each = f"'{verb}': it is said of all of ball_1, ball_2, ball_3, and nothing that is named for it is of {left}"
    assert found == (each if left else "")


@pytest.mark.parametrize(
    ("prompt", "least", "found"),
    [
        ("Two of the three balls land in the cup.", 1, "'land': it is said of 2, and counts asks for 1"),
        ("Two of the three balls land in the cup.", 2, ""),
        ("All three balls end in the cup.", 2, "'end': it is said of 3, and counts asks for 2"),
        ("All three balls end in the cup.", 3, ""),
    ],
)
def test_what_counts_counts_as_many(prompt: str, least: int, found: str) -> None:
    verb = "land" if "land" in prompt else "end"
    clauses: dict[str, list[int | str]] = {verb: [0], "Two": BALLS[:2], "three": BALLS}
    assert said(prompt, (f"counts(cup, {least}, ball_1, ball_2, ball_3)",), clauses) == found


@pytest.mark.parametrize(
    "prompt",
    [
        "A winch reels in the ball.",  # of which a plan has parts alone, by other names
        "The ball leaves the upper one standing.",
    ],
)
def test_where_it_is_not_known_who_does_it_nothing_is_objected_to(prompt: str) -> None:
    assert said(prompt, ("moves crate",), {prompt[:-1]: [0, "ball", "cart", "cork"]}) == ""


@pytest.mark.parametrize(
    ("prompt", "by", "fits"),
    [
        ("A 4 kg crate and a box fall.", "crate.mass", True), ("A 4 kg box and a crate fall.", "crate.mass", False),
        ("A box of 4 kg and a crate fall.", "crate.mass", False), ("The crate weighs 4 kg.", "crate.mass", True),
        ("The box weighs 4 kg, the crate less.", "crate.mass", False),
    ],
)  # fmt: skip
def test_a_number_is_of_the_thing_that_it_is_said_of(prompt: str, by: str, fits: bool) -> None:
    case = Case(prompt, ("drops(crate)", "drops(box)"), {"4 kg": [by], "fall": [0, 1]})
    assert ("4 kg" not in {gap.demand.text for gap in missing(case.unchecked())}) == fits


@pytest.mark.parametrize(
    ("prompt", "objective", "fits"),
    [
        ("The cart pushes the box.", "pushes(cart, box)", True),
        ("The cart pushes the box.", "pushes(box, cart)", False),
        ("The box is pushed by the cart.", "pushes(cart, box)", True),
    ],
)  # fmt: skip
def test_who_pushes_whom(prompt: str, objective: str, fits: bool) -> None:
    verb = "pushes" if "pushes" in prompt else "pushed"
    lines = [gap.line for gap in missing(Case(prompt, (objective,), {verb: [0]}).unchecked())]
    assert any("and pushes has box do it" in line for line in lines) == (not fits)
