"""Tools that read, write, patch and check a program. Each text is a new iteration; none is changed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from pydantic import Field

from wsim.errors import UserError
from wsim.program.patch import Edit, apply, diff
from wsim.program.validator import validate
from wsim.tools.base import Arguments, Result, Tool, Workspace
from wsim.tools.iterations import OfIteration, file_of
from wsim.tools.text import page

if TYPE_CHECKING:
    from wsim.program.validator import Problem

LONGEST = 200_000  # characters of a program
ANYWAY = Field(False, description="keep it even if the validator finds problems")


class ReadProgram(OfIteration):
    """Lines of a program."""

    from_line: int = Field(1, ge=1, description="first line to show")
    to_line: int | None = Field(None, ge=1, description="last line to show; as many as fit by default")


class WriteProgram(Arguments):
    """A whole program."""

    text: str = Field(description="the whole of program.py, with its build(scene)", max_length=LONGEST)
    anyway: bool = ANYWAY


class Replacement(Arguments):
    """One place of the program, and what goes there."""

    search: str = Field(description="lines as they are in the program, enough of them to be there once", min_length=1)
    replace: str = Field(description="the lines that take their place")


class PatchProgram(Arguments):
    """Edits of the newest program, in order."""

    edits: list[Replacement] = Field(description="made one after another", min_length=1, max_length=50)
    anyway: bool = ANYWAY


class ValidateProgram(OfIteration):
    """A program to check."""

    text: str | None = Field(None, description="a program's text; by default that of an iteration", max_length=LONGEST)


def read_program(workspace: Workspace, asked: ReadProgram) -> Result:
    """Lines of a program, with their numbers."""
    path = file_of(workspace, asked.iteration, "program.py", "write one with write_program")
    lines = path.read_text(encoding="utf-8").splitlines()
    last = min(asked.to_line or len(lines), len(lines))
    if asked.from_line > last:
        raise UserError(f"from_line: {asked.from_line} is beyond {last}, the last line to show")
    width = len(str(last))
    numbered = [f"{k:>{width}}  {line}".rstrip() for k, line in enumerate(lines[:last], start=1)]
    return Result("\n".join(page(numbered, asked.from_line, "from_line")))


def write_program(workspace: Workspace, asked: WriteProgram) -> Result:
    """Check a text, and make it a new iteration."""
    problems = _problems(workspace, asked.text)
    if problems and not asked.anyway:
        return Result("\n".join(["not written:", *_listed(problems)]), ok=False)
    folder = workspace.run.add(asked.text)
    return Result("\n".join([f"iterations/{folder.name}/program.py written, not run yet", *_listed(problems)]))


def patch_program(workspace: Workspace, asked: PatchProgram) -> Result:
    """Apply edits to the newest program, check what comes out, and make it a new iteration."""
    before = file_of(workspace, None, "program.py", "write one with write_program").read_text(encoding="utf-8")
    after = apply(before, [Edit(search=edit.search, replace=edit.replace) for edit in asked.edits])
    if after == before:
        raise UserError("edits: they change nothing; replace by something else than what is there")
    problems = _problems(workspace, after)
    if problems and not asked.anyway:
        return Result("\n".join(["not written; lines are those of the patched text:", *_listed(problems)]), ok=False)
    folder = workspace.run.add(after, before)
    head = f"iterations/{folder.name}/program.py written, not run yet"
    return Result("\n".join([head, *_listed(problems), *diff(before, after).splitlines()[2:]]))


def validate_program(workspace: Workspace, asked: ValidateProgram) -> Result:
    """What is wrong with a program, without running it."""
    text = asked.text
    if text is None:
        path = file_of(workspace, asked.iteration, "program.py", "write one with write_program")
        text = path.read_text(encoding="utf-8")
    problems = _problems(workspace, text)
    return Result("\n".join(_listed(problems)) or "no problems found", ok=not problems)


def _problems(workspace: Workspace, text: str) -> list[Problem]:
    return validate(text, workspace.plan)


def _listed(problems: Sequence[Problem]) -> list[str]:
    if not problems:
        return []
    return [f"{len(problems)} problem{'s' * (len(problems) > 1)}:", *(problem.sentence for problem in problems)]


TOOLS = (
    Tool(
        "read_program", "The program of an iteration with line numbers, all of it or some lines.", ReadProgram,
        read_program,
    ),
    Tool(
        "write_program", "Make a text the program of a new iteration, if the validator finds nothing wrong with it.",
        WriteProgram, write_program, writes=True, narrow="mend these first",
    ),
    Tool(
        "patch_program", "Search and replace in the newest program; what comes out is checked, and a new iteration.",
        PatchProgram, patch_program, writes=True, narrow="read_program shows the whole of it",
    ),
    Tool(
        "validate_program", "Find mistakes in a program without running it: imports, names, arguments, units, plan.",
        ValidateProgram, validate_program, narrow="mend these first",
    ),
)  # fmt: skip
