"""A changed plan asks for as much as the one before, or is refused."""

from __future__ import annotations

from typing import Any

import pytest

from tests.agents.flies import BALL, CLAUSES, GROUND, PROMPT, answer
from wsim.agents.planner import read_plan
from wsim.plan.asked.weaker import weakened
from wsim.plan.schema import Plan

MOVES = {"kind": "moves", "object": "ball", "value": 0.5}


def said(sentence: str) -> dict[str, Any]:
    return {"kind": "formula", "object": "ball", "sentence": sentence}


REACHES = said("finally (reaches(ball, (0.6, 0, 1.2), within 10 cm))")
RANGE = said("finally (gone_between(ball, x, 0.5 m, 0.7 m))")
OTHER = {**BALL, "name": "other", "position": [0, 2, 2], "velocity": [9, 0, 0]}
UPRIGHT = said("not upright(ball, 10 deg)")


def plan(*objectives: dict[str, Any], **change: Any) -> Plan:
    both = [{"words": "flies half a metre", "by": list(range(len(objectives) or 1))}, CLAUSES[0]]
    return read_plan(answer(**{"objectives": list(objectives) or [MOVES], "clauses": both, **change}), PROMPT)


SAME: dict[str, tuple[Plan, Plan]] = {
    "nothing": (plan(), plan()),
    "a longer run and a higher start": (
        plan(), plan(simulation={"duration": 0.4}, objects=[GROUND, {**BALL, "position": [0, 0, 3]}])),
    "another objective in its place": (plan(REACHES), plan(MOVES)),
    "one more": (plan(MOVES), plan(MOVES, REACHES)),
    "a little wider": (plan(REACHES), plan(said("finally (reaches(ball, (0.6, 0, 1.2), within 11.9 cm))"))),
    "narrower": (plan(RANGE), plan(said("finally (gone_between(ball, x, 0.5 m, 0.6 m))"))),
    "another place": (plan(REACHES), plan(said("finally (reaches(ball, (0.5, 0, 1), within 10 cm))"))),
}  # fmt: skip
WEAKER: dict[str, tuple[Plan, Plan, str]] = {
    "an objective dropped": (plan(MOVES, REACHES), plan(MOVES), "1 objectives, where there were 2"),
    "one tied no more": (
        plan(MOVES, REACHES), plan(MOVES, REACHES, clauses=[{"words": "flies half a metre", "by": [0]}, CLAUSES[0]]),
        "'flies' has 1 objectives, and had 2",
    ),
    "a verb untied": (
        plan(),
        plan(clauses=[CLAUSES[0], {"words": "half a metre", "by": [0]}, {"words": "flies", "unchecked": "hard"}]),
        "'flies': hard, and it was",
    ),
    "the prompt's number": (plan(), plan({**MOVES, "value": 0.3}), "'half a metre': no objective that is named for it"),
    "a wider limit": (
        plan(REACHES), plan(said("finally (reaches(ball, (0.6, 0, 1.2), within 13 cm))")),
        "within of reaches ball is 0.13, where it was 0.1; 20% is the most that a limit may move",
    ),
    "a wider range": (
        plan(RANGE), plan(said("finally (gone_between(ball, x, 0.3 m, 0.7 m))")), "range of gone_between ball x is 0.4",
    ),
    "a narrower one under a not": (
        plan(UPRIGHT), plan(said("not upright(ball, 5 deg)")), "within of upright ball is 5, where it was 10",
    ),
    "an easier alternative": (
        plan(), plan(said("moves(ball, 0.5 m) or moves(ball, 0.1 m)")), "least of moves ball is 0.1, where it was 0.5",
    ),
    "an alternative that asks nothing of it": (
        plan(REACHES), plan(said("finally (reaches(ball, (0.6, 0, 1.2), within 10 cm)) or speed_between(ball, 0, 9)")),
        "within of reaches ball is open in an alternative, where it was 0.1",
    ),
    "another thing": (
        plan(), plan({**MOVES, "object": "other"}, objects=[GROUND, BALL, OTHER]),
        "'flies' was asked of ball, and is no more",
    ),
    "another direction": (
        plan({**MOVES, "direction": "front"}), plan({**MOVES, "direction": "back"}),
        "ball moves back, where it was front",
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", SAME)
def test_what_asks_for_as_much_is_taken(what: str) -> None:
    assert weakened(*SAME[what]) == []


@pytest.mark.parametrize("what", WEAKER)
def test_what_asks_for_less_is_refused(what: str) -> None:
    old, new, why = WEAKER[what]
    assert why in "; ".join(weakened(old, new))


def test_what_the_prompt_names_may_not_go() -> None:
    old = plan(objects=[GROUND, BALL, {**BALL, "name": "wall", "position": [5, 0, 1], "velocity": [0, 0, 0]}],
               objectives=[MOVES, {"kind": "collides_with", "object": "ball", "ref": "wall"}])  # fmt: skip
    assert "wall is gone" in weakened(old, plan(MOVES, REACHES))


def test_a_blow_is_not_replaced_by_what_shows_none() -> None:
    prompt = "A ball hits the ground."
    words = [{"words": "hits", "by": [0]}]
    hits = {"kind": "collides_with", "object": "ball", "ref": "ground"}
    old, new = (read_plan(answer(objectives=[each], clauses=words), prompt) for each in (hits, MOVES))
    assert "'hits' had an objective that shows it, and what it has now does not" in weakened(old, new)


def test_plans_without_clauses_are_held_by_their_words() -> None:
    bare, less = (plan(each, clauses=None) for each in (MOVES, {**MOVES, "value": 0.3}))
    assert weakened(bare, bare) == []
    assert any("half a metre" in line for line in weakened(bare, less))
