"""A range has a number if it is about that number, on the side that the prompt says; a denial is of the whole run."""

from __future__ import annotations

import pytest

from tests.plan.asked.prompts import Case
from wsim.plan.asked.covered import NOT_ALL, missing


def said(prompt: str, objective: str, words: str) -> list[str]:
    """The words that nothing answers for."""
    case = Case(prompt, (objective,), {words: [0], "The ball": ["ball"]})
    return [gap.demand.text for gap in missing(case.unchecked()) if gap.demand.kind == "number"]


@pytest.mark.parametrize(
    ("number", "objective", "has"),
    [
        ("36 km/h", "eventually (speed_between(ball, 9 m/s, 11 m/s))", True),
        ("36 km/h", "eventually (speed_between(ball, 0 m/s, 36 m/s))", False),  # so does what stands
        ("36 km/h", "eventually (speed_between(ball, 0 m/s, 1000 m/s))", False),
        ("90 degrees", "turned_between(ball, z, 80 deg, 100 deg)", True),
        ("90 degrees", "turned_between(ball, z, -100 deg, -80 deg)", True),  # which way, its sign says
        ("90 degrees", "turned_between(ball, z, -360 deg, 360 deg)", False),
        ("60 rpm", "spin_between(ball, z, 0 deg/s, 10000 deg/s)", False),
        ("60 rpm", "spin_between(ball, z, 340 deg/s, 380 deg/s)", True),
        ("at least 2 m", "gone_between(ball, x, 2 m, 5 m)", True),
        ("at least 2 m", "gone_between(ball, x, -2 m, 2 m)", False),
        ("at least 2 m", "moves(ball, least 2 m)", True),
        ("no more than 2 m", "moves(ball, least 2 m)", False),
        ("no more than 2 m", "not moves(ball, least 2 m)", True),
        ("no more than 2 m", "gone_between(ball, x, -2 m, 2 m)", True),
        ("no less than 2 m", "gone_between(ball, x, 0 m, 2 m)", False),
        ("faster than 2 m/s", "speed_between(ball, 0 m/s, 2 m/s)", False),
        ("faster than 2 m/s", "speed_between(ball, 2 m/s, 20 m/s)", True),
        ("slower than 2 m/s", "speed_between(ball, 2 m/s, 20 m/s)", False),
        ("slower than 2 m/s", "speed_between(ball, 0 m/s, 2 m/s)", True),
        ("at most 2 m/s", "speed_between(ball, 0 m/s, 2 m/s)", True),
        ("after two seconds", "eventually[0, 2] (touches(ball, box))", False),
        ("after two seconds", "eventually[2, 5] (touches(ball, box))", True),
        ("after two seconds", "eventually[1.5, 2.5] (touches(ball, box))", True),
    ],
)  # fmt: skip
def test_a_range_has_a_number_if_it_is_about_it(number: str, objective: str, has: bool) -> None:
    assert (said(f"The ball moves {number}.", objective, f"moves {number}") == []) == has


@pytest.mark.parametrize(("by", "has"), [("ball.place", False), ("ball.velocity", False), (0, True)])
def test_where_a_thing_stands_is_not_how_far_it_goes(by: int | str, has: bool) -> None:
    prompt = "The ball rolls 3 m."
    case = Case(prompt, ("gone_between(ball, x, 2.9 m, 3.1 m)",), {"The ball rolls": [0], "3 m": [by]})
    assert (missing(case.unchecked()) == []) == has


@pytest.mark.parametrize(
    ("prompt", "objective", "whole"),
    [
        ("The ball never touches the wall.", "always (not touches(ball, wall))", True),
        ("The ball never touches the wall.", "never_touches(ball, wall)", True),
        ("The ball never touches the wall.", "always[0, 0.5] (not touches(ball, wall))", False),
        ("The ball never touches the wall.", "eventually (not touches(ball, wall))", False),
        ("The ball never touches the wall during the first second.", "always[0, 1] (not touches(ball, wall))", True),
        ("The ball never touches the wall until it is hit.", "always[0, 1] (not touches(ball, wall))", True),
    ],
)
def test_never_is_the_whole_run(prompt: str, objective: str, whole: bool) -> None:
    case = Case(prompt, (objective,), {"never touches the wall": [0]})
    assert any(gap.why == NOT_ALL for gap in missing(case.unchecked())) == (not whole)


@pytest.mark.parametrize(
    ("prompt", "verb"),
    [("A gate opens.", "opens"), ("The ball whacks the box.", "whacks"), ("The crane hoists a crate.", "hoists"),
     ("The tank leaks.", ""), ("The box lies close to the wall.", ""), ("A box is at the end of a ramp.", ""),
     ("The ball ends up in the cup.", "ends"), ("An open box.", "")],
)  # fmt: skip
def test_what_more_verbs_ask_is_asked_for(prompt: str, verb: str) -> None:
    case = Case(prompt, ("moves crate",), {prompt.split()[0]: ["crate"]})
    silent = {gap.demand.text for gap in missing(case.unchecked())}
    assert (verb in silent) if verb else silent <= {"lies"}


@pytest.mark.parametrize(
    ("prompt", "objective", "shows"),
    [
        ("The ball turns.", "turned_between(ball, z, -1000 deg, 1000 deg)", False),
        ("The ball turns.", "turned_between(ball, z, 10 deg, 1000 deg)", True),
        ("The ball moves.", "always (speed_between(ball, 0 m/s, 1000 m/s))", False),
        ("The ball stops.", "finally (speed_between(ball, 0 m/s, 1 cm/s))", True),
        ("The ball hits the wall.", "never_touches(ball, wall)", False),
        ("The ball hits the wall.", "reaches(ball, wall)", True),
    ],
)
def test_what_holds_of_what_stands_still_is_no_motion(prompt: str, objective: str, shows: bool) -> None:
    case = Case(prompt, (objective,), {prompt[:-1]: [0]})
    assert (missing(case.unchecked()) == []) == shows
