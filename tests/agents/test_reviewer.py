"""What a reviewer is shown: stills, and exact facts. What it may answer; and what is left where it fails."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import pytest

from tests.agents.flies import CAMERA, PROMPT, flies, review
from tests.agents.scripted import Server, text
from wsim.agents.ask import Desk
from wsim.agents.budget import Ledger
from wsim.agents.crew import Crew
from wsim.agents.models import Models
from wsim.agents.reviewer import Review, facts, keep
from wsim.agents.reviewer import review as ask_for_review
from wsim.agents.transcript import Transcript
from wsim.judge.verdict import Verdict
from wsim.plan.schema import Plan
from wsim.program.compose import compose
from wsim.runs.attempt import Attempt, Reached
from wsim.runs.folder import RunFolder
from wsim.runs.iteration import Iteration
from wsim.runs.settings import Settings
from wsim.tools import Workspace
from wsim.tools.plan import plan_lines

ABOVE = {"name": "above", "eye": [0, -1, 6], "target": [0, 0, 2]}


@pytest.fixture(scope="module")
def plan() -> Plan:
    return flies(simulation={"duration": 0.8, "frame_rate": 10}, cameras=[CAMERA, ABOVE])


@pytest.fixture(scope="module")
def made(plan: Plan, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An iteration with pictures, which nobody may change."""
    folder = RunFolder(tmp_path_factory.mktemp("pictured")).iteration(1)
    (folder / "program.py").write_text(compose(plan))
    assert Iteration.of(folder / "program.py", folder, plan, Settings(device="cpu")).run().status == "accepted"
    return folder


@pytest.fixture
def iteration(made: Path, tmp_path: Path) -> Path:
    """The same, to be written to."""
    folder = tmp_path / "run" / "iterations" / "01"
    shutil.copytree(made, folder)
    return folder


def test_facts_are_shares_of_the_picture(made: Path, tmp_path: Path) -> None:
    side, above = facts(made)
    assert side.startswith("side (% of picture at start/least/end): ")
    assert above.startswith("above (")
    start, least, end = map(float, side.partition("ball ")[2].split(",")[0].split("/"))
    assert 0.0 < least <= min(start, end) < 5.0
    assert facts(tmp_path) == []


def test_a_reviewer_is_shown_all_of_it(server: Server, desk: Desk, plan: Plan, made: Path) -> None:
    server.script["reviewer"] = [text(f"```json\n{review(differences=[])}\n```")]
    found = ask_for_review(desk, plan, made, plan_lines(plan))
    assert (found.summary, found.differences) == ("A ball flies.", [])
    (request,) = server.asked("reviewer")
    for part in ("A ball flies", "ball moves", *facts(made)):
        assert part in request
    assert re.search(r"top to bottom: side 00\.000s, (side \S+, )+above 00\.800s\n", request)  # as the plan has them
    sent = server.requests[0]["messages"][1]["content"][1]["image_url"]["url"]
    assert sent.startswith("data:image/jpeg;base64,")


def test_a_reviewer_is_asked_of_each_clause(server: Server, desk: Desk, plan: Plan, made: Path) -> None:
    """What the pictures contradict is heard; what cannot be seen in them is no fault."""
    seen = [
        {"clause": 1, "shown": "cannot be seen", "why": "a speed"},
        {"clause": 2, "shown": "no", "why": "it stays where it is"},
    ]
    server.script["reviewer"] = [text(review(clauses=[{"clause": 3, "shown": "yes"}])), text(review(clauses=seen))]
    found = ask_for_review(desk, plan, made, plan_lines(plan))
    first, second = server.asked("reviewer")
    for part in (f"Prompt: {PROMPT}", "1. A thrown ball\n2. flies half a metre"):
        assert part in first
    assert "there is no clause 3; they are numbered from 1 to 2" in second
    assert found.unshown(plan) == ["not shown: 'flies half a metre': it stays where it is"]


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        ("<html><p>A ball flies.</p></html>", "no JSON object in the answer"),
        (review()[:-1], "it breaks off"),
        ('{"objects": "ball"}', "summary: it is missing"),
        (review(differences=[{"object": "ball", "what": "x"}] * 21), "differences: it must have at most 20 items"),
        (review(stars=5), "stars: there is no such field"),
        (
            review(differences=[{"object": "bird", "what": "it sings"}]),
            "the plan has no object 'bird'; it has ball, ground",
        ),
        (review(differences=[{"object": "ball", "what": "", "severity": "awful"}]), "differences.0.severity: "),
    ],
)
def test_what_is_no_review_is_sent_back(
    server: Server, desk: Desk, plan: Plan, made: Path, answer: str, message: str
) -> None:
    server.script["reviewer"] = [text(answer), text(review())]
    assert ask_for_review(desk, plan, made, []).summary == "A ball flies."
    first, second = server.asked("reviewer")
    assert message in second
    assert message not in first


def test_a_long_review_is_heard_so_far(server: Server, desk: Desk, plan: Plan, made: Path) -> None:
    server.script["reviewer"] = [text(review(summary="long " * 10_000))]
    assert len(ask_for_review(desk, plan, made, []).text) < 2000


def test_a_review_is_kept_beside_the_facts(iteration: Path) -> None:
    before = json.loads((iteration / "review.json").read_text())
    difference = {"object": "ball", "what": "it is blue", "severity": "minor"}
    keep(iteration, Review.model_validate({"summary": "Seen.", "differences": [difference]}), "m@x")
    after = json.loads((iteration / "review.json").read_text())
    assert after["share_of_picture"] == before["share_of_picture"]
    assert (after["by"], after["review"]["differences"]) == ("m@x", [difference])


def test_without_a_model_the_facts_are_the_review(plan: Plan, iteration: Path) -> None:
    run = RunFolder(iteration.parents[1])
    desk = Desk(Models(), Transcript(run.path), Ledger())
    crew = Crew(desk, Workspace(run))
    tried = Attempt(iteration, "", Reached.ALL, Verdict(status="accepted", summary=""))
    crew.look(tried, plan)
    assert tried.review.splitlines()[1:] == facts(iteration)
    assert "Nobody looked at the pictures" in tried.review
    assert crew.notes == []
    kept = json.loads((iteration / "review.json").read_text())
    assert (kept["by"], kept["review"]) == ("builtin", {"facts": facts(iteration)})


def test_a_reviewer_that_fails_is_done_without(server: Server, desk: Desk, plan: Plan, iteration: Path) -> None:
    server.forever["reviewer"] = text("It is lovely.")
    crew = Crew(desk, Workspace(RunFolder(iteration.parents[1])))
    tried = Attempt(iteration, "", Reached.ALL, Verdict(status="accepted", summary=""))
    crew.look(tried, plan)
    assert tried.review.splitlines()[1:] == facts(iteration)
    assert tried.seen is None
    (note,) = crew.notes
    assert note.startswith("iteration 1 was reviewed by facts alone: the reviewer's model: unusable: 5 answers")
