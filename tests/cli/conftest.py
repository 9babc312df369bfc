from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from tests import children
from tests.patience import STUCK
from wsim.cli import app
from wsim.errors import UserError
from wsim.program.sandbox import available
from wsim.rules.planner import plan

ENVIRONMENT = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY", "COLUMNS")}


@dataclass
class Ended:
    """A command that has ended."""

    code: int
    out: str
    err: str
    runs: Path

    @property
    def run(self) -> Path:
        """The one run folder that it made."""
        (path,) = self.runs.iterdir()
        return path

    @property
    def verdict(self) -> dict[str, Any]:
        """What the run's only iteration came to."""
        return json.loads((self.run / "iterations" / "01" / "verdict.json").read_text())

    @property
    def failure(self) -> dict[str, Any]:
        """The one finding that did not pass."""
        (failure,) = (finding for finding in self.verdict["findings"] if not finding["passed"])
        return failure


def start(command: list[str], folder: Path) -> subprocess.Popen[str]:
    """Start a command in a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    pipe = subprocess.PIPE
    return children.start(command, cwd=folder, env=ENVIRONMENT, stdin=subprocess.DEVNULL, stdout=pipe, stderr=pipe)


def end(process: subprocess.Popen[str], folder: Path) -> Ended:
    """Wait for a command, and see what no command may ever do: trace back."""
    try:
        out, err = process.communicate(timeout=STUCK)
    finally:
        children.end_group(process)
    assert "Traceback" not in out + err, err
    return Ended(process.returncode, out, err, folder / "runs")


def wsim_command(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "wsim.cli", *map(str, arguments)]


@pytest.fixture
def wsim(tmp_path: Path) -> Callable[..., Ended]:
    """Run `wsim` in an empty folder."""
    return lambda *arguments: end(start(wsim_command(*arguments), tmp_path), tmp_path)


@pytest.fixture
def told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Ended]:
    """Call `wsim` in an empty folder, in this process: for what does not hang on a process of its own."""

    def one(*arguments: object) -> Ended:
        monkeypatch.chdir(tmp_path)
        done = CliRunner().invoke(app, [str(word) for word in arguments], prog_name="wsim")
        if isinstance(done.exception, UserError):  # as `main` says it
            return Ended(2, done.stdout, f"{done.stderr}wsim: {done.exception}\n", tmp_path / "runs")
        if done.exception is not None and not isinstance(done.exception, SystemExit):
            raise done.exception
        return Ended(done.exit_code, done.stdout, done.stderr, tmp_path / "runs")

    return one


@pytest.fixture(scope="session")
def require_isolation() -> Callable[[str], None]:
    def check(name: str) -> None:
        problem = available()[name]
        if problem:
            pytest.skip(f"{name}: {problem}")

    return check


@pytest.fixture(scope="session")
def floating_plan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The plan of a floating block in coarse water, small and short: 288 particles for 2 s."""
    data = plan("A wooden block floats in a tank of water.").model_dump(mode="json")
    things = {thing["name"]: thing for thing in data["objects"]}
    level = 0.25
    things["tank"]["construction"]["size"] = [0.4, 0.4, 0.4]
    (surface,) = (rule for rule in things["water"]["topology"]["relation"] if rule["predicate"] == "FREE-SURFACE-AT")
    surface["value"] = level
    things["wooden_block"]["pose"]["position"] = [0.0, 0.0, 0.28]  # 0.06 m deep; at rest it is 0.084 m
    data["simulation"] |= {"duration": 2.0, "spacing": 0.05, "frame_rate": 10.0}
    path = tmp_path_factory.mktemp("plan") / "plan.json"
    path.write_text(json.dumps(data))
    return path


@pytest.fixture(scope="session")
def generated(floating_plan: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Ended, Ended]:
    """That plan without pictures, and three frames of it with pictures, both generated at once."""
    folders = [tmp_path_factory.mktemp("floating"), tmp_path_factory.mktemp("pictured")]
    data = json.loads(floating_plan.read_text())
    data["simulation"] |= {"duration": 0.2}
    (folders[1] / "plan.json").write_text(json.dumps(data))
    options = [("--plan", floating_plan, "--no-pictures"), ("--plan", "plan.json")]
    command = wsim_command("generate", "--yes", "--device", "cpu")
    started = [start([*command, *map(str, more)], folder) for more, folder in zip(options, folders, strict=True)]
    floating, pictured = (end(process, folder) for process, folder in zip(started, folders, strict=True))
    return floating, pictured


@pytest.fixture(scope="session")
def floating(generated: tuple[Ended, Ended]) -> Ended:
    """The plan of a floating block, generated without pictures."""
    return generated[0]


@pytest.fixture(scope="session")
def pictured(generated: tuple[Ended, Ended]) -> Ended:
    """Three frames of it, generated with pictures."""
    return generated[1]


@pytest.fixture(scope="session")
def reruns(floating: Ended, tmp_path_factory: pytest.TempPathFactory) -> tuple[Ended, Ended]:
    """That run run again: as it is, and with heavy wood."""
    folders = [tmp_path_factory.mktemp("again"), tmp_path_factory.mktemp("heavy")]
    command = wsim_command("run", floating.run, "--no-pictures", "--device", "cpu")
    started = [start([*command, *more], folder) for more, folder in zip(([], HEAVY), folders, strict=True)]
    again, heavy = (end(process, folder) for process, folder in zip(started, folders, strict=True))
    return again, heavy


HEAVY = ["--set", "wood_density=2500"]


@pytest.fixture
def launch(tmp_path: Path) -> Iterator[Callable[..., subprocess.Popen[str]]]:
    """Start `wsim` in an empty folder, and see that it is gone afterwards, with all that it started."""
    started: list[subprocess.Popen[str]] = []

    def one(*arguments: object) -> subprocess.Popen[str]:
        started.append(start(wsim_command(*arguments), tmp_path))
        return started[-1]

    yield one
    for process in started:
        children.end_group(process)
