"""Whatever its models do, the loop ends, says why, and loses nothing."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest

from tests import children
from tests.agents.flies import PROMPT, edit, flies, lasts, opinion
from tests.agents.kept import Kept, models
from tests.agents.scripted import Server, call, hang, status, text
from tests.crashing import crashing
from tests.patience import STUCK, until
from wsim.agents import relay
from wsim.agents.budget import Budget
from wsim.agents.models import ROLES, Models
from wsim.agents.transcript import read
from wsim.judge.checks.energy import CheckEnergy
from wsim.loop.generate import generate
from wsim.loop.options import Generated, Options
from wsim.plan.schema import Plan
from wsim.progress import silent
from wsim.runs.settings import Settings

SETTINGS = Settings(device="cpu", pictures=False)
NO_WORLD = replace(SETTINGS, params={"mass": 1.0})  # the program has no such parameter: it fails in a second


@pytest.fixture(autouse=True)
def quick(own_cache: None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(relay, "LONGEST_PAUSE", 0.0)


@pytest.fixture
def loop(server: Server, tmp_path: Path) -> Callable[..., Generated]:
    """Make the thrown ball with the server's coder."""

    def one(
        settings: Settings = NO_WORLD,
        roles: tuple[str, ...] = ("coder",),
        progress: Any = silent,
        plan: Plan | None = None,
        **budget: Any,
    ) -> Generated:
        limits = Budget(**{"request_seconds": STUCK, **budget})
        options = Options(settings=settings, models=models(server, *roles), budget=limits)
        given = None if "planner" in roles else plan or flies()
        return generate(PROMPT, tmp_path / "runs", options, plan=given, progress=progress)

    return one


def blocked(done: Generated, cause: str) -> Kept:
    """What a run has left that ended without an accepted world: nothing of it is lost, and it says why."""
    kept = Kept(done.run.path)
    assert done.verdict is not None
    assert done.verdict.status == kept.facts["status"] == "blocked"
    assert kept.facts["cause"].startswith(cause), kept.facts["cause"]
    assert done.verdict.summary.startswith(cause)
    assert not list(kept.folder.glob("accepted*"))
    assert (kept.folder / "report.html").is_file()
    assert "usage" in kept.facts
    for number, row in enumerate(kept.facts.get("iterations", []), start=1):
        assert row["number"] == number
        assert json.loads(kept.text(number, "verdict.json"))["status"] == row["status"]
        assert kept.text(number)
        assert number == 1 or kept.text(number, "patch.diff")
    if kept.facts.get("iterations"):
        assert f"Best so far: iteration {kept.facts['best']}" in done.verdict.summary
    read(kept.folder)
    return kept


def test_the_iteration_limit(server: Server, loop: Callable[..., Generated]) -> None:
    server.script["coder"] = [text(lasts(0.3)), text(lasts(0.5)), text(lasts(0.6))]
    kept = blocked(loop(iterations=3), "iteration limit: 3 programs were tried")
    assert kept.rows == [("build", "rejected", True), ("build", "rejected", False), ("build", "rejected", False)]
    assert kept.facts["best"] == 1
    assert len(server.requests) == 2
    assert "iteration 2" in server.asked("coder")[1]


def test_the_token_limit(server: Server, loop: Callable[..., Generated]) -> None:
    server.forever["coder"] = text("I am thinking about it.")
    kept = blocked(loop(tokens=2000), "token limit: 2200 of 2000 tokens are used")
    assert kept.rows == [("build", "rejected", True)]
    assert kept.facts["usage"]["tokens"] == 2200


@dataclass
class Clock:
    """Time that a test can let pass."""

    ahead: float = 0.0

    def monotonic(self) -> float:

        return time.monotonic() + self.ahead


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    """The time that budgets are held to."""
    made = Clock()
    monkeypatch.setattr("wsim.agents.budget.time", made)
    return made


def test_the_time_limit_while_a_model_thinks(server: Server, loop: Callable[..., Generated], clock: Clock) -> None:
    def late(handler: Any, body: Any) -> None:
        clock.ahead = 1000.0
        status(500)(handler, body)

    server.forever["coder"] = late
    kept = blocked(loop(seconds=600.0), "time limit: 600 s are over")
    assert kept.rows == [("build", "rejected", True)]
    assert len(server.requests) == 1


def test_the_time_limit_in_the_middle_of_a_simulation(
    server: Server, loop: Callable[..., Generated], clock: Clock
) -> None:
    server.script["coder"] = [text(lasts(0.4))]
    seen: list[str] = []

    def progress(stage: str, done: float, total: float) -> None:
        seen.append(stage)
        if stage.startswith("simulating") and len(server.requests) == 1 and done > 0:
            clock.ahead = 1000.0

    kept = blocked(loop(SETTINGS, progress=progress, seconds=600.0), "time limit: 600 s are over")
    assert seen[-1].startswith("simulating")
    assert kept.rows == [("recording", "rejected", True)]
    assert kept.numbers == ["01", "02"]  # the second was not finished; its program is there
    assert "duration=0.4" in kept.text(2)
    assert not list(kept.folder.rglob("*.partial"))


def test_a_limit_before_acceptance_loses_nothing(server: Server, loop: Callable[..., Generated], clock: Clock) -> None:
    def late(handler: Any, body: Any) -> None:
        clock.ahead = 1000.0
        text(opinion())(handler, body)

    server.script["judge"] = [late]
    good = flies(simulation={"duration": 0.4, "frame_rate": 10})
    done = loop(SETTINGS, ("coder", "judge"), plan=good, seconds=600.0)
    kept = blocked(done, "time limit: 600 s are over")
    assert kept.rows == [("review", "blocked", True)]
    assert done.verdict is not None
    assert done.verdict.findings
    assert all(finding.passed for finding in done.verdict.findings)


@pytest.mark.parametrize(
    ("entry", "kind"), [(status(429), "rate limit"), (status(401), "refused"), (text("No."), "unusable")]
)
def test_a_coder_that_fails(server: Server, loop: Callable[..., Generated], entry: Any, kind: str) -> None:
    server.script["coder"] = [text(lasts(0.3))]
    server.forever["coder"] = entry
    kept = blocked(loop(), f"the coder's model: {kind}: ")
    assert kept.numbers == ["01", "02"]
    assert kept.facts["best"] == 1


def test_a_coder_that_only_calls_tools(server: Server, loop: Callable[..., Generated]) -> None:
    server.forever["coder"] = call("show_skill", {"name": "cameras-and-light"})
    blocked(loop(), "the coder's model: unusable: ")
    assert len(server.requests) < 25


def test_a_coder_that_says_the_same_for_ever(server: Server, loop: Callable[..., Generated]) -> None:
    server.forever["coder"] = text(lasts(0.3))
    kept = blocked(loop(), "the coder's model: unusable: ")
    assert kept.numbers == ["01", "02"]
    assert "the program of iteration 2" in kept.facts["cause"]


def test_a_planner_that_talks_rubbish(server: Server, loop: Callable[..., Generated]) -> None:
    server.forever["planner"] = text('{"title": 3, "objects": "none"}')
    kept = blocked(loop(roles=ROLES), "the planner's model: unusable: ")
    assert "iterations" not in kept.facts
    assert len(read(kept.folder)) == 5


def test_rubbish_of_all_roles_but_the_planner(server: Server, loop: Callable[..., Generated]) -> None:
    server.forever |= {role: text("la la la") for role in ROLES}
    kept = blocked(loop(SETTINGS, ("coder", "reviewer", "judge")), "the coder's model: unusable: ")
    assert kept.rows == [("physics", "rejected", True)] or kept.rows == [("recording", "rejected", True)]
    assert kept.facts["notes"] == [
        "iteration 1 was judged by the checks alone: the judge's model: unusable: 5 answers could not be used; the "
        "last: no JSON object in the answer; give one, between ```json and ```"
    ]


def test_a_judge_that_lies_changes_nothing(server: Server, loop: Callable[..., Generated]) -> None:
    server.forever["judge"] = text(opinion(True, why="Perfect. The check is wrong."))
    kept = blocked(loop(SETTINGS, ("coder", "judge"), iterations=1), "iteration limit: 1 programs were tried")
    assert kept.facts["notes"] == ["iteration 1: the judge's model would accept; failed checks stay failed"]


def test_an_objection_keeps_a_world_back(server: Server, loop: Callable[..., Generated]) -> None:
    objection = {"object": "ball", "what": "it is a cube"}
    server.forever["judge"] = text(opinion(False, objections=[objection]))
    server.script["coder"] = [text(edit("radius=0.1", "radius=0.101"))]
    good = flies(simulation={"duration": 0.4, "frame_rate": 10})
    kept = blocked(loop(SETTINGS, ("coder", "judge"), plan=good, iterations=2), "iteration limit")
    assert kept.rows == [("review", "rejected", True), ("review", "rejected", False)]
    assert kept.facts["iterations"][0]["failed"] == ["JudgeObjection"]
    assert "it is a cube" in server.asked("coder")[0]


def test_a_reviewer_that_fails_leaves_the_facts(server: Server, tmp_path: Path) -> None:
    server.forever["reviewer"] = text("<html>It flies!</html>")
    server.script["judge"] = [text(opinion())]
    options = Options(settings=replace(SETTINGS, pictures=True), models=models(server, "reviewer", "judge"))
    options.confirm = False
    plan = flies(simulation={"duration": 0.4, "frame_rate": 10})
    done = generate(PROMPT, tmp_path / "runs", options, plan=plan)
    kept = Kept(done.run.path)
    assert kept.facts["status"] == "accepted"
    (note,) = kept.facts["notes"]
    assert note.startswith("iteration 1 was reviewed by facts alone: the reviewer's model: unusable: ")
    found = json.loads(kept.text(1, "review.json"))
    assert found["by"] == "builtin"
    (line,) = found["review"]["facts"]
    assert line.startswith("side (% of picture at start/least/end): ")
    assert line in server.asked("judge")[0]


def test_ctrl_c_while_a_model_thinks(server: Server, tmp_path: Path) -> None:
    """In a process of its own: an interrupt would stop whoever runs the tests as well."""
    server.script["coder"] = [hang]
    (tmp_path / "plan.json").write_text(flies().model_dump_json(), encoding="utf-8")
    command = ["generate", "--plan", "plan.json", "--yes", "--device", "cpu", "--no-pictures", "--set", "mass=1"]
    command += ["--coder-model", models(server, "coder").coder]
    command = [sys.executable, "-m", "wsim.cli", *command]
    with children.started(command, cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as process:
        until(lambda: server.asked("coder") or process.poll() is not None)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=STUCK)
    assert process.returncode == 130, err
    (folder,) = (tmp_path / "runs").iterdir()
    kept = Kept(folder)
    assert (kept.facts["status"], kept.facts["summary"]) == ("stopped", "interrupted")
    assert kept.rows == [("build", "rejected", True)]
    assert kept.facts["usage"]["tokens"] == 0


def test_a_model_that_cannot_be_reached_leaves_nothing(tmp_path: Path) -> None:
    from wsim.errors import UserError

    with pytest.raises(UserError, match="model of the judge: nobody:m"):
        generate(PROMPT, tmp_path / "runs", Options(models=Models(judge="nobody:m")), plan=flies())
    with pytest.raises(UserError, match=r"--image .*none\.png: No such file"):
        generate(PROMPT, tmp_path / "runs", Options(models=Models(), image=tmp_path / "none.png"), plan=flies())
    assert not (tmp_path / "runs").exists()


# --- nobody but the judge


def test_without_a_coder_the_judges_own_suggestions_are_applied(tmp_path: Path) -> None:
    done = generate(PROMPT, tmp_path, Options(settings=SETTINGS), plan=flies())
    kept = Kept(done.run.path)
    assert done.verdict is not None
    assert done.verdict.status == "accepted", done.verdict.summary
    assert kept.rows == [("recording", "rejected", True), ("all", "accepted", True)]
    patch = (done.run.path / "iterations" / "02" / "patch.diff").read_text()
    assert [line for line in patch.splitlines()[2:] if line[:1] in "+-"] == [
        "-    scene.simulation(duration=0.2, frame_rate=10.0)",
        "+    scene.simulation(duration=0.4, frame_rate=10.0)",
    ]
    assert kept.facts["reasons"] == {"02": "ObjectiveMoves: raise duration from 0.2 to 0.4 s"}


def test_without_a_coder_it_ends_rejected_where_nothing_is_left_to_try(tmp_path: Path) -> None:
    """No suggestion makes a parameter that the program does not have."""
    done = generate(PROMPT, tmp_path, Options(settings=NO_WORLD), plan=flies())
    assert done.verdict is not None
    assert done.verdict.status == "rejected"
    assert len(Kept(done.run.path).rows) == 1


def test_without_a_coder_it_ends_at_its_limit(tmp_path: Path) -> None:
    options = Options(settings=SETTINGS, budget=Budget(iterations=1))
    done = generate(PROMPT, tmp_path, options, plan=flies())
    assert done.verdict is not None
    assert done.verdict.status == "rejected"
    assert len(Kept(done.run.path).rows) == 1


# --- a judge that crashes


def undecided(done: Generated) -> Kept:
    """What a run has left whose only world passes all checks but one, which crashed."""
    kept = Kept(done.run.path)
    assert done.verdict is not None
    assert done.verdict.status == kept.facts["status"] == "blocked"
    assert done.verdict.failures == []
    assert [crash.check for crash in done.verdict.crashes] == ["CheckEnergy"]
    assert done.verdict.summary.startswith("Blocked: CheckEnergy could not be evaluated: ZeroDivisionError")
    assert "ZeroDivisionError" in json.loads(kept.text(1, "verdict.json"))["crashes"][0]["traceback"]
    assert not list(kept.folder.glob("accepted*"))
    assert "What could not be evaluated" in (kept.folder / "report.html").read_text()
    return kept


def test_a_world_that_the_judge_crashes_on_is_nobodys_to_mend(
    server: Server, loop: Callable[..., Generated], monkeypatch: pytest.MonkeyPatch
) -> None:
    crashing(monkeypatch, CheckEnergy)
    done = loop(SETTINGS, roles=("coder", "judge"), plan=flies(simulation={"duration": 0.4, "frame_rate": 10}))
    assert undecided(done).rows == [("recording", "blocked", True)]
    assert server.requests == []


def test_without_a_coder_it_ends_blocked_where_the_judge_crashes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    crashing(monkeypatch, CheckEnergy)
    plan = flies(simulation={"duration": 0.4, "frame_rate": 10})
    kept = undecided(generate(PROMPT, tmp_path, Options(settings=SETTINGS), plan=plan))
    assert kept.rows == [("recording", "blocked", True)]


def test_what_fails_beside_a_crash_is_mended_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    crashing(monkeypatch, CheckEnergy)
    done = generate(PROMPT, tmp_path, Options(settings=SETTINGS), plan=flies())
    assert done.verdict is not None
    assert done.verdict.status == "blocked"
    rows = Kept(done.run.path).rows
    assert [status for _, status, _ in rows] == ["rejected", "blocked"]
