"""Short texts about findings, plans and facts."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from wsim.report.numbers import digits_to_tell_apart, nice_unit, number, quantity

if TYPE_CHECKING:
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import PlanObject, Relation

RELATIONS = {
    "PLACE-ON-BASE": "on the base",
    "PLACE-ON": "on {ref}",
    "PLACE-IN": "in {ref}",
    "LEFT-OF": "left of {ref}",
    "RIGHT-OF": "right of {ref}",
    "FRONT-OF": "in front of {ref}",
    "BACK-OF": "behind {ref}",
    "FREE-SURFACE-AT": "its surface at {value}",
    "FLOATS-AT-SURFACE": "at the surface of {ref}",
    "SUBMERGED": "{value} under the surface of {ref}",
    "SPAWNED-ABOVE": "{value} above {ref}",
    "LIES-ALONG-X": "lies along X",
    "LIES-ALONG-Y": "lies along Y",
}
LINE = re.compile(r"(?P<file>[^:]+\.py):(?P<line>[0-9]{1,7})")


def prim_name(prim: str) -> str:
    """The name of a prim without the path that all share."""
    return prim.removeprefix("/World/") or prim


def said(message: str) -> str:
    """A finding's words as a person reads them: prims by their names, powers as such."""
    return nice_unit(message.replace("/World/", ""))


def program_line(finding: Finding, names: set[str], count: int) -> int | None:
    """The line of the shown program that a finding names, if it is one of its `count` lines."""
    match = LINE.fullmatch(finding.line or "")
    if match is None or match["file"] not in names:
        return None
    line = int(match["line"])
    return line if 1 <= line <= count else None


def measures(finding: Finding) -> list[tuple[str, str]]:
    """(label, text) of a finding's numbers, as many as it has, with digits enough to tell them apart."""
    digits = digits_to_tell_apart([finding.value, finding.limit])
    factor, unit = percent(finding.unit)

    def words(x: float | None, digits: int = 3, sign: bool = False) -> str:
        return quantity(None if x is None else factor * x, unit, digits, sign)

    rows = [
        ("measured", words(finding.value, digits)),
        ("expected", words(finding.expected, digits)),
        (limit_word(finding), words(finding.limit, digits)),
        ("margin", words(finding.margin, sign=True)),
        ("time", quantity(finding.time, "s")),
        ("lasts", _lasts(finding)),
    ]
    return [(label, text) for label, text in rows if text]


def _lasts(finding: Finding) -> str:
    """From when to when it was so; nothing for a moment."""
    if finding.span is None or not finding.span[1] > finding.span[0]:
        return ""
    return f"{number(finding.span[0])} … {quantity(finding.span[1], 's')}"


def percent(unit: str) -> tuple[float, str]:
    """What a number is multiplied with before a person reads it, and its unit then: a share is said in percent."""
    return (100.0, "%") if unit.startswith("share") else (1.0, unit)


def table_numbers(finding: Finding) -> dict[str, str]:
    """A finding's numbers for its row; its unit has a column of its own."""
    digits = digits_to_tell_apart([finding.value, finding.limit])
    limit = number(finding.limit, digits)
    sign = {"at most": "≤ ", "at least": "≥ ", "off by at most": "± "}.get(limit_word(finding), "")
    return {
        "value": number(finding.value, digits),
        "expected": number(finding.expected, digits),
        "limit": sign + limit if limit else "",
        "margin": number(finding.margin, sign=True),
        "unit": nice_unit(finding.unit),
        "time": number(finding.time),
        "lasts": _lasts(finding),
    }


def limit_word(finding: Finding) -> str:
    """How the limit bounds the value, as the margin tells it: "at most", "at least", "off by at most", else "limit"."""
    value, limit, margin, expected = finding.value, finding.limit, finding.margin, finding.expected
    if value is None or limit is None or margin is None or not all(map(math.isfinite, (value, limit, margin))):
        return "limit"
    scale = 1e-6 * max(abs(value), abs(limit), 1e-12)

    def tells(bound: float) -> bool:
        return abs(bound - margin) <= scale

    at_most, at_least = tells(limit - value), tells(value - limit)
    if at_most or at_least:
        return "limit" if at_most and at_least else "at most" if at_most else "at least"
    around = expected is not None and math.isfinite(expected) and tells(limit - abs(value - expected))
    return "off by at most" if around else "limit"


def describe_size(item: PlanObject) -> str:
    """An object's size in words, e.g. "0.2 × 0.2 × 0.14 m" or "radius 0.06 m"."""
    size = [number(x) for x in item.size]
    if item.primitive == "sphere" and len(size) == 1:
        return f"radius {size[0]} m"
    if item.primitive in ("cylinder", "capsule") and len(size) == 2:
        return f"radius {size[0]} m, height {size[1]} m"
    return " × ".join(size) + " m" if size else ""


def describe_relation(relation: Relation) -> str:
    """A relation in words, e.g. "in front of block, gap 0.1 m"."""
    phrase = RELATIONS.get(relation.predicate, relation.predicate.replace("-", " ").lower())
    words = phrase.format(ref=relation.ref or "the base", value=quantity(relation.value, "m"))
    return f"{words}, gap {quantity(relation.gap, 'm')}" if relation.gap else words


def duration(seconds: float | None) -> str:
    """Wall time as a person says it."""
    if seconds is None or not math.isfinite(seconds):
        return ""
    if seconds < 120:
        return quantity(seconds, "s")
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes}\N{NO-BREAK SPACE}min {rest:02d}\N{NO-BREAK SPACE}s"


def plain(value: object) -> str:
    """A fact of unknown kind as text."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return number(value, 4)
    if isinstance(value, dict):
        return ", ".join(f"{key} {plain(item)}" for key, item in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(plain(item) for item in value)
    return "" if value is None else str(value)
