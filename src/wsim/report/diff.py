"""A unified diff as coloured lines of HTML."""

from __future__ import annotations

import difflib
import re
from dataclasses import dataclass

from markupsafe import Markup

from wsim.report.source import visible

MOST_LINES = 600
HUNK = re.compile(r"@@ -\d+(?:,\d+)? \+(?P<line>\d+)")
KINDS = {"+": "added", "-": "removed", " ": "same"}


@dataclass(frozen=True)
class DiffLine:
    """One line of a diff."""

    kind: str  # "added", "removed", "same", "at" for the place of those that follow, "cut" for what is left out
    html: Markup


@dataclass(frozen=True)
class Diff:
    """A diff, and how many lines it adds and removes."""

    lines: list[DiffLine]
    added: int
    removed: int


def make_diff(patch: str) -> Diff:
    """A unified diff of one file, without its header."""
    lines: list[DiffLine] = []
    begun = False
    for line in patch.removesuffix("\n").split("\n"):
        hunk = HUNK.match(line)
        begun = begun or hunk is not None
        if hunk is not None:
            lines.append(DiffLine("at", Markup("line {}").format(hunk["line"])))
        elif begun:
            kind = KINDS.get(line[:1], "same")
            lines.append(DiffLine(kind, visible(line[1:].expandtabs(4))))
    added, removed = (sum(line.kind == kind for line in lines) for kind in ("added", "removed"))
    if len(lines) > MOST_LINES:
        left = DiffLine("cut", Markup("… {} more lines").format(len(lines) - MOST_LINES))
        lines = [*lines[:MOST_LINES], left]
    return Diff(lines, added, removed)


def difference(before: str, after: str) -> Diff:
    """How one program differs from another."""
    return make_diff("\n".join(difflib.unified_diff(before.split("\n"), after.split("\n"), n=1, lineterm="")))
