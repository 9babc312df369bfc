"""What the prompt has first is not asked to come later; where nothing asks which comes first, that is said."""

from __future__ import annotations

import pytest

from tests.plan.asked.prompts import Case
from wsim.plan.asked.covered import missing, not_checked
from wsim.plan.asked.order import pairs

CLAUSES: dict[str, list[int | str]] = {"hits": [0], "falls": [0], "the crate": ["crate"]}
HIT, OVER = "collides_with(ball, box)", "drops(crate)"
ROUND = "and the objective that is named for it has it before that"
OPEN = "nothing asks which comes first"


@pytest.mark.parametrize(
    ("prompt", "first"),
    [
        ("The ball hits the box, then the crate falls.", "hits"),
        ("After the ball hits the box, the crate falls.", "hits"),
        ("The crate falls after the ball hits the box.", "hits"),
        ("The ball hits the box before the crate falls.", "hits"),
        ("The crate falls before the ball hits the box.", "falls"),
        ("Before the ball hits the box the crate falls.", "falls"),
        ("The crate falls and then the ball hits the box.", "falls"),
    ],
)
def test_the_order_asked_for_is_the_one_said(prompt: str, first: str) -> None:
    one, other = (HIT, OVER) if first == "hits" else (OVER, HIT)
    right, wrong = (Case(prompt, (f"{a} then {b}",), CLAUSES).unchecked() for a, b in ((one, other), (other, one)))
    loose = Case(prompt, (HIT, OVER), CLAUSES | {"falls": [1]}).unchecked()
    assert [(a.text, b.text) for a, b in pairs(right)] == [("hits", "falls") if first == "hits" else ("falls", "hits")]
    assert not any(ROUND in gap.line for gap in missing(right))
    assert any(ROUND in gap.line for gap in missing(wrong))
    assert [line for line in not_checked(loose) if OPEN in line]
    assert not [line for line in not_checked(right) if OPEN in line]


@pytest.mark.parametrize(
    ("prompt", "objectives", "clauses"),
    [
        ("The ball hits the box, then comes to rest.", (HIT, "settles ball"), {"hits": [0], "comes to rest": [1]}),
        ("The ball stops before it hits the wall.", ("stops_before(ball, wall)",), {"stops": [0], "hits": [0]}),
        ("The ball hits the box, then lands on the crate.", (HIT, "rests_on ball crate"), {"hits": [0], "lands": [1]}),
        ("The ball hits the box. The crate falls.", (HIT, OVER), {"hits": [0], "falls": [1]}),
        ("The ball hits the box, and the crate falls.", (HIT, OVER), {"hits": [0], "falls": [1]}),
    ],
)  # fmt: skip
def test_what_comes_last_anyway_needs_no_order(
    prompt: str, objectives: tuple[str, ...], clauses: dict[str, list[int | str]]
) -> None:
    assert [line for line in not_checked(Case(prompt, objectives, clauses).unchecked()) if OPEN in line] == []
