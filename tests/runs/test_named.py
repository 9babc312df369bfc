"""Runs by a part of their names."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsim.errors import UserError
from wsim.runs.folder import RunFolder
from wsim.runs.named import folders, named

NAMES = ["20260101-120000-a-ball-falls", "20260102-090000-a-ball-rolls", "20260102-090000-sweep-springs"]


@pytest.fixture
def base(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name in NAMES:
        (tmp_path / "runs" / name).mkdir(parents=True)
        mark = "sweep.json" if "sweep" in name else "run.json"
        (tmp_path / "runs" / name / mark).write_text("{}")
    (tmp_path / "runs" / "notes").mkdir()
    return Path("runs")


@pytest.mark.parametrize(
    ("text", "name"),
    [("latest", NAMES[2]), ("falls", NAMES[0]), ("20260101", NAMES[0]), ("BALL-ROLLS", NAMES[1]), ("sweep", NAMES[2])],
)
def test_a_part_of_a_name_will_do(base: Path, text: str, name: str) -> None:
    assert named(Path(text)) == base / name


def test_what_may_be_several_is_refused_with_their_names(base: Path) -> None:
    with pytest.raises(UserError, match=f"ball may be any of {NAMES[1]}, {NAMES[0]}; give more"):
        named(Path("ball"))


def test_what_is_there_is_itself_and_what_is_not_is_left_to_who_asked(base: Path) -> None:
    Path("falls").mkdir()
    assert named(Path("falls")) == Path("falls")
    assert named(Path("no/falls")) == Path("no/falls")
    assert named(Path("nothing")) == Path("nothing")
    with pytest.raises(UserError, match="nothing does not exist; `wsim runs`"):
        RunFolder.open("nothing")
    assert RunFolder.open("rolls").path.name == NAMES[1]


def test_a_folder_without_runs_has_no_latest(tmp_path: Path) -> None:
    assert folders(tmp_path / "runs") == []
    with pytest.raises(UserError, match="holds no run yet"):
        named(Path("latest"), tmp_path / "runs")


def test_what_lies_in_a_run_is_named_by_the_run(tmp_path: Path) -> None:
    first, second = tmp_path / "20260101-120000-sweep-ball", tmp_path / "20260102-120000-sweep-box"
    for sweep in (first, second):
        (sweep / "candidates" / "0007").mkdir(parents=True)
        (sweep / "sweep.json").write_text("{}", encoding="utf-8")
    inside = Path("candidates/0007")
    assert named("latest" / inside, tmp_path) == second / inside
    assert named("ball" / inside, tmp_path) == first / inside
    for path in ("sweep" / inside, Path("ball/candidates/0008"), Path("../ball") / inside, Path("nothing") / inside):
        assert named(path, tmp_path) == path  # of none, or of several: left to who asked, who says that it is not there


def test_where_a_run_is_meant_a_sweep_is_called_one(tmp_path: Path) -> None:
    (tmp_path / "sweep.json").write_text("{}", encoding="utf-8")
    with pytest.raises(UserError, match="is a sweep, not a run: none of it was run in full"):
        RunFolder.open(tmp_path)
    (tmp_path / "candidates" / "0012").mkdir(parents=True)
    with pytest.raises(UserError, match=r"name a candidate's, such as .*candidates/0012;"):
        RunFolder.open(tmp_path)
