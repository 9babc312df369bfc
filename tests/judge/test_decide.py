"""What a verdict says of the words of the prompt."""

from __future__ import annotations

from wsim.judge.decide import held
from wsim.judge.verdict import Finding, Verdict
from wsim.plan.asked.covered import Told

PASSED = Verdict(
    status="accepted", summary="Accepted: all 1 findings pass.",
    findings=[Finding(check="CheckFinite", passed=True, message="all numbers are finite")],
)  # fmt: skip


def test_without_a_word_on_the_prompt_it_stays_as_it_is() -> None:
    assert held(PASSED, Told()) == PASSED
    assert "not_checked" not in PASSED.model_dump()


def test_an_accepted_world_says_what_was_not_checked() -> None:
    found = held(PASSED, Told(not_checked=("'gently': nothing measures it",)))
    assert (found.status, found.summary) == ("accepted", "Accepted: all 1 findings pass; not checked: 'gently'.")
    assert found.not_checked == ["'gently': nothing measures it"]
    assert Verdict.model_validate_json(found.model_dump_json()) == found


def test_a_world_that_was_not_asked_what_happens_is_not_accepted() -> None:
    found = held(PASSED, Told(unasked="nothing asks for 'hits'", not_checked=("'hits': no clause has it",)))
    assert (found.status, found.summary) == ("blocked", "Blocked: nothing asks for 'hits'; all 1 findings pass.")


def test_what_failed_stays_failed() -> None:
    failed = PASSED.model_copy(update={"status": "rejected", "summary": "Rejected: 1 of 1 findings fail."})
    found = held(failed, Told(unasked="nothing asks for 'hits'", not_checked=("'hits': no clause has it",)))
    assert (found.status, found.summary) == ("rejected", "Rejected: 1 of 1 findings fail; not checked: 'hits'.")


def test_a_world_says_what_it_stands_in_for() -> None:
    found = held(PASSED, Told(stands_in_for="a bottle that buckles: bodies are rigid."))
    assert found.summary.endswith("It stands in for a bottle that buckles: bodies are rigid.")
