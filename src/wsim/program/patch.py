"""Search/replace edits of a program: found once each, or refused with what is there instead."""

from __future__ import annotations

import difflib
import re
from collections.abc import Sequence
from dataclasses import dataclass

from wsim.errors import UserError

_OPENING, _MIDDLE, _END = (
    re.compile(mark) for mark in (r"<{5,}[ \t]*SEARCH", r"={5,}[ \t]*$", r">{5,}[ \t]*REPLACE[ \t]*$")
)
_SHOWN = 6  # lines of the program that an error quotes
_WIDE = 160  # characters of each


class PatchError(UserError):
    """An edit that does not fit the program: one message with what to do next."""


@dataclass(frozen=True)
class Edit:
    """Replace one place of a program; an empty `search` stands for the whole of an empty program."""

    search: str
    replace: str


def parse(text: str) -> list[Edit]:
    """The edits in a text, each between `<<<<<<< SEARCH`, `=======` and `>>>>>>> REPLACE`.

    Raises:
        PatchError: If there is none, or one is not finished.
    """
    found: list[Edit] = []
    search: list[str] = []
    replace: list[str] = []
    filled: list[str] | None = None  # the half of a block that a line belongs to
    begun = 0
    for line in _unix(text).split("\n"):
        if _OPENING.match(line):
            search, replace, begun = [], [], begun + 1
            filled = search
        elif filled is search and _MIDDLE.match(line):
            filled = replace
        elif filled is replace and _END.match(line):
            found.append(Edit(*("".join(f"{one}\n" for one in half) for half in (search, replace))))
            filled = None
        elif filled is not None:
            filled.append(line)
    if begun > len(found):
        raise PatchError(
            f"{begun - len(found)} of {begun} edits has no end; close each with ======= and >>>>>>> REPLACE on lines "
            "of their own"
        )
    if not found:
        raise PatchError("no edit: give at least one block of <<<<<<< SEARCH, =======, >>>>>>> REPLACE")
    return found


def apply(text: str, edits: Sequence[Edit]) -> str:
    """A program with edits made, one after the other; all of them or none.

    Args:
        text: The program.
        edits: Each `search` must stand exactly once in the program as the edits before left it. Blanks at the ends of
            lines do not count.

    Raises:
        PatchError: If one is not found, or found more than once; names the lines that come nearest.
    """
    text = _unix(text)
    for number, edit in enumerate(edits, start=1):
        edit = Edit(_unix(edit.search), _unix(edit.replace))
        text = _replace(text, edit, f"edit {number} of {len(edits)}")
    return text


def diff(before: str, after: str, name: str = "program.py") -> str:
    """A unified diff of two versions of a file."""
    old, new = ([f"{line}\n" for line in _lines(text)] if text else [] for text in (before, after))
    return "".join(difflib.unified_diff(old, new, name, name, n=2))


def _replace(text: str, edit: Edit, which: str) -> str:
    if not edit.search.strip():
        if text.strip():
            raise PatchError(f"{which}: the search is empty; copy the lines that are to be replaced")
        return edit.replace
    lines, wanted = _lines(text), [line.rstrip() for line in _lines(edit.search.strip("\n"))]
    bare = [line.rstrip() for line in lines]
    at = [k for k in range(len(bare) - len(wanted) + 1) if bare[k : k + len(wanted)] == wanted]
    if len(at) == 1:
        replacement = _lines(edit.replace.strip("\n")) if edit.replace.strip() else []
        return "\n".join([*lines[: at[0]], *replacement, *lines[at[0] + len(wanted) :]]) + "\n"
    part = edit.search.strip()
    if not at and len(wanted) == 1 and text.count(part) == 1:
        return text.replace(part, edit.replace.strip())
    if not at and len(wanted) == 1:
        at = [k for k, line in enumerate(lines) if part in line]
    if not at:
        raise PatchError(
            f"{which}: these lines are not in the program: {_quote(wanted)}; nearest: {_near(bare, wanted)}"
        )
    numbers = ", ".join(str(k + 1) for k in at[:5])
    raise PatchError(f"{which}: found more than once, at lines {numbers}; give more lines around the one that is meant")


def _lines(text: str) -> list[str]:
    """The lines of a text, at line feeds alone: what else `str.splitlines` splits at may stand in a string."""
    return text.removesuffix("\n").split("\n")


def _unix(text: str) -> str:
    return text.replace("\r\n", "\n")


def _near(lines: list[str], wanted: list[str]) -> str:
    """The part of the program that is most like what was searched for."""
    size = min(len(wanted), _SHOWN)
    windows = range(max(len(lines) - size, 0) + 1)
    target = "\n".join(line[:_WIDE] for line in wanted[:size])
    matcher = difflib.SequenceMatcher(autojunk=False)
    matcher.set_seq2(target)

    def likeness(k: int) -> float:
        matcher.set_seq1("\n".join(line[:_WIDE] for line in lines[k : k + size]))
        longest = max(block.size for block in matcher.get_matching_blocks())
        return matcher.ratio() + longest / len(target)  # a few characters may be searched for in a long line

    best = max(windows, key=likeness, default=0)
    return f"line {best + 1}: {_quote(lines[best : best + size])}"


def _quote(lines: Sequence[str]) -> str:
    shown = "\n".join(line if len(line) <= _WIDE else line[:_WIDE] + "…" for line in lines[:_SHOWN])
    return f"{shown!r}" + (" …" if len(lines) > _SHOWN else "")
