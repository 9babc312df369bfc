"""A plan whose clauses are found from its prompt's words: for planners that know no clauses of their own."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from wsim.plan.asked.demands import REQUIRED, Demand, demands
from wsim.plan.asked.doers import outsiders
from wsim.plan.asked.often import asks_often
from wsim.plan.asked.shown import SHOWN_BY, shows, shows_not
from wsim.plan.asked.stated import FIELDS, asks, asks_by_then, close, of_opening, states, values
from wsim.plan.asked.tokens import tokens
from wsim.plan.asked.vocabulary import CAUSES, OPENED, SCHEDULED, stem
from wsim.plan.schema.clause import OF_JOINTS, WHOLE, Clause

if TYPE_CHECKING:
    from wsim.plan.schema import Plan, PlanObject

UNASKED = "no objective of the plan asks for it"
UNFOUND = "no number that the plan states is this one"
_STILL = ("to rest", "to a stop", "to a halt", "to a standstill")
_LIES = "rests_on stays_on stays_inside stays_within contained_in lies_on supported_by settles upright"
_STATES = dict.fromkeys(("lie", "sit", "rest", "stand"), frozenset(_LIES.split())) | {"weigh": frozenset[str]()}
_WITHOUT_UNIT = ("friction", "restitution", "rolling")


def tied(plan: Plan) -> Plan:
    """The plan with a clause for each demand of its prompt: what happens, is so, or is a number.

    A verb is tied to the objectives that can show it, a number to the objective or property that has it; what neither
    is found for is said to be unchecked.
    """
    found = [_clause(plan, demand) for demand in demands(plan.prompt) if demand.kind in REQUIRED]
    return plan.model_copy(update={"clauses": found})


def _clause(plan: Plan, demand: Demand) -> Clause:
    by: list[int | str] = [] if demand.kind == "beyond" else list(evidence(plan, demand))
    if by:
        return Clause(words=demand.text, by=by)
    return Clause(words=demand.text, unchecked=UNFOUND if demand.kind == "number" else UNASKED)


def evidence(plan: Plan, demand: Demand) -> Iterator[int | str]:
    """What of a plan shows a demand of its prompt: objectives by number, things and their properties by name."""
    if demand.kind == "number":
        yield from _of_number(plan, demand)
        return
    if demand.denied:
        yield from (k for k, each in enumerate(plan.objectives) if shows_not(each, demand.base))
        return
    base = _base(plan, demand)
    shown = SHOWN_BY.get(base, _STATES.get(base))
    numbers = [k for k, each in enumerate(plan.objectives) if shown is None or shows(each, shown)]
    if base in _STATES:  # that the water stays in its tank is not that something lies there
        fluids = {item.name for item in plan.objects if item.state == "fluid"}
        numbers = [k for k in numbers if plan.objectives[k].object not in fluids]
    if demand.kind == "verb":  # what is asked of others than it is said of shows nothing
        numbers = [k for k in numbers if not outsiders(plan, demand, [plan.objectives[k]], some=True)]
    yield from numbers
    if not numbers and demand.base in CAUSES:
        for item in plan.objects:
            fields = {"velocity": any(item.velocity), "surface_velocity": bool(item.surface_velocity)}
            fields |= {"spin": bool(item.angular_velocity_deg), "actuation": bool(item.registration.actuation)}
            yield from (f"{item.name}.{field}" for field, has in fields.items() if has)
        yield from (f"{joint.name}.drive" for joint in plan.joints if joint.drive is not None)
    opened = [each.name for each in plan.openings if each.start or each.stop]
    if not numbers and demand.base in OPENED and opened:
        yield from opened
    elif not numbers and demand.base in SCHEDULED and plan.schedules:
        yield from (schedule.name for schedule in plan.schedules)
    elif not numbers and demand.kind == "state" and base == demand.base:
        yield from (item.name for item in plan.objects if item.primitive != "ground")


def _base(plan: Plan, demand: Demand) -> str:
    """A verb as it is meant: "comes to rest" is one verb of two words that would each be another alone."""
    said = [token.text for token in tokens(plan.prompt) if not token.stops]
    k = demand.first - (demand.base == "rest" and said[demand.first - 1 : demand.first] == ["to"]) * len(("to", "come"))
    comes = k >= 0 and stem(said[k]) == "come" and " ".join(said[k + 1 : k + 4]).startswith(_STILL)
    return "stop" if comes and demand.base in ("come", "rest", "stop", "halt") else demand.base


def _of_number(plan: Plan, demand: Demand) -> Iterator[int | str]:
    placed = ("place",) if demand.unit in ("m", "deg") else ()
    fields = (*FIELDS.get(demand.unit, ()), *placed) if demand.unit else _WITHOUT_UNIT
    for item in plan.objects:
        field = next((f for f in fields if any(close(value, demand) for value in values(plan, item.name, f))), None)
        if field is not None:
            yield f"{item.name}.{field}"
    for joint in plan.joints:
        for field in OF_JOINTS[1:]:
            if any(close(value, demand) for value in values(plan, joint.name, field)):
                yield f"{joint.name}.{field}"
    for cord in plan.cords if demand.unit == "m" else ():
        if close(cord.length or 0.0, demand):
            yield f"{cord.name}.length"
    for opening in plan.openings if demand.unit else ():
        if field := of_opening(plan, opening, demand):
            yield f"{opening.name}.{field}"
    for schedule in plan.schedules if demand.unit else ():
        if states(plan, schedule.name, "", demand):
            yield schedule.name
    if demand.unit:
        has = asks_by_then if demand.bound else asks
        yield from (k for k, each in enumerate(plan.objectives) if has(each, demand))
    else:
        named = [item.name for item in plan.objects if _counted(item, demand)]
        if demand.often:
            yield from (k for k, each in enumerate(plan.objectives) if asks_often(each, demand.value or 0.0))
        else:
            yield from named or _as_many(plan, demand) or _doing_so(plan, demand)
    if demand.unit == "s" and close(plan.simulation.duration, demand):
        yield f"{WHOLE}.duration"


def _counted(item: PlanObject, demand: Demand) -> bool:
    words = [token.text for token in tokens(item.words)]
    return any(token.text in words for token in tokens(demand.text))


def _doing_so(plan: Plan, demand: Demand) -> list[str]:
    """Things of which the verb right behind a number is asked, if they are as many: "the first two float"."""
    said = [token.text for token in tokens(plan.prompt) if not token.stops][demand.last + 1 : demand.last + 3]
    base = next((base for text in said if (base := stem(text)) in SHOWN_BY), None)
    fluids = {item.name for item in plan.objects if item.state == "fluid"}
    asked = [each.object for each in plan.objectives if base and shows(each, SHOWN_BY[base])]
    found = dict.fromkeys(name for name in asked if name not in fluids)
    return list(found) if len(found) == demand.value else []


def _as_many(plan: Plan, demand: Demand) -> list[str]:
    """Things of one kind, numbered, that are as many."""
    kinds: dict[str, list[str]] = {}
    for item in plan.objects:
        stem, _, number = item.name.rpartition("_")
        if number.isdigit():
            kinds.setdefault(stem, []).append(item.name)
    return next((names for names in kinds.values() if len(names) == demand.value), [])
