"""How fast what hits a thing must be for that to fall over: a block about its edge, a stack off what is below."""

from __future__ import annotations

import math

from wsim.defaults import GRAVITY
from wsim.plan.schema import PlanObject
from wsim.rules.cast import Cast, Thing
from wsim.rules.scenes.part import pair_friction, tall

SPARE = 1.3  # times the speed that just does it
FASTEST = 12.0  # that the planner lets something hit by itself, as one throws by hand [m/s]
HIGH = 0.75  # of its height, that what is to fall over is thrown at


def tipping_speed(item: PlanObject, met: PlanObject, height: float, bounce: float) -> float:
    """The least speed with which something tips a block that it hits at a height above its foot [m/s].

    Its middle is to rise over its edge, with the rate w of m (h^2 + d^2) / 3 w^2 / 2 = m g (sqrt(h^2 + d^2) - h) / 2,
    and the blow's impulse gives that about the edge.
    """
    square, own = tall(met) ** 2 + deep(met) ** 2, met.mass or 1.0
    inertia = own * square / 3
    rate = math.sqrt(own * GRAVITY * (math.sqrt(square) - tall(met)) / inertia)
    return rate * inertia / height * (1 / (item.mass or 1.0) + height**2 / inertia) / (1 + bounce)


def shoving_speed(item: PlanObject, met: PlanObject, above: int, bounce: float) -> float:
    """The least speed with which something drives one of a stack so far that what is above it falls [m/s].

    By half of its depth against that. Friction of what is above and below stops it and takes what is above along: the
    two come to rest against each other at mu g (2 n + 2), with n above.
    """
    slides = math.sqrt(2 * pair_friction(met, met) * GRAVITY * (above + 1) * deep(met))
    return slides * (1 + (met.mass or 1.0) / (item.mass or 1.0)) / (1 + bounce)


def enough(thing: Thing, usual: float, needed: float, cast: Cast) -> float:
    """The speed that the prompt gives, with a warning where that is too low; else one that will do [m/s]."""
    if thing.speed is None and SPARE * needed <= FASTEST:
        return max(usual, math.ceil(10 * SPARE * needed) / 10)
    speed = thing.speed or FASTEST
    if speed < needed:
        choice = f"warning: at {speed:g} m/s it may not knock it over, which takes {needed:.2g} m/s"
        cast.assume(thing.words, choice, "the plan asks for what the prompt says")
    return speed


def deep(item: PlanObject) -> float:
    """A thing's extent along X as it stands [m]."""
    return item.size[0] if item.primitive == "box" else 2 * item.size[0]
