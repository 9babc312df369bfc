"""What the viewer shows of a run with several iterations, and of a sweep."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from rerun.chunk import RrdReader

from wsim.errors import UserError
from wsim.judge import judge
from wsim.recording import read
from wsim.report.side_by_side import recorded, side_by_side
from wsim.runs.iteration import Iteration
from wsim.runs.settings import Settings

PROGRAM = """
def build(scene):
    scene.simulation(duration=0.3)
    scene.ground()
    scene.box("box", size=(0.2, 0.2, 0.2), position=(0, 0, 0.3), density=500.0)
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of two iterations; in the second, what is recorded hovers."""
    folder = tmp_path_factory.mktemp("runs") / "20260101-000000-a-box"
    first, second = (folder / "iterations" / f"{k:02d}" for k in (1, 2))
    first.mkdir(parents=True)
    (first / "program.py").write_text(PROGRAM)
    Iteration(first, settings=Settings(device="cpu", pictures=False)).run()
    shutil.copytree(first, second)
    recording = read(second / "recording.rrd")
    recording.body_q[5:, :, 2] += 0.05
    (second / "verdict.json").write_text(judge(recording).model_dump_json())
    (folder / "run.json").write_text("{}")
    return folder


def test_findings_stand_at_their_times(run: Path, tmp_path: Path) -> None:
    assert [name for name, _ in recorded(run)] == ["iteration 1", "iteration 2"]
    made = side_by_side(run, tmp_path / "all.rrd")
    texts: dict[str, list[str]] = {}
    for chunk in RrdReader(made).stream():
        if chunk.entity_path.endswith("/findings"):
            rows = chunk.to_record_batch().column("TextLog:text").to_pylist()
            texts.setdefault(chunk.entity_path, []).extend(text for (text,) in rows)
    assert list(texts) == ["/02/findings"]  # the first one passed, and nothing was asked of it
    assert all(text.startswith("iteration 2: rejected: ✗") for text in texts["/02/findings"])


def test_candidates_of_a_sweep_and_no_more_than_a_screen_has_room_for(run: Path, tmp_path: Path) -> None:
    for k in range(12):
        shutil.copytree(run / "iterations", tmp_path / "sweep" / "candidates" / f"{k:04d}" / "iterations")
    shutil.rmtree(tmp_path / "sweep" / "candidates" / "0003" / "iterations" / "02")
    names = [name for name, _ in recorded(tmp_path / "sweep")]
    assert names == [f"candidate {k}" for k in (0, 0, 1, 1, 10, 10, 11, 11)]
    with pytest.raises(UserError, match="has no recordings"):
        side_by_side(tmp_path)
