"""What README and the other documents say of the code is so."""

import re
import tomllib
from pathlib import Path
from typing import get_args

import pytest

from tests.documents import DOCUMENTS, ROOT, blocks, inline
from wsim.cli.verbs import VERBS as NAMES
from wsim.cli.verbs import load
from wsim.judge.checks.registry import physics_checks, run_checks
from wsim.judge.language.kinds import KINDS
from wsim.judge.verdict import RepairKind
from wsim.plan.schema import Plan
from wsim.rules.lexicon import lexicon
from wsim.scene import Scene
from wsim.scene.check import check_stage
from wsim.skills import skills

VERBS = {name: load(name) for name in NAMES}


def options_of(verb: str) -> set[str]:
    """The options of a verb, and of the commands of one that is a group."""
    commands = [VERBS[verb], *getattr(VERBS[verb], "commands", {}).values()]
    return {name for each in commands for option in each.params for name in option.opts + option.secondary_opts}


def section(title: str, document: str = "README.md") -> str:
    text = (ROOT / document).read_text(encoding="utf-8")
    return re.split(r"^## ", text.split(f"\n## {title}\n")[1], flags=re.MULTILINE)[0]


def test_there_are_documents() -> None:
    names = {path.relative_to(ROOT).as_posix() for path in DOCUMENTS}
    assert {"README.md", "CONTRIBUTING.md", "AGENTS.md", "docs/architecture.md", "docs/judge.md"} <= names


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.name)
def test_links_lead_somewhere(path: Path) -> None:
    for target in re.findall(r"[^\"]\]\(([^)#]+)", path.read_text(encoding="utf-8")):
        assert target.startswith("https://") or (path.parent / target).exists(), target


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.name)
def test_commands_exist(path: Path) -> None:
    """Each `wsim VERB` and each `make TARGET` within sentences."""
    code = "\n".join(inline(path))
    assert set(re.findall(r"(?:^|/)wsim ([a-z]+)", code, re.MULTILINE)) <= set(VERBS)
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    assert set(re.findall(r"^make ([a-z-]+)", code, re.MULTILINE)) <= targets


def test_readme_has_every_verb_and_no_option_that_is_not_there() -> None:
    said = section("Command line")
    assert set(re.findall(r"^\| `wsim ([a-z]+)", said, re.MULTILINE)) == set(VERBS)
    options = {name for verb in VERBS for name in options_of(verb)}
    assert set(re.findall(r"--[a-z][a-z-]+", said)) <= options | {"--help"}


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.name)
def test_commands_take_the_options_that_they_are_given(path: Path) -> None:
    for verb, rest in re.findall(r"^(?:\S*/)?wsim ([a-z]+)(.*)$", "\n".join(inline(path)), re.MULTILINE):
        assert set(re.findall(r"(?<=\s)--[a-z][a-z-]+", rest)) <= options_of(verb), f"wsim {verb}{rest}"


def test_every_package_has_its_row() -> None:
    said = set(re.findall(r"`src/wsim/(\w+)/`", section("Where things are", "AGENTS.md")))
    assert said == {path.parent.name for path in (ROOT / "src" / "wsim").glob("*/__init__.py")}


def test_the_layers_are_those_that_the_linter_holds() -> None:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]
    (layers,) = (contract["layers"] for contract in settings["contracts"] if contract["type"] == "layers")
    said = re.findall(r"^ {4}(.+)$", section("Layers", "CONTRIBUTING.md"), re.MULTILINE)
    assert said == [layer.replace("wsim.", "") for layer in layers]


def test_the_plans_version_is_the_schemas() -> None:
    said = re.findall(
        r"`wsim\.plan\.schema\.Plan`, `version` (\d+)", (ROOT / "docs/architecture.md").read_text("utf-8")
    )
    assert [int(version) for version in said] in ([], [Plan.model_fields["version"].default])


def test_the_skills_are_as_many_as_the_readme_says() -> None:
    numbers = ("twelve", "thirteen", "fourteen", "fifteen", "sixteen", "seventeen", "eighteen", "nineteen", "twenty",
               "twenty-one", "twenty-two", "twenty-three", "twenty-four")  # fmt: skip
    (said,) = re.findall(r"\[skills/\]\(skills\),\s+([\w-]+)\s+of\s+them", (ROOT / "README.md").read_text("utf-8"))
    assert numbers.index(said) + 12 == len(skills())
    rows = re.findall(r"^\| \[([a-z-]+)\]", (ROOT / "docs/skills.md").read_text("utf-8"), re.MULTILINE)
    assert sorted(rows) == [skill.name for skill in skills()]


def test_the_judges_page_has_every_check_and_objective() -> None:
    checks = {check.name for check in run_checks() + physics_checks()}
    for title, names in (("Checks", checks), ("Objectives", set(KINDS))):
        said = re.findall(r"^\| `([A-Za-z_]+)`", section(title, "docs/judge.md"), re.MULTILINE)
        assert sorted(said) == sorted(names)


def test_the_judges_page_has_every_kind_of_repair() -> None:
    said = " ".join(section("What to change", "docs/judge.md").split())
    assert [kind for kind in get_args(RepairKind) if kind not in said] == []


@pytest.mark.parametrize("marks", ["faults", "judge-repairs", "judge-speed"])
def test_the_judges_page_has_the_places_of_its_tables(marks: str) -> None:
    text = (ROOT / "docs/judge.md").read_text(encoding="utf-8")
    assert re.search(f"^<!-- {marks}:begin -->\n(.*\n)*?<!-- {marks}:end -->$", text, re.MULTILINE)


def test_readme_has_the_planners_vocabulary() -> None:
    said = set(re.findall(r"[a-z]+\d*", section("The builtin planner").lower()))
    spelled = {"aluminum", "golden", "gray", "wooden"}  # other spellings of words that are there
    known = lexicon()
    words = {
        word
        for kind in ("GROUP", "FLUID", "GROUND", "MATERIAL", "COLOR", "SCALE")
        for words in known.words_of(kind)
        for word in words.split()
    }
    ours = {key for key, noun in known.nouns.items() if noun.asset is None}
    assert (ours | words) - spelled <= said
    listed = set(re.findall(r"^\| `([a-z_]+)`", (ROOT / "docs" / "assets.md").read_text(), re.MULTILINE))
    assert {noun.asset for noun in known.nouns.values() if noun.asset} <= listed


def test_program_of_the_readme_builds_a_sound_stage(tmp_path: Path) -> None:
    (block,) = blocks(ROOT / "README.md")
    namespace: dict = {"__name__": "program"}
    exec(compile(block.text, "readme.py", "exec"), namespace)
    scene = Scene()
    namespace["build"](scene)
    assert check_stage(scene.save(tmp_path / "stage.usda"), [tmp_path]) == []
