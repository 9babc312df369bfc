"""What a planner forgot to tie is tied where the words find what shows it, and asked for where they do not."""

from __future__ import annotations

import pytest

from tests.plan.asked.prompts import Case
from wsim.plan.asked.covered import missing, unasked
from wsim.plan.asked.filled import filled


@pytest.mark.parametrize(
    ("prompt", "objectives", "clauses", "found"),
    [
        ("Put a ball on the table: it falls.", ("drops(ball)",), {"falls": [0]}, ["Put"]),
        ("The ball falls and hits the box.", ("collides_with ball box",), {"hits": [0]}, ["falls"]),
        ("Released above the box, the ball hits it.", ("collides_with ball box",), {"hits": [0]}, ["Released"]),
        ("The ball falls, thrown at 3 m/s.", ("drops(ball)",), {"thrown": ["ball.velocity"]}, ["falls", "3 m/s"]),
        ("The box topples and the ball falls.", ("drops(ball)",), {"falls": [0]}, []),  # of the box nothing is asked
        ("The ball whacks and zooms.", ("drops(ball)",), {"whacks": [0]}, []),  # of these verbs nothing is known
        ("The ball falls but never hits the box.", ("drops(ball)",), {"falls": [0]}, []),  # a denial is to be said
    ],
)
def test_what_is_found_is_tied(
    prompt: str, objectives: tuple[str, ...], clauses: dict[str, list[int | str]], found: list[str]
) -> None:
    plan = Case(prompt, objectives, clauses).unchecked()
    assert [clause.words for clause in filled(plan).clauses[len(clauses) :]] == found
    assert {gap.demand.text for gap in missing(filled(plan))} == {gap.demand.text for gap in missing(plan)} - set(found)


def test_a_plan_without_clauses_is_left_as_it_is() -> None:
    plan = Case("The ball falls.", ("drops(ball)",), {}).unchecked()
    assert filled(plan) is plan
    assert unasked(plan) == ""


@pytest.mark.parametrize(("state", "shown"), [("dynamic", True), ("kinematic", False)])
def test_what_is_free_from_the_start_is_released(state: str, shown: bool) -> None:
    thing = {"name": "ball", "role": "mechanism", "primitive": "sphere", "size": [0.1], "state": state,
             "material": {"name": "wood", "density": 600}, "position": [0, 0, 1]}  # fmt: skip
    ground = {**thing, "name": "ground", "role": "terrain", "primitive": "ground", "size": [], "state": "static"}
    prompt = "The ball is released and falls."
    case = Case(prompt, ("drops(ball)",), {"released": ["ball"], "falls": [0]}, {"objects": [ground, thing]})
    assert (missing(case.unchecked()) == []) == shown
