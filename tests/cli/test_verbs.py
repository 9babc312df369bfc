"""judge, view, doctor, wrong options and Ctrl-C, as a person at a terminal meets them."""

from __future__ import annotations

import json
import re
import shutil
import signal
import subprocess
import sys
import time
import urllib.error
import urllib.request
from pathlib import Path

import pytest
from typer.testing import CliRunner

from tests import children
from tests.crashing import crashing
from tests.patience import STUCK
from wsim import __version__
from wsim.cli import app
from wsim.judge.checks.energy import CheckEnergy
from wsim.judge.verdict import Verdict

PROMPT = "A wooden block floats in a tank of water."
TANK = """\
def build(scene):
    scene.simulation(duration=60.0, frame_rate=20.0)
    tank = scene.tank("tank", inner_size=(0.3, 0.3, 0.3))
    scene.fluid("water", fills=tank, level=0.15, spacing=0.05)
    scene.camera("side", eye=(0.0, -2.0, 1.0), target=(0.0, 0.0, 0.0), width=64, height=36)
"""


@pytest.mark.parametrize("verb", [("plan",), ("generate", "--yes")])
def test_unknown_words_are_named_in_one_line(wsim, tmp_path: Path, verb: tuple[str, ...]) -> None:
    ended = wsim(*verb, "A purple giraffe sings.")
    assert ended.code == 2
    assert ended.err.startswith("wsim: ")
    assert ended.err.count("\n") == 1
    assert len(ended.err) <= 3 * 80  # lines of a terminal
    assert "'giraffe', 'sings'" in ended.err
    assert "wsim plan --words" in ended.err
    assert ended.out == ""
    assert list(tmp_path.iterdir()) == []


def test_the_builtin_planners_words_are_listed(wsim) -> None:
    ended = wsim("plan", "--words")
    assert ended.code == 0
    said = " ".join(ended.out.split())
    for word in ("things: ", "seesaw", "materials: ", "oak", "what they do: ", "float,"):
        assert word in said
    assert max(map(len, ended.out.splitlines())) <= 80


@pytest.mark.parametrize(
    ("left", "said"),
    [
        ([], "the run was stopped before its program was built; `wsim run"),
        (["stage.usda"], "the run was stopped before it simulated; `wsim run"),
        (["stage.usda", "recording.rrd.partial"], "the run was stopped while it simulated, and left recording.rrd.par"),
        (["verdict.json"], "its program made no world; see"),
    ],
)
@pytest.mark.parametrize("verb", ["judge", "view"])
def test_a_run_without_a_recording_says_what_became_of_it(
    wsim, tmp_path: Path, verb: str, left: list[str], said: str
) -> None:
    folder = tmp_path / "run" / "iterations" / "01"
    folder.mkdir(parents=True)
    for name in left:
        (folder / name).touch()
    ended = wsim(verb, tmp_path / "run")
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert f"{folder} has no recording: {said}" in ended.err


def test_a_trajectory_without_a_byte_is_named(wsim, tmp_path: Path) -> None:
    (tmp_path / "empty.npz").touch()
    ended = wsim("judge", tmp_path / "empty.npz")
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert "empty.npz cannot be read as a NumPy .npz file" in ended.err


def test_judge_judges_the_recording_again(wsim, floating, reruns) -> None:
    before = {path: path.read_bytes() for path in floating.run.rglob("*") if path.is_file()}
    whole = wsim("judge", floating.run, "--json")
    assert (whole.code, whole.err) == (0, "")
    assert json.loads(whole.out) == floating.verdict
    shown = wsim("judge", floating.run / "iterations" / "01" / "recording.rrd")
    assert shown.code == 0
    assert re.search(r"^accepted ", shown.out, re.MULTILINE)
    assert "ObjectiveFloats" in shown.out
    assert {path: path.read_bytes() for path in floating.run.rglob("*") if path.is_file()} == before
    _, heavy = reruns
    rejected = wsim("judge", heavy.run, "--json")
    assert rejected.code == 1
    assert Verdict.model_validate_json(rejected.out).status == "rejected"


def test_a_judge_that_crashes_says_so_and_ends_with_3(reruns, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _, heavy = reruns
    recording = heavy.run / "iterations" / "01" / "recording.rrd"
    alone = shutil.copyfile(recording, tmp_path / "alone.rrd")
    crashing(monkeypatch, CheckEnergy)
    ended = CliRunner().invoke(app, ["judge", str(alone)])
    assert ended.exit_code == 3
    assert "? CheckEnergy could not be evaluated: ZeroDivisionError: float division by zero" in ended.output
    assert "report it with its traceback, which wsim judge --json prints" in ended.output
    beside = CliRunner().invoke(app, ["judge", str(recording)])  # by the plan, which its mass breaks
    assert beside.exit_code == 1
    assert "? CheckEnergy could not be evaluated" in beside.output


def test_a_recording_alone_is_judged_without_a_plan(wsim, reruns, tmp_path: Path) -> None:
    """Heavy wood breaks the plan's promise, and no law of physics."""
    _, heavy = reruns
    shutil.copyfile(heavy.run / "iterations" / "01" / "recording.rrd", tmp_path / "alone.rrd")
    alone = wsim("judge", "alone.rrd")
    assert alone.code == 0
    assert "Objective" not in alone.out
    assert wsim("judge", "alone.rrd", "--plan", heavy.run / "plan.json").code == 1


def test_view_without_a_display_prints_what_to_do(wsim, floating) -> None:
    ended = wsim("view", floating.run)
    assert (ended.code, ended.err) == (0, "")
    assert "rerun recording.rrd" in ended.out
    assert f"wsim view --web {floating.run}" in ended.out
    chosen = wsim("view", floating.run, "--finding", 1)
    assert "wsim view recording.rrd --finding 1\n" in chosen.out and "verdict.json" in chosen.out
    assert f"wsim view --web {floating.run} --finding 1\n" in chosen.out
    beyond = wsim("view", floating.run, "--finding", 99)
    assert beyond.code == 2
    assert beyond.err == f"wsim: --finding 99: the verdict has {len(floating.verdict['findings'])} findings\n"


def test_view_serves_a_finding_to_a_browser_until_interrupted(launch, reruns) -> None:
    _, heavy = reruns
    number = 1 + next(i for i, finding in enumerate(heavy.verdict["findings"]) if not finding["passed"])
    process = launch("view", "--web", heavy.run, "--finding", number)
    chosen = heavy.verdict["findings"][number - 1]
    assert process.stdout.readline().startswith(f"finding {number} at {chosen['time']:.3f} s: {chosen['message'][:40]}")
    assert "127.0.0.1 only" in process.stdout.readline()
    url = process.stdout.readline().strip()
    assert url.startswith("http://127.0.0.1:")
    local = urllib.request.build_opener(urllib.request.ProxyHandler({}))
    with local.open(url, timeout=STUCK) as page:
        assert page.status == 200
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=STUCK)
    assert process.returncode == 0, err
    assert out + err == ""
    with pytest.raises(urllib.error.URLError):
        local.open(url, timeout=STUCK)


def test_doctor_and_version(wsim) -> None:
    ended = wsim("doctor")
    assert (ended.code, ended.err) == (0, "")
    for word in ("device cpu", "newton", "warp-lang", "isolation bubblewrap", "isolation landlock", "kernel cache"):
        assert word in ended.out
    assert wsim("--version").out == f"wsim {__version__}\n"


PROGRAM = "def build(scene):\n    scene.box('b', size=(1, 1, 1), density=500.0)\n"
# arguments: part of what is said
MISTAKES: dict[tuple[str, ...], str] = {
    ("run", "nothing.py"): "nothing.py does not exist",
    ("run", "."): "not in a run's folder",
    ("run", "text.txt"): "not a Python program",
    ("run", "program.py", "--set", "wood"): "--set wood: expected NAME=NUMBER",
    ("run", "program.py", "--set", "wood=nan"): "--set wood=nan: expected NAME=NUMBER",
    ("run", "program.py", "--isolation", "prayer"): "use auto, bubblewrap, landlock or none",
    ("run", "program.py", "--device", "cuda:77"): "device 'cuda:77' is not here",
    ("run", "program.py", "--runs", "text.txt"): "choose another with --runs",
    ("run", "program.py", "--plan", "text.txt"): "text.txt: not JSON",
    ("judge", "nothing"): "nothing does not exist",
    ("judge", "nothing.rrd"): "nothing.rrd does not exist",
    ("judge", "text.rrd"): "not a whole Rerun recording",
    ("view", "nothing"): "nothing does not exist",
    ("generate",): "give a sentence",
    ("generate", PROMPT, "--yes", "--isolation", "prayer"): "use auto, bubblewrap, landlock or none",
}
WRONG_OPTIONS = [
    ("run", "program.py", "--bad"),
    ("run",),
    ("run", "program.py", "--timeout", "nan"),
    ("run", "program.py", "--timeout", "1e9"),
    ("run", "program.py", "--memory", "0.5"),
    ("run", "program.py", "--time-step", "-1"),
    ("view", ".", "--port", "70000"),
    ("nothing",),
]


@pytest.fixture
def place(tmp_path: Path) -> set[str]:
    (tmp_path / "program.py").write_text(PROGRAM)
    (tmp_path / "text.txt").write_text("text")
    (tmp_path / "text.rrd").write_text("text")
    return {"program.py", "text.txt", "text.rrd"}


@pytest.mark.parametrize("arguments", MISTAKES, ids=" ".join)
def test_a_mistake_is_one_line_and_leaves_nothing(told, place, tmp_path: Path, arguments: tuple[str, ...]) -> None:
    ended = told(*arguments)
    assert ended.code == 2, ended.out
    assert ended.err.startswith("wsim: ")
    assert ended.err.count("\n") == 1
    assert MISTAKES[arguments] in ended.err
    assert {path.name for path in tmp_path.iterdir()} == place


@pytest.mark.parametrize("arguments", WRONG_OPTIONS, ids=" ".join)
def test_a_wrong_option_ends_with_2(told, place, tmp_path: Path, arguments: tuple[str, ...]) -> None:
    ended = told(*arguments)
    assert ended.code == 2
    assert ended.err.startswith("wsim: ")
    assert ended.err.count("\n") == 1
    assert f"wsim {arguments[0]} --help" in ended.err or arguments == ("nothing",)
    assert {path.name for path in tmp_path.iterdir()} == place


def test_ctrl_c_while_it_simulates_leaves_nothing_that_looks_finished(launch, tmp_path: Path) -> None:
    (tmp_path / "tank.py").write_text(TANK)
    process = launch("run", "tank.py", "--device", "cpu")
    for line in process.stdout:
        if line.startswith("simulating"):
            break
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=STUCK)
    assert process.returncode == 130, err
    assert err == "wsim: stopped\n"
    (run,) = (tmp_path / "runs").iterdir()
    facts = json.loads((run / "run.json").read_text())
    assert (facts["status"], facts["summary"]) == ("stopped", "interrupted")
    found = {path.name for path in run.rglob("*") if path.is_file()}
    assert not found & {"verdict.json", "review.json", "video.mp4", "SHA256SUMS", "report.html"}
    assert not any(".partial" in name or ".part." in name for name in found)
    recording = run / "iterations" / "01" / "recording.rrd"
    judged = launch("judge", recording)  # what happened so far is kept, and says that it is not all
    out, _ = judged.communicate(timeout=STUCK)
    assert judged.returncode == 1, out
    assert "CheckComplete" in out


def test_a_ctrl_c_that_comes_while_an_object_is_deleted_is_not_lost(tmp_path: Path) -> None:
    """Python drops what `__del__` raises; Warp's arrays have one, and a simulation deletes many."""
    code = (
        "import os, signal, time, wsim.cli\n"
        "class Deleted:\n"
        "    def __del__(self):\n"
        "        os.kill(os.getpid(), signal.SIGINT)\n"
        "        time.sleep(0.2)\n"
        "def work():\n"
        "    Deleted()\n"
        "    time.sleep(20.0)\n"
        "wsim.cli.app.command('work')(work)\n"
        "wsim.cli.main()\n"
    )
    with children.started([sys.executable, "-c", code, "work"], stderr=subprocess.PIPE) as process:
        _, err = process.communicate(timeout=STUCK)
    assert (process.returncode, err) == (130, "wsim: stopped\n")
