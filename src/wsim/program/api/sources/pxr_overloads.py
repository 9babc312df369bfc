"""How USD's C++ functions are called, as they tell whoever calls them wrongly.

Given more arguments than any function has, each answers with its C++ signatures and does nothing.
"""

from __future__ import annotations

import re
from typing import Any

from wsim.program.api.entry import Parameter

_TOO_MANY = 64
_NAMESPACE = re.compile(r"pxrInternal_v\w+?__pxrReserved__::|std::__cxx11::|std::")
_TEMPLATES = (
    (re.compile(r"basic_string<.*?> ?>"), "string"),
    (re.compile(r"pxr_boost::python::(?:api::)?"), ""),
    (re.compile(r"Tf(?:Weak|Ref)Ptr<(\w+)>"), r"\1"),
)


def is_binding(value: object) -> bool:
    """Whether a value is a C++ function that Boost.Python shows."""
    return type(value).__module__ == "Boost.Python" and type(value).__name__ == "function"


def overloads(function: Any) -> tuple[tuple[Parameter, ...], ...]:
    """The ways to call a bound C++ function, as it answers to a call that no way fits; empty if it does not tell."""
    try:
        function(*[_Nothing()] * _TOO_MANY)
    except Exception as error:  # noqa: BLE001 - each binding raises its own kind
        _, found, text = str(error).partition("did not match C++ signature:")
    else:
        return ()
    if not found:
        return ()
    ways = [_parse(line.strip()) for line in text.strip().splitlines()]
    # A function that takes whatever it is given tells of one parameter, or of none.
    return () if None in ways else tuple(way for way in ways if way is not None)


class _Nothing:
    """What no function takes."""


def _parse(line: str) -> tuple[Parameter, ...] | None:
    line = _NAMESPACE.sub("", line)
    for pattern, plain in _TEMPLATES:
        line = pattern.sub(plain, line)
    inside = re.match(r"^\S+?\((.*)\)$", line)
    if inside is None or "..." in line:
        return None
    return tuple(_parameter(part) for part in _split(inside[1]) if part != "void")


def _split(text: str) -> list[str]:
    """Arguments at commas that stand in no brackets or quotes."""
    parts, depth, quote, start = [], 0, "", 0
    for i, c in enumerate(text):
        if quote:
            quote = "" if c == quote else quote
        elif c in "'\"":
            quote = c
        elif c in "<([{":
            depth += 1
        elif c in ">)]}":
            depth -= 1
        elif c == "," and depth == 0:
            parts.append(text[start:i].strip())
            start = i + 1
    return [*parts, text[start:].strip()] if text.strip() else parts


def _parameter(text: str) -> Parameter:
    declared, equals, default = text.partition("=")
    declared = declared.replace("{lvalue}", "").strip()
    kind, _, name = declared.rpartition(" ")
    if not kind or not re.fullmatch(r"\w+", name) or (declared.startswith("unsigned") and kind == "unsigned"):
        kind, name = declared, ""
    if name in ("int", "long", "char", "double", "short", "const"):
        kind, name = declared, ""
    return Parameter(name, "either" if name else "positional", kind.strip(), default.strip() if equals else None)
