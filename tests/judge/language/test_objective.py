"""A formula in a plan: what the verdict says of it."""

import numpy as np
import pytest
from pydantic import ValidationError

from wsim.judge import judge
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.language import ObjectiveCheck, parse
from wsim.plan.schema import Objective, Plan

TOP = "/World/box_3"


def verdict(case, said, sentence=""):
    objective = Objective(kind="formula", object="box_3", formula=parse(said), sentence=sentence)
    plan = case.plan.model_copy(update={"objectives": [objective]})
    found = judge(case.recording, plan)
    return found, [finding for finding in found.findings if finding.check == "ObjectiveFormula"]


def test_a_tower_that_stands_is_accepted(stack):
    found, (upright, rests) = verdict(stack(), "upright(box_3, 10 deg) and rests_on(box_3, box_2)")
    assert found.status == "accepted", found.summary
    assert upright.value == 0.0 and upright.limit == 10.0 and upright.margin == 10.0 and upright.unit == "deg"
    assert upright.prim == rests.prim == TOP and upright.line == "program.py:22"
    assert upright.limit_from == "the objective's angle"
    assert upright.objective == "upright(box_3, within 10 deg) and rests_on(box_3, box_2)"
    assert upright.span == (0.0, 3.0)


def test_a_tower_that_falls_is_rejected_with_the_moment_and_the_angle(stack):
    found, (upright,) = verdict(stack(fallen=True), "always[0, 1.4](upright(box_3, 10 deg))", "The tower stands.")
    assert found.status == "rejected" and upright.objective == "The tower stands."
    # It turns by 90 degrees from 1.25 to 1.5 s, in frames of 1/30 s: 54 degrees at 1.4 s.
    assert upright.value == pytest.approx(54.0, abs=1e-3) and upright.margin == pytest.approx(-44.0, abs=1e-3)
    assert upright.time == pytest.approx(1.4) and upright.span == (pytest.approx(1.3), pytest.approx(3.0))
    assert "54 deg at 1.400 s, where 10 deg is the most" in upright.message


def test_a_mean_over_a_window_is_told_with_its_ends(stack):
    """Upright until 1.25 s, 90 degrees from 1.5 s on: what comes after the window is not looked at."""
    _, (before,) = verdict(stack(fallen=True), "mean[0.5, 1](upright(box_3, 10 deg))")
    assert before.passed and before.span == (0.0, pytest.approx(1.0)) and "from 0.500 s to 1.000 s" in before.message
    _, (after,) = verdict(stack(fallen=True), "mean[2, 2.5](upright(box_3, 10 deg))")
    assert after.value == pytest.approx(90.0, abs=1e-2) and after.time == pytest.approx(2.0) and not after.passed
    assert after.span == (pytest.approx(1.3), pytest.approx(2.5))


def test_a_conjunct_that_fails_is_told_from_one_that_holds(stack):
    _, (stands, falls) = verdict(stack(fallen=True), "upright(box_2, 10 deg) and rests_on(box_3, box_2)")
    assert stands.passed and not falls.passed
    assert stands.prim == "/World/box_2" and falls.prim == TOP


def test_a_denial_keeps_the_limit_from_the_other_side(stack):
    _, (fell,) = verdict(stack(fallen=True), "not always(upright(box_3, 10 deg))")
    assert fell.passed and fell.value == pytest.approx(90.0, abs=1e-2) and fell.limit == 10.0
    assert fell.margin == pytest.approx(80.0, abs=1e-2) and "10 deg is the least" in fell.message
    _, (stands,) = verdict(stack(), "not always(upright(box_3, 10 deg))")
    assert not stands.passed and stands.margin == -10.0


@pytest.mark.parametrize(
    ("said", "why"),
    [
        ("always[2, 9](settles(box_3))", "box_3: the window [2, 9] s is not covered: the recording has 3 s"),
        ("touches(box_3, lamp)", "the world has no 'lamp'; it has /World/box_1"),
        ("rolls_without_slip(box_3)", "not round"),
        ("contained_in(box_3, ground)", "no container, and not hollow either; containers are none"),
    ],
)
def test_what_cannot_be_judged_fails_and_says_why(stack, said, why):
    found, (finding,) = verdict(stack(), said)
    assert found.status == "rejected" and not finding.passed
    assert finding.prim == TOP and finding.objective == said and why in finding.message


def test_a_signal_that_was_not_recorded_is_not_satisfied(stack):
    case = stack()
    case = case.changed(contact_force=np.full_like(case.recording.contact_force, np.nan))
    for said in ("supported_by(box_1, ground)", "not supported_by(box_1, ground)"):
        objective = Objective(kind="formula", object="box_1", formula=parse(said))
        (finding,) = ObjectiveCheck(objective).run(Evidence(case.recording, case.plan))
        assert not finding.passed and finding.margin is None
        assert "force of contacts upwards of /World/box_1 is not known" in finding.message


def test_a_plan_keeps_its_formula_in_json(stack):
    plan = stack().plan
    objective = Objective(kind="formula", object="box_3", formula=parse("always[0, 2](upright(box_3, 10 deg))"))
    whole = Plan.model_validate({**plan.model_dump(), "objectives": [objective.model_dump()], "clauses": []})
    assert Plan.model_validate_json(whole.model_dump_json()).objectives == [objective]
    lamp = {"kind": "formula", "object": "box_3", "formula": {"op": "touches", "object": "box_3", "ref": "lamp"}}
    with pytest.raises(ValidationError, match=r"objectives\.0\.formula: no object 'lamp'; the plan has"):
        Plan.model_validate({**plan.model_dump(), "objectives": [lamp]})


def test_a_formula_goes_with_its_own_kind():
    with pytest.raises(ValidationError, match="it has none"):
        Objective(kind="formula", object="a")
    with pytest.raises(ValidationError, match="this is 'settles'"):
        Objective(kind="settles", object="a", formula=parse("settles(a)"))
