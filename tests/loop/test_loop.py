"""The loop, with a real simulation and models whose answers are written here: it repairs, and is replayed."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import pytest
from PIL import Image

from tests.agents.flies import PROMPT, REPAIR, answer, edit, lasts, opinion, review
from tests.agents.kept import Kept, models
from tests.agents.scripted import Server, apart, call, status, text
from wsim.agents import relay
from wsim.agents.transcript import read
from wsim.loop.generate import generate
from wsim.loop.options import Generated, Options
from wsim.loop.replay import replay
from wsim.runs.settings import Settings

SETTINGS = Settings(device="cpu", pictures=False)


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
    server.script["judge"] = [JUDGED, JUDGED, JUDGED, text(opinion())]
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
        "planner": (2, 1), "coder": (7, 0), "judge": (4, 0), "reviewer": (1, 1),
    }  # fmt: skip
    assert kept.facts["usage"]["tokens"] == 14 * 1100


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


def test_the_judge_is_asked_again_about_the_best(repaired: Repaired) -> None:
    """Its repair did not help: it is told what was tried. The patch that was undone is not asked about."""
    first, again, third, last = repaired.server.asked("judge")
    assert "A ball flies." in last  # of a world without a fault it is asked, too: whether the prompt came true
    assert "# Tried from here, and undone" not in first + third
    before, _, told = again.partition("# Tried from here, and undone")
    assert before.rstrip().endswith(first.rstrip())
    assert "iteration 2: It is too short. It failed at physics: ObjectiveMoves: " in told
    assert "+    scene.simulation(duration=0.1" in told


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
    assert len(exchanges) == len(repaired.server.requests) == 16
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
