"""What goes to the left is not asked to go to the right; what is pushed off is asked to be off."""

from __future__ import annotations

import pytest

from tests.plan.asked.prompts import STOCK, Case
from wsim.plan.asked.covered import missing

OTHER = "and what is named for it goes the other way"


def said(prompt: str, objectives: tuple[str, ...], clauses: dict[str, list[int | str]]) -> str:
    return " ".join(gap.line for gap in missing(Case(prompt, objectives, clauses).unchecked()))


@pytest.mark.parametrize(
    ("prompt", "wrong", "right"),
    [
        ("The box slides to the left.", "moves(box, least 1 m, right)", "moves(box, least 1 m, left)"),
        ("The box slides to the left.", "gone_between(box, y, -3 m, -1 m)", "gone_between(box, y, 1 m, 3 m)"),
        ("The box slides to the right and hits the wall.", "moves(box, left)", "moves(box, right)"),
        ("The box slides forwards.", "moves(box, least 1 m, back)", "moves(box, least 1 m, front)"),
        ("The box moves upward.", "gone_between(box, z, -2 m, -1 m)", "gone_between(box, z, 1 m, 2 m)"),
        ("The box rises.", "drops(box)", "not drops(box)"),
        ("The box sinks.", "gone_between(box, z, 1 m, 2 m)", "drops(box)"),
    ],
)
def test_what_goes_the_other_way_is_objected_to(prompt: str, wrong: str, right: str) -> None:
    clauses: dict[str, list[int | str]] = {prompt[:-1].partition(" and")[0]: [0], "hits the wall": [0]}
    assert OTHER in said(prompt, (wrong,), clauses)
    assert OTHER not in said(prompt, (right,), clauses)


@pytest.mark.parametrize(
    "prompt",
    [
        "The box slides to the left of the cart.",  # a place, which it may come to from the left as well
        "The box slides to the left wall.",
        "The box turns to the left.",  # as it looks itself
        "The box slides up to the crate, left of the wall.",
    ],
)
def test_a_place_is_no_way(prompt: str) -> None:
    assert OTHER not in said(prompt, ("moves(box, least 1 m, right)",), {prompt[:-1]: [0]})


@pytest.mark.parametrize(("velocity", "objected"), [([0, 3, 0], False), ([0, -3, 0], True), ([3, 0.1, 0], False)])
def test_a_start_goes_where_it_is_said(velocity: list[float], objected: bool) -> None:
    things = [{"name": "ground", **STOCK["ground"]}, {"name": "ball", **STOCK["ball"], "velocity": velocity}]
    prompt = "The ball is thrown to the left and hits the ground."
    clauses: dict[str, list[int | str]] = {"thrown to the left": ["ball.velocity"], "hits the ground": [0]}
    made = Case(prompt, ("collides_with ball ground",), clauses, {"objects": things}).unchecked()
    assert any(OTHER in gap.line for gap in missing(made)) == objected


@pytest.mark.parametrize(
    ("objectives", "objected"),
    [
        (("pushes(cart, box)",), True), (("pushes(cart, box)", "drops(box)"), False),
        (("pushes(cart, box)", "collides_with(cart, box)"), True),
        (("pushes(cart, box)", "gone_between(box, z, -2 m, -0.5 m) and never_touches(box, table)"), False),
    ],
)  # fmt: skip
def test_what_is_pushed_off_is_asked_to_be_off(objectives: tuple[str, ...], objected: bool) -> None:
    found = said("The cart pushes the box off the table.", objectives, {"pushes the box": [0], "table": ["table"]})
    assert ("nothing asks that box goes off" in found) == objected
