"""Throws over a wall: it stands where the parabola is highest, and what is thrown passes above it."""

from __future__ import annotations

import math

from wsim.defaults import GRAVITY
from wsim.errors import UserError
from wsim.plan.schema import PlanObject, Relation
from wsim.plan.schema.formula_contact import NeverTouches
from wsim.rules.cast import Cast, Thing
from wsim.rules.scenes.catch import reach
from wsim.rules.scenes.lasting import asked
from wsim.rules.scenes.part import Part, tall

CLEAR = 0.2  # between the top of a wall and what passes over it [m]


def clearing(thing: Thing, wall: PlanObject, height: float, speed: float, angle: float) -> tuple[float, float]:
    """Speed [m/s] and angle [deg] of a throw from a height [m] that clears a wall; as given where the prompt says so.

    Raises:
        UserError: The prompt's throw does not come up so far.
    """
    along, up = speed * math.cos(math.radians(angle)), speed * math.sin(math.radians(angle))
    needed = math.sqrt(max(0.0, 2 * GRAVITY * (tall(wall) + CLEAR - height)))
    if up >= needed and up > 0.0:
        return speed, angle
    if thing.speed is not None or thing.angle is not None:
        comes = height + max(up, 0.0) * up / (2 * GRAVITY)
        raise UserError(
            f"{thing.words!r}: the throw comes up to {comes:.2g} m, and {wall.name} is {tall(wall):g} m high; give "
            "more speed or a steeper angle, or leave them out"
        )
    up = math.ceil(100 * needed) / 100
    return round(math.hypot(along, up), 2), round(math.degrees(math.atan2(up, along)), 1)


def stand_below(
    thing: Thing, item: PlanObject, wall: PlanObject, apex: float, direction: str, cast: Cast, part: Part
) -> None:
    """The wall under the highest point of a throw, which is so far from its start [m].

    Raises:
        UserError: The wall would stand across.
    """
    assert thing.over is not None
    if direction not in ("front", "back"):
        raise UserError(f"{thing.words!r}: the builtin planner throws over a wall forward or backward, not to the side")
    deep = wall.size[0] if wall.primitive == "box" else 2 * wall.size[0]
    gap = round(apex - deep / 2 - reach(item), 3)
    if gap <= 0.0:
        raise UserError(f"{thing.words!r}: its highest point is {apex:.2g} m away, too near for {wall.name}")
    rows = [
        Relation(predicate="PLACE-ON-BASE"),
        Relation(predicate="FRONT-OF" if direction == "front" else "BACK-OF", ref=item.name, gap=gap),
        Relation(predicate="ALIGN-CENTER-LR", ref=item.name),
    ]
    part.caught.append(wall.related(rows))
    sentence = f"{item.name} passes over {wall.name} and does not touch it."
    part.objectives.append(asked(item.name, sentence, NeverTouches(object=item.name, ref=wall.name)))
    cast.assume(thing.over.words, f"{gap:g} m from where the throw begins", "there the parabola is highest")
