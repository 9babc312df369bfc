"""What vehicles do: drive over what there is, and cross what floats, from one dock to another."""

from __future__ import annotations

from dataclasses import replace

from wsim.rules.cast import Thing
from wsim.rules.phrases import Action, Phrase, Place
from wsim.rules.places import common, do, put, where
from wsim.rules.reader import Reader
from wsim.rules.tokens import NOT_IN_THIS_ORDER, NotUnderstood


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
            if isinstance(over, Thing) and over.noun.family == "pontoon" and place.preposition in ("over", "along"):
                _over(thing, over)
            elif isinstance(over, Thing):
                fits = ("over", "on", "along", "in") if over.noun.family == "land" else ("along", "past")
                if place.preposition not in fits:
                    raise NotUnderstood([place.words], "lets a vehicle drive over land and past things, not there:")
                put(over, "ground")
            elif over != "ground":
                raise NotUnderstood([place.words], "lets a vehicle drive over land, not there:")
        elif place.preposition in ("from", "to") and place.phrase is not None:
            _dock(reader, place.phrase, last=place.preposition == "to")
        elif place.direction != "front" and (
            place.preposition not in ("speed", "time") or not common(reader, thing, place)
        ):
            raise NotUnderstood([place.words], NOT_IN_THIS_ORDER)
    put(thing, "ground")
    do(thing, "drive")


def cross(reader: Reader, thing: Thing, action: Action) -> None:
    """Drive over a floating block, between two docks."""
    over = where(reader, action.target) if action.target is not None else None
    if isinstance(over, Thing) and over.noun.family == "land" and action.target is not None:
        drive(reader, thing, replace(action, places=[Place("over", action.target, words=action.words), *action.places]))
        return
    if thing.noun.family != "vehicle" or not isinstance(over, Thing) or over.noun.family != "pontoon":
        raise NotUnderstood([f"{thing.words} {action.words}"], "lets a vehicle cross a floating block, but not this:")
    for place in action.places:
        if place.preposition == "between" and place.phrase is not None:
            _between(reader, place)
        elif place.preposition in ("from", "to") and place.phrase is not None:
            _dock(reader, place.phrase, last=place.preposition == "to")
        elif place.preposition not in ("speed", "time") or not common(reader, thing, place):
            raise NotUnderstood([place.words], NOT_IN_THIS_ORDER)
    _over(thing, over)


def leave(reader: Reader, thing: Thing, action: Action) -> None:
    """Come from a dock before it crosses what floats, or to the other one after that."""
    last = action.verb == "reach"
    if thing.noun.family != "vehicle" or action.target is None or ("cross" in thing.does) != last:
        why = (
            "lets a vehicle leave a dock, cross a floating block and reach the other dock, in this order, but not this:"
        )
        raise NotUnderstood([f"{thing.words} {action.words}"], why)
    _dock(reader, action.target, last=last)
    for place in action.places:
        if place.preposition not in ("speed", "time") or not common(reader, thing, place):
            raise NotUnderstood([place.words], NOT_IN_THIS_ORDER)


def _over(thing: Thing, block: Thing) -> None:
    if "cross" in thing.does:
        raise NotUnderstood([block.words], "lets a vehicle cross one floating block, once, not this as well:")
    put(thing, "ground")
    put(block, "ground")
    do(thing, "cross")


def _dock(reader: Reader, phrase: Phrase, *, last: bool) -> None:
    """One dock: the first, or the last."""
    at = where(reader, phrase)
    if not isinstance(at, Thing) or at.noun.family != "dock" or at.count > 1 or (at.kind == "opposite" and not last):
        which = "to another dock" if last else "from a dock"
        raise NotUnderstood([phrase.words], f"lets a vehicle come {which}, not there:")


def _between(reader: Reader, place: Place) -> None:
    """Both docks: "two docks", or "a dock and another"."""
    assert place.phrase is not None
    if place.other is None and place.phrase.plural and place.phrase.count is None:
        place.phrase.count = 2  # "between docks"
    things = [where(reader, phrase) for phrase in (place.phrase, place.other) if phrase is not None]
    if any(not isinstance(at, Thing) or at.noun.family != "dock" for at in things) or (
        sum(at.count for at in things if isinstance(at, Thing)) != len("ab")
    ):
        raise NotUnderstood([place.words], "lets a vehicle cross a floating block between two docks, not there:")
