"""Whether an objective asks for something as often as the prompt says."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from wsim.plan.asked.nodes import nodes
from wsim.plan.schema.formula import VOCABULARY, Eventually, Finally, Ordered, Then, Until

if TYPE_CHECKING:
    from wsim.plan.schema import Objective

TURN = 360.0  # [deg]
_RETURNS = ("climbs_to", "bounces_to", "swings", "dies_down", "follows_path", "counts")
_ENDS = ("rests_on", "settles", "floats", "topples", "moves")  # kinds that are asked at the end


def asks_often(objective: Objective, times: float) -> bool:
    """Whether it has an event that comes so many times, one after another; or as many turns."""
    for node, denied in nodes(objective):
        low, high = getattr(node, "low", None), getattr(node, "high", None)
        turns = str(getattr(node, "op", "")) == "turned_between" and low is not None and high is not None
        if turns and any(low <= way <= high for way in (TURN * times, -TURN * times)):  # type: ignore[operator]
            return True
        if isinstance(node, Then) and not denied and _most(node) >= times:
            return True
    return False


def _most(node: Then) -> int:
    """How often its commonest event comes; of those that all differ, how many there are."""
    seen = Counter(event.model_dump_json() for event in node.events)
    commonest = max(seen.values())
    return len(node.events) if commonest == 1 else commonest


def asks_exactly(objective: Objective) -> bool:
    """Whether it denies that events come one after another: that there is one time more."""
    return any(isinstance(node, Then) and denied for node, denied in nodes(objective))


def asks_again(objective: Objective) -> bool:
    """Whether it asks for what comes after something else: in an order, from some time on, or at the end."""
    if objective.formula is None:
        return objective.kind in _RETURNS + _ENDS
    top = objective.formula
    kind = VOCABULARY.get(str(getattr(top, "op", "")))
    if kind is not None and kind.alone.startswith("finally"):
        return True
    for node, _ in nodes(objective):
        if isinstance(node, Finally) or str(getattr(node, "op", "")) in _RETURNS:
            return True
    return asks_order(objective)


def asks_order(objective: Objective) -> bool:
    """Whether it asks for one thing after another, or from some time on."""
    for node, _ in nodes(objective):
        window = getattr(node, "window", None)
        if isinstance(node, Then | Ordered | Until) or (window is not None and window[0] > 0.0):
            return True
    return any(isinstance(node, Eventually) and isinstance(of, Eventually) for node, _ in nodes(objective)
               for of in node.parts())  # fmt: skip
