"""The iterations of a run: which one is meant, and how a new one comes to be."""

from __future__ import annotations

from pathlib import Path

from pydantic import Field

from wsim.errors import UserError
from wsim.tools.base import Arguments, Workspace


class OfIteration(Arguments):
    """Something of one iteration."""

    iteration: int | None = Field(None, ge=1, description="number of the iteration; the newest by default")


def folder_of(workspace: Workspace, number: int | None) -> Path:
    """An iteration's folder, the newest by default.

    Raises:
        UserError: If there is none, or none of that number.
    """
    known = workspace.run.iterations()
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
    have = [each.name for each in workspace.run.iterations() if (each / name).is_file()]
    others = f", or look at an iteration that has one: {', '.join(have)}" if have else ""
    raise UserError(f"iterations/{folder.name} has no {name}; {way}{others}")
