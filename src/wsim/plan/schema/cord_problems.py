"""What makes the ropes, springs and cables of a plan impossible beside its other parts."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from wsim.limits import TAUT

if TYPE_CHECKING:
    from wsim.plan.schema.cords import Cord
    from wsim.plan.schema.draft import Draft
    from wsim.plan.schema.objects import PlanObject

_NO_ENDS = ("fluid", "ground", "terrain", "scatter")


def cord_problems(plan: Draft) -> Iterator[str]:
    """All of them, each with its path and what would fix it."""
    items = {item.name: item for item in plan.objects}
    for i, cord in enumerate(plan.cords):
        ends = [(field, getattr(cord, field)) for field in ("a", "b") if getattr(cord, field) is not None]
        rounds = [(f"around.{k}.object", each.object) for k, each in enumerate(cord.around or ())]
        unknown = [(field, name) for field, name in (*ends, *rounds) if name not in items]
        for field, name in unknown:
            yield f"cords.{i}.{field}: no object {name!r}; the plan has {', '.join(items) or 'none'}"
        for field, name in () if unknown else ends:
            if items[name].primitive in _NO_ENDS:
                yield f"cords.{i}.{field}: {name} is a {items[name].primitive}; leave it out, and give anchor_{field}"
        for field, name in () if unknown else rounds:
            if items[name].primitive != "cylinder":
                yield f"cords.{i}.{field}: a rope runs round cylinders; {name} is a {items[name].primitive}"
        if not unknown and cord.kind != "cable" and not any(_yields(items[name]) for _, name in ends):
            yield f"cords.{i}: neither of its ends is at a body that it could move; tie it to a dynamic one"
        if not unknown and _apart(cord, items) < TAUT:
            yield f"cords.{i}: both its ends are at one place; give anchor_a or anchor_b, where it is fixed"
        for item in plan.objects:
            if cord.owns(item.name) and item.name != cord.name:
                yield f"cords.{i}.name: {item.name} is one of its links' names; give the object another name"


def _yields(item: PlanObject) -> bool:
    return item.state == "dynamic"


def _apart(cord: Cord, items: dict[str, PlanObject]) -> float:
    """From one end to the other as far as it is known [m]; as good as endless where it is not."""
    places = []
    for name, anchor in ((cord.a, cord.anchor_a), (cord.b, cord.anchor_b)):
        pose = items[name].pose if name is not None else None
        if anchor is None and pose is None:
            return 1e9
        places.append(anchor if anchor is not None or pose is None else pose.position)
    one, other = places
    assert one is not None and other is not None
    return float(sum((x - y) ** 2 for x, y in zip(one, other, strict=True)) ** 0.5)
