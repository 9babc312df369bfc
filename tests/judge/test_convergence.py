"""What counts as converged: verdicts stand, and numbers move by less than a share of their margin."""

from __future__ import annotations

from typing import Any

import pytest

from tests.crashing import CRASH
from wsim.judge.convergence import CheckConverged, Rerun
from wsim.judge.verdict import Finding, RepairTarget, Verdict

TARGET = RepairTarget(kind="time step", parameter="time_step", direction="lower")


def measured(value: float, limit: float = 10.0, unit: str = "mm", **fields: Any) -> Finding:
    """An objective's finding that wants at most `limit`."""
    whole = {"check": "ObjectiveStops", "objective": "it stops", "prim": "/World/it", "message": "it stopped"}
    numbers = {"value": value, "limit": limit, "margin": limit - value, "unit": unit, "passed": value <= limit}
    return Finding.model_validate({**whole, **numbers, **fields})


def verdict(*findings: Finding) -> Verdict:
    return Verdict(status="accepted", summary="", findings=list(findings))


def compare(first: Finding, *again: Finding) -> list[Finding]:
    rerun = Rerun("half the time step", verdict(*again), 0.5, "theory", TARGET)
    return CheckConverged().compare(verdict(first), [rerun])


@pytest.mark.parametrize(("second", "passed"), [(6.1, True), (7.9, True), (8.1, False), (9.1, False)])
def test_a_number_may_move_by_its_share_of_the_margin(second: float, passed: bool) -> None:
    (finding,) = compare(measured(6.0), measured(second))  # margin 4: it may move by 2
    assert finding.passed is passed
    assert (finding.value, finding.limit) == (pytest.approx(abs(second - 6.0)), pytest.approx(2.0))
    assert finding.message.startswith("Not converged") is not finding.passed
    assert "6 mm at first" in finding.message
    assert f"{second:.4g} mm with half the time step" in finding.message
    assert finding.limit_from == "0.5 of the margin: theory"
    assert (finding.target is None) is finding.passed


@pytest.mark.parametrize("second", [5.0, 3.1, 0.0, -20.0])
def test_a_number_that_moves_away_from_its_only_limit_stands(second: float) -> None:
    assert compare(measured(9.9), measured(second))[0].passed  # whatever it comes to in the limit, it keeps to 10


@pytest.mark.parametrize(("second", "passed"), [(9.9, False), (8.5, True), (4.6, True), (4.4, False)])
def test_a_number_that_moves_towards_what_is_expected_has_the_room_to_the_other_side(
    second: float, passed: bool
) -> None:
    """At most 10 about 5: at 9 it has 1 to its limit and 9 to 0, which is as far on the other side."""
    (finding,) = compare(measured(9.0, expected=5.0), measured(second, expected=5.0))
    assert finding.limit == pytest.approx(0.5 * (1.0 if second > 9.0 else 9.0))
    assert finding.passed is passed


def test_an_objective_that_crashed_in_the_rerun_is_not_gone_from_it() -> None:
    crash = CRASH.model_copy(update={"check": "ObjectiveStops", "objective": "it stops"})
    again = Verdict(status="blocked", summary="", findings=[measured(6.0, objective=None)], crashes=[crash])
    found = CheckConverged().compare(
        verdict(measured(6.0)), [Rerun("half the time step", again, 0.5, "theory", TARGET)]
    )
    assert all(finding.passed for finding in found)


def test_a_limit_that_tightens_with_the_resolution_is_no_move() -> None:
    (finding,) = compare(measured(6.0), measured(6.0, limit=8.0))
    assert (finding.passed, finding.value) == (True, 0.0)


def test_numbers_of_different_units_are_compared_as_shares_of_their_limits() -> None:
    (near,) = compare(measured(6.0), measured(30.0, limit=60.0, unit="deg"))  # 0.4 and 0.5 of the limit
    (far,) = compare(measured(6.0), measured(57.0, limit=60.0, unit="deg"))  # 0.4 and 0.05
    assert (near.passed, near.value, near.limit) == (True, pytest.approx(0.1), pytest.approx(0.2))
    assert not far.passed


def test_every_verdict_must_stand_a_checks_too() -> None:
    check = Finding(check="CheckEnergy", passed=True, message="no gain", prim="/World/it", value=1.0, unit="J")
    fell = check.model_copy(update={"passed": False, "message": "2 J gained", "value": 2.0, "prim": "/World/other"})
    (finding,) = compare(check, fell)
    assert not finding.passed
    assert (finding.value, finding.expected, finding.unit) == (2.0, 1.0, "J")
    assert "with half the time step, CheckEnergy fails: 2 J gained; at first: no gain" in finding.message
    assert finding.target == TARGET
    (calm,) = compare(check, check.model_copy(update={"value": 1.9}))  # a check's number may move as it likes
    assert calm.passed


def test_what_fails_only_in_the_rerun_and_what_is_gone_from_it_fail() -> None:
    known = measured(6.0)
    (new,) = [
        f for f in compare(known, known, measured(0.0, check="control", objective=None, passed=False)) if not f.passed
    ]
    assert "control fails" in new.message
    (gone,) = compare(known)
    assert not gone.passed
    assert "not found" in gone.message


def test_of_several_reruns_the_worst_is_told_or_all_that_fail() -> None:
    reruns = [
        Rerun(f"another seed ({k})", verdict(measured(6.0 + k)), 0.5, "theory", TARGET)
        for k in (0.1, 1.5, 0.7, 2.5, 3.5)
    ]
    (worst,) = CheckConverged().compare(verdict(measured(6.0)), reruns[:3])
    assert (worst.passed, worst.value) == (True, pytest.approx(1.5))
    failed = CheckConverged().compare(verdict(measured(6.0)), reruns)
    assert [finding.value for finding in failed] == pytest.approx([2.5, 3.5])
