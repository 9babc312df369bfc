"""What vehicles do: drive over what there is, and cross what floats, from one dock to another."""

from __future__ import annotations

from wsim.rules.cast import Thing
from wsim.rules.grammar import NOT_IN_THIS_ORDER, NotUnderstood
from wsim.rules.phrases import Action, Phrase
from wsim.rules.places import common, do, put, where
from wsim.rules.reader import Reader


def drive(reader: Reader, thing: Thing, action: Action) -> None:
    """Drive so far, over what there is."""
    if thing.noun.family != "vehicle":
        raise NotUnderstood([f"{thing.words} {action.words}"], "lets a vehicle drive, but not this:")
    if "drive" in thing.does:
        raise NotUnderstood([f"{thing.words} {action.words}"], "lets a vehicle drive once, not this as well:")
    for place in action.places:
        if place.preposition == "way":
            thing.way = place.length
        elif place.preposition in ("over", "on", "along", "past", "in") and place.phrase is not None:
            over = where(reader, place.phrase)
            if isinstance(over, Thing) and over.noun.family == "pontoon" and place.preposition == "over":
                _over(thing, over)
            elif isinstance(over, Thing):
                fits = ("over", "on", "along", "in") if over.noun.family == "land" else ("along", "past")
                if place.preposition not in fits:
                    raise NotUnderstood([place.words], "lets a vehicle drive over land and past things, not there:")
                put(over, "ground")
            elif over != "ground":
                raise NotUnderstood([place.words], "lets a vehicle drive over land, not there:")
        elif place.preposition in ("from", "to") and place.phrase is not None:
            _docks(reader, place.phrase)
        elif place.direction != "front" and (
            place.preposition not in ("speed", "time") or not common(reader, thing, place)
        ):
            raise NotUnderstood([place.words], NOT_IN_THIS_ORDER)
    put(thing, "ground")
    do(thing, "drive")


def cross(reader: Reader, thing: Thing, action: Action) -> None:
    """Drive over a floating block, between two docks."""
    over = where(reader, action.target) if action.target is not None else None
    if thing.noun.family != "vehicle" or not isinstance(over, Thing) or over.noun.family != "pontoon":
        raise NotUnderstood([f"{thing.words} {action.words}"], "lets a vehicle cross a floating block, but not this:")
    for place in action.places:
        if place.preposition == "between" and place.phrase is not None:
            for phrase in (place.phrase, place.other):
                _docks(reader, phrase)
        elif place.preposition in ("from", "to") and place.phrase is not None:
            _docks(reader, place.phrase)
        elif place.preposition not in ("speed", "time") or not common(reader, thing, place):
            raise NotUnderstood([place.words], NOT_IN_THIS_ORDER)
    _over(thing, over)


def leave(reader: Reader, thing: Thing, action: Action) -> None:
    """Come from a dock, or to one: what crosses a floating block does."""
    if thing.noun.family != "vehicle" or action.target is None:
        raise NotUnderstood(
            [f"{thing.words} {action.words}"], "lets a vehicle leave a dock or reach one, but not this:"
        )
    _docks(reader, action.target)
    for place in action.places:
        if place.preposition not in ("speed", "time") or not common(reader, thing, place):
            raise NotUnderstood([place.words], NOT_IN_THIS_ORDER)


def _over(thing: Thing, block: Thing) -> None:
    put(thing, "ground")
    put(block, "ground")
    do(thing, "cross")


def _docks(reader: Reader, phrase: Phrase | None) -> None:
    at = where(reader, phrase) if phrase is not None else None
    if phrase is not None and (not isinstance(at, Thing) or at.noun.family != "dock"):
        raise NotUnderstood([phrase.words], "lets a vehicle come from a dock and go to one, not there:")
