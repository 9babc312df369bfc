"""Validation errors for people: one line, each problem with its path in the plan."""

from __future__ import annotations

import json
from typing import Any

from pydantic import ValidationError

SHOWN = 20  # problems in a message
LONGEST_PART = 60  # characters of a field's name, which may be anything in a file that is no plan
# What is wrong, by pydantic's type of error, with the numbers of its context; the value stands behind it.
_WORDS = {
    "missing": "it is missing",
    "extra_forbidden": "there is no such field",
    "literal_error": "it must be {expected}",
    "enum": "it must be {expected}",
    "greater_than": "it must be > {gt:.10g}",
    "greater_than_equal": "it must be >= {ge:.10g}",
    "less_than": "it must be < {lt:.10g}",
    "less_than_equal": "it must be <= {le:.10g}",
    "finite_number": "it must be a finite number",
    "string_type": "it must be a text",
    "string_too_short": "it must have {min_length} characters or more",
    "string_too_long": "it must have at most {max_length} characters",
    "bool_type": "it must be true or false",
    "bool_parsing": "it must be true or false",
    "too_short": "it must have {min_length} items or more; it has {actual_length}",
    "too_long": "it must have at most {max_length} items",
    "union_tag_invalid": "there is no kind {tag!r}; the kinds are {expected_tags}",
    "union_tag_not_found": "it does not say of which kind it is",
    "string_unicode": "it is no text that can be written",
    **dict.fromkeys(("float_type", "float_parsing", "int_type", "int_parsing"), "it must be a number"),
    "int_from_float": "it must be a whole number",
    **dict.fromkeys(("list_type", "tuple_type"), "it must be a list, [...]"),
    **dict.fromkeys(("dict_type", "model_type", "model_attributes_type"), "it must be an object, {{...}}"),
}
_NAME = "it must be a name of letters, digits and _, that begins with no digit"
_NAMES = ("^[A-Za-z_][A-Za-z0-9_]*$", "^[A-Za-z_][A-Za-z0-9_]*(\\.[a-z_]+)?$")
_TOLD = ("value_error", "missing", "extra_forbidden", "string_unicode", "union_tag_not_found")  # in full by themselves
LONGEST = 500  # characters of one problem


def explain(error: ValidationError) -> str:
    """One line for a person: each problem with its path in the plan."""
    lines = []
    # Not all of them: a list of a million wrong items has a million problems.
    items = error.errors(include_url=False)
    for item in items[:SHOWN]:
        where = ".".join(_short(str(part), LONGEST_PART) for part in item["loc"])
        text = _short(_said(item).removeprefix("Value error, "), LONGEST if item["type"] != "value_error" else 4000)
        lines.append((f"{where}: {text}" if where else text) + _way_out(item))
    more = [f"and {len(items) - SHOWN} more"] if len(items) > SHOWN else []
    return "; ".join([*lines, *more])


def _said(item: Any) -> str:
    """What is wrong, with the value that is."""
    text = _wrong(item)
    value = item["input"]
    if item["type"] in _TOLD or not isinstance(value, (bool, int, float, str, type(None))):
        return text
    return f"{text}; it is {'null' if value is None else json.dumps(value, ensure_ascii=False)[:LONGEST_PART]}"


def _wrong(item: Any) -> str:
    words, context = _WORDS.get(item["type"]), item.get("ctx", {})
    if item["type"] == "string_pattern_mismatch":
        return _NAME if context["pattern"] in _NAMES else f"it must match {context['pattern']}"
    return str(item["msg"]) if words is None else words.format(**context)


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
