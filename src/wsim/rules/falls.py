"""What falls, is let go, bounces, lands and topples: the actions of a clause, put to the cast."""

from __future__ import annotations

from dataclasses import replace

from wsim.defaults import GRAVITY
from wsim.errors import UserError
from wsim.rules.cast import CARRIERS, Thing
from wsim.rules.goes import aim, go, movable, strike
from wsim.rules.phrases import Action, Place
from wsim.rules.places import common, do, put, put_inside, refuse_afloat, stand, support, where
from wsim.rules.reader import Reader
from wsim.rules.tokens import NOT_IN_THIS_ORDER, NotUnderstood

_LET_GO = {"let", "released"}  # of which one word is in what is said of what starts from rest where it is
_INTO = ("in", "into", "inside", "on", "onto", "to", "at", "against")


def topple(reader: Reader, thing: Thing, action: Action) -> None:
    """Fall over; or, with an object, let that fall over."""
    if action.target is not None:
        strike(reader, thing, action)
        return
    if thing.noun.family == "seesaw":
        do(thing, "tilt")
        return
    if thing.noun.family != "solid":
        raise NotUnderstood([action.words], "lets a stack, a row or a body topple, but not this:")
    for place in action.places:
        if not common(reader, thing, place):
            ground = place.phrase is not None and where(reader, place.phrase, thing) == "ground"
            if place.preposition not in ("on", "in", "at") and not ground:
                raise NotUnderstood([action.words], "lets things fall over, but not at or onto others:")
            _land(reader, thing, action, place)
    if not thing.group and thing.count > 1:
        reader.cast.assume(thing.words, "in a row", "the prompt does not say how they stand")
        thing.arrangement = "row"
    put(thing, "ground")
    do(thing, "topple")


def fall(reader: Reader, thing: Thing, action: Action) -> None:
    """Drop, fall over, or off what it is on."""
    if thing.noun.family == "pendulum" or thing.rod is not None:
        _let_go(reader, thing, action)
        return
    high = thing.drop_height is not None or any(place.length is not None for place in action.places)
    times = [place.value or 0.0 for place in action.places if place.preposition == "time"]
    if times and not high and action.verb == "fall":  # "falls for a second": from so high; else it is the run's time
        thing.drop_height = round(GRAVITY * times[0] ** 2 / 2, 4)
        action = replace(action, places=[place for place in action.places if place.preposition != "time"])
    aimed = [place for place in action.places if place.preposition not in ("time", "toward", "in_turn")]
    over = action.particle == "over" or (thing.group and not aimed and action.particle != "in")
    if action.verb == "fall" and (over or (action.particle == "down" and thing.group)):
        topple(reader, thing, action)
        return
    if action.particle == "off" or any(place.preposition in ("off", "via") for place in action.places):
        _fall_off(reader, thing, action)
        return
    into = any(place.preposition in ("in", "into", "inside", "onto") for place in action.places)
    if thing.support is not None and thing.support.noun.family == "belt" and into and "drop" not in thing.does:
        _fall_off(reader, thing, action)
        return
    if thing.path is not None and not action.places and action.particle is None:
        return  # what is let go on a ramp goes down it, as it is said to
    movable(thing, action)
    if thing.target is not None or thing.off or thing.path is not None:
        land(reader, thing, action)
        return
    if any(one.target is thing for one in reader.cast.things) and not aimed:
        topple(reader, thing, action)
        return
    do(thing, "drop")
    if action.particle == "in":
        put(thing, "water")
    for place in action.places:
        if place.preposition in ("from", "way") and place.length is not None:
            thing.drop_height = place.length
        elif place.preposition == "from" and place.phrase is not None and _on_ramp(reader, thing, place):
            thing.does.remove("drop")
        elif place.preposition == "from":
            raise NotUnderstood([action.words], "needs a height after 'from', as in 'from 0.5 m':")
        elif place.preposition == "on" and _LET_GO & {*action.words.split()} and _on_ramp(reader, thing, place):
            thing.does.remove("drop")
        elif not common(reader, thing, place):
            _land(reader, thing, action, place)


def _on_ramp(reader: Reader, thing: Thing, place: Place) -> bool:
    """Whether what is let go is on a ramp: "from the top of a ramp"."""
    at = where(reader, place.phrase, thing) if place.phrase is not None else None
    if not isinstance(at, Thing) or at.noun.family != "ramp" or "drop" not in thing.does:
        return False
    support(reader, thing, at)
    do(thing, "roll" if thing.round else "slide")
    return True


def _let_go(reader: Reader, thing: Thing, action: Action) -> None:
    """A pendulum that is let go swings.

    Raises:
        NotUnderstood: It is to drop, which its rod or rope does not let it.
    """
    if not _LET_GO & {*action.words.split()} and not any(place.preposition == "angle" for place in action.places):
        raise NotUnderstood([action.words], "lets what hangs swing, or be let go, but not fall:")
    for place in action.places:
        if place.preposition == "angle":
            thing.angle = place.value
        elif not common(reader, thing, place):
            raise NotUnderstood([place.words], "lets a pendulum go from an angle, not so:")
    put(thing, "ground")
    do(thing, "swing")


def _fall_off(reader: Reader, thing: Thing, action: Action) -> None:
    """Off a belt that carries it, or off what it stands on: something must set it going, or hit it."""
    carrier = thing.support
    off = next((place for place in action.places if place.preposition in ("off", "via")), None)
    if carrier is None and off is not None and off.phrase is not None:
        found = where(reader, off.phrase, thing)
        carrier = found if isinstance(found, Thing) else None
    if carrier is not None and carrier.noun.family == "belt":
        movable(thing, action)
        support(reader, thing, carrier)
        do(thing, "drop")
        for place in action.places:
            if place is not off and not common(reader, thing, place):
                come_down(reader, thing, action, place)
        return
    if any(one.target is thing for one in reader.cast.things) or thing.off:
        thing.off = True
        for place in action.places:
            if place is not off and not common(reader, thing, place):
                come_down(reader, thing, action, place)
        return
    go(reader, thing, action, "roll" if thing.round else "slide")


def come_down(reader: Reader, thing: Thing, action: Action, place: Place) -> None:
    """Where what has left its support comes down."""
    if place.phrase is None or place.preposition not in _INTO:
        raise NotUnderstood([action.words], NOT_IN_THIS_ORDER)
    if thing.into is not None and place.preposition in ("on", "in"):
        stand(reader, thing.into, [place])  # "in a bucket on the floor"
        return
    at = where(reader, place.phrase, thing)
    if at == "ground" or (at is thing.support and place.phrase.part in ("end", "edge")):
        return
    if not isinstance(at, Thing) or at is thing.support or at.noun.family != "vessel":
        raise NotUnderstood([place.words], "lets things come down in a vessel or on the ground, not there:")
    if at.count > 1 or any(one is not thing and one.into is at for one in reader.cast.things):
        raise UserError(f"{at.words!r}: the builtin planner lets one thing land in it, not more")
    put(at, "ground")
    thing.into = at


def land(reader: Reader, thing: Thing, action: Action) -> None:
    """End up where a fall or a flight ends; alone, what lands was dropped."""
    movable(thing, action)
    flies = thing.off or "throw" in thing.does or thing.path is not None
    if not flies and not (thing.support is not None and thing.support.noun.family == "belt") and thing.target is None:
        if "drop" in thing.does and not action.places:
            return
        do(thing, "drop")
    for place in action.places:
        if common(reader, thing, place):
            continue
        if "drop" in thing.does and not (thing.support is not None and thing.support.noun.family == "belt"):
            _land(reader, thing, action, place)
        else:
            come_down(reader, thing, action, place)


def _land(reader: Reader, thing: Thing, action: Action, place: Place) -> None:
    if place.phrase is None or place.preposition not in _INTO:
        raise NotUnderstood([action.words], NOT_IN_THIS_ORDER)
    below = thing.inside or thing.support
    if below is not None and place.preposition in ("on", "in"):
        stand(reader, below, [place])
        return
    refuse_afloat(reader, thing, place)
    at = where(reader, place.phrase, thing)
    if not isinstance(at, Thing):
        put(thing, at)
    elif at.noun.family == "vessel":
        put_inside(reader, thing, at)
    elif place.preposition in ("into", "inside") and at.noun.family == "solid" and not at.group:
        raise NotUnderstood([place.words], "builds it as a solid body with no room in it, so nothing falls in:")
    elif at.noun.family in CARRIERS:
        raise NotUnderstood([action.words], "sets things on a belt or a turntable, and drops nothing onto it:")
    else:
        support(reader, thing, at)


def bounce(reader: Reader, thing: Thing, action: Action) -> None:
    """Off the ground or what it falls on; off a wall, which it rolls into."""
    movable(thing, action)
    if thing.noun.primitive != "sphere":
        raise NotUnderstood([f"{thing.words} {action.words}"], "lets balls bounce, but not this:")
    walls = []
    for place in action.places:
        on = place.preposition in ("on", "onto", "off", "against")
        at = where(reader, place.phrase, thing) if place.phrase is not None and on else None
        if place.preposition == "from" and place.length is not None:
            thing.drop_height = place.length
        elif place.preposition == "share":
            thing.share = place.value
        elif place.preposition == "toward" and place.direction == "back" and thing.target is not None:
            continue
        elif isinstance(at, Thing) and place.preposition in ("off", "against") and at.noun.key == "wall":
            walls.append(place)
        elif isinstance(at, Thing) and at is thing.support and not thing.off:
            continue
        elif isinstance(at, Thing) and thing.off:
            raise NotUnderstood([action.words], "lets what leaves a table bounce on the ground, not there:")
        elif isinstance(at, Thing):
            support(reader, thing, at)
        elif at == "ground":
            put(thing, "ground")
        elif at is not None or not common(reader, thing, place):
            raise NotUnderstood([action.words], NOT_IN_THIS_ORDER)
    do(thing, "bounce")
    if walls and walls[0].phrase is not None:
        aim(reader, thing, walls[0].phrase, action)
    elif not {"drop", "throw"} & {*thing.does} and thing.target is None and not thing.off:
        put(thing, "ground")
        do(thing, "drop")
