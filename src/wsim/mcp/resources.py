"""What a client may read: the skills, the plan's schema, and the files of the run that is open."""

from __future__ import annotations

import json
import mimetypes
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from wsim.errors import UserError
from wsim.mcp.desk import HOW_TO_OPEN, Desk
from wsim.plan.schema import Plan
from wsim.skills import skills

SCHEMA = "wsim://plan-schema"
RUN_FILES = {
    "plan.json": "The plan of the run that is open: what the world is judged by.",
    "program.py": "The newest program of the run that is open.",
    "verdict.json": "The verdict on the newest program of the run that is open.",
}


@dataclass(frozen=True)
class Readable:
    """A resource: its address, what it is, and how its text is read."""

    uri: str
    name: str
    description: str
    kind: str  # MIME type
    read: Callable[[], str]


def readables(desk: Desk) -> dict[str, Readable]:
    """All that there is to read, by its address."""
    return {readable.uri: readable for readable in (*_skills(), _schema(), *_run_files(desk))}


def _skills() -> Iterator[Readable]:
    """Each skill as `skill://NAME`, and the texts beside it as `skill://NAME/PATH`."""
    for skill in skills():
        uri, front = f"skill://{skill.name}", skill.folder / "SKILL.md"
        yield Readable(uri, skill.name, skill.description, _kind(front), partial(_text, front))
        for path in sorted(skill.folder.rglob("*.*")):
            beside = path.relative_to(skill.folder).as_posix()
            if path != front and _kind(path).startswith("text/"):
                told = f"Goes with the skill {skill.name}."
                yield Readable(f"{uri}/{beside}", f"{skill.name}/{beside}", told, _kind(path), partial(_text, path))


def _schema() -> Readable:
    def read() -> str:
        return json.dumps(Plan.model_json_schema(), separators=(",", ":"))

    return Readable(SCHEMA, "plan-schema", "JSON schema of a plan, for write_plan.", "application/schema+json", read)


def _run_files(desk: Desk) -> Iterator[Readable]:
    for name, told in RUN_FILES.items():
        yield Readable(f"run://{name}", name, told, _kind(Path(name)), partial(_run_file, desk, name))


def _run_file(desk: Desk, name: str) -> str:
    if desk.run is None:
        raise UserError(HOW_TO_OPEN)
    places = [desk.run.path] if name == "plan.json" else sorted((desk.run.path / "iterations").glob("[0-9][0-9]*"))
    if not places or not (places[-1] / name).is_file():
        raise UserError(f"run {desk.run.path.name} has no {name} yet")
    return _text(places[-1] / name)


def _text(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def _kind(path: Path) -> str:
    """MIME type; the tables of some systems do not know Markdown."""
    if path.suffix == ".md":
        return "text/markdown"
    return mimetypes.guess_type(path.name)[0] or "application/octet-stream"
