"""What a prompt asks of how things go on: that they die down, come up again, turn, lean, or stop before others."""

from __future__ import annotations

from wsim.errors import UserError
from wsim.plan.schema import Objective
from wsim.plan.schema.formula import Eventually, Formula
from wsim.plan.schema.formula_contact import StopsBefore
from wsim.plan.schema.formula_motion import ClimbsTo, DiesDown
from wsim.plan.schema.formula_place import OwnSpinBetween, TiltBetween, TurnedBetween
from wsim.rules.cast import Cast, Thing

RATE = 0.05  # of a rate of turning, that it may be off by
DOWN = 0.9  # of the angle to its lowest point, that what swings into something turns by at least


def asked(name: str, sentence: str, formula: Formula) -> Objective:
    """An objective in the language."""
    return Objective(kind="formula", object=name, sentence=sentence, formula=formula)


def to_and_fro(thing: Thing, name: str, axis: str, most: float, cast: Cast) -> list[Objective]:
    """Of what swings or bounces along an axis, and comes again up to a share of its height at the most.

    Raises:
        UserError: the share is none.
    """
    made = []
    if "die" in thing.does:
        formula = DiesDown.model_validate({"object": name, "axis": axis})
        made.append(asked(name, f"{name} dies down: it goes less far each time.", formula))
    if thing.share is not None:
        if not 0.0 < thing.share <= 1.0:
            raise UserError(f"{thing.words!r}: {thing.share:.0%} is not above 0 and up to 100 % of where it started")
        if thing.share > most:
            choice = f"warning: it comes up to {most:.0%} of its height"
            cast.assume(thing.words, choice, "the plan asks for what the prompt says")
        sentence = f"{name} comes up to {thing.share:.0%} of its height again."
        made.append(asked(name, sentence, ClimbsTo(object=name, share=thing.share)))
    return made


def stops(name: str, ref: str) -> Objective:
    """It stands still before another, without having touched it."""
    return asked(name, f"{name} stops before {ref}.", StopsBefore(object=name, ref=ref))


def turns(name: str, rate: float) -> Objective:
    """It turns about the vertical at a rate [deg/s]."""
    low, high = sorted((rate * (1.0 - RATE), rate * (1.0 + RATE)))
    formula = OwnSpinBetween(object=name, axis="z", low=low, high=high)
    return asked(name, f"{name} turns at {rate:g} degrees a second.", formula)


def swings_down(name: str, angle: float) -> Objective:
    """What is let go at a positive angle about Y [deg] comes down from there, all but a tenth of the way or farther."""
    formula = Eventually(of=TurnedBetween(object=name, axis="y", low=-180.0, high=-DOWN * angle))
    return asked(name, f"{name} swings down by {DOWN * angle:.3g} degrees or more.", formula)


def leans(name: str, angle: float, most: float, words: str, sign: float = 1.0) -> Objective:
    """A plank goes down at its front, or its back with a sign of -1, by an angle [deg], with room up to another.

    Raises:
        UserError: there is not that much room.
    """
    if not 0.0 < angle < most:
        raise UserError(f"{words!r}: {angle:g} degrees is not above 0 and below {most:.3g}, where it is on the ground")
    low, high = sorted((sign * angle, sign * 90.0))
    formula = Eventually(of=TiltBetween(object=name, axis="x", low=low, high=high))
    return asked(name, f"{name} tilts by {angle:g} degrees or more.", formula)
