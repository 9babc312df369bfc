"""What a sweep meets in the wild: numbers that are not finite, odd names and letters, a full disk, impatience."""

from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.children import started
from tests.patience import STUCK
from wsim.errors import UserError
from wsim.judge.verdict import Finding
from wsim.sweep.axis import Axis
from wsim.sweep.candidate import Candidate, Outcome, slack
from wsim.sweep.folder import SweepFolder
from wsim.sweep.sampling import read_points
from wsim.sweep.search import Search
from wsim.sweep.spec import Spec
from wsim.sweep.table import ranked, table

PROGRAM = """
def build(scene):
    scene.simulation(duration=0.1)
    scene.ground()
    scene.sphere("ball", radius=scene.param("status", 0.1, low=0.05, high=0.2), position=(0, 0, 1), density=500.0)
"""
SWEEP = [sys.executable, "-m", "wsim.cli", "sweep", "--no-full", "--workers", "1"]


def made(base: Path, **asked) -> SweepFolder:
    (base / "ball.py").write_text(PROGRAM)
    return SweepFolder.create(base / "runs", "ball", Spec(**asked), [base / "ball.py"])


def outcome(number: int, **given) -> Outcome:
    return Outcome(candidate=Candidate(number=number), status="rejected", **given)


@given(reason=st.text(st.characters(exclude_categories=["Cs"]), max_size=20), value=st.floats())
def test_whatever_came_of_a_candidate_is_read_again(tmp_path_factory, reason: str, value: float) -> None:
    folder = made(tmp_path_factory.mktemp("odd"))
    kept = [outcome(k, reason=reason, values={reason: value}, margins={reason: value}) for k in range(2)]
    for each in kept:
        folder.add(each)
    assert [repr(each) for each in folder.outcomes().values()] == [repr(each) for each in kept]
    assert folder.finish(kept) is None and folder.finished


def test_wherever_a_kill_cuts_the_last_line_what_was_before_it_is_read(tmp_path: Path) -> None:
    folder = made(tmp_path)
    file = folder.path / "outcomes.jsonl"
    folder.add(outcome(0, reason="Würfel µ ≥ 0.3 — 立方体"))
    whole = file.read_bytes()
    folder.add(outcome(1, reason="Würfel µ ≥ 0.3 — 立方体"))
    both = file.read_bytes()
    for end in range(len(whole), len(both)):
        file.write_bytes(both[:end])
        known = folder.outcomes()
        assert 0 in known and (1 in known) == (end == len(both) - 1)
        folder.add(outcome(2))
        assert set(folder.outcomes()) == {*known, 2}


@pytest.mark.parametrize("margin", [math.inf, -math.inf, math.nan])
def test_a_room_that_is_not_finite_still_has_a_rank(margin: float) -> None:
    found = Finding(check="Check", passed=False, prim=None, message="", margin=margin, limit=1.0, value=margin)
    assert slack(found) == -1.0
    assert slack(found.model_copy(update={"margin": 0.5, "limit": margin})) == -1.0
    rows = [outcome(k, slack=slack(found.model_copy(update={"margin": -float(k)}))) for k in range(3)]
    assert [row.candidate.number for row in ranked([outcome(3, slack=slack(found)), *rows])] == [0, 1, 2, 3]


def test_a_parameter_may_be_called_as_a_column_is() -> None:
    params = dict.fromkeys(("status", "seed", "rank", "seconds", "reason", "speed"), 3.0)
    (row,) = table([Outcome(candidate=Candidate(number=7, params=params, seed=2), status="accepted")]).to_pylist()
    assert [row[name] for name in ("status", "seed", "rank", "seconds")] == ["accepted", 2, 1, 0.0]
    assert row["speed"] == 3.0
    assert [row[f"parameter: {name}"] for name in params if name != "speed"] == [3.0] * 5


def test_a_grid_that_no_memory_holds_is_refused() -> None:
    axes = [Axis(name=f"x{k}", low=0.0, high=1.0) for k in range(25)]
    with pytest.raises(UserError, match=r"--method grid: 33,554,432 points, of 2 values or more along each of 25"):
        _ = Spec(axes=axes, method="grid").count


def test_a_range_that_overflows_is_refused_and_any_seed_searches() -> None:
    with pytest.raises(UserError, match=r"--vary x=-1e308:1e308: x: from -1e\+308 to 1e\+308 is further than"):
        Axis.parse("x=-1e308:1e308")
    for seed in (0, 2**32 - 1, 2**40):
        assert Search([Axis(name="x", low=0.0, high=1.0)], seed).ask()


def test_lines_of_a_file_are_counted_as_an_editor_does(tmp_path: Path) -> None:
    (tmp_path / "points.csv").write_text("\nspeed\n\n1\n\n\nfast\n")
    with pytest.raises(UserError, match="line 7: speed is 'fast'"):
        read_points(tmp_path / "points.csv")


def test_a_full_disk_is_said_in_a_line_with_the_way_on(tmp_path: Path) -> None:
    folder = made(tmp_path, axes=[Axis(name="status", low=0.05, high=0.2)], samples=2)
    (folder.path / "outcomes.jsonl").symlink_to("/dev/full")
    with started([*SWEEP, "--resume", str(folder.path)], cwd=tmp_path, stderr=subprocess.PIPE) as process:
        _, said = process.communicate(timeout=STUCK)
    assert process.returncode == 2
    assert f"{folder.path} takes no more: No space left on device" in said
    assert f"wsim sweep --resume {folder.path}" in said
    (folder.path / "outcomes.jsonl").unlink()
    with started([*SWEEP, "--resume", str(folder.path)], cwd=tmp_path) as process:
        assert process.wait(STUCK) == 0
    assert len(folder.outcomes()) == 3


def test_two_sweeps_in_one_folder_are_refused(tmp_path: Path) -> None:
    folder = made(tmp_path, samples=2)
    with folder.taken():
        with pytest.raises(UserError, match="another wsim sweep works in"), SweepFolder(folder.path).taken():
            pass
        ended = subprocess.run([*SWEEP, "--resume", folder.path], capture_output=True, text=True, timeout=STUCK)
        assert ended.returncode == 2 and "another wsim sweep works in" in ended.stderr
    with folder.taken():
        assert not (folder.path / "outcomes.jsonl").exists()


@pytest.mark.parametrize("between", [0.002, 0.05])
def test_ctrl_c_twice_ends_it_once_and_leaves_nobody_behind(tmp_path: Path, between: float) -> None:
    folder = made(tmp_path, axes=[Axis(name="status", low=0.05, high=0.2)], samples=200)
    asked = [*SWEEP, "--resume", str(folder.path)]
    with started(asked, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        until = time.monotonic() + STUCK
        while not (folder.path / "outcomes.jsonl").exists() and time.monotonic() < until:
            time.sleep(0.02)
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does
        time.sleep(between)
        os.killpg(process.pid, signal.SIGINT)
        _, said = process.communicate(timeout=STUCK)
        assert process.returncode == 130
        assert "Traceback" not in said
    assert folder.outcomes()
