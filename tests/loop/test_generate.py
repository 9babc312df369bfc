"""`generate` where it stops before anything is built; whole runs are in tests/cli."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from wsim.loop import start as starting
from wsim.loop.generate import generate
from wsim.loop.options import Options
from wsim.progress import silent
from wsim.rules.planner import NotUnderstood


def test_a_plan_that_is_not_approved_is_kept_and_not_built(tmp_path: Path) -> None:
    shown = []
    done = generate("A cork ball floats in a tank of water.", tmp_path, approve=shown.append)
    assert shown == [done.plan]
    assert done.verdict is None
    assert {path.name for path in done.run.path.iterdir()} == {"run.json", "plan.json", "plan.png", "transcript.jsonl"}
    assert done.run.facts()["status"] == "not approved"
    (line,) = (done.run.path / "transcript.jsonl").read_text().splitlines()
    assert json.loads(line)["reply"] == done.plan.model_dump(mode="json")


def test_a_prompt_that_is_not_understood_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(NotUnderstood) as caught:
        generate("A purple giraffe sings.", tmp_path / "runs")
    assert caught.value.words == ["giraffe", "sings"]
    assert not (tmp_path / "runs").exists()


def test_the_report_is_made_ready_once_while_a_world_is_simulated(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done = []
    monkeypatch.setattr(starting, "do_beside", lambda call, name: done.append(name))
    _, crew = starting.start("a ball", tmp_path, None, Options(), silent)
    for stage in ("building the stage", "simulating", "simulating", "judging", "simulating"):
        crew.workspace.progress(stage, 0, 1)
    assert done == ["makes the report ready"]
