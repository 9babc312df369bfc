"""What the judge's model may do: object, and say what to mend. What it may not: accept what failed."""

from __future__ import annotations

import json
import re
from typing import Any

import pytest

from tests.agents.scripted import Server, text
from wsim.agents.ask import RETRIES, Desk
from wsim.agents.failures import ModelError
from wsim.agents.judge import PLAN_STAYS, Opinion, decide, opinion
from wsim.judge.verdict import Finding, Verdict
from wsim.plan.schema import Plan
from wsim.plan.schema.cords import Cord

PASSED = Verdict(status="accepted", summary="ok", findings=[Finding(check="CheckEnergy", passed=True, message="ok")])
FAILED = Verdict(
    status="rejected", summary="no", findings=[Finding(check="ObjectiveSlides", passed=False, message="it sticks")]
)
OBJECTION = {"object": "crate", "what": "it is upside down"}
REPAIR = {"kind": "physical parameter", "object": "crate", "parameter": "friction", "why": "it sticks; take 0.2"}


def said(accept: bool, objections: list[Any] | None = None, repair: Any = None, **more: Any) -> str:
    return json.dumps({"accept": accept, "why": "so", "repair": repair, "objections": objections or [], **more})


def ask(desk: Desk, plan: Plan, passed: bool = True, seen: str = "") -> Opinion:
    lines = ["accepted: 0 of 1 findings fail"] if passed else ["rejected: 1 of 1 findings fail", "ObjectiveSlides"]
    return opinion(desk, plan, ["ground", "ramp", "crate"], lines, seen, passed)


@pytest.mark.parametrize("objections", [[], [OBJECTION]])
def test_what_failed_cannot_be_talked_away(server: Server, desk: Desk, slide: Plan, objections: list[Any]) -> None:
    server.script["judge"] = [text(said(True, objections, why="The check is wrong; accept this world."))]
    held = ask(desk, slide, passed=False)
    assert held.accept
    assert decide(FAILED, held) == FAILED


def test_an_objection_rejects_what_passed(server: Server, desk: Desk, slide: Plan) -> None:
    server.script["judge"] = [text(f"```json\n{said(False, [OBJECTION])}\n```")]
    verdict = decide(PASSED, ask(desk, slide, seen="The crate stands on its lid."))
    assert verdict.status == "rejected"
    (finding,) = verdict.failures
    assert (finding.check, finding.prim) == ("JudgeObjection", "/World/crate")
    assert finding.message == "crate: it is upside down"
    assert finding.target is not None
    assert finding.target.kind == "visual mismatch"
    assert PASSED.findings[0] in verdict.findings
    (request,) = server.asked("judge")
    for part in (slide.prompt, "ramp", "accepted: 0 of 1", "The crate stands on its lid."):
        assert part in request


def test_a_judge_is_told_when_the_plan_stays(server: Server, desk: Desk, slide: Plan) -> None:
    server.script["judge"] = [text(said(False, repair=REPAIR))] * 2
    for stays in (False, True):
        opinion(desk, slide, ["ramp"], ["rejected: 1 of 1 findings fail"], "", passed=False, plan_stays=stays)
    assert [PLAN_STAYS in request for request in server.asked("judge")] == [False, True]


def test_cords_are_named_as_objects_are(server: Server, desk: Desk, slide: Plan) -> None:
    rope = Cord(name="rope", kind="rope", b="crate", anchor_a=(0.0, 0.0, 3.0))
    server.script["judge"] = [text(said(False, [{**OBJECTION, "object": "rope"}]))]
    held = ask(desk, slide.model_copy(update={"cords": [rope]}))
    assert held.objections[0].object == "rope" and len(server.asked("judge")) == 1


def test_an_objection_beside_a_failed_check_says_nothing_that_counts(server: Server, desk: Desk, slide: Plan) -> None:
    server.script["judge"] = [text(said(False, [OBJECTION], REPAIR))]
    held = ask(desk, slide, passed=False)
    assert decide(FAILED, held) == FAILED
    assert held.repair is not None
    assert held.repair.sentence == "physical parameter (friction of crate): it sticks; take 0.2"
    assert "nobody has looked at pictures yet" in server.asked("judge")[0]


def test_an_accepted_world_stays_accepted(server: Server, desk: Desk, slide: Plan) -> None:
    server.script["judge"] = [text(said(True))]
    assert decide(PASSED, ask(desk, slide)) == PASSED


@pytest.mark.parametrize(
    ("answer", "passed", "message"),
    [
        (
            said(False, [{**OBJECTION, "object": "giraffe"}]),
            True,
            "the plan has no object 'giraffe'; it has crate, ground",
        ),
        (said(False, repair=REPAIR), True, "every check passed: accept, or object to an object of the plan"),
        (said(False), True, "every check passed: accept, or object"),
        (said(False), False, "not accepted, and neither a repair, a fault of the plan nor an objection"),
        (said(False, repair={**REPAIR, "kind": "magic"}), False, "repair.kind: .*; kinds are physical parameter"),
        (said(False, repair={"kind": "camera"}), False, "repair.why: it is missing"),
        (said(True, score=10), True, "score: there is no such field"),
        ('{"why": "fine"}', True, "accept: it is missing"),
        ("I accept.", True, "no JSON object in the answer"),
        (said(True)[:-3], True, "not JSON"),
    ],
)
def test_what_is_no_opinion_is_sent_back(
    server: Server, desk: Desk, slide: Plan, answer: str, passed: bool, message: str
) -> None:
    server.script["judge"] = [text(answer), text(said(True))]
    assert ask(desk, slide, passed).accept
    first, second = server.asked("judge")
    assert re.search(message, second)
    assert not re.search(message, first)


def test_a_judge_that_never_says_anything_usable_is_none(server: Server, desk: Desk, slide: Plan) -> None:
    server.forever["judge"] = text(said(False, [{**OBJECTION, "object": "giraffe"}]))
    with pytest.raises(ModelError) as caught:
        ask(desk, slide)
    assert (caught.value.kind, caught.value.role) == ("unusable", "judge")
    assert len(server.requests) == RETRIES + 1
