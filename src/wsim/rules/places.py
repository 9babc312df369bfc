"""Where things are: the places of a phrase or an action, put to the cast."""

from __future__ import annotations

from wsim.assets import get
from wsim.errors import UserError
from wsim.rules.cast import Beside, Thing
from wsim.rules.lexicon import lexicon
from wsim.rules.phrases import Phrase, Place
from wsim.rules.reader import Reader
from wsim.rules.tokens import NOT_IN_THIS_ORDER, NotUnderstood

SURFACES = {"friction": 2.0, "restitution": 1.0}  # what of a surface may be said, and its most
MANNERS = ("head_on", "from_rest", "still", "together", "upright", "freely", "to_and_fro", "again", "level", "in_turn",
           "beside", "on_side", "stacked", "slowly", "quickly", "below")  # fmt: skip
CARRIED = ("solid", "vessel")  # families of what may stand on something
UPRIGHT = ("wall", "post")  # on which nothing is put, and over which things are thrown
MOST_INSIDE = 9  # things in a vessel
AT_RIM = 0.01  # above a vessel, of what comes to lie in it beside others [m]
FURNITURE = "furniture"  # of the catalogue's categories
ROOMY = ("table", "desk", "workbench")  # what has room under it
SIDES = ("LEFT-OF", "RIGHT-OF", "FRONT-OF", "BACK-OF")


def stand(reader: Reader, thing: Thing, places: list[Place]) -> None:
    """Where a thing is, when nothing says what it does there; "on a table in a corner" places the table, too."""
    for number, place in enumerate(places):
        if common(reader, thing, place):
            continue
        at = place.phrase
        across = place.words.startswith("across") and thing.noun.primitive == "box"  # "a plank lies across two bricks"
        if (
            place.length is not None
            or place.preposition not in ("in", "inside", "on", "at", "into", "onto", *(("along",) if across else ()))
            or at is None
        ):
            raise NotUnderstood([f"{thing.words} {place.words}"], "knows these words, but cannot place them")
        if at.kind == "group" and at.members is None and place.preposition in ("in", "into"):
            arrange(reader, thing, at.arrangement)
            continue
        below = thing.inside or thing.support
        if number and below is not None and (below.place is None or below.place == "ground"):
            stand(reader, below, [place])
            continue
        refuse_afloat(reader, thing, place)
        _stand_at(reader, thing, place, at)


def _stand_at(reader: Reader, thing: Thing, place: Place, at: Phrase) -> None:
    found = where(reader, at, thing)
    if isinstance(found, Thing):
        if at.kind == "pronoun" and (found.round or found.rod is not None):
            # Nothing stands on a ball, or on what hangs: it is what that is on, or above.
            found = found.path or found.support or found
        if part(at) in ("end", "bottom", "edge") and found.noun.family == "ramp":
            raise NotUnderstood([place.words], "stands things on a ramp, at its top, but not there:")
        if part(at) == "middle" and found.noun.family == "turntable":
            thing.side = "middle"
        inside = place.preposition in ("in", "inside", "into")
        vessels = reader.cast.family("vessel")
        if inside and at.kind == "pronoun" and found.noun.family != "vessel" and len(vessels) == 1:
            found = vessels[0]
        if inside and not (part(at) and found.noun.family != "vessel"):
            put_inside(reader, thing, found)
        elif found.noun.family in ("rod", "rope"):
            hang(reader, thing, found)
            return
        elif found.count == 2 and not found.group and thing.noun.primitive == "box" and thing.count == 1:
            first, second = reader.split(found)
            support(reader, thing, first)
            put(second, "ground")
            thing.bridges = second
        else:
            support(reader, thing, found)
        do(thing, "rest")
    elif found == "water":
        put(thing, "water")
        if part(at) == "bottom":
            do(thing, "sink")
        elif place.preposition == "on" or part(at) in ("surface", "top"):
            do(thing, "float")
    else:
        put(thing, "ground")
        do(thing, "rest")


def common(reader: Reader, thing: Thing, place: Place) -> bool:
    """Take a place that means the same whatever the thing does; False for the others."""
    if place.preposition == "side":
        _beside(reader, thing, place)
    elif place.preposition == "between":
        _between(reader, thing, place)
    elif place.preposition == "time":
        reader.cast.duration = place.value
    elif place.preposition == "after":
        thing.delay = place.value
    elif place.preposition == "speed":
        thing.speed = place.value
    elif place.preposition == "spin":
        thing.spin = place.value
    elif place.preposition in SURFACES:
        _surface(reader, thing, place)
    elif place.preposition == "angle" and thing.noun.family == "ramp":
        thing.phrase.angle = place.value
    elif place.preposition == "angle" and thing.path is not None and "swing" not in thing.does:
        if thing.path.phrase.angle not in (None, place.value):
            raise UserError(f"{place.words!r}: the prompt gives the ramp {thing.path.phrase.angle:g} degrees before")
        thing.path.phrase.angle = place.value
    elif place.preposition == "by_way":
        if not reader.cast.family("vehicle"):
            raise NotUnderstood([place.words], "sets things beside the way of a vehicle, but not so:")
    elif place.preposition == "stacked":
        arrange(reader, thing, "stack")
    elif place.preposition in MANNERS:
        thing.manners.add(place.preposition)
    elif place.preposition == "often":
        thing.times = int(place.value or 1)
    elif place.preposition == "spot":
        _spot(reader, thing, place)
    else:
        return False
    return True


def _spot(reader: Reader, thing: Thing, place: Place) -> None:
    """At an end of a thing: of what is named, else of what it is on, else of the last that has ends."""
    named = where(reader, place.phrase) if place.phrase is not None else thing.support or thing.path
    found = named or reader.part_of(Phrase("part", "", part="end"))
    if not isinstance(found, Thing) or found is thing:
        raise NotUnderstood([place.words], "cannot tell of what this is an end:")
    if thing.support is not found and thing.path is not found:
        support(reader, thing, found)
        do(thing, "rest")
    thing.side = place.direction


def _surface(reader: Reader, thing: Thing, place: Place) -> None:
    """How a thing, or two, rub or bounce."""
    value, most = place.value or 0.0, SURFACES[place.preposition]
    if value > most:
        raise UserError(f"{place.words!r}: a {place.preposition} of {value:g} is outside 0 to {most:g}")
    if place.phrase is None or place.other is None:
        thing.surface[place.preposition] = value
        return
    pair = [where(reader, phrase) for phrase in (place.phrase, place.other)]
    things = [one for one in pair if isinstance(one, Thing)]
    if "water" in pair or not things:
        raise NotUnderstood([place.words], "knows of a friction or a restitution between solid things, not so:")
    things[0].pairs.append((things[1] if len(things) > 1 else None, place.preposition, value))


def _beside(reader: Reader, thing: Thing, place: Place) -> None:
    assert place.side is not None and place.phrase is not None
    predicate = place.side.predicate
    other = where(reader, place.phrase, thing)
    if other == "water" and place.phrase.kind == "pronoun" and predicate != "SPAWNED-ABOVE":
        other = reader.it(place.phrase, thing)  # "a stone is dropped next to it": to what floats
    if predicate == "SPAWNED-ABOVE":
        _above(reader, thing, place, other)
        return
    if not isinstance(other, Thing) or other is thing:
        raise NotUnderstood([place.words], "places things by other things, not so:")
    if predicate == "under" and other.noun.key in ROOMY and thing.noun.family == "solid" and thing.count == 1:
        thing.beside.append(Beside("under", other))
        for one in (thing, other):
            put(one, "ground")
        do(thing, "rest")
        return
    if predicate == "under":
        if other.noun.family != "solid" or (other.support is not None and other.support is not thing):
            raise NotUnderstood(
                [place.words], f"builds a {other.kind} as a solid body that has no room under it, so not this:"
            )
        support(reader, other, thing)
        do(thing, "rest")
        return
    if other.count > 1 and not other.group:
        raise NotUnderstood([place.phrase.words], "cannot tell which of them this is")
    on = other.support
    if place.phrase.kind == "pronoun" and on is not None and on.noun.family == "furniture" and _furniture(thing):
        other = on  # "a laptop on a desk and a chair stands behind it"
    if "water" in (thing.place, other.place) and place.side.key == "next_to":
        for one in (thing, other):
            put(one, "water")
        thing.beside.append(Beside("beside", other))
        return
    if predicate not in SIDES and place.length is not None:
        raise NotUnderstood([place.words], NOT_IN_THIS_ORDER)
    if place.side.assume:
        reader.cast.assume(thing.words, place.side.assume, f"the prompt says {place.words!r}, not on which side")
    thing.beside.append(Beside(predicate, other, gap=place.length, loose=bool(place.side.assume)))
    if predicate in SIDES:
        put(thing, "ground")
        put(other, "ground")
        do(thing, "rest")


def _furniture(thing: Thing) -> bool:
    """Whether it is the catalogue's furniture, which stands beside a table, not on it."""
    asset = get(thing.noun.asset) if thing.noun.asset is not None else None
    return asset is not None and asset.category.startswith(FURNITURE)


def _above(reader: Reader, thing: Thing, place: Place, other: str | Thing) -> None:
    """Above a thing is where a fall begins."""
    if isinstance(other, Thing) and thing.support not in (None, other):
        raise NotUnderstood([place.words], "drops what is above a thing, and this stands on another:")
    if place.length is not None:
        thing.drop_height = place.length
    elif thing.drop_height is None and not isinstance(other, Thing):
        raise NotUnderstood([place.words], "needs a height, as in '0.5 m above the water':")
    if isinstance(other, Thing):
        support(reader, thing, other)
    else:
        put(thing, other)
    if "drop" not in thing.does and "hang" not in thing.does:
        reader.cast.assume(thing.words, "falls from there", "nothing is said to hold it up")
        do(thing, "drop")


def _between(reader: Reader, thing: Thing, place: Place) -> None:
    assert place.phrase is not None
    if place.other is None:
        pair = reader.thing(place.phrase) if place.phrase.kind in lexicon().nouns else None
        if pair is None or pair.count != 2 or pair.group:
            raise NotUnderstood([place.words], "needs to be told between which two things:")
        _put_between(thing, place, *reader.split(pair))
        return
    _put_between(thing, place, where(reader, place.phrase, thing), where(reader, place.other))


def _put_between(thing: Thing, place: Place, first: str | Thing, second: str | Thing) -> None:
    if not isinstance(first, Thing) or not isinstance(second, Thing) or len({thing, first, second}) < 3:
        raise NotUnderstood([place.words], "places things between two other things, not so:")
    thing.beside.append(Beside("between", first, second))
    for one in (thing, first, second):
        put(one, "ground")
    do(thing, "rest")


def where(reader: Reader, phrase: Phrase, thing: Thing | None = None) -> str | Thing:
    """The water, the ground, or a thing other than the one that is there."""
    if phrase.kind == "ground":
        reader.scenery(phrase)
        return "ground"
    if phrase.kind == "part":
        if phrase.owner is not None:
            return where(reader, phrase.owner, thing)
        own = thing.support or thing.path if thing is not None else None
        found = own or reader.part_of(phrase)
        if found is not None:
            return found
        if phrase.part in ("surface", "bottom", "top"):
            return "water"
        raise NotUnderstood([phrase.words], "cannot tell of what this is a part")
    if reader.is_scenery(phrase):
        reader.scenery(phrase)
        return "water"
    if phrase.kind == "pronoun":
        if reader.cast.wet and all(thing.place == "water" for thing in reader.last):
            return "water"
        return reader.it(phrase, thing)
    return reader.thing(phrase)


def refuse_afloat(reader: Reader, thing: Thing, place: Place) -> None:
    """Refuse "a plank floats and a cube lies on it", which the water is not.

    Raises:
        NotUnderstood: It is on what is in the water.
    """
    swims = any(one is not thing and one.place == "water" for one in reader.last)
    if (
        place.preposition in ("on", "onto")
        and place.phrase is not None
        and place.phrase.part in ("it", "them")
        and swims
    ):
        raise NotUnderstood([place.words], "stacks things on the ground, not on what is in the water:")


def part(phrase: Phrase) -> str | None:
    """Which part of its owner a phrase names."""
    return phrase.part if phrase.kind == "part" else None


def put(thing: Thing, place: str) -> None:
    """Say that a thing is in the water or on the ground."""
    if thing.place is not None and thing.place != place:
        raise UserError(f"{thing.words!r} cannot be in the water and on the ground")
    if place == "water" and thing.noun.family != "solid":
        raise NotUnderstood([thing.words], "puts blocks, balls and the like in water, but not this:")
    thing.place = place


def support(reader: Reader, thing: Thing, other: Thing) -> None:
    """Stand a thing on another."""
    if other is thing:
        raise NotUnderstood([thing.words], "cannot place a thing on itself:")
    if other.place == "water":
        raise UserError(
            f"{thing.words!r} on {other.words!r}: the builtin planner stacks things on the ground, not in water"
        )
    if other.count > 1 and not other.group:
        raise NotUnderstood([other.words], "cannot tell which of them this is")
    if other.noun.family in ("vessel", "rod", "rope", "pendulum") or thing.noun.family not in CARRIED:
        raise NotUnderstood([f"{thing.words} on {other.words}"], "cannot stand this on that:")
    put(thing, "ground")
    put(other, "ground")
    if other.noun.family == "ramp":
        thing.path = other
        return
    crowded = any(one is not thing and one.support is other for one in reader.cast.things)
    if crowded and other.noun.family not in ("furniture", "belt", "turntable", "seesaw"):
        raise UserError(f"{other.words!r}: the builtin planner puts one thing, or a stack, on another, not two")
    thing.support = other


def put_inside(reader: Reader, thing: Thing, other: Thing) -> None:
    """Put a thing in a vessel."""
    if other.noun.family != "vessel" or thing.noun.family != "solid" or other.count > 1:
        raise NotUnderstood([f"{thing.words} in {other.words}"], "puts things in a bowl or a bucket, but not this:")
    held = thing.count + sum(one.count for one in reader.cast.things if one.inside is other and one is not thing)
    if thing.group or held > MOST_INSIDE:
        raise UserError(f"{other.words!r}: the builtin planner puts up to {MOST_INSIDE} things in it, side by side")
    thing.inside = other
    if held > 1:
        for one in {*(one for one in reader.cast.things if one.inside is other), thing}:
            if "drop" not in one.does:
                do(one, "drop")
                one.drop_height = AT_RIM if one.drop_height is None else one.drop_height
                reader.cast.assume(one.words, "let go at the rim", "from there it settles among the others")
    put(thing, "ground")
    put(other, "ground")


def hang(reader: Reader, thing: Thing, rod: Thing) -> None:
    """Hang a thing, or each of several, on a rod or a rope, which is then no thing of its own."""
    counted = rod.phrase.count not in (None, 1, thing.count)
    if counted or thing.noun.family != "solid" or (rod.noun.family == "rod" and not thing.round):
        raise NotUnderstood(
            [f"{thing.words} on {rod.words}"], "hangs balls on rods, and solid things on ropes, but not"
        )
    reader.cast.things = [one for one in reader.cast.things if one is not rod]
    thing.rod = rod.phrase
    put(thing, "ground")
    do(thing, "hang")


def arrange(reader: Reader, thing: Thing, arrangement: str) -> None:
    """Stack things, or stand them in a row."""
    if thing.count < 2:
        raise UserError(f"{thing.words!r}: a {arrangement} has at least two things; give a number")
    thing.arrangement = arrangement
    put(thing, "ground")
    do(thing, "rest")


def do(thing: Thing, what: str) -> None:
    """Note what a thing does."""
    if what not in thing.does:
        thing.does.append(what)
    for a, b in (("float", "sink"), ("float", "submerge")):
        if a in thing.does and b in thing.does:
            raise UserError(f"{thing.words!r} cannot both {a} and {b}; the prompt asks for both")
