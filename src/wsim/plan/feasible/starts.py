"""Where things start: what is to stay somewhere starts there, and what is pushed off a table stands on it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from wsim.errors import UserError
from wsim.plan.asked.demands import demands
from wsim.plan.asked.tokens import tokens
from wsim.plan.feasible.asked import Said, said
from wsim.plan.layout.bodies import around
from wsim.plan.layout.boxes import Box

if TYPE_CHECKING:
    from wsim.plan.schema import Plan, PlanObject

NEAR = 0.03  # [m]: it falls no farther before it is there
_PUSHED = ("push", "knock", "shove", "nudge", "kick", "sweep")
_HOLDS = ("stays_inside", "contained_in", "fills", "level_in", "counts")
_SOLID = ("box", "sphere", "cylinder", "capsule", "ground", "terrain")
_UNBOUNDED = ("ground", "terrain", "scatter", "fluid", "robot", "vehicle")


def start_faults(plan: Plan) -> Iterator[str]:
    """All of them."""
    items = {item.name: item for item in plan.objects}
    for each in said(plan):
        yield from _inside(each, items)
        if each.name not in ("stays_on", "stays_inside") or not each.throughout or each.denied:
            continue
        one, other = items.get(each.object or ""), items.get(each.ref or "")
        if one is None or other is None or one.state != "dynamic":
            continue
        apart = _apart(one, other, level=each.name == "stays_inside")
        if apart is not None and apart > NEAR:
            yield (
                f"{each.where}: {each.name}: {one.name} starts {apart:.2g} m from {other.name}, and it is to be there "
                f"all the time; place it there, or ask for the end: rests_on, finally (touches({one.name}, "
                f"{other.name}))"
            )
    yield from _pushed_off(plan)


def _inside(each: Said, items: dict[str, PlanObject]) -> Iterator[str]:
    """In what is solid there is nothing."""
    other = items.get(each.ref or "")
    if each.name in _HOLDS and other is not None and other.primitive in _SOLID:
        yield (
            f"{each.where}: {each.name} {other.name}, which is a solid {other.primitive} and has no hollow; name a "
            "tank, or a vessel of the catalogue"
        )


def _pushed_off(plan: Plan) -> Iterator[str]:
    """ "Pushed off a table": something that moves starts on it."""
    spoken = [token.text for token in tokens(plan.prompt) if not token.stops]
    for verb in (each for each in demands(plan.prompt) if each.base in _PUSHED):
        after = spoken[verb.last + 1 : verb.last + 9]
        if "off" not in after:
            continue
        noun = after[after.index("off") + 1 :]
        carrier = next(
            (item for item in plan.objects if item.name in noun and item.primitive not in _UNBOUNDED), None
        )  # fmt: skip
        if carrier is None or any(_stands_on(item, carrier) for item in plan.objects):
            continue
        if all(_apart(item, carrier) is None for item in plan.objects if item.state == "dynamic"):
            continue
        yield (
            f"objects: the prompt has something {verb.text} off {carrier.name}, and nothing that moves starts on it; "
            f"place it there: PLACE-ON {carrier.name}"
        )


def _stands_on(item: PlanObject, carrier: PlanObject) -> bool:
    apart = _apart(item, carrier)
    return item is not carrier and item.state == "dynamic" and apart is not None and apart <= NEAR


def _apart(one: PlanObject, other: PlanObject, level: bool = False) -> float | None:
    """How far the boxes round two things are apart at the start [m], not positive where they meet; None: unknown.

    On the level alone what is over the other is not apart from it: what drops into a bowl is between its walls.
    """
    if {one.primitive, other.primitive} & set(_UNBOUNDED) or one.pose is None or other.pose is None:
        return None
    try:
        a, b = around(one), around(other)
        if level and a.low[2] > b.low[2]:
            a = Box((*a.low[:2], b.low[2]), (*a.high[:2], b.high[2]))
        return -a.overlap(b)
    except UserError:  # what only the catalogue knows
        return None
