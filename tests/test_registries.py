"""What a file offers is named where it is looked up: a file that is forgotten there is told by name."""

import ast
from importlib import import_module
from pathlib import Path
from typing import get_args

import wsim
from wsim.cli.verbs import VERBS
from wsim.judge.checks.registry import PHYSICS, RUN
from wsim.judge.language.kinds import KINDS
from wsim.judge.language.measure import MEASURERS
from wsim.plan.schema.draft import KindOfOne, KindOfTwo
from wsim.plan.schema.formula import VOCABULARY, Ordered
from wsim.tools import TOOLS

HOME = Path(wsim.__file__).parent


def defines(file: Path) -> set[str]:
    """The names that a file gives to functions, and to what it assigns."""
    found = set()
    for node in ast.parse(file.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.FunctionDef):
            found.add(node.name)
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            found |= {n.id for n in ast.walk(node) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    return found


def offering(room: str, name: str) -> set[str]:
    """The files of a room that define a name, but for the one that gathers them; an empty name is the file's own."""
    files = (HOME / room).glob("*.py")
    return {file.stem for file in files if (name or file.stem) in defines(file)} - {"registry", "__init__"}


def test_a_name_is_found(tmp_path):
    (tmp_path / "one.py").write_text("OF: tuple = (1,)\nTO = ()\n\n\ndef at():\n    IN = 1\n    return IN\n")
    assert defines(tmp_path / "one.py") == {"OF", "TO", "at"}


def test_each_file_of_checks_is_asked():
    missing = offering("judge/checks", "CHECKS") - {module.__name__.rpartition(".")[2] for module in (*RUN, *PHYSICS)}
    assert not missing, f"name {sorted(missing)} in RUN or PHYSICS of judge/checks/registry.py"


def test_each_file_of_measures_is_read():
    """A predicate without a measure could be written in a plan, and never judged."""
    assert set(VOCABULARY.values()) - {*MEASURERS} == {Ordered}


def test_the_plan_and_the_judge_know_the_same_objectives():
    planned = {*get_args(KindOfOne), *get_args(KindOfTwo)}
    unplanned, unjudged = sorted({*KINDS} - planned), sorted(planned - {*KINDS})
    assert not unplanned, f"name {unplanned} in KindOfTwo (it needs a ref) or KindOfOne of plan/schema/draft.py"
    assert not unjudged, f"say in KINDS of judge/language/kinds.py which formula {unjudged} are"


def test_each_file_of_tools_is_offered():
    files = offering("tools", "TOOLS")
    missing = {file for file in files for tool in import_module(f"wsim.tools.{file}").TOOLS if tool.name not in TOOLS}
    assert len(files) > 5
    assert not missing, f"name {sorted(missing)} in tools/registry.py"


def test_each_verb_is_named():
    missing = offering("cli", "") - {*VERBS}
    assert not missing, f"name {sorted(missing)} in VERBS of cli/verbs.py"
