"""A program's source as lines of HTML, coloured by token; style.css has the colours of Pygments' short names."""

from __future__ import annotations

import ast
import io
import re
import textwrap
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup, escape
from pygments import token
from pygments.formatters.html import HtmlFormatter
from pygments.lexers.python import PythonLexer

MOST_LINES = 5000
MOST_STATEMENT_LINES = 10
COLORED = (
    token.Keyword, token.Operator.Word, token.Comment, token.String, token.Number, token.Name.Function,
    token.Name.Class, token.Name.Decorator,
)  # fmt: skip
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
    # Unprocessed: the lexer's own preparation would take other characters for line ends.
    tokens = PythonLexer().get_tokens_unprocessed("\n".join(lines) + "\n")
    html = io.StringIO()
    HtmlFormatter(nowrap=True).format(((_shown(kind), text) for _, kind, text in tokens), html)
    colored = html.getvalue().split("\n")[: len(lines)]
    return [SourceLine(i, _named(line), failed.get(i, [])) for i, line in enumerate(colored, start=1)]


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


def _shown(kind: Any) -> Any:
    """A token's kind if the page has a colour for it, else the kind that makes no span."""
    return kind if any(kind in one for one in COLORED) else token.Text


def visible(text: str) -> Markup:
    """Text as HTML, with the characters that would change its order named."""
    return _named(str(escape(text)))


def _named(html: str) -> Markup:
    return Markup(BIDI.sub(lambda match: f"<mark>U+{ord(match[0]):04X}</mark>", html))
