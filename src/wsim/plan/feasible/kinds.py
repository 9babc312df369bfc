"""Predicates of what cannot have them: of a box that rolls, of three where there is one, of what meets itself."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from wsim.plan.feasible.asked import Said, said

if TYPE_CHECKING:
    from wsim.plan.schema import Plan, PlanObject

_ROLLS = ("rolls_without_slip", "rolls_freely")  # a die that tumbles rolls down, too
_DOWN = ("rolls_down", "rolls_freely", "goes_down")
_WITH_ANOTHER = ("touches", "never_touches", "collides_with", "pushes", "rests_on", "lies_on", "stays_on", "bounces_to",
                 "contained_in", "stays_inside", "weighs_on", "stops_before")  # fmt: skip


_LOOSE = {  # what is as loose as this holds of anything
    "upright": ("within", 90.0, "deg"), "settles": ("speed", 1.0, "m/s"), "touches": ("within", 1.0, "m"),
    "rests_on": ("within", 1.0, "m"), "lies_on": ("within", 1.0, "m"), "stays_on": ("within", 1.0, "m"),
}  # fmt: skip
_LITTLE = {"moves": ("least", 1e-4, "m"), "drops": ("share", 0.01, "of its height")}


def kind_faults(plan: Plan) -> Iterator[str]:
    """All of them."""
    items = {item.name: item for item in plan.objects}
    tied = {name for joint in plan.joints for name in (joint.child, joint.parent)}
    tied |= {name for cord in plan.cords for name in (cord.a, cord.b)}
    for each in said(plan):
        item = items.get(each.object or "")
        why = "" if each.denied or each.optional else _cannot(each, item, items, tied)
        if why:
            yield f"{each.where}: {each.name}{f' of {each.object}' if item is not None else ''}: {why}"


def _cannot(each: Said, item: PlanObject | None, items: dict[str, PlanObject], tied: set[str | None]) -> str:
    """Why it cannot be, and the way out; empty where it may."""
    if each.name == "counts" and each.fields["least"] > len(each.fields["objects"]):
        return f"{each.fields['least']:g} of the {len(each.fields['objects'])} that it names; name more, or count fewer"
    if item is None:
        return ""
    if each.name in _WITH_ANOTHER and each.ref == each.object:
        return "it is said of a thing and itself; name another"
    for table, sign in ((_LOOSE, 1.0), (_LITTLE, -1.0)):
        field, limit, unit = table.get(each.name, ("", 0.0, ""))
        value = each.fields.get(field)
        if value is not None and sign * value >= sign * limit:
            return (
                f"{field} {value:g} {unit} holds of anything; ask for {'less' if sign > 0 else 'more'} than {limit:g}"
            )
    on = items.get(each.ref or "")
    if each.name in _ROLLS and item.primitive == "box" and not item.assembled and item.name not in tied:
        return "a box does not roll; take a sphere, a capsule or a cylinder, or ask that it slides"
    if each.name in _DOWN and on is not None and on.primitive == "ground":
        return f"{on.name} is level, and nothing goes down it; name what slopes"
    if each.name == "swings" and item.name not in tied and not item.assembled:
        return "nothing holds it; hang it on a joint or a cord"
    return ""
