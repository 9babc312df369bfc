"""Strings with values in them: f"block_{i}"."""

from __future__ import annotations

import ast
from collections.abc import Callable

from wsim.program.validator.state import State
from wsim.program.validator.values import Const, Instance, Value


def joined(reader: State, node: ast.JoinedStr) -> Value:
    """The whole string, where all in it is known."""
    text = ""
    known = True
    for part in node.values:
        if isinstance(part, ast.Constant):
            text += str(part.value)
            continue
        assert isinstance(part, ast.FormattedValue)
        shown = _formatted(reader, part)
        known = known and shown is not None
        text += shown or ""
    return Const(text) if known else Instance("builtins.str")


def _formatted(reader: State, node: ast.FormattedValue) -> str | None:
    value = reader.value(node.value)
    form = reader.value(node.format_spec) if node.format_spec is not None else Const("")
    if not isinstance(value, Const) or not isinstance(form, Const) or not _is_short(form.value):
        return None
    if not isinstance(value.value, (str, int, float, bool)):
        return None
    shown: dict[int, Callable[[object], str]] = {115: str, 114: repr, 97: ascii}
    try:
        if node.conversion in shown:
            return format(shown[node.conversion](value.value), form.value)
        return format(value.value, form.value)
    except (ValueError, TypeError):
        return None


def _is_short(form: object) -> bool:
    """Whether a format asks for no more than a line."""
    digits = "".join(c if c.isdigit() else " " for c in str(form)).split()
    return all(len(number) <= 2 for number in digits)
