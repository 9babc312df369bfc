"""The loop, with a real simulation and models whose answers are written here: it repairs, and it always ends."""

from __future__ import annotations

import hashlib
import json
import os
import signal
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from tests.agents.flies import PROMPT, REPAIR, answer, edit, flies, lasts, opinion, review
from tests.agents.scripted import Server, apart, call, hang, status, text
from wsim.agents import relay
from wsim.agents.budget import Budget
from wsim.agents.models import ROLES, Models
from wsim.agents.transcript import read
from wsim.generate import Generated, Options, generate
from wsim.pipeline import Settings
from wsim.plan.schema import Plan
from wsim.progress import silent
from wsim.replay import replay

SETTINGS = Settings(device="cpu", pictures=False)
NO_WORLD = replace(SETTINGS, params={"mass": 1.0})  # the program has no such parameter: it fails in a second


@pytest.fixture(autouse=True)
def quick(own_cache: None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(relay, "LONGEST_PAUSE", 0.0)


def models(server: Server, *roles: str) -> Models:
    return Models(**{role: server.model(role) for role in roles or ROLES})


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
        limits = Budget(**{"request_seconds": 20.0, **budget})
        options = Options(settings=settings, models=models(server, *roles), budget=limits)
        given = None if "planner" in roles else plan or flies()
        return generate(PROMPT, tmp_path / "runs", options, plan=given, progress=progress)

    return one


@dataclass
class Kept:
    """What a run has left."""

    folder: Path

    @property
    def facts(self) -> dict[str, Any]:
        return json.loads((self.folder / "run.json").read_text())

    @property
    def rows(self) -> list[tuple[str, str, bool]]:
        """How far each iteration came, its status, and whether it was kept."""
        return [(row["reached"], row["status"], row["kept"]) for row in self.facts["iterations"]]

    def text(self, number: int, name: str = "program.py") -> str:
        return (self.folder / "iterations" / f"{number:02d}" / name).read_text()

    @property
    def numbers(self) -> list[str]:
        return sorted(path.name for path in (self.folder / "iterations").iterdir())


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


# --- one run with all that may happen on the way


@dataclass
class Repaired:
    """A run that came to a good end, what its models were asked, and how it was asked for."""

    done: Generated
    server: Server

    @property
    def kept(self) -> Kept:
        return Kept(self.done.run.path)


GOOD_PLAN = json.dumps(answer())
JUDGED = text(opinion(False, repair=REPAIR))


@pytest.fixture(scope="module")
def repaired(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Repaired]:
    """Planned at the second attempt; the worse patch is undone, the better one kept, then it is right."""
    folder = tmp_path_factory.mktemp("repaired")
    server = Server()
    server.script["planner"] = [status(500), text("A ball, you say?"), text(f"```json\n{GOOD_PLAN}\n```")]
    server.script["coder"] = [
        text(lasts(0.1)),
        text(lasts(0.1)),  # the same again
        text(edit("duration=0.3", "duration=0.4")),  # not in the program
        text(edit("scene.simulation(duration=0.2", "scene.simulate(duration=0.3")),  # no such call
        text(lasts(0.3)),
        call("query_recording", {"signal": "position", "prim": "ball", "reduction": "last"}),
        text(lasts(0.4, before=0.3)),
    ]
    server.forever["judge"] = JUDGED
    server.script["reviewer"] = [status(429), text(review(differences=[]))]
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", apart(folder / "cache"))
        patch.setattr(relay, "LONGEST_PAUSE", 0.0)
        options = Options(settings=replace(SETTINGS, pictures=True), models=models(server))
        done = generate(PROMPT, folder / "runs", options)
    server.close()
    yield Repaired(done, server)


def test_it_is_planned_repaired_reviewed_and_accepted(repaired: Repaired) -> None:
    kept = repaired.kept
    assert repaired.done.verdict is not None
    assert repaired.done.verdict.status == kept.facts["status"] == "accepted", repaired.done.verdict.summary
    assert kept.rows == [
        ("physics", "rejected", True),
        ("physics", "rejected", False),
        ("physics", "rejected", True),
        ("all", "accepted", True),
    ]
    assert [kept.text(number).split("duration=")[1].split(",")[0] for number in (1, 2, 3, 4)] == [
        "0.2",
        "0.1",
        "0.3",
        "0.4",
    ]
    assert kept.facts["best"] == 4
    assert kept.facts["title"] == "A ball flies"
    assert "cause" not in kept.facts
    usage = kept.facts["usage"]["by_role"]
    assert {role: (used["requests"], used["failed"]) for role, used in usage.items()} == {
        "planner": (2, 1), "coder": (7, 0), "judge": (3, 0), "reviewer": (1, 1),
    }  # fmt: skip
    assert kept.facts["usage"]["tokens"] == 13 * 1100


def test_a_worse_patch_is_undone_and_told_of(repaired: Repaired) -> None:
    first, second, *_ = repaired.server.asked("coder")
    assert "duration=0.2" in first
    assert "# Tried before, and undone" not in first
    assert "there is no time to fly" in first  # the judge
    told = second.partition("# Tried before, and undone")[2]
    assert "iteration 2: It is too short. It failed at physics: ObjectiveMoves: " in told
    assert "+    scene.simulation(duration=0.1" in told
    assert "duration=0.2" in second.partition("# Verdict")[0]  # the best so far is what is to be edited
    diff = repaired.kept.text(3, "patch.diff")
    assert "-    scene.simulation(duration=0.2" in diff
    assert "+    scene.simulation(duration=0.3" in diff


def test_what_cannot_be_used_goes_back_to_the_coder(repaired: Repaired) -> None:
    asked = repaired.server.asked("coder")
    assert len(asked) == 7
    assert "the program of iteration 2" in asked[2]
    assert "these lines are not in the program: 'duration=0.3'" in asked[3]
    assert "simulate" in asked[4].rpartition("has mistakes")[2]
    assert "# Tried before" not in asked[5]  # the best is new
    (answer,) = [body["messages"][-1] for body in repaired.server.requests if body["messages"][-1]["role"] == "tool"]
    assert "0.45" in answer["content"]  # [m]: where the best so far came to
    assert "nearest: line 34: '    scene.simulation(duration=0.2, frame_rate=10.0)'" in asked[3]


def test_the_reviewer_sees_stills_and_facts(repaired: Repaired) -> None:
    bodies = [body for body in repaired.server.requests if body["model"] == "reviewer"]
    assert len(bodies) == 2
    parts = bodies[1]["messages"][1]["content"]
    assert [part["type"] for part in parts] == ["text", "image_url"]
    assert "ball" in parts[0]["text"]
    (picture,) = (repaired.kept.folder / "pictures").iterdir()
    with Image.open(picture) as sheet:
        assert sheet.size == (768, 288)  # five stills, three beside each other
        assert sheet.getextrema() != ((0, 0),) * 3
    assert picture.stat().st_size < 40_000
    kept = json.loads(repaired.kept.text(4, "review.json"))
    assert kept["by"] == repaired.server.model("reviewer")
    assert kept["review"]["summary"] == "A ball flies."
    assert kept["share_of_picture"]


def test_what_is_accepted_is_stamped(repaired: Repaired) -> None:
    accepted = repaired.kept.folder / "accepted"
    assert {path.name for path in accepted.iterdir()} == {"program.py", "stage.usda", "acceptance.json", "SHA256SUMS"}
    assert (accepted / "program.py").read_text() == repaired.kept.text(4)
    for line in (accepted / "SHA256SUMS").read_text().splitlines():
        digest, name = line.split()
        assert hashlib.sha256((accepted / name).read_bytes()).hexdigest() == digest
    assert json.loads((accepted / "acceptance.json").read_text()) == {"stripped": False, "largest_distance_m": 0.0}


def test_every_exchange_is_written_down(repaired: Repaired) -> None:
    exchanges = read(repaired.kept.folder)
    assert len(exchanges) == len(repaired.server.requests) == 15
    assert [exchange.error["kind"] for exchange in exchanges if exchange.error] == ["server", "rate limit"]


def test_it_is_replayed_with_no_model_left(repaired: Repaired, tmp_path: Path) -> None:
    recorded = repaired.kept.folder
    again = replay(recorded, tmp_path / "runs")
    assert again.divergences == []
    assert again.differing == []
    assert again.same == 2 + 4 * 2 + 3  # the plan and the transcript; programs and verdicts; three patches
    made = Kept(again.generated.run.path)
    assert made.rows == repaired.kept.rows
    assert made.facts["usage"]["tokens"] == repaired.kept.facts["usage"]["tokens"]
    assert (made.folder / "accepted" / "SHA256SUMS").read_bytes() == (recorded / "accepted" / "SHA256SUMS").read_bytes()


# --- how it ends otherwise


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
        import time

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


def test_ctrl_c_while_a_model_thinks(server: Server, loop: Callable[..., Generated], tmp_path: Path) -> None:
    import asyncio

    def interrupt(handler: Any, body: Any) -> None:
        os.kill(os.getpid(), signal.SIGINT)
        hang(handler, body)

    server.script["coder"] = [interrupt]
    asyncio.set_event_loop(asyncio.new_event_loop())
    with pytest.raises(KeyboardInterrupt):
        loop()
    asyncio.set_event_loop(asyncio.new_event_loop())  # the other has a request left in it
    (folder,) = (tmp_path / "runs").iterdir()
    kept = Kept(folder)
    assert (kept.facts["status"], kept.facts["summary"]) == ("stopped", "interrupted")
    assert kept.rows == [("build", "rejected", True)]
    assert kept.facts["usage"]["tokens"] == 0


def test_a_model_that_cannot_be_reached_leaves_nothing(tmp_path: Path) -> None:
    from wsim.errors import UserError

    with pytest.raises(UserError, match="model of the judge: nobody:m"):
        generate(PROMPT, tmp_path / "runs", Options(models=Models(judge="nobody:m")), plan=flies())
    with pytest.raises(UserError, match="--image .*none.png: No such file"):
        generate(PROMPT, tmp_path / "runs", Options(models=Models(), image=tmp_path / "none.png"), plan=flies())
    assert not (tmp_path / "runs").exists()
