"""Vessels that catch what leaves an edge on the level: where the parabola of its middle comes through the mouth."""

from __future__ import annotations

import math
from dataclasses import dataclass

from wsim.defaults import GRAVITY, WALL
from wsim.errors import UserError
from wsim.plan.schema import Objective, PlanObject
from wsim.plan.schema.formula_place import ContainedIn
from wsim.rules.cast import Cast, Thing
from wsim.rules.scenes.lasting import asked
from wsim.rules.scenes.part import fall_time

AT_ONCE = 1.5  # times g r: of the square of the speed at which a ball's middle leaves an edge without turning round it
DULL = 0.05  # restitution of what lands in a vessel
CLEAR = 0.03  # between the edge and the vessel [m]


@dataclass
class Caught:
    """A vessel; how far its near side and its middle are from the edge [m], and the speed there [m/s]."""

    vessel: PlanObject
    gap: float
    way: float
    speed: float


def catcher(
    thing: Thing, vessel: PlanObject, item: PlanObject, speed: float | None, height: float, cast: Cast
) -> Caught:
    """Where the vessel is for what leaves an edge.

    Args:
        thing: What comes.
        vessel: What catches it.
        item: The object that comes.
        speed: Of it, on the level [m/s]; None for the least that will do.
        height: Of the edge above the vessel's floor [m].
        cast: What the prompt speaks of.

    Raises:
        UserError: The vessel is as high as the edge, or would be under it.
    """
    assert thing.into is not None
    rim = vessel.size[2] + WALL
    drop = height - rim
    if drop < reach(item):
        raise UserError(
            f"{thing.into.words!r}: its rim is {rim:.2g} m high, too near to the edge at {height:.2g} m; take a lower "
            "one"
        )
    time, half = fall_time(drop), vessel.size[0] / 2 + WALL
    least = max(math.sqrt(AT_ONCE * GRAVITY * reach(item)), (half + CLEAR) / time)
    at = speed if speed is not None else math.ceil(100 * least) / 100
    way = at * time
    if way < half:
        raise UserError(
            f"{thing.words!r}: at {at:.2g} m/s it falls {way:.2g} m from the edge, too near; give more speed"
        )
    choice = f"its middle {way:.3g} m from the edge"
    cast.assume(thing.into.words, choice, f"there a parabola at {at:.3g} m/s comes through its mouth")
    deaden(thing, thing.into, cast)
    return Caught(vessel, round(way - half, 3), round(way, 3), at)


def deaden(thing: Thing, vessel: Thing, cast: Cast) -> None:
    """A vessel that gives way, so that what lands in it stays there, where the prompt says nothing of that."""
    if thing.said("restitution", vessel) is None:
        thing.pairs.append((vessel, "restitution", DULL))
        cast.assume(thing.words, f"a restitution of {DULL:g} in {vessel.words}", "so that it does not bounce out again")


def reach(item: PlanObject) -> float:
    """From its middle to what it stands on [m]."""
    if item.primitive == "sphere" or item.relation("LIES-ALONG-Y") is not None:
        return item.size[0]
    return item.size[-1] / 2


def lands(name: str, vessel: str) -> Objective:
    """It ends in a vessel."""
    return asked(name, f"{name} lands in {vessel}.", ContainedIn(object=name, ref=vessel))
