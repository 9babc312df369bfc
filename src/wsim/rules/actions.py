"""What things do: the actions of a clause, put to the cast. One function a verb, or a family of verbs."""

from __future__ import annotations

from collections.abc import Callable

from wsim.errors import UserError
from wsim.rules import falls, wheels
from wsim.rules.cast import CARRIERS, Beside, Thing
from wsim.rules.goes import aim, go, movable, push, strike
from wsim.rules.lexicon import lexicon
from wsim.rules.phrases import Action, Place
from wsim.rules.places import MANNERS, UPRIGHT, arrange, common, do, hang, part, put, stand, support, where
from wsim.rules.reader import EACH_OTHER, Reader
from wsim.rules.starts import check_starts
from wsim.rules.tokens import NOT_IN_THIS_ORDER, NotUnderstood

MOVES = ("roll", "slide", "push", "throw", "swing", "meet", "hang", "tilt")  # what a thing does on the ground alone
_INTO = ("into", "to", "against", "towards", "at")


def act(reader: Reader, thing: Thing, action: Action) -> None:
    """Let a thing do what a clause says."""
    check_starts(thing, action)
    reader.cast.said.append((thing, action))
    (_be if action.verb == "be" else _RULES[action.verb])(reader, thing, action)


def meet(reader: Reader, things: list[Thing], action: Action) -> None:
    """Two things come at each other."""
    if sum(thing.count for thing in things) != 2 or any(thing.noun.family != "solid" for thing in things):
        raise NotUnderstood([action.words], "lets two things collide; name two, or what is hit:")
    for place in action.places:
        other = place.phrase is not None and place.phrase.part in EACH_OTHER
        ground = place.phrase is not None and not other and where(reader, place.phrase) == "ground"
        if not other and not ground and not all(common(reader, thing, place) for thing in things):
            raise NotUnderstood([place.words], NOT_IN_THIS_ORDER)
    for thing in things:
        reader.cast.said.append((thing, action))
        put(thing, "ground")
        do(thing, "meet")
        if action.verb in ("roll", "slide"):
            do(thing, action.verb)
    if len(things) == 2:
        things[0].meets, things[1].meets = things[1], things[0]


# ---- in water
def _in_water(reader: Reader, thing: Thing, action: Action) -> None:
    if thing.group:
        raise UserError(f"{thing.words!r}: the builtin planner stacks things on the ground, not in water")
    put(thing, "water")
    do(thing, action.verb)
    for place in action.places:
        if place.preposition in ("time", "side", *MANNERS) and common(reader, thing, place):
            continue
        if place.phrase is None or place.preposition not in ("in", "into", "inside", "on", "onto", "at", "to"):
            raise NotUnderstood([action.words], NOT_IN_THIS_ORDER)
        if where(reader, place.phrase, thing) != "water" and place.phrase.kind != "ground":
            raise NotUnderstood([action.words], f"cannot let a thing {action.verb} there:")
        if action.verb == "float" and part(place.phrase) == "bottom":
            raise UserError(f"{action.words!r}: what floats is not at the bottom")


# ---- along
def _roll(reader: Reader, thing: Thing, action: Action) -> None:
    go(reader, thing, action, "roll")


def _slide(reader: Reader, thing: Thing, action: Action) -> None:
    go(reader, thing, action, "slide")


# ---- through the air
def _throw(reader: Reader, thing: Thing, action: Action) -> None:
    if thing.count > 1:
        raise UserError(f"{thing.words!r}: the builtin planner throws one thing; give one")
    movable(thing, action)
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
        elif place.phrase is not None and place.preposition == "over":
            _over(reader, thing, place)
        elif place.phrase is not None and place.preposition in (*_INTO, "onto", "in", "on"):
            at = where(reader, place.phrase, thing)
            if thing.target is not None and thing.target.support is None and place.preposition in ("on", "in"):
                stand(reader, thing.target, [place])
            elif thing.into is not None or (isinstance(at, Thing) and at.noun.family == "vessel"):
                falls.come_down(reader, thing, action, place)
            elif at != "ground":
                aim(reader, thing, place.phrase, action)
        else:
            raise NotUnderstood([place.words], "cannot throw a thing there:")


def _over(reader: Reader, thing: Thing, place: Place) -> None:
    """Over a wall, which stands where the throw is highest."""
    at = where(reader, place.phrase, thing) if place.phrase is not None else None
    free = isinstance(at, Thing) and at.count == 1 and at.support is None and not at.beside
    if not isinstance(at, Thing) or at.noun.key not in UPRIGHT or not free or thing.target is not None:
        raise NotUnderstood([place.words], "throws things over a wall or a post that stands on the ground, not so:")
    if at.phrase.length is not None:  # "over a wall of 1 m": its height
        at.phrase.measures["z"], at.phrase.length = at.phrase.length, None
    put(at, "ground")
    thing.over = at


# ---- on what moves
def _carry(reader: Reader, thing: Thing, action: Action) -> None:
    if thing.noun.family not in CARRIERS or action.target is None:
        raise NotUnderstood([f"{thing.words} {action.words}"], "lets a conveyor or a turntable carry things, not so:")
    put(thing, "ground")
    for place in action.places:
        if not common(reader, thing, place):
            raise NotUnderstood([place.words], NOT_IN_THIS_ORDER)
    load = where(reader, action.target, thing)
    if not isinstance(load, Thing):
        raise NotUnderstood([action.words], "lets a conveyor or a turntable carry blocks, balls and the like, not so:")
    support(reader, load, thing)
    do(load, "ride")


def _ride(reader: Reader, thing: Thing, action: Action) -> None:
    movable(thing, action)
    do(thing, "ride")
    for place in action.places:
        at = (
            where(reader, place.phrase, thing)
            if place.phrase is not None and place.preposition in ("on", "along")
            else None
        )
        if isinstance(at, Thing) and at.noun.family in CARRIERS:
            support(reader, thing, at)
        elif thing.support is not None and place.phrase is not None and place.phrase.part == "end":
            continue  # of what carries it
        elif not common(reader, thing, place):
            raise NotUnderstood([place.words], "lets things ride on a conveyor or a turntable, not there:")
    if thing.support is None:
        raise NotUnderstood([action.words], "lets things ride on a conveyor or a turntable; name it after")


def _move(reader: Reader, thing: Thing, action: Action) -> None:
    (_carry if action.target is not None else _run)(reader, thing, action)


def _run(reader: Reader, thing: Thing, action: Action) -> None:
    if thing.noun.family not in CARRIERS:
        said = thing.words if action.relative else f"{thing.words} {action.words}"
        raise NotUnderstood([said], "lets a conveyor run and a turntable turn, not this:")
    put(thing, "ground")
    do(thing, "run")
    for place in action.places:
        if not common(reader, thing, place):
            raise NotUnderstood([place.words], NOT_IN_THIS_ORDER)


# ---- on a hinge
def _swing(reader: Reader, thing: Thing, action: Action) -> None:
    if action.verb == "hang" and thing.noun.family == "solid":
        do(thing, "hang")
    struck: list[Place] = []
    stands: list[Place] = []  # where that is which it swings into
    for place in action.places:
        if place.preposition == "angle":
            thing.angle = place.value
            continue
        if common(reader, thing, place):
            continue
        at = where(reader, place.phrase, thing) if place.phrase is not None else None
        if isinstance(at, Thing) and at.noun.family in ("rod", "rope"):
            hang(reader, thing, at)
        elif struck and place.preposition == "on" and isinstance(at, Thing):
            stands.append(place)
        elif isinstance(at, Thing) and place.preposition in (*_INTO, "through") and action.verb == "swing":
            struck.append(place)
        elif at != "ground" or action.verb == "hang":
            raise NotUnderstood([place.words], "hangs things on a rod or a rope, not there:")
    if thing.noun.family != "pendulum" and thing.rod is None:
        raise NotUnderstood([action.words], "lets a pendulum swing, or what hangs on a rod or a rope, but not this:")
    put(thing, "ground")
    do(thing, action.verb)
    for place in struck:
        assert place.phrase is not None
        aim(reader, thing, place.phrase, action)
    if thing.target is not None and thing.target.support is None:
        stand(reader, thing.target, stands)


def _tilt(reader: Reader, thing: Thing, action: Action) -> None:
    if thing.support is not None and thing.support.noun.family == "seesaw":
        thing = thing.support  # "a ball drops onto a seesaw and it tilts"
    toward = [place for place in action.places if place.preposition in ("to", "towards", "toward", "down")]
    angles = [place.value for place in action.places if place.preposition == "angle"]
    if thing.noun.family != "seesaw" or len(angles) + len(toward) != len(action.places):
        raise NotUnderstood([action.words], "lets a seesaw tilt, but not this:")
    for place in toward:
        on = where(reader, place.phrase, thing) if place.phrase is not None else None
        if isinstance(on, Thing) and on.support is not thing:
            raise NotUnderstood([place.words], "tilts a seesaw to what is on it, not so:")
        thing.side = place.direction or (on.side if isinstance(on, Thing) else None)
    thing.angle = angles[0] if angles else thing.angle
    do(thing, "tilt")


def _go(reader: Reader, thing: Thing, action: Action) -> None:
    """Up or down, of a seesaw's end or of what is on it; off or down, of what rolls or slides."""
    if thing.noun.family == "vehicle" and action.verb == "go" and action.particle is None:
        wheels.drive(reader, thing, action)
        return
    seesaw = thing if thing.noun.family == "seesaw" else thing.support
    down_it = any(place.preposition in ("down", "off", "into", "along", "across") for place in action.places)
    if thing.noun.family == "solid" and (down_it or (action.particle == "down" and thing.path is not None)):
        go(reader, thing, action, "roll" if thing.round else "slide")
        return
    down = action.verb == "go" and action.particle == "down"
    if seesaw is None or seesaw.noun.family != "seesaw" or action.places or not (down or action.verb == "go_up"):
        raise NotUnderstood(
            [f"{thing.words} {action.words}"], "lets the ends of a seesaw go up and down, but not this:"
        )
    side = thing.side
    if side not in ("left", "right"):
        riders = [one for one in reader.cast.things if one.support is seesaw]
        if thing is seesaw or len(riders) not in (1, 2):
            raise NotUnderstood([action.words], "cannot tell which end of the seesaw this is:")
        side = thing.side = thing.side if thing.side in ("left", "right") else ("left", "right")[riders.index(thing)]
    falls_ = side if down else {"left": "right", "right": "left"}[side]
    if seesaw.side not in (None, falls_) and seesaw is not thing:
        raise UserError(f"{action.words!r}: the seesaw goes down at its {seesaw.side} end, the prompt says so")
    seesaw.side = falls_
    do(seesaw, "tilt")
    if thing is not seesaw and not down:
        do(thing, "rise")


def _balance(reader: Reader, thing: Thing, action: Action) -> None:
    """A seesaw that stays level; or what stands on something narrow."""
    if thing.noun.family == "seesaw" and not [place for place in action.places if not common(reader, thing, place)]:
        do(thing, "level")
        return
    if thing.support is not None and thing.support.noun.family == "seesaw" and not action.places:
        do(thing.support, "level")
        return
    _rest(reader, thing, action)


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
    """Slide towards something, and stand still before it or against it; what drives comes to rest by its brakes."""
    if "drive" in thing.does and all(place.preposition == "way" for place in action.places):
        for place in action.places:
            if thing.way not in (None, place.length):
                raise UserError(f"{action.words!r}: the prompt says before how far it drives")
            thing.way = place.length
        do(thing, "stop")
        return
    movable(thing, action)
    others = [place for place in action.places if not common(reader, thing, place)]
    short = [place.phrase for place in others if place.preposition == "before" and place.phrase is not None]
    against = [
        place for place in others if place.preposition in ("against", "at", "on", "in") and place.phrase is not None
    ]
    if len(short) + len(against) != len(others) or len(others) > 1:
        raise NotUnderstood([action.words], "lets a thing that slides stop before another, but not so:")
    if short:
        if thing.round or {"roll", "throw"} & {*thing.does}:
            raise NotUnderstood([action.words], "lets a thing that slides stop before another, but not so:")
        if not {"slide", "push"} & {*thing.does}:
            do(thing, "slide")
        aim(reader, thing, short[0], action)
        do(thing, "stop")
        return
    for place in against:
        assert place.phrase is not None
        at = where(reader, place.phrase, thing)
        if isinstance(at, Thing) and at.noun.family == "vessel":
            falls.land(reader, thing, action)
        elif isinstance(at, Thing) and place.preposition in ("against", "at"):
            aim(reader, thing, place.phrase, action)
            do(thing, "still")
        elif isinstance(at, Thing) and "drop" in thing.does:
            falls.land(reader, thing, action)
        elif at != "ground":
            raise NotUnderstood([action.words], "lets a thing come to rest against another, but not so:")
    if "drop" not in thing.does and thing.place != "water":
        do(thing, "still")


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
        group = place.phrase is not None and place.phrase.kind == "group" and place.phrase.members is None
        if place.phrase is not None and group and place.preposition in ("in", "into", "to"):
            if place.phrase.arrangement != "stack":
                raise NotUnderstood([action.words], "stacks things on one another, not so:")
            continue
        if place.preposition == "stacked":
            continue
        at = where(reader, place.phrase, thing) if place.phrase is not None else None
        if isinstance(at, Thing) and place.preposition in ("on", "onto"):
            support(reader, thing, at)
        elif at != "ground":
            raise NotUnderstood([action.words], "stacks things on the ground, not there:")
    arrange(reader, thing, "stack")


def _be(_reader: Reader, thing: Thing, action: Action) -> None:
    """What a clause of its own says of a thing: "the ramp is at 20 degrees", "the table is 0.8 m high"."""
    described, phrase = action.target, thing.phrase
    assert described is not None
    for name in ("material", "color", "length", "angle", "scale", "weight", "shape"):
        value = getattr(described, name)
        if value is None:
            continue
        if getattr(phrase, name) not in (None, value):
            raise UserError(f"{action.words!r}: the prompt says something else of {thing.words!r} before")
        setattr(phrase, name, value)
    for name, value in described.measures.items():
        if phrase.measures.get(name) not in (None, value):
            raise UserError(f"{action.words!r}: the prompt says something else of {thing.words!r} before")
        phrase.measures[name] = value


def _face(reader: Reader, thing: Thing, action: Action) -> None:
    if action.target is None or action.places:
        raise NotUnderstood([action.words], "needs to be told what it faces:")
    other = where(reader, action.target, thing)
    if not isinstance(other, Thing) or other is thing:
        raise NotUnderstood([action.words], "turns things to other things, not so:")
    thing.beside.append(Beside("FACING-TO", other))


def _rest(reader: Reader, thing: Thing, action: Action) -> None:
    stand(reader, thing, action.places)
    if "hang" not in thing.does and "drop" not in thing.does:
        do(thing, "rest")


def _refused(_reader: Reader, thing: Thing, action: Action) -> None:
    raise NotUnderstood([f"{thing.words} {action.words}"], "cannot let a thing do this:")


_RULES: dict[str, Callable[[Reader, Thing, Action], None]] = {
    "float": _in_water, "sink": _in_water, "submerge": _in_water,
    "topple": falls.topple, "fall": falls.fall, "drop": falls.fall, "bounce": falls.bounce, "land": falls.land,
    "roll": _roll, "slide": _slide, "push": push, "hit": strike, "knock": strike, "collide": strike, "touch": strike,
    "go": _go, "go_up": _go, "balance": _balance, "miss": _refused,
    "throw": _throw, "fly": _throw, "swing": _swing, "hang": _swing, "tilt": _tilt,
    "carry": _carry, "move": _move, "ride": _ride, "run": _run, "patrol": _patrol, "return": _return,
    "drive": wheels.drive, "cross": wheels.cross, "leave": wheels.leave, "reach": wheels.leave,
    "stop": _stop, "climb": _come_again, "die": _come_again,
    "stack": _stack, "face": _face, "rest": _rest, "start": _rest, "hold": _refused, "pour": _refused, "fill": _refused,
    "drain": _refused, "empty": _refused, "open": _refused, "close": _refused,
}  # fmt: skip
