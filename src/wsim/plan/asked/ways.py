"""Which way something goes: "to the left", "forwards", "rises"; and whether what is asked of it goes another."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from wsim.plan.asked import vocabulary as words
from wsim.plan.asked.nodes import nodes
from wsim.plan.asked.parties import involved, takes_part
from wsim.plan.asked.tokens import Words, text_at
from wsim.plan.schema.formula import Predicate

if TYPE_CHECKING:
    from wsim.plan.asked.demands import Demand
    from wsim.plan.schema import Objective, Plan
    from wsim.plan.schema.clause import Clause

Way = tuple[int, int]  # an axis of the world, and a sign: x points to the front, y to the left, z up
WAYS: dict[str, Way] = {
    "left": (1, 1), "right": (1, -1), "forward": (0, 1), "forwards": (0, 1), "backward": (0, -1),
    "backwards": (0, -1), "upward": (2, 1), "upwards": (2, 1), "downward": (2, -1), "downwards": (2, -1),
}  # fmt: skip
_GOES_BY_ITSELF: dict[str, Way] = {
    **dict.fromkeys(("rise", "ascend", "soar"), (2, 1)),
    **dict.fromkeys(("fall", "descend", "plunge", "plummet", "sink"), (2, -1)),
}
_DIRECTIONS: dict[str, Way] = {"front": (0, 1), "back": (0, -1), "left": (1, 1), "right": (1, -1)}
_AFTER = words.as_set(
    "after along and at before by down for from in into on onto over past then through until when while with"
)
_MOVED = words.as_set("hit kick knock move nudge pull push shove sweep throw toss")
_CONTACTS = words.as_set("collides_with touches pushes")
_CLEAR = 0.3  # share of a velocity along an axis from which on it goes that way


def wrong_way(plan: Plan, demand: Demand, objectives: Sequence[Objective], clauses: Sequence[Clause]) -> str:
    """Why what is named for a verb goes another way than the prompt says; empty where it does not, or none is said.

    Args:
        plan: The plan.
        demand: The verb.
        objectives: Those that clauses name for it.
        clauses: Those, for the velocities that they name.
    """
    said = _way_said(plan, demand)
    if said is None:
        return ""
    word, (axis, sign) = said
    asked = [way for each in objectives for way in _ways(each, axis != 0)]
    asked += _started(plan, clauses) if axis != 0 else ()  # forwards is where it looks, which may be any way
    if (axis, sign) in asked or (axis, -sign) not in asked:
        return ""
    letter = "xyz"[axis]
    return f"'{word}' is along {'+' if sign > 0 else '-'}{letter}, and what is named for it goes the other way"


def stays_there(plan: Plan, demand: Demand) -> str:
    """Why what is pushed off something, or out of it, is asked for no more than the push; empty where it is."""
    read = Words.of(plan.prompt)
    bears = takes_part(plan, demand).bears if demand.base in _MOVED else None
    if bears is None or demand.denied:
        return ""
    rest = range(demand.first + 1, min([*(b for b in read.breaks if b > demand.first), len(read.said)]))
    away = next((read.said[k].text for k in rest if read.said[k].text in ("off", "out")), None)
    about = [each for each in plan.objectives if (involved(each, plan) or bears) & bears]
    if away is None or any(_kinds(each) - _CONTACTS for each in about):
        return ""
    return f"nothing asks that {' or '.join(sorted(bears))} goes {away}: drops, gone_between, rests_on the ground"


def _kinds(objective: Objective) -> set[str]:
    """Its kind, or the predicates of its formula."""
    found = {str(getattr(node, "op", "")) for node, _ in nodes(objective) if isinstance(node, Predicate)}
    return found or {objective.kind}


def _way_said(plan: Plan, demand: Demand) -> tuple[str, Way] | None:
    read = Words.of(plan.prompt)
    for k in range(demand.first + 1, len(read.said)):
        if k in read.breaks or demand.base not in words.GOES:
            break
        text, before = read.said[k].text, text_at(read.said, k - 1)
        aside = text not in ("left", "right") or (before == "the" and text_at(read.said, k - 2) in ("to", "towards"))
        # "to the left of the box" is a place, and so is "to the left wall".
        ends = k + 1 == len(read.said) or k + 1 in read.breaks or text_at(read.said, k + 1) in _AFTER
        if text in WAYS and aside and ends:
            return text, WAYS[text]
    by_itself = _GOES_BY_ITSELF.get(demand.base)
    return None if by_itself is None else (demand.text, by_itself)


def _ways(objective: Objective, of_world: bool) -> Iterator[Way]:
    """Those that an objective asks for, and does not deny; along the world's axes, too, or of directions alone."""
    for node, denied in nodes(objective):
        if denied:
            continue
        fields = dict(node)
        op, direction = str(fields.get("op")), fields.get("direction")
        if op == "drops":
            yield 2, -1
        elif direction in _DIRECTIONS:
            yield _DIRECTIONS[direction]
        elif op == "gone_between" and of_world and fields["of"] is None and fields["low"] * fields["high"] > 0.0:
            yield "xyz".index(fields["axis"]), 1 if fields["low"] > 0.0 else -1


def _started(plan: Plan, clauses: Sequence[Clause]) -> Iterator[Way]:
    """Those of the velocities that clauses name."""
    named = {name for clause in clauses for name, field in clause.things if field in ("velocity", "")}
    for item in plan.objects:
        speed = sum(each * each for each in item.velocity) ** 0.5
        if item.name in named:
            yield from ((axis, 1 if each > 0.0 else -1) for axis, each in enumerate(item.velocity)
                        if abs(each) > _CLEAR * speed > 0.0)  # fmt: skip
