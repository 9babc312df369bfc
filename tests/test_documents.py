"""What README and the other documents say of the code is so."""

import re
from pathlib import Path
from typing import get_args

import pytest

from wsim.cli.verbs import VERBS as NAMES
from wsim.cli.verbs import load
from wsim.judge.decide import OBJECTIVES, physics_checks, run_checks
from wsim.judge.verdict import RepairKind
from wsim.rules.lexicon import lexicon
from wsim.scene import Scene
from wsim.scene.check import check_stage

ROOT = Path(__file__).parents[1]
DOCUMENTS = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/*.md")])
VERBS = {name: load(name) for name in NAMES}


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
    """Each `wsim VERB` and each `make TARGET` in code."""
    text = path.read_text(encoding="utf-8")
    code = "\n".join(re.findall(r"`([^`\n]+)`", text) + re.findall(r"^ {4}(.+)$", text, re.MULTILINE))
    assert set(re.findall(r"(?:^|/)wsim ([a-z]+)", code, re.MULTILINE)) <= set(VERBS)
    targets = set(re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    assert set(re.findall(r"^make ([a-z]+)", code, re.MULTILINE)) <= targets


def test_readme_has_every_verb_and_no_option_that_is_not_there() -> None:
    said = section("Command line")
    assert set(re.findall(r"^\| `wsim ([a-z]+)", said, re.MULTILINE)) == set(VERBS)
    options = {
        name for verb in VERBS.values() for option in verb.params for name in option.opts + option.secondary_opts
    }
    assert set(re.findall(r"--[a-z][a-z-]+", said)) <= options | {"--help"}


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.name)
def test_commands_take_the_options_that_they_are_given(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    code = "\n".join(re.findall(r"`([^`\n]+)`", text) + re.findall(r"^ {4}(.+)$", text, re.MULTILINE))
    for verb, rest in re.findall(r"^(?:\S*/)?wsim ([a-z]+)(.*)$", code, re.MULTILINE):
        options = {name for option in VERBS[verb].params for name in option.opts + option.secondary_opts}
        assert set(re.findall(r"(?<=\s)--[a-z][a-z-]+", rest)) <= options, f"wsim {verb}{rest}"


def test_the_judges_page_has_every_check_and_objective() -> None:
    checks = {check.name for check in run_checks() + physics_checks()}
    for title, names in (("Checks", checks), ("Objectives", set(OBJECTIVES))):
        said = re.findall(r"^\| `([A-Za-z_]+)`", section(title, "docs/judge.md"), re.MULTILINE)
        assert sorted(said) == sorted(names)


def test_the_judges_page_has_every_kind_of_repair() -> None:
    said = " ".join(section("What to change", "docs/judge.md").split())
    assert [kind for kind in get_args(RepairKind) if kind not in said] == []


@pytest.mark.parametrize("marks", ["faults", "judge-speed"])
def test_the_judges_page_has_the_places_of_its_tables(marks: str) -> None:
    text = (ROOT / "docs/judge.md").read_text(encoding="utf-8")
    assert re.search(f"^<!-- {marks}:begin -->\n(.*\n)*?<!-- {marks}:end -->$", text, re.MULTILINE)


def test_readme_has_the_planners_vocabulary() -> None:
    said = set(re.findall(r"[a-z]+", section("The builtin planner").lower()))
    spelled = {"aluminum", "golden", "gray", "wooden"}  # other spellings of words that are there
    known = lexicon()
    words = {
        word for kind in ("GROUP", "FLUID", "GROUND", "MATERIAL", "COLOR", "SCALE") for word in known.words_of(kind)
    }
    assert (set(known.nouns) | words) - spelled <= said


def test_program_of_the_readme_builds_a_sound_stage(tmp_path: Path) -> None:
    (source,) = re.findall(r"```python\n(.*?)```", section("A program"), re.DOTALL)
    namespace: dict = {"__name__": "program"}
    exec(compile(source, "readme.py", "exec"), namespace)
    scene = Scene()
    namespace["build"](scene)
    assert check_stage(scene.save(tmp_path / "stage.usda"), [tmp_path]) == []
