"""`wsim plan`, and what `wsim generate` shows and asks before it builds, as a person at a terminal meets them."""

from __future__ import annotations

import json
import os
import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from PIL import Image

from tests.patience import STUCK
from wsim.plan.schema import Plan

from .conftest import ENVIRONMENT, wsim_command

EXAMPLES = Path(__file__).parents[2] / "examples" / "plans"
PROMPT = "A wooden block floats in a tank of water."
OPEN = "A ball and blocks drop into a tank of water."  # of what, and how many?
Talk = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def talk(tmp_path: Path) -> Talk:
    """Run `wsim generate` with typed lines for answers; it stops before anything is simulated."""

    def run(typed: str, *arguments: object, editor: str = "true") -> subprocess.CompletedProcess[str]:
        (tmp_path / "runs").write_text("a file where the runs' folder would be: nothing can be built")
        return subprocess.run(
            wsim_command("generate", *arguments),
            cwd=tmp_path,
            env={**ENVIRONMENT, "EDITOR": editor, "VISUAL": ""},
            input=typed,
            capture_output=True,
            text=True,
            timeout=STUCK,
        )

    return run


def editor(folder: Path, *commands: str) -> str:
    """An editor that does one of these sed commands each time it is opened."""
    steps = "".join(f"  {k}) sed -i '{command}' \"$1\" ;;\n" for k, command in enumerate(commands))
    script = folder / "editor.sh"
    script.write_text(
        "#!/bin/sh\n"
        f'count=$(cat {folder}/count 2>/dev/null || echo 0)\necho $((count + 1)) > {folder}/count\n'
        f"case $count in\n{steps}esac\n"
    )  # fmt: skip
    script.chmod(0o755)
    return str(script)


def test_a_plan_is_shown_printed_and_written(wsim, tmp_path: Path) -> None:
    ended = wsim("plan", PROMPT, "-o", "plan.json")
    assert (ended.code, ended.err) == (0, "")
    for words in (
        "wooden_block",
        "tank: on the ground",
        "wooden_block: floating on water",
        "must: wooden_block floats on the water.",
        "assumed: ",
        "from above   ↑ LEFT (+Y)   → FRONT (+X)",
        "side, from the right",
        "particles of fluid",
        "on one CPU core",
        "picture: plan.png",
        "plan: plan.json",
    ):
        assert words in ended.out
    assert {path.name for path in tmp_path.iterdir()} == {"plan.json", "plan.png"}
    assert Image.open(tmp_path / "plan.png").format == "PNG"
    written = Plan.model_validate_json((tmp_path / "plan.json").read_text())
    printed = wsim("plan", PROMPT, "--json")
    assert Plan.model_validate_json(printed.out) == written


def test_a_plan_without_a_file_has_its_picture_in_a_new_folder(wsim, tmp_path: Path) -> None:
    ended = wsim("plan", PROMPT)
    (picture,) = re.findall(r"^picture: (.+)$", ended.out, re.MULTILINE)
    assert Path(picture).is_file()
    Path(picture).unlink()
    Path(picture).parent.rmdir()
    assert list(tmp_path.iterdir()) == []


def test_a_plan_from_a_file_is_checked_laid_out_and_shown(wsim, tmp_path: Path) -> None:
    path = EXAMPLES / "buggy_floating_bridge.json"
    ended = wsim("plan", "--plan", path, "-o", "laid_out.json")
    assert (ended.code, ended.err) == (0, "")
    for words in ("toy buggy with four driven wheels, 0.5 m long (for now: box)", "gangway_back: a bridge from"):
        assert words in ended.out
    placed = Plan.model_validate_json((tmp_path / "laid_out.json").read_text())
    assert placed.object("buggy").pose is not None
    (tmp_path / "wrong.json").write_text(path.read_text().replace('"FACING-TO"', '"FACES"'))
    wrong = wsim("plan", "--plan", "wrong.json")
    assert wrong.code == 2
    assert wrong.err.startswith("wsim: wrong.json: not a plan: objects.8.topology.relation.3: there is no predicate")
    assert wrong.err.count("\n") == 1


def test_the_schema_is_printed(wsim) -> None:
    schema = json.loads(wsim("plan", "--schema").out)
    assert schema["title"] == "Plan"
    assert {"objects", "joints", "cameras", "objectives", "assumptions"} <= set(schema["properties"])
    assert "PlanObject" in schema["$defs"]


@pytest.mark.parametrize("verb", [("plan",), ("generate", "--yes")])
def test_a_plan_that_the_scene_refuses_is_refused(wsim, tmp_path: Path, verb: tuple[str, ...]) -> None:
    plan = json.loads((EXAMPLES / "wood_afloat.json").read_text())
    name = next(item["name"] for item in plan["objects"] if item["role"] == "rigid_body")
    plan["joints"] = [
        {"name": f"rail_{axis.lower()}", "kind": "slider", "child": name, "parent": None, "axis": axis} for axis in "XY"
    ]
    (tmp_path / "plan.json").write_text(json.dumps(plan))
    ended = wsim(*verb, "--plan", "plan.json")
    assert ended.code == 2
    assert ended.err.count("\n") == 1
    said = 'plan.json: a plan that cannot be built: joint_prismatic("rail_y"): the joints rail_x, rail_y make a loop'
    assert said in ended.err
    assert "a loop needs one plain hinge" in ended.err


def test_a_plan_that_cannot_be_written_is_said(wsim, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    ended = wsim("plan", PROMPT, "-o", "file/plan.json")
    assert ended.code == 2
    assert ended.err.startswith("wsim: cannot write the plan to file/plan.json: ")
    assert ended.err.count("\n") == 1


def test_questions_are_shown_and_answered_from_a_file(wsim, tmp_path: Path) -> None:
    shown = wsim("plan", OPEN).out
    for number, name in enumerate(("count_block", "material_ball", "material_block"), start=1):
        assert f"question {number}, {name}: " in shown
    (tmp_path / "answers.toml").write_text('count_block = 2\nmaterial_block = "ice"\nmaterial_ball = "cork"\n')
    answered = wsim("plan", OPEN, "--answers", "answers.toml", "--json")
    assert answered.code == 0, answered.err
    plan = Plan.model_validate_json(answered.out)
    names = [item.name for item in plan.objects if item.role == "rigid_body"]
    assert names == ["cork_ball", "ice_block_1", "ice_block_2"]
    assert [(a.subject, a.choice) for a in plan.assumptions[:3]] == [
        ("blocks", "2"),
        ("a ball", "cork"),
        ("blocks", "ice"),
    ]
    assert "question" not in wsim("plan", OPEN, "--answers", "answers.toml").out


def test_what_does_not_turn_the_outcome_is_not_asked(wsim) -> None:
    assert "question" not in wsim("plan", PROMPT).out
    dropped = wsim("plan", "A ball drops on a tower of five blocks and knocks it over.").out
    assert re.findall(r"question \d+, (\w+)", dropped) == ["height_ball"]


MISTAKES: dict[tuple[str, ...], str] = {
    ("plan",): "give a sentence",
    ("plan", PROMPT, "--plan", "plan.json"): "not both",
    ("plan", "--plan", "none.json"): "none.json: cannot be read",
    ("plan", OPEN, "--answers", "none.toml"): "none.toml: cannot be read",
    ("plan", OPEN, "--answers", "broken.toml"): "broken.toml: neither TOML nor JSON",
    ("plan", OPEN, "--answers", "unknown.toml"): "there is no question 'material_whale'; the questions about this",
    ("plan", OPEN, "--answers", "wrong.toml"): "count_block = 'many': expected a whole number",
    ("plan", OPEN, "--answers", "cheese.toml"): "material_ball = 'cheese': the planner cannot take this answer",
    ("plan", "--plan", "plan.json", "--answers", "wrong.toml"): "a plan from a file has none",
    ("plan", PROMPT, "--image", "none.png"): "--image none.png: No such file or directory",
    ("plan", PROMPT, "--image", "wrong.toml"): "--image wrong.toml: it is not a picture; give a PNG or a JPEG",
    ("plan", PROMPT, "--image", "photo.png"): "the builtin planner does not see pictures; name a model that does",
    ("generate", PROMPT, "--yes", "--image", "photo.png"): "the builtin planner does not see pictures",
    ("generate", PROMPT, "--image", "none.png"): "--image none.png: No such file or directory",
    ("generate", PROMPT): "nothing was built: there was no answer; --yes builds without asking, --answers FILE",
}


@pytest.mark.parametrize("arguments", MISTAKES, ids=" ".join)
def test_a_mistake_is_one_line_and_leaves_nothing(told, tmp_path: Path, arguments: tuple[str, ...]) -> None:
    (tmp_path / "plan.json").write_text((EXAMPLES / "offroad_vehicle.json").read_text())
    (tmp_path / "broken.toml").write_text("material_ball = ")
    (tmp_path / "unknown.toml").write_text('material_whale = "steel"')
    (tmp_path / "wrong.toml").write_text('count_block = "many"')
    (tmp_path / "cheese.toml").write_text('material_ball = "cheese"')
    Image.new("RGB", (4, 4)).save(tmp_path / "photo.png")
    before = set(tmp_path.iterdir())
    ended = told(*arguments)
    assert ended.code == 2, ended.out
    assert ended.err.startswith("wsim: ")
    assert ended.err.count("\n") == 1
    assert MISTAKES[arguments] in ended.err
    assert set(tmp_path.iterdir()) == before


def test_no_builds_nothing(talk: Talk) -> None:
    ended = talk("no\n", PROMPT)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert "must: wooden_block floats on the water." in ended.stdout
    assert ended.stdout.endswith("nothing was built\n")


def test_a_question_is_answered_by_its_number(talk: Talk) -> None:
    ended = talk("9\n2\nsteal\n2\ncork\nno\n", OPEN)
    assert ended.returncode == 0, ended.stderr
    assert "'9' is none of these" in ended.stdout
    assert "material_ball = 'steal': the planner cannot take this answer" in ended.stdout
    last = ended.stdout[ended.stdout.rindex("from above") :]
    assert "cork_ball" in last
    assert re.findall(r"question \d+, (\w+)", last) == ["count_block", "material_block"]


def test_an_edited_plan_is_checked_again_and_again(talk: Talk, tmp_path: Path) -> None:
    """First a mistake, then its cure with another level: what floats is laid out anew."""
    level = r"s/\"predicate\": \"FREE-SURFACE-AT\"/\"predicate\": \"FREE-SURFACE\"/"
    cure = r"s/\"FREE-SURFACE\"/\"FREE-SURFACE-AT\"/; s/\"value\": 0\.[0-9]*/\"value\": 0.2/"
    ended = talk("edit\nyes\nno\n", PROMPT, editor=editor(tmp_path, level, cure))
    assert ended.returncode == 0, ended.stderr
    assert "there is no predicate 'FREE-SURFACE'; did you mean FREE-SURFACE-AT?" in ended.stdout
    assert "edited: the plan is used as it is written" in ended.stdout
    before, after = ended.stdout.split("edited:")
    assert "its surface 0.2 m above the floor" in after and "its surface 0.2 m above the floor" not in before
    heights = [
        float(re.search(r"wooden_block +│ box .*, ([\d.]+) *$", half, re.MULTILINE)[1]) for half in (before, after)
    ]
    assert heights[1] == pytest.approx(0.02 + 0.2 + 0.005 + 0.07, abs=2e-3)
    assert heights[0] > heights[1]


def test_an_editor_that_is_not_there_is_said(talk: Talk) -> None:
    ended = talk("edit\nno\n", PROMPT, editor="no-such-editor")
    assert ended.returncode == 0, ended.stderr
    assert "the editor 'no-such-editor' cannot be started" in ended.stdout
    failed = talk("edit\nno\n", PROMPT, editor="false")
    assert "false ended with 1; the plan is as it was" in failed.stdout


def test_yes_goes_on_to_build(talk: Talk, tmp_path: Path) -> None:
    """Return alone is a yes, and so is a file of answers, without a terminal; here the folder for runs is a file."""
    (tmp_path / "answers.json").write_text('{"material_ball": "oak"}')
    for typed, arguments in (("\n", (PROMPT,)), ("", (OPEN, "--answers", "answers.json")), ("", (PROMPT, "--yes"))):
        ended = talk(typed, *arguments)
        assert ended.returncode == 2
        assert "choose another with --runs" in ended.stderr, ended.stdout


@pytest.mark.parametrize("width", ["60", "100"])
def test_the_drawing_keeps_to_the_terminal(tmp_path: Path, width: str) -> None:
    code = "import sys; sys.stdout.isatty = lambda: True; from wsim.cli import main; main()"
    ended = subprocess.run(
        [*wsim_command()[:1], "-c", code, "plan", PROMPT, "-o", "plan.json"],
        cwd=tmp_path,
        env={**os.environ, "COLUMNS": width, "TERM": "dumb"},
        capture_output=True,
        text=True,
        timeout=STUCK,
    )
    assert ended.returncode == 0, ended.stderr
    drawing = ended.stdout[ended.stdout.index("from above") :].splitlines()
    assert max(len(line) for line in drawing if line[:1] in "┌│└├") <= int(width)
