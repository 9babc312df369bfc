"""docs/tools.md shows what the tools answer, and the command line calls them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from docs import run_tools
from tests.tools.conftest import RIGID
from wsim.cli import app
from wsim.errors import UserError
from wsim.tools import TOOLS
from wsim.tools.signals import BODY, FLUID, JOINT

ROOT = Path(__file__).parents[2]
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e-?\d+)?")
PAGE = (ROOT / "docs" / "tools.md").read_text(encoding="utf-8")


def test_the_page_shows_what_the_tools_answer() -> None:
    """In words exactly; in numbers to 2 %, for another machine may round otherwise."""
    with run_tools.workplace(PAGE):
        for example in run_tools.examples(PAGE):
            said, answer = example.said, run_tools.printed(example)
            assert NUMBER.sub("#", said).split() == NUMBER.sub("#", answer).split(), example.command
            for mine, theirs in zip(NUMBER.findall(said), NUMBER.findall(answer), strict=True):
                assert float(mine) == pytest.approx(float(theirs), rel=0.02), example.command


def test_the_page_has_every_tool_and_every_signal() -> None:
    shown = {example.command.split()[1] for example in run_tools.examples(PAGE)}
    assert shown == set(TOOLS)
    signals = set(re.findall(r"`([a-z_]+)`", PAGE.split("| signal |")[1].split("\n\n")[0]))
    assert signals - {"rotation_deg", "other"} == {*BODY, *JOINT, *FLUID, "gap"}


def command(*words: str) -> str:
    done = CliRunner().invoke(app, ["tool", *words])
    assert done.exception is None, done.output
    return done.output


def test_the_command_lists_explains_and_calls() -> None:
    listed = command()
    assert [line.split()[0] for line in listed.splitlines()] == list(TOOLS)
    assert "words: what people call it" in command("search_catalogue")
    assert 'reduction ["samples"]' in command("query_recording")
    assert command("search_catalogue", "words=desk", "limit=1").splitlines()[1].startswith("desk")


def test_values_are_json_where_they_are_that_else_text(tmp_path: Path) -> None:
    run = tmp_path / "made"
    assert "01/program.py" in command("write_program", "--run", str(run), f"text={RIGID}")
    assert command("read_program", "--run", str(run), "from_line=3", "to_line=3") == "3  from wsim.scene import Scene\n"
    assert "no asset '12'" in CliRunner().invoke(app, ["tool", "show_asset", "id=12"]).output
    assert (run / "run.json").is_file()


def test_where_a_tool_says_no_the_exit_code_is_1() -> None:
    done = CliRunner().invoke(app, ["tool", "show_asset", "id=mugg"])
    assert done.exit_code == 1
    assert done.output == "show_asset: no asset 'mugg'; did you mean 'mug'?\n"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["stil"], "did you mean still?"),
        (["show_asset", "mug"], "expected KEY=VALUE"),
        (["show_asset", "id=mug", "id=desk"], "id is given twice"),
        (["read_plan", "part=objects"], "give its folder with --run"),
        (["read_plan", "--run", "nowhere"], "does not exist"),
    ],
)
def test_a_mistake_in_the_command_is_one_line(words: list[str], said: str) -> None:
    done = CliRunner().invoke(app, ["tool", *words])
    assert isinstance(done.exception, UserError)
    assert said in str(done.exception)
