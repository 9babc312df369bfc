"""Answers as short text: numbers of four digits, tables, pages of lines, and a limit with what was left out."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

import wsim
from wsim.assets import asset_folders

LIMIT = 2000  # characters of an answer: about 600 tokens
DIGITS = 4  # significant, of a number
ROOT = "/World/"


def number(x: float | None) -> str:
    """A number with at most four significant digits; nothing for None."""
    return "" if x is None else f"{x:.{DIGITS}g}"


def numbers(values: Iterable[float], between: str = ", ") -> str:
    """Numbers in a row."""
    return between.join(number(x) for x in values)


def name_of(prim: str | None) -> str:
    """A prim as a plan calls it: /World/block is block."""
    return (prim or "").removeprefix(ROOT)


def prim_of(name: str) -> str:
    """The prim that a name means: block is /World/block."""
    return name if name.startswith("/") else ROOT + name


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """Lines of left-aligned columns; columns that are empty in every row are left out."""
    rows = [list(row) for row in rows]
    kept = [k for k in range(len(head)) if any(row[k] for row in rows)]
    lines = [[cells[k] for k in kept] for cells in (list(head), *rows)]
    widths = [max(len(cell) for cell in column) for column in zip(*lines, strict=True)]
    return ["  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip() for line in lines]


def page(lines: Sequence[str], first: int, field: str, room: int = LIMIT - 120) -> list[str]:
    """As many lines from the `first` (counted from 1) as there is room for, and how to ask for the next.

    Args:
        lines: All of them.
        first: The first to show.
        field: The argument that takes the first line.
        room: Characters.
    """
    lines = "\n".join(lines).rstrip().splitlines()
    shown: list[str] = []
    for line in lines[first - 1 :]:
        room -= len(line) + 1
        if room < 0 and shown:
            break
        shown.append(line)
    last = first - 1 + len(shown)
    if last < len(lines):
        shown.append(f"… lines {first} to {last} of {len(lines)}; the next with {field}={last + 1}")
    return shown


def capped(text: str, narrow: str) -> str:
    """Text of at most `LIMIT` characters: whole lines, and a last one that says what was left out.

    Args:
        text: The answer.
        narrow: How to ask for less at once, for that last line.
    """
    if len(text) <= LIMIT:
        return text
    lines = text.splitlines()
    room = LIMIT - 60 - len(narrow)
    kept: list[str] = []
    for line in lines:
        room -= len(line) + 1
        if room < 0:
            break
        kept.append(line)
    left = lines[len(kept) :]
    if not kept:  # one line alone that is longer than all there is room for
        kept, left = [lines[0][: LIMIT - 60 - len(narrow)] + "…"], lines[1:]
    return "\n".join([*kept, f"… {len(left)} more lines left out" + (f"; {narrow}" if narrow else "")])


def relative(text: str, run: Path) -> str:
    """Text that is the same on any machine: paths begin at the run's folder, or at a package's; no addresses."""
    packages = Path(wsim.__file__).parents[1]
    assets = [(folder.resolve(), "assets/") for folder in asset_folders()]
    for folder, instead in ((run.resolve(), ""), (run, ""), *assets, (packages, "")):
        if "/" in str(folder).strip("/"):  # a single word may be anything's name
            named = rf"(?<![\w./-]){re.escape(str(folder))}"
            text = re.sub(rf"{named}/", instead, text)
            text = re.sub(rf"{named}(?![\w-])", instead.rstrip("/") or "the run", text)
    text = re.sub(r"/\S*?/wsim-stage-[^/\s]+/", "", text)
    return re.sub(r"0x[0-9a-f]{6,}", "0x…", text)
