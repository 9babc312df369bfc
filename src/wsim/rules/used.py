"""What a prompt says of a thing and no scene would use, which is refused rather than dropped."""

from __future__ import annotations

from wsim.rules.cast import CARRIERS, Beside, Thing
from wsim.rules.holds import fillable
from wsim.rules.places import CARRIED
from wsim.rules.tokens import NotUnderstood

_GOES = {"roll", "slide", "push", "throw", "meet", "ride", "run", "patrol", "drive", "cross"}


def posed(thing: Thing) -> bool:
    """Whether it has a place of its own in its part of the scene, which rows do not give."""
    on = thing.support.noun.family if thing.support is not None else ""
    own = thing.noun.family in ("pendulum", "seesaw", "ramp", "belt", "turntable")
    return own or on in ("seesaw", "belt", "turntable") or thing.path is not None or thing.rod is not None


def check_used(thing: Thing, struck: bool) -> None:
    """Refuse what no scene would use, rather than drop it.

    Args:
        thing: Of the cast.
        struck: Whether something hits it.

    Raises:
        NotUnderstood: It says something that nothing comes of.
    """
    for beside in thing.beside:
        if beside.loose and (posed(thing) or posed(beside.ref)):
            beside.predicate = "beside"  # the parts of a scene are side by side
    for manner in {"slowly", "quickly"} & thing.manners:
        moves = {"roll", "slide", "push", "drive"} & {*thing.does}
        if thing.speed is not None or thing.path is not None or thing.off or thing.into or not moves:
            raise NotUnderstood([manner], "lets what goes along the ground do it")
    for given, problem in (*_adjectives(thing), *_manners(thing, struck), *_bearing(thing)):
        if given:
            raise NotUnderstood([thing.words], problem)


def _hangs_above(thing: Thing) -> bool:
    """Whether what hangs over something can be built: alone, above furniture that stands on the ground."""
    on = thing.support
    free = thing.count == 1 and thing.target is None and "drop" not in thing.does
    return on is not None and on.noun.family == "furniture" and on.support is None and free


def _bearing(thing: Thing) -> tuple[tuple[bool, str], ...]:
    """What carries it, and what it leaves: neither may be what the scenes lay out without it."""
    below, does = thing.support or thing.inside, {*thing.does}
    goes = below is not None and below.noun.family in CARRIED and (posed(below) or bool(_GOES & {*below.does}))
    table = thing.support is not None and thing.support.noun.family != "belt"
    hangs = thing.rod is not None or thing.noun.family == "pendulum"
    hit = thing.target
    swung = hit is not None and (hit.rod is not None or hit.noun.family == "pendulum")
    leans = hit is not None and hit.path is not None
    high = thing.path is not None and hit is not None and hit.support is not None
    alone = thing.support is None and thing.path is None and not thing.off and hit is None
    falls = alone and "drop" in does and bool({"roll", "slide"} & does)
    two = thing.path is not None and (thing.support is not None or thing.into is not None or thing.inside is not None)
    return (
        (swung, "lets things hit what stands, not what hangs, as this is to:"),
        (leans, "lets things hit what stands on the ground or a table, not what is on a ramp, as this is to:"),
        (high, "lets what comes down a ramp hit what stands on the ground, but not this:"),
        (thing.path is not None and "drop" in does, "lets things go on a ramp, and drops nothing onto it, such as"),
        (falls, "lets things fall, or roll or slide, but not this one after the other:"),
        (two, "lets what goes down a ramp go on along the ground, but not over or into what this is to:"),
        (goes, "puts nothing on what moves, hangs, or is on a ramp, a belt, a turntable or a seesaw, such as"),
        (thing.off and below is None and thing.path is None, "needs to be told off what this goes"),
        (thing.off and table and "drop" in does, "lets things roll or slide off a table, but not drop on it and leave"),
        (hangs and ("meet" in does or thing.meets is not None), "lets what hangs swing into a thing, but not this:"),
        (hangs and below is not None and not _hangs_above(thing), "hangs one thing, which hits nothing, above a table"),
    )


def _sides(thing: Thing) -> list[Beside]:
    """The rows that say where it is; neighbours in water are its row there."""
    return [beside for beside in thing.beside if beside.predicate != "beside"]


def _adjectives(thing: Thing) -> tuple[tuple[bool, str], ...]:
    phrase, family = thing.phrase, thing.noun.family
    moving = thing.target is not None or bool(_GOES & {*thing.does})
    carries = family in CARRIERS or (thing.support is not None and thing.support.noun.family == "belt")
    placed = thing.target or thing.meets or thing.path or thing.rod or thing.inside or thing.place == "water"
    ill = family in ("pendulum", "seesaw") or (thing.support is not None and thing.support.noun.family == "seesaw")
    strange = bool(set(phrase.measures) - {"x", "z", "mass", "radius", "diameter"})
    return (
        (phrase.angle is not None and family not in ("ramp", "pendulum"), "inclines a ramp, but not this"),
        (phrase.share == 0.0 and not fillable(thing.noun), "has empty tanks and vessels, but not this"),
        (thing.speed is not None and not moving and not carries, "needs to be told how this moves"),
        (
            thing.force is not None and bool(thing.round or thing.target or thing.path or thing.off or thing.speed),
            "pushes with a force what slides on the level, and hits nothing, but not this",
        ),
        (thing.delay is not None and not _waits(thing), "lets go after a time, or pushes with a force, but not so"),
        (thing.spin is not None and family != "turntable", "turns a turntable at a rate, but not this"),
        (bool(_sides(thing)) and bool(placed or ill), "cannot place this beside something, with what else it does"),
        (family == "pendulum" and strange, "cannot give a pendulum this measure"),
        (phrase.scale is not None and phrase.length is not None, "takes a size or a length, not both"),
        ({"mass", "density"} <= set(phrase.measures), "takes a mass or a density, not both"),
    )


def _waits(thing: Thing) -> bool:
    """Whether it may be held, and let go or pushed later: nothing else holds it or has set it going."""
    free = thing.support is None or not posed(thing)
    goes = bool({"throw", "swing", "meet", "roll", "slide"} & {*thing.does}) and thing.path is None
    return thing.force is not None or (
        thing.noun.family == "solid"
        and free
        and not goes
        and ("drop" in thing.does or thing.path is not None)
        and not thing.group
        and thing.rod is None
        and thing.speed is None
    )


def _manners(thing: Thing, struck: bool) -> tuple[tuple[bool, str], ...]:
    does, said, family = {*thing.does}, thing.manners, thing.noun.family
    hits = thing.target is not None or thing.meets is not None or "meet" in does or struck
    flat = thing.side not in (None, "middle") and family != "seesaw"
    on = thing.support.noun.family if thing.support is not None else ""
    return (
        ("head_on" in said and not hits, "needs to be told what this hits head on"),
        ("from_rest" in said and (thing.speed is not None or (thing.path is None and bool(_GOES & does))),
         "lets things start from rest on a ramp, but not this"),
        ("still" in said and bool(_GOES & does), "cannot let this move and be still"),
        ("upright" in said and thing.noun.primitive == "sphere", "stands what has ends upright, but not this"),
        ("to_and_fro" in said and not {"swing", "bounce"} & does, "lets what swings go to and fro, but not this"),
        ("again" in said and "bounce" not in does, "lets what bounces do it again, but not this"),
        ("level" in said and "seesaw" not in (family, on), "keeps a seesaw level, but not this"),
        ("below" in said and thing.into is None, "lets things fall into a vessel below them, but not this:"),
        ("in_turn" in said and "topple" not in does, "lets things fall one after another, but not this"),
        (thing.times is not None and "bounce" not in does, "counts bounces, but not this"),
        (thing.times is not None and "throw" in does, "counts bounces of what falls, not of what is thrown:"),
        (flat and on != "seesaw", "puts things at the ends of a seesaw, but not of this"),
    )  # fmt: skip
