"""What things do: the actions of a clause, put to the cast. One function a verb, or a family of verbs."""

from __future__ import annotations

from collections.abc import Callable

from wsim.errors import UserError
from wsim.rules import wheels
from wsim.rules.cast import CARRIERS, Beside, Thing
from wsim.rules.grammar import NOT_IN_THIS_ORDER, NotUnderstood
from wsim.rules.lexicon import lexicon
from wsim.rules.phrases import Action, Phrase, Place
from wsim.rules.places import arrange, common, do, hang, part, put, put_inside, stand, support, where
from wsim.rules.reader import Reader

MOVES = ("roll", "slide", "push", "throw", "swing", "meet", "hang", "tilt")  # what a thing does on the ground alone
_INTO = ("into", "to", "against", "towards", "at")


def act(reader: Reader, thing: Thing, action: Action) -> None:
    """Let a thing do what a clause says."""
    _RULES[action.verb](reader, thing, action)


def meet(reader: Reader, things: list[Thing], action: Action) -> None:
    """Two things come at each other."""
    if sum(thing.count for thing in things) != 2 or any(thing.noun.family != "solid" for thing in things):
        raise NotUnderstood([action.words], "lets two things collide; name two, or what is hit:")
    for place in action.places:
        if not all(common(reader, thing, place) for thing in things):
            raise NotUnderstood([place.words], NOT_IN_THIS_ORDER)
    for thing in things:
        put(thing, "ground")
        do(thing, "meet")
    if len(things) == 2:
        things[0].meets, things[1].meets = things[1], things[0]


# ---- in water
def _in_water(reader: Reader, thing: Thing, action: Action) -> None:
    if thing.group:
        raise UserError(f"{thing.words!r}: the builtin planner stacks things on the ground, not in water")
    put(thing, "water")
    do(thing, action.verb)
    for place in action.places:
        if place.preposition == "time" and common(reader, thing, place):
            continue
        if place.phrase is None or place.preposition not in ("in", "into", "inside", "on", "onto", "at", "to"):
            raise NotUnderstood([action.words], NOT_IN_THIS_ORDER)
        if where(reader, place.phrase) != "water" and place.phrase.kind != "ground":
            raise NotUnderstood([action.words], f"cannot let a thing {action.verb} there:")
        if action.verb == "float" and part(place.phrase) == "bottom":
            raise UserError(f"{action.words!r}: what floats is not at the bottom")


# ---- down
def _topple(reader: Reader, thing: Thing, action: Action) -> None:
    if action.target is not None:
        _strike(reader, thing, action)
        return
    if thing.noun.family != "solid" or (not thing.group and thing.noun.key != "domino" and thing.count > 1):
        raise NotUnderstood([action.words], "lets a stack or a row topple, but not this:")
    for place in action.places:
        if not common(reader, thing, place):
            raise NotUnderstood([action.words], "lets a stack or a row topple, but not this:")
    if not thing.group and thing.count > 1:
        reader.cast.assume(thing.words, "in a row", "the prompt does not say how they stand")
        thing.arrangement = "row"
    put(thing, "ground")
    do(thing, "topple")


def _fall(reader: Reader, thing: Thing, action: Action) -> None:
    aimed = [place for place in action.places if place.preposition not in ("time", "toward")]
    over = action.particle == "over" or (thing.group and not aimed and action.particle != "in")
    if action.verb == "fall" and (over or (action.particle == "down" and thing.group)):
        _topple(reader, thing, action)
        return
    _movable(thing, action)
    do(thing, "drop")
    if action.particle == "in":
        put(thing, "water")
    for place in action.places:
        if place.preposition == "from" and place.length is not None:
            thing.drop_height = place.length
        elif place.preposition == "from":
            raise NotUnderstood([action.words], "needs a height after 'from', as in 'from 0.5 m':")
        elif not common(reader, thing, place):
            _land(reader, thing, action, place)


def _land(reader: Reader, thing: Thing, action: Action, place: Place) -> None:
    if place.phrase is None or place.preposition not in ("in", "into", "inside", "on", "onto", "to", "at"):
        raise NotUnderstood([action.words], NOT_IN_THIS_ORDER)
    at = where(reader, place.phrase)
    if not isinstance(at, Thing):
        put(thing, at)
    elif at.noun.family == "vessel":
        put_inside(reader, thing, at)
    else:
        support(reader, thing, at)


def _bounce(reader: Reader, thing: Thing, action: Action) -> None:
    """Off the ground or what it falls on; off a wall, which it rolls into."""
    _movable(thing, action)
    if thing.noun.primitive != "sphere":
        raise NotUnderstood([f"{thing.words} {action.words}"], "lets balls bounce, but not this:")
    walls = []
    for place in action.places:
        on = place.preposition in ("on", "onto", "off", "against")
        at = where(reader, place.phrase) if place.phrase is not None and on else None
        if place.preposition == "from" and place.length is not None:
            thing.drop_height = place.length
        elif place.preposition == "share":
            thing.share = place.value
        elif isinstance(at, Thing) and place.preposition in ("off", "against") and at.noun.key == "wall":
            walls.append(place)
        elif isinstance(at, Thing):
            support(reader, thing, at)
        elif at == "ground":
            put(thing, "ground")
        elif at is not None or not common(reader, thing, place):
            raise NotUnderstood([action.words], NOT_IN_THIS_ORDER)
    do(thing, "bounce")
    if walls and walls[0].phrase is not None:
        _aim(reader, thing, walls[0].phrase, action)
    elif not {"drop", "throw"} & {*thing.does}:
        put(thing, "ground")
        do(thing, "drop")


# ---- along
def _roll(reader: Reader, thing: Thing, action: Action) -> None:
    _go(reader, thing, action, "roll")


def _slide(reader: Reader, thing: Thing, action: Action) -> None:
    _go(reader, thing, action, "slide")


def _push(reader: Reader, thing: Thing, action: Action) -> None:
    if action.target is not None:
        _strike(reader, thing, action)
    else:
        _go(reader, thing, action, "push")


def _go(reader: Reader, thing: Thing, action: Action, how: str) -> None:
    """Roll, slide or be pushed: down a ramp, along what carries it, off it, or into something."""
    if thing.count > 1:
        raise UserError(f"{thing.words!r}: the builtin planner lets one thing {how} or hit; give one")
    _movable(thing, action)
    put(thing, "ground")
    targets = []
    for place in action.places:
        if common(reader, thing, place):
            continue
        if place.preposition == "toward":
            thing.direction = place.direction
        elif place.phrase is None or place.preposition in ("from", "inside", "in"):
            raise NotUnderstood([action.words], NOT_IN_THIS_ORDER)
        elif place.preposition in ("on", "onto", "along", "down", "off"):
            _on_path(reader, thing, action, place)
        elif place.preposition in _INTO:
            targets.append(place.phrase)
        else:
            raise NotUnderstood([action.words], f"cannot let a thing {how} there:")
    do(thing, how)
    for phrase in targets:
        _aim(reader, thing, phrase, action)


def _on_path(reader: Reader, thing: Thing, action: Action, place: Place) -> None:
    assert place.phrase is not None
    at = where(reader, place.phrase)
    if at == "ground" and place.preposition not in ("down", "off"):
        return
    if not isinstance(at, Thing) or (place.preposition == "down") != (at.noun.family == "ramp"):
        raise NotUnderstood([action.words], "lets things go down a ramp, or along the ground or a table, not there:")
    support(reader, thing, at)
    thing.off = place.preposition == "off"


def _strike(reader: Reader, thing: Thing, action: Action) -> None:
    """Hit, knock over, push, collide with: it rolls or slides into its target."""
    if thing.count > 1:
        raise UserError(f"{thing.words!r}: the builtin planner lets one thing roll or hit; give one")
    _movable(thing, action)
    for place in action.places:
        if place.preposition == "toward":
            thing.direction = place.direction
        elif not common(reader, thing, place):
            ground = place.phrase is not None and where(reader, place.phrase) == "ground"
            if not ground or place.preposition not in ("on", "onto"):
                raise NotUnderstood([action.words], "cannot let a thing roll there:")
    if action.target is None:
        raise NotUnderstood([action.words], "needs to be told what is hit:")
    _aim(reader, thing, action.target, action)


def _aim(reader: Reader, thing: Thing, phrase: Phrase, action: Action) -> None:
    if phrase.kind == "pronoun" and thing.target is None and thing.support is None:
        raise NotUnderstood([action.words], "cannot tell what 'it' stands for in")
    target = (thing.target or thing.support) if phrase.kind == "pronoun" else where(reader, phrase)
    if not isinstance(target, Thing) or target is thing or target.noun.family not in ("solid", "furniture"):
        raise NotUnderstood([action.words], "lets a thing hit a block, a ball or a stack, not this:")
    if target.count > 1 and not target.group:
        raise NotUnderstood([phrase.words], "cannot tell which of them this is")
    put(target, "ground")
    put(thing, "ground")
    if action.verb in ("knock", "topple"):
        do(target, "topple")
    if "drop" in thing.does:
        support(reader, thing, target)
    else:
        thing.target = target
        if not {"roll", "slide", "push", "throw"} & {*thing.does}:
            do(thing, "roll" if thing.round else "slide")
        if target.group and target.kind == "domino":
            do(target, "topple")
    if target.group:
        reader.struck = target


# ---- through the air
def _throw(reader: Reader, thing: Thing, action: Action) -> None:
    if thing.count > 1:
        raise UserError(f"{thing.words!r}: the builtin planner throws one thing; give one")
    _movable(thing, action)
    put(thing, "ground")
    do(thing, "throw")
    for place in action.places:
        if place.preposition == "angle":
            thing.angle = place.value
        elif place.preposition == "from" and place.length is not None:
            thing.drop_height = place.length
        elif place.preposition == "toward":
            thing.direction = place.direction
        elif common(reader, thing, place):
            continue
        elif place.phrase is not None and place.preposition in (*_INTO, "onto"):
            _aim(reader, thing, place.phrase, action)
        else:
            raise NotUnderstood([place.words], "cannot throw a thing there:")


# ---- on what moves
def _carry(reader: Reader, thing: Thing, action: Action) -> None:
    if thing.noun.family not in CARRIERS or action.target is None:
        raise NotUnderstood([f"{thing.words} {action.words}"], "lets a conveyor or a turntable carry things, not so:")
    put(thing, "ground")
    for place in action.places:
        if not common(reader, thing, place):
            raise NotUnderstood([place.words], NOT_IN_THIS_ORDER)
    load = where(reader, action.target)
    if not isinstance(load, Thing):
        raise NotUnderstood([action.words], "lets a conveyor or a turntable carry blocks, balls and the like, not so:")
    support(reader, load, thing)
    do(load, "ride")


def _ride(reader: Reader, thing: Thing, action: Action) -> None:
    _movable(thing, action)
    do(thing, "ride")
    for place in action.places:
        at = where(reader, place.phrase) if place.phrase is not None and place.preposition in ("on", "along") else None
        if isinstance(at, Thing) and at.noun.family in CARRIERS:
            support(reader, thing, at)
        elif not common(reader, thing, place):
            raise NotUnderstood([place.words], "lets things ride on a conveyor or a turntable, not there:")
    if thing.support is None:
        raise NotUnderstood([action.words], "lets things ride on a conveyor or a turntable; name it after")


def _move(reader: Reader, thing: Thing, action: Action) -> None:
    (_carry if action.target is not None else _run)(reader, thing, action)


def _run(reader: Reader, thing: Thing, action: Action) -> None:
    if thing.noun.family not in CARRIERS:
        raise NotUnderstood([f"{thing.words} {action.words}"], "lets a conveyor run and a turntable turn, not this:")
    put(thing, "ground")
    do(thing, "run")
    for place in action.places:
        if not common(reader, thing, place):
            raise NotUnderstood([place.words], NOT_IN_THIS_ORDER)


# ---- on a hinge
def _swing(reader: Reader, thing: Thing, action: Action) -> None:
    for place in action.places:
        if place.preposition == "angle":
            thing.angle = place.value
            continue
        if common(reader, thing, place):
            continue
        at = where(reader, place.phrase) if place.phrase is not None else None
        if not isinstance(at, Thing) or at.noun.family != "rod":
            raise NotUnderstood([place.words], "hangs things on a rod, not there:")
        hang(reader, thing, at)
    if thing.noun.family != "pendulum" and thing.rod is None:
        raise NotUnderstood([action.words], "lets a pendulum swing, or a ball on a rod, but not this:")
    put(thing, "ground")
    do(thing, action.verb)


def _tilt(_reader: Reader, thing: Thing, action: Action) -> None:
    if thing.noun.family != "seesaw" or any(place.preposition != "angle" for place in action.places):
        raise NotUnderstood([action.words], "lets a seesaw tilt, but not this:")
    thing.angle = action.places[0].value if action.places else thing.angle
    do(thing, "tilt")


# ---- on its legs
def _patrol(reader: Reader, thing: Thing, action: Action) -> None:
    """Walk round an office."""
    target = action.target
    if thing.noun.family != "robot" or target is None or lexicon().nouns[target.kind].family != "office":
        raise NotUnderstood([f"{thing.words} {action.words}"], "lets a robot patrol an office, but not so:")
    if target.adorned:
        raise NotUnderstood([target.words], "furnishes one office itself, and not as it is told to:")
    for place in action.places:
        if place.preposition != "speed" or not common(reader, thing, place):
            raise NotUnderstood([place.words], NOT_IN_THIS_ORDER)
    put(thing, "ground")
    do(thing, "patrol")
    reader.cast.office = target.words


def _return(_reader: Reader, thing: Thing, action: Action) -> None:
    """Come back, which every patrol does."""
    if "patrol" not in thing.does or action.places:
        raise NotUnderstood([f"{thing.words} {action.words}"], "lets a robot come back from a patrol, but not this:")


# ---- how it goes on
def _stop(reader: Reader, thing: Thing, action: Action) -> None:
    """Slide towards something, and stand still before it; what drives comes to rest by its brakes."""
    if "drive" in thing.does and not action.places:
        do(thing, "stop")
        return
    _movable(thing, action)
    others = [place for place in action.places if not common(reader, thing, place)]
    phrases = [place.phrase for place in others if place.preposition == "before" and place.phrase is not None]
    if len(phrases) != 1 or len(others) > 1 or thing.round or {"roll", "throw"} & {*thing.does}:
        raise NotUnderstood([action.words], "lets a thing that slides stop before another, but not so:")
    if not {"slide", "push"} & {*thing.does}:
        do(thing, "slide")
    _aim(reader, thing, phrases[0], action)
    do(thing, "stop")


def _come_again(reader: Reader, thing: Thing, action: Action) -> None:
    """What swings or bounces: ever less far, or up to a share of its height again."""
    swings = thing.noun.family == "pendulum" or thing.rod is not None
    if not (swings or "bounce" in thing.does):
        raise NotUnderstood([f"{thing.words} {action.words}"], "lets what swings or bounces do this, but not this:")
    others = [place for place in action.places if not common(reader, thing, place)]
    shares = [place.value for place in others if place.preposition == "share"]
    if len(shares) != len(others) or (action.verb == "climb") != (len(shares) == 1):
        raise NotUnderstood([action.words], NOT_IN_THIS_ORDER)
    thing.share = shares[0] if shares else thing.share
    if swings:
        put(thing, "ground")
        do(thing, "swing")
    do(thing, action.verb)


# ---- at rest
def _stack(reader: Reader, thing: Thing, action: Action) -> None:
    for place in action.places:
        at = where(reader, place.phrase) if place.phrase is not None else None
        if isinstance(at, Thing) and place.preposition in ("on", "onto"):
            support(reader, thing, at)
        elif at != "ground":
            raise NotUnderstood([action.words], "stacks things on the ground, not there:")
    arrange(reader, thing, "stack")


def _face(reader: Reader, thing: Thing, action: Action) -> None:
    if action.target is None or action.places:
        raise NotUnderstood([action.words], "needs to be told what it faces:")
    other = where(reader, action.target)
    if not isinstance(other, Thing) or other is thing:
        raise NotUnderstood([action.words], "turns things to other things, not so:")
    thing.beside.append(Beside("FACING-TO", other))


def _rest(reader: Reader, thing: Thing, action: Action) -> None:
    stand(reader, thing, action.places)
    if "hang" not in thing.does and "drop" not in thing.does:
        do(thing, "rest")


def _movable(thing: Thing, action: Action) -> None:
    if thing.noun.family != "solid":
        raise NotUnderstood([f"{thing.words} {action.words}"], "moves blocks, balls and the like, but not this:")


def _refused(_reader: Reader, thing: Thing, action: Action) -> None:
    raise NotUnderstood([f"{thing.words} {action.words}"], "cannot let a thing do this:")


_RULES: dict[str, Callable[[Reader, Thing, Action], None]] = {
    "float": _in_water, "sink": _in_water, "submerge": _in_water,
    "topple": _topple, "fall": _fall, "drop": _fall, "bounce": _bounce,
    "roll": _roll, "slide": _slide, "push": _push, "hit": _strike, "knock": _strike, "collide": _strike,
    "throw": _throw, "fly": _throw, "swing": _swing, "hang": _swing, "tilt": _tilt,
    "carry": _carry, "move": _move, "ride": _ride, "run": _run, "patrol": _patrol, "return": _return,
    "drive": wheels.drive, "cross": wheels.cross, "leave": wheels.leave, "reach": wheels.leave,
    "stop": _stop, "climb": _come_again, "die": _come_again,
    "stack": _stack, "face": _face, "rest": _rest, "hold": _refused, "pour": _refused,
}  # fmt: skip
