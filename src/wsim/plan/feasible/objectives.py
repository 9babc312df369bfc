"""Objectives that contradict each other, what they are of, or the time that there is."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING

from wsim.plan.feasible.asked import Said, said

if TYPE_CHECKING:
    from wsim.plan.schema import Plan
    from wsim.plan.schema.nodes import Node

_TIPPED = 45.0  # [deg]: as "topples" has it
# Two things that cannot both be true of one object against one other: at the end, or ever.
_EXCLUDE = (
    ({"floats"}, {"submerged", "sinks"}),
    ({"touches", "collides_with", "pushes", "rests_on", "stays_on", "bounces_to", "weighs_on"}, {"never_touches"}),
    ({"collides_with", "touches"}, {"stops_before"}),
)
_MUTUAL = {"touches", "collides_with", "never_touches"}  # of two alike: which is named first says nothing
LATE = 1e-9  # [s]


def objective_faults(plan: Plan) -> Iterator[str]:
    """All of them."""
    asked = said(plan)
    yield from _windows(plan)
    yield from _contradictions(asked)


def _windows(plan: Plan) -> Iterator[str]:
    """A window that begins after the end is empty, and one that ends there asks for what is not recorded."""
    end = plan.simulation.duration
    for number, objective in enumerate(plan.objectives):
        if objective.formula is None:
            continue
        latest = _latest(objective.formula)
        if latest > end + LATE:
            yield (
                f"objectives.{number}.formula: its windows reach to {latest:g} s, and the run ends at {end:g} s; "
                f"shorten them, or give simulation.duration {latest:g}"
            )


def _latest(node: Node) -> float:
    """Up to when a formula looks at least, from where it is asked [s]; inner windows count from outer ones' ends."""
    own = 0.0
    windows = getattr(node, "windows", None) or (getattr(node, "window", None),)
    for window in windows:
        if window is not None:
            own = max(own, window[1] if window[1] is not None else window[0])
    if getattr(node, "op", "") == "finally":
        return max(getattr(node, "seconds", None) or 0.0, 0.0)
    inner = max((_latest(part) for part in node.parts()), default=0.0)
    return own + inner


def _contradictions(asked: Sequence[Said]) -> Iterator[str]:
    """Two objectives of which only one can come true."""
    for k, one in enumerate(asked):
        for other in asked[k + 1 :]:
            if one.object is not None and (why := _against(one, other)):
                yield f"{one.where} and {other.where}: {why}; leave one of the two out"


def _against(one: Said, other: Said) -> str:
    if one.optional or other.optional:
        return ""
    if one.object != other.object:
        mutual = {one.object, one.ref} == {other.object, other.ref} and {one.name, other.name} & _MUTUAL
        return (
            _shut_out(one, replace(other, fields={**other.fields, "object": one.object, "ref": one.ref}))
            if mutual
            else ""
        )
    return _shut_out(one, other) or _ranges(one, other) or _moves(one, other)


def _shut_out(one: Said, other: Said) -> str:
    """What the names alone say that cannot both be true."""
    for first, second in ((one, other), (other, one)):
        if first.whole and not first.denied and second.denied and _what(first) == _what(second):
            return f"{one.object} cannot be {first.name} all the time, and not"
        if first.denied or second.denied:
            continue
        if first.name == "topples" and second.name == "upright" and second.whole:
            within = second.fields.get("within")
            if within is None or within < _TIPPED:
                return f"{one.object} cannot topple and stay upright"
        same = _others(first) & _others(second)
        for these, those in _EXCLUDE:
            if second.name == "never_touches" and not second.whole:
                continue
            if second.name in ("submerged", "sinks") and min(first.end, second.end) < inf:
                continue  # what floats at first may sink at last
            if first.name in these and second.name in those and same:
                return f"{one.object} cannot do both, {first.name} and {second.name}, with {min(same)}"
    return ""


def _what(each: Said) -> tuple[str, dict[str, object]]:
    return each.name, each.fields


def _ranges(one: Said, other: Said) -> str:
    """Two ranges of one quantity at one time that have nothing in common."""
    same = one.name == other.name and all(one.fields.get(k) == other.fields.get(k) for k in ("axis", "of", "fluid"))
    if not same or one.denied or other.denied or not (one.plain and other.plain) or "low" not in one.fields:
        return ""
    if max(one.fields["low"], other.fields["low"]) <= min(one.fields["high"], other.fields["high"]):
        return ""
    ranges = " and ".join(f"{each.fields['low']:g} to {each.fields['high']:g}" for each in (one, other))
    return f"{one.object} cannot have both, {one.name} {ranges}"


def _moves(one: Said, other: Said) -> str:
    """Two ways at once, or a way out of where it is to stay."""
    for first, second in ((one, other), (other, one)):
        if first.denied or second.denied or first.name != "moves":
            continue
        ways = {first.fields.get("direction"), second.fields.get("direction")}
        if second.name == "moves" and first.plain and second.plain and ways in ({"front", "back"}, {"left", "right"}):
            return f"{one.object} cannot end both, {' and '.join(sorted(map(str, ways)))} of where it started"
        least = first.fields.get("least") or 0.0
        if second.name == "stays_within" and second.whole and least > 2.0 * second.fields["radius"]:
            return f"{one.object} cannot move {least:g} m inside a radius of {second.fields['radius']:g} m"
    return ""


def _others(each: Said) -> set[str]:
    """What it is said against."""
    found = (each.ref, each.fields.get("fluid"))
    return {name for name in found if name is not None}
