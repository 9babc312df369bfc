"""What bounces, and what a prompt says of surfaces and pairs: contacts, where the materials have it otherwise."""

from __future__ import annotations

import math
from itertools import combinations_with_replacement

from wsim.plan.schema import Contact, Objective, Plan, PlanObject
from wsim.plan.schema.formula import Then
from wsim.plan.schema.formula_contact import CollidesWith
from wsim.rules.cast import Cast, Thing
from wsim.rules.places import SURFACES
from wsim.rules.scenes.lasting import asked, to_and_fro
from wsim.rules.scenes.motion import item_of, top
from wsim.rules.scenes.part import Part, fall_time

HARDLY = 0.2  # a restitution below which a ball that falls from 0.5 m comes up by 2 cm
QUICK = 60.0  # pictures a second, so that each bounce that is counted is seen [1/s]
SEEN = 3  # bounces that one looks at


def bounces(thing: Thing) -> bool:
    """Whether a ball that drops is to come up again: it is said to, or its restitution is."""
    return "drop" in thing.does and thing.round and ("bounce" in thing.does or bool(_told(thing)))


def _told(thing: Thing) -> float | None:
    return thing.said("restitution", thing.support)


def bounce(thing: Thing, item: PlanObject, on: PlanObject, part: Part, cast: Cast) -> list[Objective]:
    """That it comes off what it falls on as fast as the restitution has it; the time of its first bounces is noted."""
    value = returned(thing, item, on, None if thing.off else thing.support, cast)
    lead, time = _comes_down(thing, item, part)
    if value < HARDLY:
        choice = f"warning: with a restitution of {value:g} it comes up to {value**2:.1%} of its height"
        cast.assume(thing.words, choice, "the plan asks for what the prompt says")
    seen = max(SEEN, thing.times or 0)
    part.frame_rate = max(part.frame_rate, QUICK if thing.times else 0.0)
    part.duration = max(
        part.duration, round(lead + time * (1 + 2 * sum(value**k for k in range(1, seen + 1))) + 0.5, 1)
    )
    sentence = f"{item.name} bounces off {on.name} with a restitution of {value:g}."
    formula = CollidesWith(object=item.name, ref=on.name, restitution=value)
    often = []
    if thing.times is not None and thing.times > 1:
        again = Then(
            events=(CollidesWith(object=item.name, ref=on.name),) * thing.times, windows=(None,) * (thing.times - 1)
        )
        often.append(asked(item.name, f"{item.name} bounces off {on.name} {thing.times} times.", again))
    return [asked(item.name, sentence, formula), *often, *to_and_fro(thing, item.name, "z", value**2, cast)]


def _comes_down(thing: Thing, item: PlanObject, part: Part) -> tuple[float, float]:
    """How long it goes along what it leaves, and how long it then falls for [s]."""
    if not thing.off or thing.support is None:
        return 0.0, fall_time(thing.drop_height or 0.0)
    carrier = item_of(part.names[id(thing.support)][-1], part)
    return max(carrier.size[:2]) / 2 / max(math.hypot(*item.velocity), 0.1), fall_time(top(carrier.name, part))


def returned(thing: Thing, item: PlanObject, on: PlanObject, other: Thing | None, cast: Cast) -> float:
    """The restitution of a ball and what it bounces off: the prompt's; else the ball's, which gives way the more."""
    told = thing.said("restitution", other)
    if told is not None:
        return told
    value = item.material.restitution if item.material is not None else 0.0
    name = item.material.name if item.material is not None else item.name
    cast.assume(thing.words, f"bounces off {on.name} with a restitution of {value:g}", f"that of {name}")
    thing.pairs.append((other, "restitution", value))
    return value


def restitution(a: PlanObject, b: PlanObject) -> float:
    """Of two things by their materials: the smaller of those that are stated, as `wsim.scene.contact` has it."""
    return min((o.material.restitution for o in (a, b) if o.material is not None and o.material.restitution), default=0)


def contacts(cast: Cast, names: dict[int, list[str]], plan: Plan) -> list[Contact]:
    """A contact for each pair whose friction or restitution the prompt gives, and whose materials give another."""
    made = []
    for first, second in combinations_with_replacement([*cast.things, None], 2):
        if first is None:
            continue
        for one in names.get(id(first), []):
            for other in ["ground"] if second is None else names.get(id(second), []):
                a, b = plan.object(one), plan.object(other)
                given = _given(first, second, a, b)
                if (
                    given
                    and one != other
                    and not a.state == b.state == "static"
                    and (first is not second or one < other)
                ):
                    made.append(Contact(object=one, ref=other, **given))
    return made


def _given(first: Thing, second: Thing | None, a: PlanObject, b: PlanObject) -> dict[str, float]:
    if a.material is None or b.material is None:
        by_materials = {}
    else:
        by_materials = {"friction": min(a.material.friction, b.material.friction), "restitution": restitution(a, b)}
    said = {name: first.said(name, second) for name in (*SURFACES, "rolling")}
    return {name: value for name, value in said.items() if value is not None and value != by_materials.get(name)}
