"""Whether a changed plan asks for less of its prompt than the one before: what a planner may not mend a world by."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from wsim.plan.asked.covered import gaps, spans
from wsim.plan.asked.demands import REQUIRED, Demand, demands
from wsim.plan.asked.shown import SHOWN_BY, shows
from wsim.plan.asked.tied import tied
from wsim.plan.schema.formula import Predicate

if TYPE_CHECKING:
    from wsim.plan.schema import Objective, Plan
    from wsim.plan.schema.nodes import Node

WIDER = 0.2  # share by which a limit may be widened: what a first guess of a number is off by
_MORE_IS_WEAKER = ("tolerance", "within", "radius")
_LESS_IS_WEAKER = ("value", "least")
Limits = dict[tuple[str, ...], list[tuple[str, float]]]
_Room = tuple[tuple[str, ...], str, float]  # what is asked of what, its field, and the room that it leaves


def weakened(old: Plan, new: Plan) -> list[str]:
    """What a changed plan no longer asks for, a line each; empty for one that asks for as much.

    Objectives may be replaced and numbers moved that the prompt leaves open. Each clause of the prompt stays tied, by
    as many objectives as before, about the same things and of a kind that shows its verb; limits widen by a share of
    0.2 at most, in none of several alternatives; directions and the prompt's own numbers stay; nothing that a clause or
    an objective names goes.
    """
    before, after = (plan if plan.clauses else tied(plan) for plan in (old, new))
    return [
        *_gone(before, new), *_unasked(before, after), *_fewer(before, after), *_wider(before, new),
        *_turned(before, new),
    ]  # fmt: skip


def _gone(old: Plan, new: Plan) -> Iterator[str]:
    named = {name for clause in old.clauses for name, _ in clause.things}
    named |= {name for each in old.objectives for name in (each.object, each.ref) if name is not None}
    known, there = (_names(plan) for plan in (old, new))
    yield from (f"{name} is gone" for name in sorted(known & named - there))


def _names(plan: Plan) -> set[str]:
    named = (*plan.objects, *plan.joints, *plan.cords)
    return {str(getattr(each, "name", "")) for each in named}


def _unasked(old: Plan, new: Plan) -> Iterator[str]:
    open_before = {gap.demand for gap in gaps(old)}
    for gap in gaps(new):
        if gap.demand.kind in REQUIRED and gap.demand not in open_before:
            yield f"{gap.line}, and it was"


def _fewer(old: Plan, new: Plan) -> Iterator[str]:
    """Clauses that are tied to fewer objectives, or to some of which none shows the verb any more."""
    if len(new.objectives) < len(old.objectives):
        yield f"{len(new.objectives)} objectives, where there were {len(old.objectives)}"
    asked = {demand for demand in demands(old.prompt) if demand.kind == "verb"}
    for demand in sorted(asked, key=lambda each: each.first):
        had, has = (_tied_to(demand, plan) for plan in (old, new))
        if len(has) < len(had):
            yield f"{demand.quoted} has {len(has)} objectives, and had {len(had)}"
        lost = _about(had) - _about(has)
        if has and lost:
            yield f"{demand.quoted} was asked of {', '.join(sorted(lost))}, and is no more"
        shown = SHOWN_BY.get(demand.base)
        if shown and _show(had, shown) and has and not _show(has, shown):
            yield f"{demand.quoted} had an objective that shows it, and what it has now does not"


def _tied_to(demand: Demand, plan: Plan) -> list[Objective]:
    here = set(range(demand.first, demand.last + 1))
    numbers = {number for clause, at in spans(plan) if here <= at for number in clause.objectives}
    return [plan.objectives[number] for number in sorted(numbers)]


def _about(objectives: list[Objective]) -> set[str]:
    """The objects that objectives are about."""
    return {each.object for each in objectives}


def _turned(old: Plan, new: Plan) -> Iterator[str]:
    """Objectives that ask for another direction."""
    now = {(each.kind, each.object): each.direction for each in new.objectives}
    for each in old.objectives:
        direction = now.get((each.kind, each.object), each.direction)
        if each.direction is not None and direction != each.direction:
            yield f"{each.object} {each.kind} {direction or 'anywhere'}, where it was {each.direction}"


def _show(objectives: list[Objective], shown: frozenset[str]) -> bool:
    return any(shows(each, shown) for each in objectives)


def _wider(old: Plan, new: Plan) -> Iterator[str]:
    """Limits of the same thing that leave more room: the narrowest of the old ones against the narrowest now."""
    before, after = _limits(old), _limits(new)
    for key, rooms in before.items():
        had = min(room for _, room in rooms)
        if key not in after:
            continue
        field, has = min(after[key], key=lambda each: each[1])
        if has > had * (1.0 + WIDER) if had > 0.0 else has > had * (1.0 - WIDER) + 1e-12:
            more = f"{abs(has):g}" if math.isfinite(has) else "open in an alternative"
            more += f", where it was {abs(had):g}"
            yield f"{field} of {' '.join(key[:-1])} is {more}; {WIDER:.0%} is the most that a limit may move"


def _limits(plan: Plan) -> Limits:
    """The room that each thing that is asked leaves, by what it is asked of: greater is weaker."""
    found: Limits = {}
    for objective in plan.objectives:
        if objective.formula is not None:
            for key, field, room in _of(objective.formula, False):
                found.setdefault((*key, field), []).append((field, room))
        names = sorted(name for name in (objective.object, objective.ref) if name is not None)
        for field, alike in (("tolerance", "within"), ("value", "least")):  # as a formula calls them
            value = getattr(objective, field)
            if value is not None:
                room = value if field == "tolerance" else -value
                found.setdefault((objective.kind, *names, alike), []).append((field, room))
    return found


def _either(parts: list[list[_Room]]) -> Iterator[_Room]:
    """Of alternatives each leaves as much room as the one that leaves most: all, where it says nothing of a thing."""
    keys = dict.fromkeys((key, field) for part in parts for key, field, _ in part)
    for key, field in keys:
        rooms = [[room for k, f, room in part if (k, f) == (key, field)] for part in parts]
        yield key, field, max(min(each, default=math.inf) for each in rooms)


def _of(node: Node, denied: bool) -> Iterator[_Room]:
    op = str(getattr(node, "op", ""))
    if op == ("and" if denied else "or"):
        yield from _either([list(_of(part, denied)) for part in node.parts()])
        return
    if not isinstance(node, Predicate):
        for part in node.parts():
            yield from _of(part, denied ^ (op == "not"))
        return
    key = (op, *sorted(node.objects_named()), *([str(node.axis)] if hasattr(node, "axis") else []))
    sign = -1.0 if denied else 1.0
    for field in (*_MORE_IS_WEAKER, *_LESS_IS_WEAKER):
        value = getattr(node, field, None)
        if isinstance(value, (int, float)):
            yield key, field, sign * float(value) * (1.0 if field in _MORE_IS_WEAKER else -1.0)
    low, high = getattr(node, "low", None), getattr(node, "high", None)
    if isinstance(low, float) and isinstance(high, float):
        yield key, "range", sign * (high - low)
