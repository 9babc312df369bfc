"""What a verdict says of a candidate, and which candidate is the better one."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.crashing import CRASH
from wsim.judge.verdict import Finding, Verdict
from wsim.sweep.candidate import Candidate, Outcome, slack
from wsim.sweep.table import ranked, table
from wsim.sweep.work import as_varied


def finding(margin: float | None, limit: float = 1.0, objective: str | None = "the ball flies") -> Finding:
    passed = margin is None or margin >= 0.0
    return Finding(
        check="ObjectiveMoves", passed=passed, message="", objective=objective, value=2.0, limit=limit, margin=margin
    )


def outcome(number: int, status: str, *findings: Finding) -> Outcome:
    verdict = Verdict(status=status, summary="", findings=list(findings)) if status != "failed" else None
    candidate = Candidate(number=number, params={"speed": float(number)})
    return Outcome.of(candidate, verdict, 1.0) if verdict else Outcome(candidate=candidate, status="failed")


def test_the_order_is_that_of_verdicts_then_of_room() -> None:
    rows = [
        outcome(0, "failed"),
        outcome(1, "rejected", finding(-0.5)),
        outcome(2, "accepted", finding(0.1)),
        outcome(3, "rejected", finding(-0.1), finding(9.0)),
        outcome(4, "accepted", finding(0.5)),
        outcome(5, "blocked"),
        outcome(6, "accepted", finding(0.5)),
    ]
    assert [row.candidate.number for row in ranked(rows)] == [4, 6, 2, 3, 1, 5, 0]


def test_a_crash_of_the_judge_is_kept_and_no_parameter_excuses_it() -> None:
    varied = Finding(check="CheckPlanSizes", passed=False, message="twice as long as planned")
    rejected = Verdict(status="rejected", summary="", findings=[finding(0.5), varied], crashes=[CRASH])
    verdict = as_varied(rejected)
    assert verdict.status == "blocked"
    assert verdict.summary.startswith("Blocked: CheckEnergy could not be evaluated: ZeroDivisionError")
    row = Outcome.of(Candidate(number=0), verdict, 1.0)
    assert (row.status, row.failures, row.crashes) == ("blocked", [], [CRASH])
    assert Outcome.model_validate_json(row.model_dump_json()) == row
    assert "CheckEnergy could not be evaluated" in table([row])["reason"].to_pylist()[0]


def test_what_was_asked_decides_and_what_else_failed() -> None:
    room = outcome(0, "accepted", finding(0.5), finding(0.001, objective=None))
    assert (room.slack, room.decided_by) == (pytest.approx(1 / 3), "the ball flies")
    broken = outcome(0, "rejected", finding(0.5), finding(-1.0, objective=None))
    assert (broken.slack, broken.decided_by) == (pytest.approx(-0.5), "ObjectiveMoves")
    assert outcome(0, "accepted", finding(0.001, objective=None)).slack is None


# A subnormal number may be none in another unit.
@given(st.floats(-1e6, 1e6, allow_subnormal=False), st.floats(0.0, 1e6, allow_subnormal=False), st.floats(1e-3, 1e3))
def test_slack_has_the_sign_of_its_margin_and_no_unit(margin: float, limit: float, unit: float) -> None:
    found = slack(finding(margin, limit))
    assert -1.0 <= found <= 1.0
    assert found * margin >= 0.0
    assert slack(finding(unit * margin, unit * limit)) == pytest.approx(found, abs=1e-12)


def test_the_table_has_a_row_a_candidate_and_a_column_a_number() -> None:
    made = table([outcome(1, "rejected", finding(-0.5)), outcome(4, "accepted", finding(0.5)), outcome(0, "failed")])
    assert made.column_names == [
        "rank", "candidate", "program", "seed", "speed", "status", "slack", "decided_by",
        "value: the ball flies", "margin: the ball flies", "failures", "reason", "seconds", "together", "note",
    ]  # fmt: skip
    assert made["candidate"].to_pylist() == [4, 1, 0]
    assert made["margin: the ball flies"].to_pylist() == [0.5, -0.5, None]
