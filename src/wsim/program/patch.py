"""Search/replace edits of a program: found once each, or refused with what is there instead."""

from __future__ import annotations

import difflib
import re
from collections.abc import Sequence
from dataclasses import dataclass

from wsim.errors import UserError

_BLOCK = re.compile(
    r"^<{5,}[ \t]*SEARCH[ \t]*\n(?P<search>.*?)^={5,}[ \t]*\n(?P<replace>.*?)^>{5,}[ \t]*REPLACE[ \t]*$",
    re.DOTALL | re.MULTILINE,
)
_OPENING = re.compile(r"^<{5,}[ \t]*SEARCH", re.MULTILINE)
_SHOWN = 6  # lines of the program that an error quotes


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
    text = text.replace("\r\n", "\n")
    found = [Edit(match["search"], match["replace"]) for match in _BLOCK.finditer(text)]
    begun = len(_OPENING.findall(text))
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
    for number, edit in enumerate(edits, start=1):
        text = _replace(text, edit, f"edit {number} of {len(edits)}")
    return text


def diff(before: str, after: str) -> str:
    """A unified diff of two versions of program.py."""
    lines = difflib.unified_diff(
        before.splitlines(keepends=True), after.splitlines(keepends=True), "program.py", "program.py", n=2
    )
    return "".join(line if line.endswith("\n") else line + "\n" for line in lines)


def _replace(text: str, edit: Edit, which: str) -> str:
    if not edit.search.strip():
        if text.strip():
            raise PatchError(f"{which}: the search is empty; copy the lines that are to be replaced")
        return edit.replace
    lines, wanted = text.splitlines(), [line.rstrip() for line in edit.search.strip("\n").splitlines()]
    bare = [line.rstrip() for line in lines]
    at = [k for k in range(len(bare) - len(wanted) + 1) if bare[k : k + len(wanted)] == wanted]
    if len(at) == 1:
        replacement = edit.replace.strip("\n").splitlines() if edit.replace.strip() else []
        return "\n".join([*lines[: at[0]], *replacement, *lines[at[0] + len(wanted) :]]) + "\n"
    if not at and len(wanted) == 1 and text.count(edit.search.strip()) == 1:  # a part of one line
        return text.replace(edit.search.strip(), edit.replace.strip())
    if not at:
        raise PatchError(
            f"{which}: these lines are not in the program: {_quote(wanted)}; nearest: {_near(bare, wanted)}"
        )
    numbers = ", ".join(str(k + 1) for k in at[:5])
    raise PatchError(
        f"{which}: found {len(at)} times, at lines {numbers}; give more lines around the one that is meant"
    )


def _near(lines: list[str], wanted: list[str]) -> str:
    """The part of the program that is most like what was searched for."""
    size = min(len(wanted), _SHOWN)
    windows = range(max(len(lines) - size, 0) + 1)
    target = "\n".join(wanted[:size])

    def likeness(k: int) -> float:
        return difflib.SequenceMatcher(None, "\n".join(lines[k : k + size]), target, autojunk=False).ratio()

    best = max(windows, key=likeness, default=0)
    return f"line {best + 1}: {_quote(lines[best : best + size])}"


def _quote(lines: Sequence[str]) -> str:
    shown = "\\n".join(line for line in lines[:_SHOWN])
    return f"{shown!r}" + (" …" if len(lines) > _SHOWN else "")
