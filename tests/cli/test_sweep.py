"""`wsim sweep` as a person meets it: what is refused, and Ctrl-C."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

from tests.children import started
from tests.patience import STUCK
from wsim.cli import app
from wsim.errors import UserError

PROGRAM = """
def build(scene):
    scene.simulation(duration=0.1)
    scene.ground()
    scene.sphere("ball", radius=scene.param("radius", 0.1, low=0.05, high=0.2), position=(0, 0, 1), density=500.0)
"""


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--device", "cpu,cuda:0"], "--device cpu,cuda:0: several devices are GPUs, as in cuda:0,cuda:1"),
        (["--device", "cuda:7,cuda:8"], "device 'cuda:7' is not here"),
        (["--store", "nowhere://x"], "nowhere://x cannot be reached"),
        (["--resume", "memory://empty"], "memory://empty is no sweep's folder"),
        (["--ray", "10.0.0.1"], "--ray 10.0.0.1: expected auto, or the cluster's HOST:PORT"),
        (["--ray", "ray://10.0.0.1:10001"], "expected auto, or the cluster's HOST:PORT"),
        (["--ray", "127.0.0.1:1"], "--ray 127.0.0.1:1: no Ray cluster answers there"),
    ],
)
def test_what_cannot_be_is_said_in_a_line(tmp_path: Path, options: list[str], said: str) -> None:
    if "--ray" in options:
        pytest.importorskip("ray", reason="Ray is not installed: pip install 'wsim[ray]'")
    (tmp_path / "program.py").write_text(PROGRAM)
    programs = [] if "--resume" in options else [str(tmp_path / "program.py")]
    ended = CliRunner().invoke(app, ["sweep", *programs, "--samples", "2", "--runs", str(tmp_path / "runs"), *options])
    assert isinstance(ended.exception, UserError)
    assert said in str(ended.exception)


def test_what_is_done_at_ctrl_c_is_kept_and_the_rest_is_done_on_resume(tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text(PROGRAM)
    sweep = [sys.executable, "-m", "wsim.cli", "sweep", "--no-full", "--workers", "1"]
    asked = [str(tmp_path / "program.py"), "--samples", "24", "--runs", str(tmp_path / "runs")]
    with started([*sweep, *asked], cwd=tmp_path) as process:
        until, lines = time.monotonic() + STUCK, 0
        while lines < 2 and time.monotonic() < until:
            time.sleep(0.02)
            lines = sum(len(path.read_text().splitlines()) for path in tmp_path.glob("runs/*/outcomes.jsonl"))
        process.send_signal(signal.SIGINT)
        assert process.wait(STUCK) == 130
    (outcomes,) = tmp_path.glob("runs/*/outcomes.jsonl")
    kept = outcomes.read_text().splitlines()
    assert 2 <= len(kept) < 25
    assert (outcomes.parent / "table.parquet").is_file()
    with started([*sweep, "--resume", str(outcomes.parent)], cwd=tmp_path) as process:
        assert process.wait(STUCK) == 0
    assert outcomes.read_text().splitlines()[: len(kept)] == kept
    assert len(outcomes.read_text().splitlines()) == 25


def test_ctrl_c_while_the_page_is_made_is_no_loss(tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text(PROGRAM)
    sweep = [sys.executable, "-m", "wsim.cli", "sweep", "--workers", "1"]
    asked = [str(tmp_path / "program.py"), "--samples", "8", "--runs", str(tmp_path / "runs"), "--no-full"]
    with started([*sweep, *asked], cwd=tmp_path, stdout=subprocess.PIPE) as process:
        until = time.monotonic() + STUCK
        while time.monotonic() < until and not list(tmp_path.glob("runs/*/summary.json")):
            time.sleep(0.005)
        process.send_signal(signal.SIGINT)  # all is run; the drawing and the page are left
        said, _ = process.communicate(timeout=STUCK)
        assert process.returncode == 130
    (outcomes,) = tmp_path.glob("runs/*/outcomes.jsonl")
    assert f"wsim sweep --resume {outcomes.parent}" in said
    kept, page = outcomes.read_text(), outcomes.parent / "report.html"
    assert len(kept.splitlines()) == 9 and not page.exists()
    with started([*sweep, "--no-full", "--resume", str(outcomes.parent)], cwd=tmp_path) as process:
        assert process.wait(STUCK) == 0
    assert outcomes.read_text() == kept
    assert page.is_file() and (outcomes.parent / "margins.png").is_file()
