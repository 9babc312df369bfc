"""Tools that look up how a program is written: the index of what it may call, and the skills."""

from __future__ import annotations

import re
from difflib import get_close_matches
from typing import TYPE_CHECKING

from pydantic import Field

from wsim.program.api import index
from wsim.skills import pick, skills
from wsim.tools.base import Arguments, Result, Tool, Workspace
from wsim.tools.text import page, table

if TYPE_CHECKING:
    from wsim.program.api import Entry

SUMMARY = 90  # characters of a hit's summary


class Words(Arguments):
    """Words to look for."""

    words: str = Field(description="words of the name or of what it does", min_length=1, max_length=200)
    limit: int = Field(8, ge=1, le=20, description="most hits")


class Skills(Arguments):
    """Words to look for among the skills."""

    words: str = Field("", description="what the program is to do; all skills by default", max_length=2000)
    limit: int = Field(3, ge=1, le=20, description="most hits")


class EntryName(Arguments):
    """An entry of the index."""

    name: str = Field(
        description='its whole name, such as "wsim.scene.Scene.box", as search_api gives it', min_length=1,
        max_length=300,
    )  # fmt: skip
    from_line: int = Field(1, ge=1, description="first line to show")


class Skill(Arguments):
    """A skill, or one section of it."""

    name: str = Field(description="the skill's name, as search_skills gives it", min_length=1, max_length=100)
    section: str = Field("", description="a heading, or references/FILE.md; the whole by default", max_length=200)
    from_line: int = Field(1, ge=1, description="first line to show")


def search_api(workspace: Workspace, asked: Words) -> Result:
    """Entries of the index that may be meant, the best first."""
    hits = index().search(asked.words, asked.limit)
    if not hits:
        return Result(f"nothing that a program may use matches {asked.words[:60]!r}; try other words")
    lines = []
    for hit in hits:
        lines.append(_written(hit.entry))
        if hit.entry.summary:
            lines.append(f"    {_shortened(hit.entry.summary)}")
    return Result("\n".join(lines))


def show_api(workspace: Workspace, asked: EntryName) -> Result:
    """One entry: its signature and what its documentation says."""
    entry = index().show(asked.name)
    doc = entry.doc or entry.summary
    lines = [_written(entry), *doc.strip().splitlines()]
    # What it takes may be documented elsewhere, on a class that its docstring names.
    lines += [f"  {each.name}: {each.meaning}" for each in entry.parameters if each.meaning and each.meaning not in doc]
    return Result("\n".join(page(lines, asked.from_line, "from_line")))


def search_skills(workspace: Workspace, asked: Skills) -> Result:
    """Skills that fit some words, or all of them."""
    if not asked.words:
        rows = [[skill.name, _shortened(skill.description)] for skill in skills()]
        return Result("\n".join(table(("skill", "when"), rows)))
    picked = pick(asked.words, asked.limit)
    if not picked:
        return Result(f"no skill fits; there are {', '.join(skill.name for skill in skills())}")
    rows = [[hit.skill.name, " ".join(hit.words[:6]), _shortened(hit.skill.description)] for hit in picked]
    return Result("\n".join(table(("skill", "matched", "when"), rows)))


def show_skill(workspace: Workspace, asked: Skill) -> Result:
    """A skill's text, a page at a time, or one of its sections."""
    known = {skill.name: skill for skill in skills()}
    if asked.name not in known:
        near = get_close_matches(asked.name, known, n=3) or list(known)
        return Result(f"no skill {asked.name[:60]!r}; there are {', '.join(near)}", ok=False)
    skill = known[asked.name]
    lines = skill.body.strip().splitlines()
    sections = _sections(lines)
    for path in sorted((skill.folder / "references").glob("*.md")):
        sections[f"references/{path.name}"] = path.read_text(encoding="utf-8").strip().splitlines()
    if asked.section:
        wanted = asked.section.strip("# ").lower()
        chosen = next((title for title in sections if title.lower() == wanted), None)
        if chosen is None:
            return Result(f"{asked.name} has no section {asked.section[:60]!r}; it has {', '.join(sections)}", ok=False)
        lines = sections[chosen]
    shown = page(lines, asked.from_line, "from_line")
    if len(shown) > 1 and shown[-1].startswith("…") and not asked.section:
        shown[-1] += f", or one section of: {', '.join(sections)}"
    return Result("\n".join(shown))


def _sections(lines: list[str]) -> dict[str, list[str]]:
    """Lines by the heading that they stand under; what is in a code block is no heading."""
    found: dict[str, list[str]] = {}
    current: list[str] = []
    code = False
    for line in lines:
        code ^= line.startswith("```")
        heading = re.match(r"##+ +(.+)", line)
        if heading and not code:
            current = found.setdefault(heading[1].strip(), [])
        current.append(line)
    return found


def _written(entry: Entry) -> str:
    """An entry's whole name with what its signature says behind the name."""
    rest = re.search(r"\(|: ", entry.signature)
    text = entry.name + (entry.signature[rest.start() :] if rest else "")
    notes = [f"deprecated: {entry.deprecated}"] if entry.deprecated else []
    notes += [] if entry.programs else ["not for programs"]
    return text + (f"  ({'; '.join(notes)})" if notes else "")


def _shortened(text: str) -> str:
    text = " ".join(text.split())
    return text if len(text) <= SUMMARY else text[: SUMMARY - 1].rsplit(" ", 1)[0] + "…"


TOOLS = (
    Tool(
        "search_api", "Search what a program may call, by name or by words of its documentation.", Words, search_api,
        needs_run=False, narrow="lower limit",
    ),
    Tool(
        "show_api", "One entry of what a program may call: signature, parameters with units, errors.", EntryName,
        show_api, needs_run=False,
    ),
    Tool(
        "search_skills", "Skills on how to write a program that fit some words.", Skills, search_skills,
        needs_run=False, narrow="lower limit",
    ),
    Tool("show_skill", "The text of a skill, or one section of it.", Skill, show_skill, needs_run=False),
)  # fmt: skip
