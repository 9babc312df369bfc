"""The plan's kinds of objective: each is a formula of the language, made of the objective's object, ref and numbers.

Kinds are short for what is asked most. What a kind means is written here and nowhere else; the numbers that an
objective leaves open are those of the predicates.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.evidence.recorded import MissingError
from wsim.judge.language import python as say
from wsim.plan.schema.formula import Finally, Formula

if TYPE_CHECKING:
    from wsim.judge.evidence.evidence import Evidence
    from wsim.plan.schema import Objective

    Macro = Callable[[Objective, Evidence], Formula]

TIPPED = 45.0  # [deg]: what leans farther comes down
HIGHER = 1.04  # of the height that a swing starts from: 2 % of its amplitude, as a height goes with its square
REST = 0.5  # [s] at the end, over which what has come to rest is still


def formula_of(objective: Objective, evidence: Evidence) -> Formula:
    """What an objective of a plan says; MissingError where it lacks something that it needs."""
    if objective.formula is not None:
        return objective.formula
    return KINDS[objective.kind](objective, evidence)


def _ref(asked: Objective) -> str:
    if asked.ref is None:
        raise MissingError(f'"{asked.kind}" needs another object, and the plan names none')
    return asked.ref


def _within(asked: Objective) -> float | None:
    return asked.tolerance or None


def _stays_inside(asked: Objective, evidence: Evidence) -> Formula:
    fluid = any(each.prim == evidence.prim(asked.object) for each in evidence.world.fluids)
    room = {} if asked.tolerance is None else {"share": asked.tolerance} if fluid else {"within": asked.tolerance}
    return say.stays_inside(asked.object, _ref(asked), **room)


def _rests_on(asked: Objective, evidence: Evidence) -> Formula:
    lies = say.mean(say.lies_on(asked.object, _ref(asked), _within(asked)))
    recording = evidence.recording
    if recording.contacts is None and not np.any(recording.contact_force):  # not recorded
        return lies
    return lies & say.mean(say.weighs_on(asked.object, _ref(asked)))


def _topples(asked: Objective, evidence: Evidence) -> Formula:
    fallen = say.mean(say.drops(asked.object))
    shapes = evidence.body(evidence.prim(asked.object)).shapes
    if all(shape.kind == "sphere" for shape in shapes):  # it has no upright
        return fallen
    upright = say.upright(asked.object, TIPPED)
    return say.eventually(~upright) & (~say.mean(upright) | fallen)


def _swings(asked: Objective, evidence: Evidence) -> Formula:
    return say.swings(asked.object) & ~say.climbs_to(asked.object, HIGHER)


def _slides(asked: Objective, evidence: Evidence) -> Formula:
    return _goes(asked) & ~say.rolls(asked.object, asked.ref)


def _rolls_down(asked: Objective, evidence: Evidence) -> Formula:
    body = evidence.body(evidence.prim(asked.object))
    rolls = say.goes_down(asked.object, _ref(asked), asked.value) & say.rolls(asked.object, asked.ref)
    ball = len(body.shapes) == 1 and body.shapes[0].kind == "sphere"
    return rolls & say.rolls_freely(asked.object, asked.ref) if ball and not any(body.velocity) else rolls


def _goes(asked: Objective) -> Formula:
    """Down the slope of another object, at some time: it may come back from what it hits; else where it ends."""
    if asked.ref is not None and asked.kind != "moves":
        return say.goes_down(asked.object, asked.ref, asked.value)
    return Finally(seconds=0.0, of=say.moves(asked.object, asked.value, asked.direction))


KINDS: dict[str, Macro] = {
    "floats": lambda asked, _: say.mean(say.floats(asked.object, _ref(asked), _within(asked))),
    "submerged": lambda asked, _: say.submerged(asked.object, _ref(asked), asked.tolerance or 0.0),
    "stays_inside": _stays_inside,
    "fills": lambda asked, _: say.mean(
        say.fills(asked.object, _ref(asked), *([1.0 - asked.tolerance] if asked.tolerance else []))
    ),
    "rests_on": _rests_on,
    "stays_on": lambda asked, _: say.stays_on(asked.object, _ref(asked), _within(asked)),
    "settles": lambda asked, _: say.mean(say.settles(asked.object, _within(asked)), REST),
    "topples": _topples,
    "moves": lambda asked, _: _goes(asked),
    "slides": _slides,
    "rolls_down": _rolls_down,
    "flies": lambda asked, _: say.flies(asked.object) & say.falls_freely(asked.object, _within(asked)),
    "collides_with": lambda asked, _: say.collides_with(asked.object, _ref(asked)),
    "swings": _swings,
    "tilts": lambda asked, _: say.tilts_to(asked.object, _ref(asked), *([asked.tolerance] if asked.tolerance else [])),
}
