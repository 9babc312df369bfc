"""Fluids: what may be asked of one, and numbers of one that nothing takes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from wsim.plan.feasible.asked import Said, said
from wsim.plan.templates import expand_row, is_block

if TYPE_CHECKING:
    from wsim.plan.schema import Plan, PlanObject

_AS_OBJECT = ("stays_inside", "fills", "conserves")  # what a fluid may be the object of
_AS_REF = ("floats", "submerged", "tilts")
_LEVEL = ("floats", "sinks", "submerged", "fills_to")  # what needs a surface, which a container gives
_PLACES = ("target", "center", "of", "on")
WAY_OUT = (
    "ask stays_inside(water, tank), fills(water, vessel), level_in(water, vessel, 0.2 m), swirls_between or conserves"
)
OVERRIDDEN = 1e-6  # [m]


def fluid_faults(plan: Plan) -> Iterator[str]:
    """All of them."""
    fluids = {item.name: item for item in plan.objects if item.primitive == "fluid"}
    for number, item in enumerate(plan.objects):
        if item.primitive == "fluid":
            yield from _itself(plan, number, item)
    for each in said(plan):
        yield from _asked(each, fluids)


def _itself(plan: Plan, number: int, item: PlanObject) -> Iterator[str]:
    """A free fluid has a place; of one in a container that gives the sides, and a free surface the height."""
    if item.pose is None and item.relation("PLACE-IN") is None:
        yield (
            f"objects.{number}: {item.name} is in no tank, and has no place beside objects that have positions; give "
            'it a "position" too'
        )
    items = {each.name: each for each in plan.objects}
    if is_block(item, items):
        return
    rows = {row.predicate: row for relation in item.relations for row in expand_row(item, relation, items)}
    held, level = rows.get("PLACE-IN"), rows.get("FREE-SURFACE-AT")
    tank = items.get(held.ref or "") if held is not None else None
    if tank is None or not tank.size or level is None or level.value is None or not item.size:
        return
    given = (*tank.size[:2], level.value)
    if any(abs(a - b) > OVERRIDDEN for a, b in zip(item.size, given, strict=False)):
        own, made = (" x ".join(f"{edge:g}" for edge in edges) for edges in (item.size, given))
        yield (
            f"objects.{number}.construction.size: {own} m of {item.name}, which its level and {tank.name} make {made} "
            "m; leave the size out, or keep PLACE-IN alone, so that a block of it starts in the tank"
        )


def _asked(each: Said, fluids: dict[str, PlanObject]) -> Iterator[str]:
    if each.object in fluids and each.name not in _AS_OBJECT:
        yield f"{each.where}: {each.name} of {each.object}, which is a fluid and has no centre; {_way_out(each)}"
    if each.ref in fluids and each.name not in _AS_REF:
        yield f"{each.where}: {each.name} {each.ref}, which is a fluid; ask floats, sinks or submerged of what is in it"
    for field in _PLACES:
        if isinstance(name := each.fields.get(field), str) and name in fluids:
            yield f"{each.where}: {field} {name} of {each.name} is a fluid and has no centre; give a point, or a body"
    surface = each.fields.get("fluid") or (each.ref if each.name in ("floats", "submerged") else None)
    if each.name in _LEVEL and surface in fluids and fluids[surface].relation("PLACE-IN") is None:
        fluid = fluids[surface]
        if not any(row.spec.fills for row in fluid.relations):
            yield (
                f"{each.where}: {each.name}: {surface} is in no tank and has no surface; put it in one (PLACE-IN, "
                "FREE-SURFACE-AT), or ask what a free fluid can: fills(water, vessel), swirls_between, conserves"
            )


def _way_out(each: Said) -> str:
    return WAY_OUT.replace("water", str(each.object))
