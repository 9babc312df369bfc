"""The iterations of a run: which one is meant, and how a new one comes to be."""

from __future__ import annotations

import shutil
from pathlib import Path

from pydantic import Field

from wsim.errors import UserError
from wsim.program.patch import diff
from wsim.runs.folder import RunFolder
from wsim.tools.base import Arguments, Workspace


class OfIteration(Arguments):
    """Something of one iteration."""

    iteration: int | None = Field(None, ge=1, description="number of the iteration; the newest by default")


def folder_of(workspace: Workspace, number: int | None) -> Path:
    """An iteration's folder, the newest by default.

    Raises:
        UserError: If there is none, or none of that number.
    """
    known = numbered(workspace.run)
    if not known:
        raise UserError("the run has no program yet; write one with write_program")
    if number is None:
        return known[-1]
    folder = workspace.run.path / "iterations" / f"{number:02d}"
    if folder not in known:
        raise UserError(f"iteration {number} is not there; the newest is {known[-1].name}")
    return folder


def file_of(workspace: Workspace, number: int | None, name: str, way: str) -> Path:
    """A file of an iteration; UserError with the way to get it, and which iterations have it, where it is not there."""
    folder = folder_of(workspace, number)
    if (folder / name).is_file():
        return folder / name
    have = [each.name for each in numbered(workspace.run) if (each / name).is_file()]
    others = f", or look at an iteration that has one: {', '.join(have)}" if have else ""
    raise UserError(f"iterations/{folder.name} has no {name}; {way}{others}")


def numbered(run: RunFolder) -> list[Path]:
    """Folders of all iterations, the oldest first."""
    found = (path for path in (run.path / "iterations").glob("[0-9]*") if path.name.isdigit())
    return sorted(found, key=lambda path: int(path.name))


def add(run: RunFolder, program: str, before: str | None = None) -> Path:
    """A new iteration that holds a program; its folder is whole or not there.

    Args:
        run: Whose iteration it is.
        program: The text of program.py.
        before: The text that it was patched from; the difference becomes patch.diff.
    """
    known = numbered(run)
    number = int(known[-1].name) + 1 if known else 1
    folder = run.path / "iterations" / f"{number:02d}"
    partial = folder.with_name(f".{folder.name}.partial")
    shutil.rmtree(partial, ignore_errors=True)
    partial.mkdir(parents=True)
    (partial / "program.py").write_text(program, encoding="utf-8")
    if before is not None:
        (partial / "patch.diff").write_text(diff(before, program), encoding="utf-8")
    partial.rename(folder)
    return folder
