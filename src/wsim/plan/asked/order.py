"""What comes before what: "then", "after", "before"; and whether what is asked comes so."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

from wsim.plan.asked import vocabulary as words
from wsim.plan.asked.demands import demands
from wsim.plan.asked.nodes import nodes
from wsim.plan.asked.often import asks_order
from wsim.plan.asked.parties import takes_part
from wsim.plan.asked.shown import SHOWN_BY, shows
from wsim.plan.asked.tokens import Words, text_at
from wsim.plan.schema.formula import Then

if TYPE_CHECKING:
    from wsim.plan.asked.demands import Demand
    from wsim.plan.schema import Objective, Plan
    from wsim.plan.schema.nodes import Node

Pair = tuple["Demand", "Demand"]
_ENDS = words.as_set("come float halt lie remain rest settle sink stay stop")
_AT_THE_END = words.as_set("rests_on lies_on settles contained_in floats sinks submerged supported_by stays_inside")


def turned_round(plan: Plan, demand: Demand, objectives: Sequence[Objective]) -> str:
    """Why a verb's objectives have it before what the prompt has it after; empty where they do not.

    Args:
        plan: The plan.
        demand: The verb, the later of two.
        objectives: Those that clauses name for it.
    """
    for first, later in pairs(plan):
        if later is not demand:
            continue
        for events in (node.events for each in objectives for node, denied in nodes(each)
                       if isinstance(node, Then) and not denied):  # fmt: skip
            mine, others = _places(plan, later, events), _places(plan, first, events)
            alone, before = mine - others, others - mine
            if alone and before and max(alone) < min(before):
                return f"it comes after {first.quoted}, and the objective that is named for it has it before that"
    return ""


def unordered(plan: Plan, objectives: Callable[[Demand], Sequence[Objective]]) -> list[str]:
    """A line for each two verbs of which the prompt says which comes first, and no objective of theirs does.

    Args:
        plan: The plan.
        objectives: Those that clauses name for a verb.
    """
    lines = []
    for first, later in pairs(plan):
        one, other = objectives(first), objectives(later)
        ends = later.base in _ENDS or bool(plan.schedules)  # the end comes last, and a schedule has its moment
        ends = ends or all(shows(each, _AT_THE_END) for each in other) or any(each in one for each in other)
        if one and other and not ends and not any(asks_order(each) for each in (*one, *other)):
            lines.append(f"{first.quoted} before {later.quoted}: nothing asks which comes first: a then b")
    return lines


def pairs(plan: Plan) -> Iterator[Pair]:
    """The verbs of which a word says that one comes before the other, the earlier one first."""
    read = Words.of(plan.prompt)
    verbs = [each for each in demands(plan.prompt) if each.kind == "verb"]
    for k, token in enumerate(read.said):
        earlier = [each for each in verbs if each.last < k and not _between(read.opens, each.last + 1, k)]
        later = [each for each in verbs if each.first > k and not _between(read.opens, k + 1, each.first)]
        if token.text == "then" and earlier and later:
            yield earlier[-1], later[0]
        elif token.text in ("after", "before", "until") and later and text_at(read.said, k + 1) not in ("that", "it's"):
            inside = [each for each in later if not _between(read.breaks, k + 1, each.first)]
            if k in read.opens or k in read.breaks:  # "After it hits the box, the block falls."
                outside = [each for each in later if each not in inside] or inside[1:] or earlier[-1:]
            else:
                outside = earlier[-1:]
            if inside and outside:
                yield (inside[0], outside[0]) if token.text == "after" else (outside[0], inside[0])


def _between(marks: frozenset[int], first: int, last: int) -> bool:
    return any(mark in marks for mark in range(first, last + 1))


def _places(plan: Plan, verb: Demand, events: Sequence[Node]) -> set[int]:
    """The events that a verb may be: of its kinds, and about what it is done to, or who does it."""
    parties = takes_part(plan, verb)
    about = parties.bears or next(iter(parties.does), None)
    shown = SHOWN_BY.get(verb.base)
    found = set()
    for k, event in enumerate(events):
        ops = {str(getattr(node, "op", "")) for node in event.walk()}
        if (shown is None or ops & shown) and (about is None or event.names() & about):
            found.add(k)
    return found
