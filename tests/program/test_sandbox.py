from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest
from pxr import Usd

from wsim.errors import UserError
from wsim.program.sandbox import available, build
from wsim.program.sandbox.isolation import bubblewrap, choose
from wsim.program.sandbox.result import read_report

PROGRAM = '''"""A block on the ground."""

from wsim.scene import Scene


def build(scene: Scene) -> None:
    scene.ground()
    density = scene.param("density", 600.0, low=300.0, high=900.0, unit="kg/m^3")
    scene.box("block", size=(0.2, 0.2, 0.2), position=(0.0, 0.0, 0.5), density=density)
    print("made a block")


if __name__ == "__main__":
    raise SystemExit("must not run")
'''


@pytest.fixture
def program(tmp_path: Path) -> Path:
    path = tmp_path / "program.py"
    path.write_text(PROGRAM)
    return path


def test_a_program_makes_a_stage(program: Path, tmp_path: Path, isolation: str) -> None:
    target = tmp_path / "stage.usda"
    result = build(program, target, {"density": 450.0}, isolation=isolation)
    assert (result.ok, result.kind, result.message, result.line) == (True, "ok", "built", None)
    assert result.log == "made a block\n"
    assert result.seconds > 0.0
    assert not target.is_symlink()
    stage = Usd.Stage.Open(str(target))
    block = stage.GetPrimAtPath("/World/block")
    assert block.GetCustomDataByKey("wsim:line") == "program.py:9"
    assert block.GetAttribute("physics:density").Get() == 450.0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["program.py", "stage.usda"]
    assert result.finding()["passed"]


def test_every_isolation_makes_the_same_stage(program: Path, tmp_path: Path, isolation: str) -> None:
    build(program, tmp_path / "bare.usda", isolation="none")
    build(program, tmp_path / "kept_apart.usda", isolation=isolation)
    assert (tmp_path / "bare.usda").read_bytes() == (tmp_path / "kept_apart.usda").read_bytes()


def test_a_failure_leaves_the_last_stage_as_it_is(program: Path, tmp_path: Path) -> None:
    target = tmp_path / "stage.usda"
    assert build(program, target, isolation="none").ok
    before = target.read_bytes()
    program.write_text("def build(scene):\n    scene.box('b', size=(-1.0, 1.0, 1.0))\n")
    result = build(program, target, isolation="none")
    assert (result.kind, result.line) == ("exception", "program.py:2")
    assert "size[0] = -1 must be > 0" in result.message
    assert target.read_bytes() == before


def test_a_message_of_any_length_is_cut_and_stays_whole_in_the_log(program: Path, tmp_path: Path) -> None:
    program.write_text("def build(scene):\n    raise ValueError('x' * 5000)\n")
    result = build(program, tmp_path / "stage.usda", isolation="none")
    assert len(result.message) <= 401
    assert result.message.startswith("ValueError: xxx")
    assert result.message.endswith("x…")
    assert "x" * 5000 in result.log


def test_a_syntax_error_names_its_line(program: Path, tmp_path: Path) -> None:
    program.write_text("def build(scene):\n    scene.ground(\n")
    result = build(program, tmp_path / "stage.usda", isolation="none")
    assert (result.kind, result.line) == ("exception", "program.py:2")
    assert result.message == "SyntaxError: '(' was never closed"


def test_a_parameter_that_the_program_lacks_is_told(program: Path, tmp_path: Path) -> None:
    result = build(program, tmp_path / "stage.usda", {"densty": 1.0}, isolation="none")
    assert result.kind == "exception"
    assert 'did you mean "density"?' in result.message


def test_folders_are_read_only_where_they_are_named(tmp_path: Path, isolation: str) -> None:
    assets = tmp_path / "assets"
    assets.mkdir()
    (assets / "note").write_text("0.25")
    program = tmp_path / "program.py"
    program.write_text(
        "def build(scene):\n"
        f"    scene.sphere('ball', radius=float(open({str(assets / 'note')!r}).read()))\n"
        f"    open({str(assets / 'more')!r}, 'w')\n"
    )
    hidden = build(program, tmp_path / "stage.usda", isolation=isolation)
    assert (hidden.kind, hidden.line) == ("exception", "program.py:2")
    shown = build(program, tmp_path / "stage.usda", isolation=isolation, readable=[assets])
    assert (shown.kind, shown.line) == ("exception", "program.py:3")
    assert os.listdir(assets) == ["note"]  # noqa: PTH208


def test_bubblewrap_takes_what_lies_behind_a_link(tmp_path: Path) -> None:
    """As a virtual environment that is a link does: its python is named both ways."""
    if problem := available()["bubblewrap"]:
        pytest.skip(problem)
    real, link = tmp_path / "real", tmp_path / "link"
    real.mkdir()
    (real / "note").write_text("0.25")
    link.symlink_to(real)
    command = [*bubblewrap([link, link / "note", real, real / "note"], scratch_bytes=1 << 20), "--"]
    done = subprocess.run([*command, "/bin/cat", str(link / "note")], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "0.25", "")


def test_a_program_is_nobody_under_bubblewrap(tmp_path: Path) -> None:
    if problem := available()["bubblewrap"]:
        pytest.skip(problem)
    program = tmp_path / "program.py"
    program.write_text(
        "import os\ndef build(scene):\n    scene.sphere('ball', radius=0.1)\n"
        "    print(os.getresuid(), os.getresgid())\n"
        "    print(sorted(os.listdir('/dev')), os.listdir('/proc'), os.path.exists('/sys'))\n"
    )
    log = build(program, tmp_path / "stage.usda", isolation="bubblewrap").log
    nobody, seen = log.splitlines()
    assert nobody == "(65534, 65534, 65534) (65534, 65534, 65534)"
    assert seen == "['null', 'random', 'urandom', 'zero'] ['self'] False"


def test_a_program_may_use_numpy_and_scratch(tmp_path: Path, isolation: str) -> None:
    program = tmp_path / "program.py"
    program.write_text(
        "import numpy as np\n"
        "def build(scene):\n"
        "    np.save('sizes.npy', np.array([0.1, 0.2]))\n"
        "    for i, size in enumerate(np.load('sizes.npy')):\n"
        "        scene.sphere(f'ball_{i}', radius=size, position=(i, 0.0, 0.0))\n"
    )
    assert build(program, tmp_path / "stage.usda", isolation=isolation).message == "built"


def test_the_environment_is_bare(tmp_path: Path, isolation: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOME_API_KEY", "1234")
    program = tmp_path / "program.py"
    program.write_text("import os\ndef build(scene):\n    scene.ground()\n    print(sorted(os.environ))\n")
    log = build(program, tmp_path / "stage.usda", isolation=isolation).log
    assert "PATH" in log
    assert "SOME_API_KEY" not in log


def test_nobody_answers_a_program_that_asks(tmp_path: Path) -> None:
    program = tmp_path / "program.py"
    program.write_text("def build(scene):\n    input('size? ')\n")
    result = build(program, tmp_path / "stage.usda", isolation="none")
    assert (result.kind, result.message) == ("exception", "EOFError: EOF when reading a line")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"program": Path("nowhere.py")}, "nowhere.py is not a file"),
        ({"params": {"density": float("nan")}}, "density = nan must be a finite number"),
        ({"isolation": "chroot"}, 'isolation = "chroot" is not known'),
    ],
)
def test_a_users_mistake_is_one_line(program: Path, tmp_path: Path, change: dict, words: str) -> None:
    arguments = {"program": program, "stage": tmp_path / "stage.usda", **change}
    with pytest.raises(UserError, match=words):
        build(**arguments)


def test_auto_takes_what_works() -> None:
    assert choose("auto") in ("bubblewrap", "landlock")
    assert choose("none") == "none"


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"{",
        b"[]",
        b'{"outcome": "ok", "more": 1}',
        b'{"outcome": "fine"}',
        b'{"outcome": "exception", "line": -1}',
        b'{"outcome": "exception", "line": 1e400}',
        b'{"outcome": "exception", "message": "' + b"x" * 5000 + b'"}',
        b"[" * 100_000,
        b"x" * 1_000_000,
    ],
)
def test_a_forged_report_is_no_report(data: bytes) -> None:
    assert read_report(data) is None
