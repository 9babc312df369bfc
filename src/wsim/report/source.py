"""A program's source as lines of HTML, coloured by token."""

from __future__ import annotations

import ast
import io
import keyword
import re
import textwrap
import token
import tokenize
from collections.abc import Iterator
from dataclasses import dataclass

from markupsafe import Markup, escape

MOST_LINES = 5000
MOST_STATEMENT_LINES = 10
# Characters that change the order in which text is shown, so that code would not read as it runs.
BIDI = re.compile("[\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069]")


@dataclass(frozen=True)
class SourceLine:
    """One line of a program."""

    number: int
    html: Markup
    failed: list[int]  # numbers of the failed findings that name it


def source_lines(program: str, failed: dict[int, list[int]]) -> list[SourceLine]:
    """A program's lines; `failed` maps a line's number to the numbers of the failed findings that name it."""
    lines = program.expandtabs(4).split("\n")[:MOST_LINES]
    if lines and not lines[-1]:
        lines.pop()
    spans: dict[int, list[tuple[int, int, str]]] = {}
    for row, start, end, kind in _tokens("\n".join(lines) + "\n"):
        spans.setdefault(row, []).append((start, end, kind))
    return [SourceLine(i, _colored(line, spans.get(i, [])), failed.get(i, [])) for i, line in enumerate(lines, start=1)]


def statement(program: str, line: int) -> str:
    """The whole call that begins at a line, or the line alone where the program does not parse; dedented."""
    lines = program.splitlines()
    try:
        tree = ast.parse(program)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return lines[line - 1].strip()
    # Of the statements that hold the line, the innermost; those with a body of their own are no calls.
    found = [
        (node.lineno, node.end_lineno or node.lineno)
        for node in ast.walk(tree)
        if isinstance(node, ast.stmt) and not hasattr(node, "body") and node.lineno <= line <= (node.end_lineno or 0)
    ]
    first, last = max(found, default=(line, line))
    shown = lines[first - 1 : last]
    if len(shown) > MOST_STATEMENT_LINES:
        shown = [*shown[:MOST_STATEMENT_LINES], "…"]
    return textwrap.dedent("\n".join(shown))


def _tokens(text: str) -> Iterator[tuple[int, int, int, str]]:
    """(line, first column, end column, class) of every token that has a colour; what does not parse has none."""
    try:
        for item in tokenize.generate_tokens(io.StringIO(text).readline):
            kind = _kind(item)
            if not kind:
                continue
            (first, start), (last, end) = item.start, item.end
            for row in range(first, last + 1):
                yield row, start if row == first else 0, end if row == last else 1_000_000, kind
    except (tokenize.TokenError, SyntaxError):
        return


def _kind(item: tokenize.TokenInfo) -> str:
    name = token.tok_name[item.type]
    if item.type == token.NAME and keyword.iskeyword(item.string):
        return "k"
    if name == "COMMENT":
        return "c"
    if name == "STRING" or name.startswith("FSTRING"):
        return "s"
    return "n" if name == "NUMBER" else ""


def _colored(line: str, spans: list[tuple[int, int, str]]) -> Markup:
    parts, at = [], 0
    for start, end, kind in spans:
        parts += [visible(line[at:start]), Markup('<span class="{}">{}</span>').format(kind, visible(line[start:end]))]
        at = end
    return Markup("").join([*parts, visible(line[at:])])


def visible(text: str) -> Markup:
    """Text as HTML, with the characters that would change its order named."""
    return Markup(BIDI.sub(lambda match: f"<mark>U+{ord(match[0]):04X}</mark>", str(escape(text))))
