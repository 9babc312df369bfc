"""What goes along, and into things: the actions of a clause, put to the cast."""

from __future__ import annotations

from dataclasses import replace

from wsim.errors import UserError
from wsim.rules.cast import CARRIERS, Thing
from wsim.rules.lexicon import lexicon
from wsim.rules.phrases import Action, Phrase, Place
from wsim.rules.places import common, do, put, stand, support, where
from wsim.rules.reader import EACH_OTHER, Reader
from wsim.rules.tokens import NOT_IN_THIS_ORDER, NotUnderstood

_INTO = ("into", "to", "against", "towards", "at", "in", "onto")
HITS = ("solid", "furniture")  # families of what may be hit


def movable(thing: Thing, action: Action) -> None:
    """See that a thing moves.

    Raises:
        NotUnderstood: It stands still.
    """
    if thing.noun.family != "solid":
        raise NotUnderstood([f"{thing.words} {action.words}"], "moves blocks, balls and the like, but not this:")


def push(reader: Reader, thing: Thing, action: Action) -> None:
    """Be pushed; or, with an object, go into that."""
    if action.target is not None:
        strike(reader, thing, action)
    elif action.particle == "over":
        movable(thing, action)
        put(thing, "ground")
        do(thing, "topple")
    else:
        go(reader, thing, action, "push")


def go(reader: Reader, thing: Thing, action: Action, how: str) -> None:
    """Roll, slide or be pushed: down a ramp, along what carries it, off it, or into something."""
    movable(thing, action)
    put(thing, "ground")
    aims: list[Place] = []
    thing.off = thing.off or action.particle == "off"
    forces = [place for place in action.places if place.preposition == "force"] if how == "push" else []
    if forces:
        thing.force = forces[0].value
        lasting = next((place for place in action.places if place.preposition == "time"), None)
        thing.pushed_for = lasting.value if lasting is not None else None
        action = replace(action, places=[place for place in action.places if place not in (*forces[:1], lasting)])
    for place in action.places:
        if place.preposition == "time":
            thing.lasts = place.value
        elif common(reader, thing, place):
            continue
        elif place.preposition == "toward":
            thing.direction = place.direction
        elif place.preposition == "from" and place.phrase is not None and place.phrase.kind == "part":
            _on_path(reader, thing, action, place)
        elif place.phrase is None or place.preposition in ("from", "inside"):
            raise NotUnderstood([action.words], NOT_IN_THIS_ORDER)
        elif place.preposition in ("on", "along", "down", "off", "via", "over"):
            _on_path(reader, thing, action, place)
        elif place.preposition in _INTO:
            aims.append(place)
        else:
            raise NotUnderstood([action.words], f"cannot let a thing {how} there:")
    do(thing, how)
    for place in aims:
        _towards(reader, thing, action, place)
    alone = not (thing.support or thing.path or thing.target or thing.off or thing.into)
    if thing.lasts is not None and not (alone and (how != "push" or thing.speed is None)):
        reader.cast.duration, thing.lasts = thing.lasts, None  # what else goes on has its own time: it is the run's
    if thing.target is None and thing.count > 1 and thing.path is None and thing.support is None and not thing.group:
        reader.cast.assume(thing.words, "side by side", "the prompt does not say how they stand")


def _towards(reader: Reader, thing: Thing, action: Action, place: Place) -> None:
    """Into what it goes: what it hits, or the vessel that it comes down in."""
    assert place.phrase is not None
    if place.phrase.part in EACH_OTHER:
        raise NotUnderstood([action.words], "lets two things go into each other; name two:")
    at = where(reader, place.phrase, thing)
    if place.preposition == "in" and thing.into is None and at == "ground":
        raise NotUnderstood([action.words], NOT_IN_THIS_ORDER)
    leaves = thing.off or (thing.support is not None and thing.support.noun.family == "belt")
    if at == "ground" and leaves:
        return
    if isinstance(at, Thing) and at.noun.family == "vessel":
        if not leaves:
            raise NotUnderstood([action.words], "lets a thing come down in a vessel from a table or a belt, not so:")
        put(at, "ground")
        thing.into = at
    elif thing.into is not None and at == "ground":
        put(thing.into, "ground")
    else:
        aim(reader, thing, place.phrase, action)


def _on_path(reader: Reader, thing: Thing, action: Action, place: Place) -> None:
    assert place.phrase is not None
    at = where(reader, place.phrase, thing)
    if place.phrase.kind == "pronoun" and isinstance(at, Thing) and at.noun.family == "solid":
        at = at.path or at.support or at  # nothing rolls along a mug: it is what that is on
    leaves = place.preposition in ("off", "via")
    if at == "ground" and place.preposition != "down" and not leaves:
        if thing.into is not None:
            put(thing.into, "ground")
        return
    if isinstance(at, Thing) and at.noun.family == "ramp" and not leaves:
        support(reader, thing, at)
        return
    if not isinstance(at, Thing) or place.preposition in ("down", "over"):
        raise NotUnderstood([action.words], "lets things go down a ramp, or along the ground or a table, not there:")
    if at is not thing.support:
        support(reader, thing, at)
    thing.off = leaves


def strike(reader: Reader, thing: Thing, action: Action) -> None:
    """Hit, knock over, push, collide with: it rolls or slides into its target, or swings or falls on it."""
    if thing.noun.family != "pendulum" and thing.rod is None:
        movable(thing, action)
    if action.target is None and action.particle in ("over", "down"):  # "the first is knocked over"
        if [place for place in action.places if not common(reader, thing, place)]:
            raise NotUnderstood([action.words], "needs to be told what is hit:")
        put(thing, "ground")
        do(thing, "topple")
        return
    off, below = None, []
    for place in action.places:
        if place.preposition == "toward":
            thing.direction = place.direction
        elif place.preposition in ("on", "in") and place.phrase is not None and place.phrase.kind in lexicon().nouns:
            below.append(place)
        elif place.preposition in ("off", "via"):
            off = place
        elif thing.path is not None and place.phrase is not None and place.phrase.part in ("bottom", "end"):
            continue  # of the ramp that it goes down: what it hits stands there
        elif not common(reader, thing, place):
            ground = place.phrase is not None and where(reader, place.phrase, thing) == "ground"
            if not ground or place.preposition not in ("on", "onto", "along"):
                raise NotUnderstood([action.words], "cannot let a thing roll there:")
    if action.target is None:
        raise NotUnderstood([action.words], "needs to be told what is hit:")
    aim(reader, thing, action.target, action)
    for place in below:
        if thing.target is not None and thing.target.support is None:
            stand(reader, thing.target, [place])
    if off is not None or action.particle == "off":
        _off(reader, thing, action, off)


def _off(reader: Reader, thing: Thing, action: Action, off: Place | None) -> None:
    """What is hit leaves what it stands on."""
    target = thing.target
    assert target is not None
    if off is not None and off.phrase is not None:
        carrier = where(reader, off.phrase, target)
        if not isinstance(carrier, Thing) or carrier.noun.family != "furniture":
            raise NotUnderstood([off.words], "knocks things off tables and the like, not off this:")
        support(reader, target, carrier)
    swings = thing.noun.family == "pendulum" or thing.rod is not None
    if target.support is not None and thing.support is None and thing.path is None and not swings:
        support(reader, thing, target.support)
    if target.support is None:
        raise NotUnderstood([action.words], "needs to be told off what:")
    target.off = True


def aim(reader: Reader, thing: Thing, phrase: Phrase, action: Action) -> None:
    """Let a thing go into what a phrase names."""
    on = thing.support if thing.support is not None and thing.support.noun.family == "solid" else None
    if phrase.kind == "pronoun" and thing.target is None and on is None:
        target: str | Thing = reader.it(phrase, thing)
    else:
        known = thing.target or on if phrase.kind == "pronoun" else None
        target = known or where(reader, phrase, thing)
    if not isinstance(target, Thing) or target is thing or target.noun.family not in HITS:
        raise NotUnderstood([action.words], "lets a thing hit a block, a ball or a stack, not this:")
    if target.count > 1 and not target.group:
        if action.verb not in ("knock", "topple", "hit") and "in_turn" not in thing.manners:
            raise NotUnderstood([phrase.words], "cannot tell which of them this is")
        target.arrangement = "row"
        reader.cast.assume(target.words, "in a row", "the prompt does not say how they stand")
    put(target, "ground")
    put(thing, "ground")
    if action.verb in ("knock", "topple") and "off" not in (action.particle, *(p.preposition for p in action.places)):
        do(target, "topple")
    if "drop" in thing.does and thing.path is None:
        if thing.support is None:
            support(reader, thing, target)
    elif thing.target is not target:
        if thing.target is not None:
            raise UserError(f"{thing.words!r}: the builtin planner lets it hit one thing, not {target.words!r} as well")
        if thing.count > 1:
            raise UserError(f"{thing.words!r}: the builtin planner lets one thing hit another; give one")
        thing.target = target
        swings = thing.noun.family == "pendulum" or thing.rod is not None
        carried = thing.support is not None and thing.support.noun.family in CARRIERS
        if not swings and not carried and not {"roll", "slide", "push", "throw"} & {*thing.does}:
            do(thing, "roll" if thing.round else "slide")
        elif swings:
            do(thing, "swing")
        if target.group and target.kind == "domino":
            do(target, "topple")
    if target.group:
        reader.struck = target
