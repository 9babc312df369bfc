"""`wsim runs`: a folder that cannot be read costs its own line, not the list."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from wsim.cli import app
from wsim.cli.sweep_show import show
from wsim.sweep.axis import Axis
from wsim.sweep.candidate import Candidate, Outcome
from wsim.sweep.folder import SweepFolder
from wsim.sweep.spec import Spec

GOOD = Spec(axes=[Axis(name="mass", low=1.0, high=2.0)], samples=3)
TOO_FEW = GOOD.model_copy(update={"method": "saltelli", "samples": 2})  # its rows cannot be counted


def _sweep(base: Path, spec: Spec) -> Path:
    program = base / "ball.py"
    program.write_text("def build(scene):\n    pass\n", encoding="utf-8")
    return SweepFolder.create(base / "runs", "ball", spec, [program]).path


def _run(base: Path, facts: str) -> Path:
    path = base / "runs" / "20260101-000000-a-ball"
    path.mkdir(parents=True)
    (path / "run.json").write_text(facts, encoding="utf-8")
    return path


@pytest.mark.parametrize("bad", ["count", "sweep.json", "bytes", "{", "[]", "null"])
def test_one_folder_that_cannot_be_read_costs_one_line(tmp_path: Path, bad: str) -> None:
    good = _sweep(tmp_path, GOOD)
    if bad in ("count", "sweep.json", "bytes"):
        other = _sweep(tmp_path, TOO_FEW)
        if bad == "sweep.json":
            (other / "sweep.json").write_text('{"samples": -1}', encoding="utf-8")
        if bad == "bytes":
            (other / "outcomes.jsonl").write_bytes(b"\xff\xfe\n")
    else:
        other = _run(tmp_path, bad)
    result = CliRunner().invoke(app, ["runs", str(tmp_path / "runs"), "--json"])
    assert result.exit_code == 0, result.output
    rows = {row["run"]: row for row in json.loads(result.stdout)}
    assert rows[good.name]["status"] == "unfinished" and rows[good.name]["summary"].endswith("of 4")
    assert rows[other.name]["status"] == "unreadable" and rows[other.name]["summary"]


@pytest.mark.parametrize(("slacks", "said"), [((None, None), True), ((0.1, 0.2), False), ((None,), False)])
def test_a_ranking_by_number_is_said(
    capsys: pytest.CaptureFixture[str], slacks: tuple[float | None, ...], said: bool
) -> None:
    outcomes = [
        Outcome(candidate=Candidate(number=k), status="accepted", reason="", slack=slack)
        for k, slack in enumerate(slacks)
    ]
    show(outcomes)
    assert ("by their numbers" in capsys.readouterr().out) == said
