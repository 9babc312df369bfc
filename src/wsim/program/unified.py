"""A unified diff, as `diff -u` and git write it, read as edits of `wsim.program.patch`."""

from __future__ import annotations

import re

from wsim.program.patch import Edit, PatchError, parse

_HUNK = re.compile(r"@@ -\d+(?:,(\d+))? \+\d+(?:,(\d+))? @@")


def edits_of(text: str) -> list[Edit]:
    """The edits of a patch in either form: search/replace blocks, or the hunks of a unified diff of one file.

    Raises:
        PatchError: If it holds neither, is cut off, or is of more files than one.
    """
    lines = text.replace("\r\n", "\n").removesuffix("\n").split("\n")
    if not any(_HUNK.match(line) for line in lines) or any(line.startswith("<<<<<") for line in lines):
        return parse(text)
    found: list[Edit] = []
    files, k = 0, 0
    while k < len(lines):
        hunk = _HUNK.match(lines[k])
        files += lines[k].startswith("+++ ")
        k += 1
        if hunk:
            edit, k = _edit(lines, k, int(hunk[1] or 1), int(hunk[2] or 1), f"hunk {len(found) + 1}")
            found.append(edit)
    if files > 1:
        raise PatchError(f"it changes {files} files; give a patch of one program")
    return found


def _edit(lines: list[str], k: int, old: int, new: int, which: str) -> tuple[Edit, int]:
    """The hunk whose lines begin at k, of so many lines before and after; and where it ends."""
    search, replace = list[str](), list[str]()
    while len(search) < old or len(replace) < new:
        mark, rest = (lines[k][:1], lines[k][1:]) if k < len(lines) else ("", "")
        if k >= len(lines) or mark not in (" ", "-", "+", "\\", ""):
            raise PatchError(f"{which} ends after {k} lines of the file, before all of its own have come")
        if mark in (" ", "-", ""):  # editors strip the blank of an empty line
            search.append(f"{rest}\n")
        if mark in (" ", "+", ""):
            replace.append(f"{rest}\n")
        k += 1
    return Edit("".join(search), "".join(replace)), k
