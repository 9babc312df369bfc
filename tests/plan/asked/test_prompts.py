"""Of sound plans none is objected to; of weakened ones nearly all are."""

from __future__ import annotations

from tests.plan.asked.prompts import HARDER, SOUND, WEAK, Case
from wsim.errors import UserError
from wsim.plan.asked.covered import missing, not_checked, unasked


def objections(case: Case) -> list[str]:
    """All that is said against a plan before it is built, and of its prompt that no run will show."""
    try:
        plan = case.plan()
    except UserError as error:
        assert "cannot come true" in str(error), error
        return [str(error)]
    return [*(gap.line for gap in missing(plan)), *not_checked(plan), *filter(None, [unasked(plan)])]


def test_of_sound_plans_none_is_objected_to() -> None:
    assert {case.prompt: found for case in [*SOUND, *HARDER] if (found := objections(case))} == {}


def test_of_weakened_plans_nine_in_ten_are() -> None:
    passed = [(case.prompt, case.objectives) for case in WEAK if not objections(case)]
    assert len(passed) <= 0.1 * len(WEAK), passed


def test_there_are_as_many_of_each() -> None:
    """Shares of sixty: one is 1.7 %."""
    assert (len(SOUND), len(WEAK)) == (60, 60)


def lines(number: int) -> str:
    return " ".join(objections(WEAK[number]))


def test_what_is_said_names_what_is_missing() -> None:
    by_prompt = {case.prompt: number for number, case in reversed(list(enumerate(WEAK)))}
    for prompt, said in {
        "The ball hits the box and the box hits the crate.": "'hits': it is said of box and crate, and the objectives "
        "that are named for it are about ball and box",
        "Within 2 seconds the ball hits the box.": "'2 seconds': no objective that is named for it ends by then: "
        "eventually[0, 2]",
        "The ball never touches the wall.": "'touches': it is not to happen, and no objective that is named",
        "The ball touches the ground twice.": "'twice': no objective that is named for it has as many events",
        "The ball hits the ground exactly once.": "'exactly once': nothing asks that it comes no more often",
        "The ball hits the ground, leaves it and hits it again.": "'again': no objective that is named for it",
        "The gate rises within 1.5 s.": "crosses of gate by 1.5 s, which does not move before 2 s (schedule lift)",
        "The door opens by 120 degrees.": "turned_between z 110 to 130 deg of door, and hinge's limits are 0 to 90",
    }.items():
        assert said in lines(by_prompt[prompt]), prompt
