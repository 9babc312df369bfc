"""Pieces of Python text, as a person would write them."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

WIDTH = 88  # columns; a call that does not fit has one argument a line, which any formatter's settings keep


def number(value: float) -> str:
    """A float as a person writes it: to a micrometre, or to four figures where it is small; rounding's dust is 0."""
    if abs(value) < 1e-9:
        return "0.0"
    rounded = round(float(value), 6) if abs(value) >= 1e-3 else float(f"{value:.4g}")
    return repr(rounded)


def tuple_of(values: Sequence[float]) -> str:
    """Numbers in parentheses."""
    return f"({', '.join(number(value) for value in values)})"


def call(target: str, arguments: Sequence[str], depth: int = 1) -> list[str]:
    """A call, indented by so many levels: on one line, or an argument a line."""
    indent = "    " * depth
    line = f"{indent}{target}({', '.join(arguments)})"
    if len(line) <= WIDTH:
        return [line]
    return [f"{indent}{target}(", *(f"{indent}    {argument}," for argument in arguments), f"{indent})"]


def comment(text: str) -> list[str]:
    """A comment in a function's body, wrapped."""
    return textwrap.wrap(text, WIDTH, initial_indent="    # ", subsequent_indent="    #   ")


def prose(text: str) -> str:
    """Free text for a docstring or a comment: one line, without what could end either or hide in it."""
    plain = "".join(" " if c.isspace() else c for c in text if c.isspace() or c.isprintable())
    return " ".join(plain.replace("\\", "/").replace('"', "'").split())
