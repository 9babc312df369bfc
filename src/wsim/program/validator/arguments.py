"""Whether a call's arguments fit one of the ways that a function can be called."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches

from wsim.program.api.entry import Entry, Parameter
from wsim.program.validator.values import Instance, Value, blur


@dataclass
class Arguments:
    """What a call is given.

    Attributes:
        call: The call.
        given: Positional arguments: value and node.
        named: Keyword arguments.
        open: It has `*` or `**` of something unknown: there may be more.
    """

    call: ast.Call
    given: list[tuple[Value, ast.expr]] = field(default_factory=list)
    named: dict[str, tuple[Value, ast.expr]] = field(default_factory=dict)
    open: bool = False

    @property
    def values(self) -> list[Value]:
        """The positional values."""
        return [value for value, _ in self.given]

    def bound(self, way: Sequence[Parameter]) -> dict[str, tuple[Value, ast.expr]]:
        """Arguments by the name of their parameter, in a way to call that they fit."""
        places = [p for p in way if p.kind in ("positional", "either")]
        found = {parameter.name: each for parameter, each in zip(places, self.given, strict=False) if parameter.name}
        return found | self.named

    def hand_over(self) -> None:
        """They go to code that is not read here, and may be changed by it."""
        for value in (*self.values, *(value for value, _ in self.named.values())):
            blur(value)
            if isinstance(value, Instance) and value.world is not None:
                value.world.touched()
                value.world.open = True


@dataclass(frozen=True)
class Misfit:
    """Why a call does not fit: the node that is wrong, what is wrong, and the parameter that is meant."""

    node: ast.AST
    message: str
    meant: str = ""
    weight: int = 1


Fits = Callable[[Value, str], bool]


def misfit(arguments: Arguments, entry: Entry, fits: Fits) -> Misfit | None:
    """Why a call fits none of an entry's ways; None if it fits one, or that is not known."""
    if not entry.overloads:
        return None
    found = []
    for way in entry.overloads:
        wrong = _misfit(arguments, way, entry, fits)
        if wrong is None:
            return None
        found.append(wrong)
    return min(found, key=lambda each: each.weight)


def _misfit(arguments: Arguments, way: Sequence[Parameter], entry: Entry, fits: Fits) -> Misfit | None:
    return (
        _keywords(arguments, way, entry)
        or _count(arguments, way, entry)
        or _missing(arguments, way, entry)
        or _types(arguments, way, entry, fits)
    )


def _keywords(arguments: Arguments, way: Sequence[Parameter], entry: Entry) -> Misfit | None:
    if any(p.kind == "**" for p in way):
        return None
    known = [p.name for p in way if p.kind in ("either", "keyword") and p.name]
    for name, (_, node) in arguments.named.items():
        if name in known or _loose(entry, name):
            continue
        meant = _meant(name, known, arguments)
        hint = f'; did you mean "{meant}"?' if meant else (f"; it takes {', '.join(known)}" if known else "")
        return Misfit(_place(arguments, name, node), f'{entry.short}() has no argument "{name}"{hint}', meant, 3)
    return None


def _loose(entry: Entry, name: str) -> bool:
    """NumPy's functions in C take more keywords than their signatures tell; their docstrings speak of those."""
    return entry.source == "numpy" and bool(re.search(rf"\b{re.escape(name)}\b", entry.doc))


def _meant(name: str, known: list[str], arguments: Arguments) -> str:
    free = [each for each in known if each not in arguments.named]
    for each in free:
        if name in each.split("_") or each in name.split("_"):
            return each
    close = get_close_matches(name, free, n=1, cutoff=0.6)
    return close[0] if close else ""


def _count(arguments: Arguments, way: Sequence[Parameter], entry: Entry) -> Misfit | None:
    if any(p.kind == "*" for p in way):
        return None
    places = [p for p in way if p.kind in ("positional", "either")]
    if entry.extra.get("native") and len(arguments.given) <= len(way):
        return None  # a signature of what is written in C says by keyword alone what may come by place too
    if len(arguments.given) > len(places):
        _, node = arguments.given[len(places)]
        keyword = [p.name for p in way if p.kind == "keyword" and p.name not in arguments.named]
        hint = f"; give the rest by name, e.g. {keyword[0]}=" if keyword else ""
        taken = f"{len(places)} positional argument{'s' * (len(places) != 1)}"
        return Misfit(node, f"{entry.short}() takes {taken}, and is given {len(arguments.given)}{hint}", weight=2)
    for place, _ in zip(places, arguments.given, strict=False):
        if place.name and place.name in arguments.named:
            node = arguments.named[place.name][1]
            return Misfit(node, f'{entry.short}() is given "{place.name}" twice', place.name, 2)
    return None


def _missing(arguments: Arguments, way: Sequence[Parameter], entry: Entry) -> Misfit | None:
    if arguments.open:
        return None
    if entry.source == "numpy" and arguments.named:
        return None
    places = [p for p in way if p.kind in ("positional", "either")]
    rest = [*places[len(arguments.given) :], *(p for p in way if p.kind == "keyword")]
    missing = [p for p in rest if p.required and p.name not in arguments.named]
    if not missing:
        return None
    names = ", ".join(f'"{p.name or p.annotation}"' for p in missing)
    return Misfit(arguments.call, f"{entry.short}() lacks {names}", missing[0].name, 2)


def _types(arguments: Arguments, way: Sequence[Parameter], entry: Entry, fits: Fits) -> Misfit | None:
    if entry.source not in ("wsim", "pxr"):
        return None
    places = [p for p in way if p.kind in ("positional", "either")]
    pairs = list(zip(places, arguments.given, strict=False))
    by_name = {p.name: p for p in way}
    pairs += [(by_name[name], each) for name, each in arguments.named.items() if name in by_name]
    for parameter, (value, node) in pairs:
        if parameter.annotation and not fits(value, parameter.annotation):
            name = f'"{parameter.name}" of ' if parameter.name else ""
            told = f"{name}{entry.short}() must be {parameter.annotation}"
            if parameter.annotation == "None":  # it is there to be refused: another may be meant
                meant = _meant(parameter.name, [p.name for p in way if p.annotation != "None"], arguments)
                told += f'; did you mean "{meant}"?' if meant else ""
            return Misfit(node, told, parameter.name, 1)
    return None


def _place(arguments: Arguments, name: str, node: ast.expr) -> ast.AST:
    return next((each for each in arguments.call.keywords if each.arg == name), node)
