"""Clauses that a prompt's words alone give."""

from __future__ import annotations

import pytest

from wsim.plan.asked.covered import missing, not_checked
from wsim.plan.asked.tied import UNASKED, UNFOUND, tied
from wsim.plan.schema import Plan
from wsim.rules.planner import plan

TIED = {
    "A ball rolls at 3 m/s and hits a row of three steel balls.": {
        "rolls": ["ball.velocity"], "3 m/s": ["ball.velocity"], "hits": [0],
        "three": ["steel_ball_1", "steel_ball_2", "steel_ball_3"],
    },
    "A pendulum of 2 m swings from 90 degrees.": {
        "2 m": ["rod.size", "pendulum.place"], "swings": [0], "90 degrees": ["rod.place", "pendulum.place"],
    },
    "A red cork ball floats in a tank of water and an iron cube sinks.": {"floats": [0], "sinks": [1]},
    "A crate slides at 3 m/s with a friction of 0.2 between the crate and the floor.": {
        "slides": [0], "3 m/s": ["crate.velocity"], "0.2": ["ground.friction", "crate.friction"],
    },
    "A log rolls down a ramp and comes to rest against a post.": {"rolls": [0], "comes": [2], "rest": [2]},
    "A rubber ball is dropped from 1 m and bounces three times.": {
        "dropped": [0, 1], "1 m": ["rubber_ball.place"], "bounces": [0, 1], "three": [1],
    },
    "A cork floats in a tank of water while a stone lies on the bottom.": {"floats": [0], "lies": [1]},
}  # fmt: skip


@pytest.mark.parametrize("prompt", TIED)
def test_each_verb_and_number_is_tied_to_what_shows_it(prompt: str) -> None:
    made = plan(prompt)
    assert {clause.words: clause.by for clause in made.clauses} == TIED[prompt]
    assert missing(made) == []
    assert not_checked(made) == []
    assert Plan.model_validate(made.model_dump()) == made


def test_what_nothing_shows_is_said_and_not_passed_over() -> None:
    made = plan("A steel ball rolls down a ramp of 20 degrees.")
    other = "A steel ball rolls down a ramp of 25 degrees and hits a wall."
    asked = made.model_copy(update={"prompt": other, "clauses": []})
    assert not_checked(tied(asked)) == [f"'25 degrees': {UNFOUND}", f"'hits': {UNASKED}"]


def test_what_is_denied_or_has_a_time_is_not_tied_to_what_shows_something_else() -> None:
    made = plan("A steel ball rolls down a ramp of 20 degrees and hits a wall.")
    prompt = "A steel ball rolls down a ramp of 20 degrees and within a second does not hit a wall."
    asked = made.model_copy(update={"prompt": prompt, "clauses": []})
    assert not_checked(tied(asked)) == [f"'a second': {UNFOUND}", f"'hit': {UNASKED}"]
    assert missing(tied(asked)) == []


def test_a_count_of_things_is_not_how_often() -> None:
    made = plan("Three rubber balls are dropped from 1 m.")
    asked = made.model_copy(update={"prompt": "Three rubber balls are dropped from 1 m, three times."})
    assert not_checked(tied(asked)) == [f"'three': {UNFOUND}"]


def test_the_numbers_of_a_push_are_its_schedules() -> None:
    pushed = plan("Push a crate with 60 N for two seconds.")
    assert not_checked(pushed) == []
    assert [clause.by for clause in pushed.clauses if clause.words in ("60 N", "two seconds")] == [
        [pushed.schedules[0].name], [pushed.schedules[0].name]
    ]  # fmt: skip
