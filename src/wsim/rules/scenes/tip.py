"""What topples with nothing that hits it: a push tips it."""

from __future__ import annotations

import math

from wsim.defaults import GRAVITY
from wsim.errors import UserError
from wsim.plan.schema import PlanObject, Proxy, Relation
from wsim.rules.cast import Cast, Thing
from wsim.rules.scenes.knock import deep
from wsim.rules.scenes.part import Part, tall, tidy

SPARE = 2.0  # of the energy that lifts the middle over the edge, which the push gives
SLIM, SLENDER, HIGHER = 2.0, 6.0, 1.5  # height against depth of what is made to fall over; against its usual extent
SLIMMEST = 1.3  # height against depth, below which a thing slides or rocks back rather than tips


def tipped(thing: Thing, made: list[PlanObject], part: Part, cast: Cast) -> list[PlanObject]:
    """The things with the start of a fall to +X: of a stack all as one, of a row the first, which takes the next along.

    Raises:
        UserError: A row of them is too low for one to reach and tip the next; or they are round.
    """
    made = [upended(item) for item in made] if thing.arrangement != "stack" else made
    if any(item.primitive not in ("box", "cylinder") for item in made) or thing.noun.lies:
        raise UserError(
            f"{thing.words!r}: the builtin planner tips boxes and what stands upright; say what else hits it"
        )
    falling = made if thing.arrangement == "stack" else made[:1]
    height, depth = sum(tall(item) for item in falling), deep(made[0])
    if height < SLIMMEST * depth:
        raise UserError(
            f"{thing.words!r}: {height:.3g} m high and {depth:.3g} m deep, it does not topple by itself; say what hits "
            "it, or give taller things"
        )
    rate = _rate(height, depth)
    pushed, bottom = [], 0.0
    for item in falling:
        pushed.append(_turning(item, rate, depth / 2, bottom + tall(item) / 2))
        bottom += tall(item)
    what = "all of it as one, " if thing.arrangement == "stack" else "the first one alone, " if len(made) > 1 else ""
    why = f"the prompt does not say what topples it; {SPARE:g} times the energy that tips it over its edge"
    cast.assume(thing.words, f"a push to +X, {what}{math.degrees(rate):.3g} degrees a second about its lower edge", why)
    part.goes[made[-1].name] = [(round(height, 3), 0.0, -height)]
    return [*pushed, *made[len(falling) :]]


def slender(thing: Thing, item: PlanObject, cast: Cast) -> PlanObject:
    """A box or a cylinder that is to fall over, and whose size is open: high enough for its depth to do so."""
    said = thing.phrase.length or thing.phrase.measures.keys() - {"mass", "density"} or thing.phrase.edges
    if said or thing.noun.asset is not None or item.primitive not in ("box", "cylinder") or thing.noun.lies:
        return item
    if tall(item) >= SLIM * deep(item):
        return item
    high = round(HIGHER * max(item.size), 3)
    thin = round(high / SLENDER, 3)
    size = (thin, item.size[1], high) if item.primitive == "box" else (thin / 2, high)
    cast.assumptions = [one for one in cast.assumptions if one.subject != thing.words or " x " not in one.choice]
    choice = " x ".join(f"{edge:g}" for edge in size) + " m"
    cast.assume(thing.words, choice, "high against its depth, or it would slide rather than fall over")
    return item.model_copy(update={"construction": Proxy(primitive=item.primitive, size=size)})


def upended(item: PlanObject) -> PlanObject:
    """A plank, a book or the like on its end: its longest edge upright, its shortest along X."""
    if item.primitive != "box" or item.size[2] >= max(item.size[:2]):
        return item
    thin, middle, long = sorted(item.size)
    size = (thin, middle, long)
    return item.model_copy(update={"construction": Proxy(primitive="box", size=size)})


def on_side(item: PlanObject, thing: Thing) -> PlanObject:
    """A cylinder, or what stands upright, on its side.

    Raises:
        UserError: It has no side to lie on.
    """
    if item.primitive in ("cylinder", "capsule"):
        return item.related([Relation(predicate="LIES-ALONG-Y")])
    if item.primitive != "box":
        raise UserError(f"{thing.words!r}: a ball has no side to lie on")
    x, y, z = item.size
    return item.model_copy(update={"construction": Proxy(primitive="box", size=(z, y, x))})


def _rate(height: float, depth: float) -> float:
    """The rate of turning about an edge from which a block tips over [rad/s].

    Its middle is to rise by r - h / 2, with r^2 = (h^2 + d^2) / 4, and its moment about the edge is m (h^2 + d^2) / 3.
    """
    square = height**2 + depth**2
    lift = (math.sqrt(square) - height) / 2
    return math.sqrt(SPARE * 2 * GRAVITY * lift / (square / 3))


def _turning(item: PlanObject, rate: float, ahead: float, up: float) -> PlanObject:
    """The object as part of what turns about an edge `ahead` of its middle and `up` below it."""
    velocity = (tidy(rate * up), 0.0, tidy(rate * ahead))
    spin = (0.0, tidy(math.degrees(rate)), 0.0)
    return item.model_copy(update={"velocity": velocity, "angular_velocity_deg": spin})
