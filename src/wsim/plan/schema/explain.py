"""Validation errors for people: one line, each problem with its path in the plan."""

from __future__ import annotations

import json
from typing import Any

from pydantic import ValidationError

SHOWN = 20  # problems in a message
LONGEST_PART = 60  # characters of a field's name, which may be anything in a file that is no plan
_TOLD = ("value_error", "missing", "extra_forbidden", "string_unicode", "union_tag_not_found")  # in full by themselves
LONGEST = 500  # characters of one problem


def explain(error: ValidationError) -> str:
    """One line for a person: each problem with its path in the plan."""
    lines = []
    # Not all of them: a list of a million wrong items has a million problems.
    items = error.errors(include_url=False, include_context=False)
    for item in items[:SHOWN]:
        where = ".".join(_short(str(part), LONGEST_PART) for part in item["loc"])
        text = _short(_said(item).removeprefix("Value error, "), LONGEST if item["type"] != "value_error" else 4000)
        lines.append((f"{where}: {text}" if where else text) + _way_out(item))
    more = [f"and {len(items) - SHOWN} more"] if len(items) > SHOWN else []
    return "; ".join([*lines, *more])


def _said(item: Any) -> str:
    """What is wrong, with the value that is; JSON has lists, and no tuples."""
    text = str(item["msg"]).replace("valid tuple", "list").replace("Tuple should", "List should")
    value = item["input"]
    if item["type"] in _TOLD or not isinstance(value, (bool, int, float, str, type(None))):
        return text
    return f"{text}; it is {'null' if value is None else json.dumps(value, ensure_ascii=False)[:LONGEST_PART]}"


def _short(text: str, most: int) -> str:
    """One line of printable characters, cut to a length."""
    cut = text if len(text) <= most else text[:most] + "…"
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in cut)


def _way_out(item: Any) -> str:
    if item["type"] == "extra_forbidden":
        return "; remove it, or look for a spelling mistake"
    if item["type"] == "missing":
        return "; add it"
    if item["type"] == "union_tag_not_found":
        return (
            '; add "kind": "proxy" (a primitive), "asset" (of the catalogue), "robot", "vehicle", "terrain", "scatter" '
            'or "external" (with a stand-in)'
        )
    if item["type"] == "string_unicode":
        return "; it holds half of a character (a lone surrogate, such as \\ud800); write the whole one"
    return ""
