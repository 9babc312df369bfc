"""`wsim run` on programs that mean harm or are broken: a verdict that says why, soon, and no traceback."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.patience import STUCK

BOX = 'def build(scene):\n    scene.box("b", size=(1, 1, 1), density=500.0)\n'
FILL = (
    "def build(scene):\n"
    "    with open({!r}, 'wb') as file:\n"
    "        while True:\n"
    "            file.write(bytes(1 << 20))\n"
)
NAN_IN_STAGE = (
    "def build(scene):\n"
    "    from pxr import Gf\n"
    '    box = scene.box("b", size=(1, 1, 1), density=500.0, position=(0, 0, 1))\n'
    '    attribute = scene.stage.GetPrimAtPath(box.path).GetAttribute("xformOp:translate")\n'
    '    attribute.Set(Gf.Vec3d(0.0, 0.0, float("nan")))\n'
)
# name: (program, check, part of the message, line)
PROGRAMS: dict[str, tuple[str, str, str, int | None]] = {
    "raises": (BOX + '    raise RuntimeError("no such world")\n', "build", "RuntimeError: no such world", 3),
    "nan_in_a_call": (
        BOX.replace("density", 'position=(0, 0, float("nan")), density'),
        "build",
        "position[2] = nan",
        2,
    ),
    "nan_in_the_stage": (NAN_IN_STAGE, "stage", "/World/b", None),
    "fills_the_root": (FILL.format("/filler"), "build", "/filler", 2),
    "fills_its_folder": (FILL.format("filler"), "build", "File too large", 4),
    "exits": ("import os\n" + BOX + "    os._exit(0)\n", "build", "ended its process", None),
    "has_no_build": ("x = 1\n", "build", "no function build(scene)", None),
    "is_no_python": ('def build(scene):\n    scene.box("b"\n', "build", "SyntaxError", 2),
    "makes_nothing": ("def build(scene):\n    pass\n", "build", "without making an object", None),
}


def check(ended, name: str, message: str, line: int | None) -> None:
    assert ended.code == 1, ended.err
    assert ended.err == ""
    assert ended.verdict["status"] == "rejected"
    failure = ended.failure
    assert failure["check"] == name
    assert message in failure["message"]
    assert failure["line"] == (f"program.py:{line}" if line else None)
    assert message in ended.out
    report = (ended.run / "report.html").read_text()
    assert "Rejected" in report
    facts = json.loads((ended.run / "run.json").read_text())
    assert (facts["status"], facts["summary"]) == ("rejected", ended.verdict["summary"])
    assert not (ended.run / "accepted").exists()
    assert not list(ended.runs.rglob("*.partial"))
    assert not list(ended.runs.rglob("recording.rrd"))


@pytest.mark.parametrize("name", PROGRAMS)
def test_a_program_that_makes_no_world_is_rejected(told, tmp_path: Path, name: str) -> None:
    text, check_name, message, line = PROGRAMS[name]
    (tmp_path / f"{name}.py").write_text(text)
    ended = told("run", f"{name}.py", "--timeout", STUCK)
    check(ended, check_name, message, line)
    assert (ended.run / "iterations" / "01" / "program.py").read_text() == text
    assert {path.name for path in tmp_path.iterdir()} == {f"{name}.py", "runs"}
    assert not Path("/filler").exists()


@pytest.mark.parametrize("isolation", ["bubblewrap", "landlock"])
def test_a_loop_is_stopped_in_time(wsim, tmp_path: Path, require_isolation, isolation: str) -> None:
    require_isolation(isolation)
    (tmp_path / "loops.py").write_text(BOX + "    while True:\n        pass\n")
    ended = wsim("run", "loops.py", "--timeout", 2, "--isolation", isolation)
    check(ended, "build", "did not end within 2 s", None)
    checks = json.loads((ended.run / "iterations" / "01" / "checks.json").read_text())
    assert checks["build"]["isolation"] == isolation
    assert checks["build"]["kind"] == "timeout"


def test_landlock_keeps_the_root_closed_too(told, tmp_path: Path, require_isolation) -> None:
    require_isolation("landlock")
    (tmp_path / "fills.py").write_text(FILL.format("/filler"))
    ended = told("run", "fills.py", "--timeout", STUCK, "--isolation", "landlock")
    check(ended, "build", "/filler", 2)
    assert not Path("/filler").exists()
