"""What README and the other documents tell a reader to type works: commands, files, names and code."""

from __future__ import annotations

import ast
import contextlib
import importlib
import os
import re
import subprocess
import sys
from collections.abc import Callable
from functools import partial, reduce
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from tests.documents import DOCUMENTS, ROOT, Block, Command, blocks, commands, inline, name_of
from tests.patience import STUCK
from wsim.agents.models import choose
from wsim.cli import app
from wsim.cli.verbs import load

COMMANDS = [command for path in DOCUMENTS for command in commands(path)]
CODE = [block for path in DOCUMENTS for block in blocks(path)]
PAGES = pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.name)
# Run below, by tests/test_documents.py and by tests/judge/language/test_page.py.
ELSEWHERE = {"README.md-python-0", "docs/mcp.md-python-0", "docs/objectives.md-python-0", "docs/objectives.md-python-1"}


def of(program: str) -> Any:
    """The documents' commands that call a program."""
    found = [command for command in COMMANDS if command.program == program]
    return pytest.mark.parametrize("command", found, ids=str)


@of("wsim")
def test_a_verb_takes_what_it_is_given(command: Command) -> None:
    """Each is read to the end, as the command line reads it, and none is run."""
    verb, *words = command.words
    load(verb).make_context(verb, words)


@of("make")
def test_make_has_the_target(command: Command) -> None:
    targets = re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    assert command.words[0] in targets


SCRIPTS = [command for command in COMMANDS if command.program == "python" and command.words[0] != "-c"]
SCRIPTS += [
    Command("Makefile", (), "python", tuple(line.split()))
    for line in re.findall(
        r"^\t\$\(BIN\)/python (?!-m)(.*)$",
        (ROOT / "Makefile").read_text(encoding="utf-8").replace("\\\n", ""),
        re.MULTILINE,
    )
]


def parameters(script: Path) -> set[str]:
    """The options that a script's parser adds."""
    calls = [node for node in ast.walk(ast.parse(script.read_text(encoding="utf-8"))) if isinstance(node, ast.Call)]
    added = [call for call in calls if isinstance(call.func, ast.Attribute) and call.func.attr == "add_argument"]
    return {word.value for call in added for word in call.args if isinstance(word, ast.Constant)}


@pytest.mark.parametrize("command", SCRIPTS, ids=str)
def test_a_script_is_there_and_takes_its_options(command: Command) -> None:
    script, *words = command.words
    options = {word for word in words if word.startswith("--")}
    assert options <= parameters(ROOT / script), command


@PAGES
def test_scripts_within_sentences_take_their_options(path: Path) -> None:
    for code in inline(path):
        if found := re.match(r"(?:\.venv/bin/python )?([\w/]+\.py) (--.*)", code):
            assert set(re.findall(r"--[a-z-]+", found[2])) <= parameters(ROOT / found[1]), code


# What wsim makes, or one of the skills has.
MADE = tuple(
    f"{folder}/" for folder in ["build", "runs", "accepted", "iterations", "frames", "pictures", "verify", "references"]
)


@PAGES
def test_files_are_there(path: Path) -> None:
    """Beside the document, in the repository, or anywhere in the package."""
    for code in inline(path):
        if not re.fullmatch(r"(?:[\w.*-]+/)+(?:[\w.*-]+\.\w+)?|[\w/]+\.py", code) or re.search(r"\b[A-Z]+\b", code):
            continue
        if code.startswith(MADE):
            continue
        named = code.rstrip("/")
        places = [path.parent.glob(named), ROOT.glob(named), (ROOT / "src" / "wsim").rglob(named)]
        assert any(place for found in places for place in found), code


@PAGES
def test_names_are_there(path: Path) -> None:
    """Each `wsim.…` is a module, or something in one."""
    for name in {name for code in inline(path) for name in re.findall(r"(?<![\w/.-])wsim(?:\.[A-Za-z_]\w*)+", code)}:
        if name.endswith((".toml", ".git")):
            continue
        parts = name.split(".")
        for known in range(len(parts), 0, -1):
            with contextlib.suppress(ModuleNotFoundError):
                module = importlib.import_module(".".join(parts[:known]))
                reduce(getattr, parts[known:], module)
                break


# --- what can be run here, offline and in seconds


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The repository as the reader of a document sees it, in which runs leave nothing behind."""
    for name in ("examples", "skills", "usd_assets"):
        (tmp_path / name).symlink_to(ROOT / name)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def is_short(command: Command) -> bool:
    """Plans, and runs without pictures, which is what takes the time; tools.md has a test of its own."""
    return command.words[0] in ("plan", "doctor") or "--no-pictures" in command.words


@pytest.mark.parametrize("command", [one for one in COMMANDS if one.program == "wsim" and is_short(one)], ids=str)
def test_a_short_command_does_its_work(command: Command, place: Path) -> None:
    device = ["--device", "cpu"] if command.words[0] == "run" else []
    done = CliRunner().invoke(app, [*command.words, *device])
    assert done.exception is None or isinstance(done.exception, SystemExit), done.output
    assert done.exit_code == 0, done.output


WITHIN = [
    Command(name_of(path), (), "python", ("-c", found[1]))
    for path in DOCUMENTS
    for code in inline(path)
    if (found := re.match(r'\.venv/bin/python -c "(.*)"$', code))
]


@pytest.mark.parametrize(
    "command", [*WITHIN, *(one for one in COMMANDS if one.program == "python" and one.words[0] == "-c")], ids=str
)
def test_a_line_of_python_does_its_work(command: Command, place: Path) -> None:
    done = subprocess.run([sys.executable, *command.words], capture_output=True, text=True, timeout=STUCK)
    assert (done.returncode, done.stderr) == (0, "")
    made = (place / "stage.usda").is_file() or Path(done.stdout.strip()).is_dir()
    assert made, done.stdout


def assets(place: Path, patch: pytest.MonkeyPatch) -> dict[str, Any]:
    from pxr import Gf, UsdGeom

    from wsim.assets import get
    from wsim.scene import Scene

    return {"scene": Scene(), "get": get, "Gf": Gf, "UsdGeom": UsdGeom}


def worlds(place: Path, patch: pytest.MonkeyPatch) -> dict[str, Any]:
    """A ball that falls, and what is asked of it."""
    from wsim.judge.language import parse
    from wsim.judge.worlds import judge_worlds, weigh
    from wsim.scene import Scene
    from wsim.sim import Simulation
    from wsim.sim.collect import collect

    scene = Scene()
    scene.simulation(duration=0.2, frame_rate=20.0)
    scene.ground()
    scene.sphere("ball", radius=0.1, density=500.0, position=(0.0, 0.0, 0.5))
    stage = scene.save(place / "stage.usda")
    given = {"Simulation": partial(Simulation, device="cpu"), "collect": collect, "judge_worlds": judge_worlds}
    return given | {"weigh": weigh, "formula": parse("speed_between(ball, 0 m/s, 3 m/s)"), "plan": None, "stage": stage}


def one_step(place: Path, patch: pytest.MonkeyPatch) -> dict[str, Any]:
    """The example's box and water, coarse, before their first step."""
    source = (ROOT / "examples/newton/sph_floating_box.py").read_text(encoding="utf-8").split("\nfor frame in")[0]
    coarse = source.replace("SPACING, DEPTH, TANK, BOX, G = 0.02,", "SPACING, DEPTH, TANK, BOX, G = 0.06,")
    assert coarse != source
    patch.setattr(sys, "argv", ["sph_floating_box.py", "cpu"])
    names: dict[str, Any] = {"dt": 1e-4}
    exec(compile(coarse, "sph_floating_box.py", "exec"), names)
    return names


def program(place: Path, patch: pytest.MonkeyPatch) -> dict[str, Any]:
    return {"text": "def build(scene):\n    scene.bax('b')\n"}


# What a page's block takes from around it, and part of what it prints.
AROUND: dict[str, tuple[Callable[[Path, pytest.MonkeyPatch], dict[str, Any]], str]] = {
    "docs/assets.md-python-1": (assets, ""),
    "docs/judge.md-python-0": (worlds, ""),
    "docs/skills.md-python-0": (lambda *_: {}, "floating-bodies "),
    "docs/sph.md-python-0": (one_step, ""),
    "docs/validator.md-python-0": (program, "bax"),
}
MANY = "1024"  # worlds


@pytest.mark.parametrize("block", [block for block in CODE if str(block) not in ELSEWHERE], ids=str)
def test_a_block_runs_and_gives_what_it_says(
    block: Block, place: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    around, printed = AROUND.get(str(block), (lambda *_: {}, ""))
    names = around(place, monkeypatch)
    text = block.text.replace(MANY, "8")
    for statement in ast.parse(text).body:
        if not isinstance(statement, ast.Expr):
            exec(compile(ast.Module([statement], []), str(block), "exec"), names)
            continue
        value = eval(compile(ast.Expression(statement.value), str(block), "eval"), names)
        said = comment(text.splitlines()[statement.end_lineno - 1])
        if isinstance(said, str) and said.endswith("..."):
            assert value.startswith(said.removesuffix("..."))
        elif said is not None:
            assert value == said
    assert printed in capsys.readouterr().out


def test_the_client_talks_to_the_server(place: Path) -> None:
    """In a shell where the environment of wsim is active."""
    (block,) = blocks(ROOT / "docs" / "mcp.md")
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}
    command = [sys.executable, "-c", block.text]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=STUCK)
    assert done.returncode == 0, done.stderr
    assert "wooden_box" in done.stdout
    assert list((place / "runs").glob("*/plan.json"))


def test_the_settings_are_read_as_they_stand(place: Path) -> None:
    (block,) = blocks(ROOT / "docs" / "agents.md", "toml")
    (place / "wsim.toml").write_text(block.text, encoding="utf-8")
    models = choose()
    assert (models.planner, models.reviewer) == ("openai:MODEL", "builtin")


def comment(line: str) -> Any:
    """The value that a line's comment says, where it is one."""
    with contextlib.suppress(SyntaxError, ValueError):
        return ast.literal_eval(line.partition("  # ")[2])
    return None


def test_what_is_said_of_a_block_is_of_one_that_is_there() -> None:
    assert {*AROUND, *ELSEWHERE} <= {str(block) for block in CODE}
