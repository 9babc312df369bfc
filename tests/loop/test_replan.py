"""The way back to the plan: evidence goes to the planner once, and it may mend what contradicts physics, no more."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.agents.flies import MOVES, PROMPT, answer, edit, opinion
from tests.agents.kept import Kept, models
from tests.agents.scripted import Server, text
from tests.patience import STUCK
from wsim.agents import relay
from wsim.agents.budget import Budget
from wsim.agents.planner import read_plan
from wsim.errors import UserError
from wsim.loop.generate import generate
from wsim.loop.options import Generated, Options
from wsim.loop.replay import replay
from wsim.plan.schema import Plan
from wsim.runs.settings import Settings

SETTINGS = Settings(device="cpu", pictures=False)
NO_WORLD = replace(SETTINGS, params={"mass": 1.0})  # the program has no such parameter: it fails in a second
CANNOT = text("CANNOT: 0.2 s at 1.5 m/s are 0.3 m, and the plan asks for 0.5 m.")
LONGER = {"duration": 0.4, "frame_rate": 10}
SHORT = answer()  # in which it comes 0.3 m far


def mended(why: str = "0.5 m at 1.5 m/s take 0.34 s", **change: Any) -> str:
    return json.dumps({"why": why, "plan": answer(**{"simulation": LONGER, **change})})


@pytest.fixture(autouse=True)
def quick(own_cache: None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(relay, "LONGEST_PAUSE", 0.0)


@pytest.fixture
def loop(server: Server, tmp_path: Path) -> Callable[..., Generated]:
    def one(
        settings: Settings = NO_WORLD,
        roles: tuple[str, ...] = ("planner", "coder"),
        approve: Callable[[Plan], bool] = lambda plan: True,
        **budget: Any,
    ) -> Generated:
        server.script.setdefault("planner", []).insert(0, text(json.dumps(SHORT)))
        limits = Budget(**{"request_seconds": STUCK, **budget})
        options = Options(settings=settings, models=models(server, *roles), budget=limits, confirm=False)
        return generate(PROMPT, tmp_path / "runs", options, approve, plan=None)

    return one


def test_a_coder_that_cannot_sends_the_plan_back(
    server: Server, loop: Callable[..., Generated], tmp_path: Path
) -> None:
    server.script |= {"coder": [CANNOT], "planner": [text(mended())]}
    seen: list[float] = []

    def approve(plan: Plan) -> bool:
        seen.append(plan.simulation.duration)
        return True

    done = loop(SETTINGS, approve=approve)
    kept = Kept(done.run.path)
    assert done.verdict is not None
    assert done.verdict.status == kept.facts["status"] == "accepted", done.verdict.summary
    assert seen == [0.2, 0.4]  # the user is asked again
    assert kept.rows == [("recording", "rejected", True), ("all", "accepted", True)]
    assert kept.facts["replans"] == [{
        "after": 1, "by": "coder", "fault": "0.2 s at 1.5 m/s are 0.3 m, and the plan asks for 0.5 m.",
        "why": "0.5 m at 1.5 m/s take 0.34 s", "kept": False, "approved": True,
    }]  # fmt: skip
    request = server.asked("planner")[1]
    for part in (PROMPT, "The coder: 0.2 s at 1.5 m/s are 0.3 m", '"duration": 0.2', "ObjectiveMoves"):
        assert part in request
    folder = kept.folder
    assert json.loads((folder / "plan-1.json").read_text())["simulation"]["duration"] == 0.2
    assert json.loads((folder / "plan.json").read_text())["simulation"]["duration"] == 0.4
    assert '+    "duration": 0.4,' in (folder / "plan.diff").read_text()
    assert done.plan is not None
    assert done.plan.assumptions[-1].choice == "0.5 m at 1.5 m/s take 0.34 s"
    page = (folder / "report.html").read_text()
    assert "The way back to the plan" in page
    assert "0.5 m at 1.5 m/s take 0.34 s" in page
    again = replay(folder, tmp_path / "again")
    assert again.divergences == []
    assert again.differing == []


def test_a_judge_that_names_the_plan_sends_it_back(server: Server, loop: Callable[..., Generated]) -> None:
    fault = "0.2 s are too short for 0.5 m"
    server.script |= {"judge": [text(opinion(False, plan=fault))], "planner": [text(mended())]}
    done = loop(SETTINGS, ("planner", "judge", "coder"))
    kept = Kept(done.run.path)
    assert [(row["by"], row["fault"], row["approved"]) for row in kept.facts["replans"]] == [("judge", fault, True)]
    assert kept.rows[-1] == ("all", "accepted", True)
    assert not server.asked("coder")


NO: dict[str, tuple[str, str]] = {
    "nonsense": ("Let me think.", "no JSON object in the answer"),
    "no plan": ('{"why": "so"}', 'answer {"why": ..., "plan": {...}}'),
    "the same plan": (mended(simulation=SHORT["simulation"]), "the plan is as it was"),
    "a weaker objective": (mended(objectives=[{**MOVES, "value": 0.3}]), "asks for less: 'half a metre'"),
    "an objective gone": (mended(objectives=[], clauses=[]), "objectives: none"),
    "a plan that cannot come true": (
        mended(objectives=[{"kind": "formula", "object": "ball", "sentence": "eventually[0, 9] (moves(ball, 0.5 m))"}]),
        "its windows reach to 9 s",
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", NO)
def test_a_planner_that_mends_nothing_is_stopped(server: Server, loop: Callable[..., Generated], what: str) -> None:
    wrong, told = NO[what]
    server.script["coder"] = [CANNOT]
    server.forever["planner"] = text(wrong)
    done = loop()
    kept = Kept(done.run.path)
    assert done.verdict is not None
    assert done.verdict.status == "blocked"
    assert kept.facts["cause"].startswith("the coder's model: gave up: ")
    (row,) = kept.facts["replans"]
    assert row["kept"]
    assert told in row["why"]
    assert len(server.asked("planner")) == 1 + 5  # the plan, and five answers that could not be used
    assert kept.numbers == ["01"]
    assert not (kept.folder / "plan.diff").exists()


def test_a_planner_that_keeps_its_plan_ends_it(server: Server, loop: Callable[..., Generated]) -> None:
    server.script |= {"coder": [CANNOT], "planner": [text('{"keep": "the program is too short, not the plan"}')]}
    kept = Kept(loop().run.path)
    assert kept.facts["status"] == "blocked"
    assert kept.facts["replans"][0]["why"] == "the program is too short, not the plan"


def test_it_goes_back_once(server: Server, loop: Callable[..., Generated]) -> None:
    server.forever |= {"coder": CANNOT, "planner": text(mended())}
    kept = Kept(loop().run.path)
    assert kept.numbers == ["01", "02"]
    assert len(server.asked("planner")) == 2
    assert kept.facts["cause"].startswith("the coder's model: gave up: ")


def test_a_person_may_say_no(server: Server, loop: Callable[..., Generated], tmp_path: Path) -> None:
    server.script |= {"coder": [CANNOT], "planner": [text(mended())]}
    kept = Kept(loop(approve=lambda plan: plan.simulation.duration == 0.2).run.path)
    assert [(row["kept"], row["approved"]) for row in kept.facts["replans"]] == [(False, False)]
    assert kept.numbers == ["01"]
    assert kept.facts["status"] == "blocked"
    assert not (kept.folder / "plan-1.json").exists()
    assert replay(kept.folder, tmp_path / "again").generated.run.facts()["replans"] == kept.facts["replans"]


def test_an_objection_traded_for_a_smaller_one_is_kept(server: Server, tmp_path: Path) -> None:
    """Of two worlds with an objection each the one with the minor objection is better."""

    def objects(what: str, severity: str) -> Any:
        return text(opinion(False, objections=[{"object": "ball", "what": what, "severity": severity}]))

    server.script["judge"] = [objects("it is far too small", "major"), objects("it is a little small", "minor")]
    server.script["coder"] = [text(edit("radius=0.1", "radius=0.1005"))]
    options = Options(
        settings=SETTINGS, models=models(server, "coder", "judge"), budget=Budget(2, request_seconds=STUCK)
    )
    options.fresh = True  # the second request reads as the first did: the checks find the same
    done = generate(PROMPT, tmp_path / "runs", options, plan=read_plan(answer(simulation=LONGER), PROMPT))
    kept = Kept(done.run.path)
    assert kept.rows == [("review", "rejected", True), ("review", "rejected", True)]
    assert kept.facts["best"] == 2


SHATTERS = "A thrown ball flies half a metre and shatters."
INSTEAD = json.dumps({"cannot": "a ball that shatters: bodies are rigid", "nearest": answer(simulation=LONGER)})


@pytest.mark.parametrize("nearest", [False, True])
def test_the_nearest_world_is_built_where_that_is_wanted(server: Server, tmp_path: Path, nearest: bool) -> None:
    server.script["planner"] = [text(INSTEAD)]
    options = Options(settings=SETTINGS, models=models(server, "planner"), confirm=False, nearest=nearest)
    done = generate(SHATTERS, tmp_path / "runs", options)
    kept = Kept(done.run.path)
    if not nearest:
        assert done.verdict is None
        assert kept.facts["status"] == "not approved"
        assert kept.facts["summary"] == "it would stand in for a ball that shatters: bodies are rigid"
        return
    assert done.verdict is not None
    assert (done.verdict.status, done.verdict.not_checked) == (
        "accepted", ["'shatters': the world stands in for it"],
    )  # fmt: skip
    said = "not checked: 'shatters'. It stands in for a ball that shatters: bodies are rigid."
    assert done.verdict.summary.endswith(said)
    page = (kept.folder / "report.html").read_text()
    assert "This world stands in for what cannot be simulated" in page


def test_a_world_of_which_nothing_asks_what_happens_is_blocked(server: Server, tmp_path: Path) -> None:
    """Its checks pass, and no patch can show what no objective asks for: no coder is asked."""
    clauses = [{"words": "A thrown ball", "by": ["ball.velocity"]}, {"words": "half a metre", "by": [0]}]
    plan = read_plan(answer(simulation=LONGER, clauses=clauses), PROMPT)
    options = Options(settings=SETTINGS, models=models(server, "coder"), confirm=False)
    done = generate(PROMPT, tmp_path / "runs", options, plan=plan)
    assert done.verdict is not None
    assert done.verdict.status == "blocked"
    assert done.verdict.summary.startswith("Blocked: nothing asks for 'flies'; all ")
    assert done.verdict.not_checked == ["'flies': no clause has it"]
    assert server.requests == []
    assert "Not checked" in (done.run.path / "report.html").read_text()


def test_a_plan_without_objectives_is_not_begun(tmp_path: Path) -> None:
    plan = read_plan(answer(clauses=None), PROMPT).model_copy(update={"objectives": []})
    with pytest.raises(UserError, match="objectives: none; say what must happen"):
        generate(PROMPT, tmp_path / "runs", plan=plan)
    assert not (tmp_path / "runs").exists()


def test_a_sentence_can_be_tried_afresh(server: Server, tmp_path: Path) -> None:
    """What was answered before answers again, unless fresh answers are asked for; these are kept in turn."""
    server.script["planner"] = [text(json.dumps(answer(title="Another")))]
    options = Options(settings=NO_WORLD, models=models(server, "planner"))

    def title(fresh: bool) -> str:
        options.fresh = fresh
        done = generate(PROMPT, tmp_path / "runs", options, lambda plan: False)
        assert done.plan is not None
        return done.plan.title

    server.script["planner"].insert(0, text(json.dumps(SHORT)))
    assert [title(fresh) for fresh in (False, False, True, False)] == [SHORT["title"]] * 2 + ["Another"] * 2
