"""Clauses become a cast: which things there are, where they are, and what each is to do."""

from __future__ import annotations

from wsim.errors import UserError
from wsim.rules.actions import MOVES, act, meet
from wsim.rules.cast import CARRIERS, Cast, Pour, Thing
from wsim.rules.grammar import NotUnderstood
from wsim.rules.phrases import Action, Clause, Phrase
from wsim.rules.places import stand
from wsim.rules.reader import EACH_OTHER, Reader


def understand(clauses: list[Clause]) -> Cast:
    """Who does what, where.

    Raises:
        NotUnderstood: a thing or an action cannot be bound to the scene.
        UserError: the prompt contradicts itself.
    """
    reader = Reader()
    for clause in clauses:
        _clause(reader, clause)
    _settle(reader)
    return reader.cast


def _clause(reader: Reader, clause: Clause) -> None:
    """Take in one clause."""
    subjects: list[Thing] = []
    scenery = []
    pending: list[Phrase] = []
    for phrase in clause.subjects:
        if reader.is_scenery(phrase):
            reader.scenery(phrase)
            scenery.append(phrase)
            continue
        if phrase.kind == "pronoun":
            subjects += reader.pronoun(phrase, clause.actions)
        else:
            subjects.append(reader.thing(phrase))
        pending.append(phrase)
        if phrase.places:  # "a cork ball and an iron ball in a tank": both are in it
            for thing in subjects[-len(pending) :]:
                stand(reader, thing, phrase.places)
            pending = []
    for action in clause.actions:
        if _of_scenery(reader, clause, scenery, subjects, action):
            continue
        if action.verb in ("collide", "hit") and (action.target is None or action.target.part in EACH_OTHER):
            meet(reader, subjects, action)
            continue
        for thing in subjects:
            act(reader, thing, action)
    if subjects:
        reader.last = subjects


def _of_scenery(reader: Reader, clause: Clause, scenery: list[Phrase], subjects: list[Thing], action: Action) -> bool:
    """Whether an action is the tank's or the water's, and is done with."""
    if action.verb == "pour":
        if subjects or any(phrase.kind != "water" for phrase in scenery):
            raise NotUnderstood([clause.words], "pours water, but not this")
        _pour(reader, action)
        return True
    if action.verb == "hold":
        held = action.target
        if subjects or held is None or held.kind != "water" or any(phrase.kind != "tank" for phrase in scenery):
            raise NotUnderstood([clause.words], "knows only of a tank that holds water, not of this")
        reader.scenery(held)
        return True
    standing = action.verb == "rest" and all(
        place.phrase is not None and place.phrase.kind == "ground" for place in action.places
    )
    back = any(place.phrase is not None and place.phrase.kind in ("pronoun", "water") for place in action.places)
    if scenery and not (standing and not subjects) and not (subjects and back):
        raise NotUnderstood([clause.words], "lets blocks and balls act, but not a tank, water or the ground")
    return False


def _pour(reader: Reader, action: Action) -> None:
    vessel, height, level = None, None, None
    into = False
    for place in action.places:
        if place.preposition == "from" and place.length is not None:
            height = place.length
        elif place.preposition == "up to":
            level = place.length
        elif place.preposition == "time":
            reader.cast.duration = place.value
        elif place.preposition in ("into", "in", "inside", "onto") and place.phrase is not None:
            into = True
            if place.phrase.kind == "pronoun":
                raise NotUnderstood([place.words], "needs to be told into what:")
            vessel = None if reader.is_scenery(place.phrase) else reader.thing(place.phrase)
            if vessel is None and place.phrase.kind != "tank":
                raise NotUnderstood([action.words], "pours water into a tank, a bowl or a bucket, not there:")
            if vessel is None:
                reader.scenery(place.phrase)
        else:
            raise NotUnderstood([place.words], "cannot pour water there:")
    if not into or (vessel is not None and (vessel.noun.family != "vessel" or vessel.count > 1)):
        raise NotUnderstood([action.words], "pours water into a tank, a bowl or a bucket:")
    reader.cast.pour = Pour(vessel, height, level)


def _settle(reader: Reader) -> None:
    """Give each thing whose place is open the one that the rest of the scene leaves for it."""
    for thing in reader.cast.things:
        _check_used(thing)
        if thing.place is not None:
            continue
        moves = bool({*MOVES, "topple"} & {*thing.does}) or thing.group or thing.noun.family != "solid"
        wet = reader.cast.wet and not moves
        thing.place = "water" if wet else "ground"
        if thing.noun.family in ("vehicle", "land", "dock", "pontoon"):
            continue
        if ("drop" in thing.does or not thing.does) and thing.support is None and thing.inside is None:
            where = "in the tank of water" if wet else "on the ground"
            reader.cast.assume(thing.words, where, "the prompt does not say where")
    _check_water(reader.cast)
    if not reader.cast.things and not reader.cast.wet and reader.cast.pour is None:
        raise NotUnderstood(["the prompt"], "found nothing to build in")


def _check_water(cast: Cast) -> None:
    """Refuse what is stacked or rolls where there is water."""
    for thing in cast.things:
        if thing.group and thing.place == "water":
            raise UserError(
                f"{thing.words!r}: the builtin planner stacks things on the ground, not in water; unstack them, or "
                "leave the water out"
            )
    for thing in cast.things:
        if cast.wet and {*MOVES} & {*thing.does}:
            raise UserError(
                f"{thing.words!r}: the builtin planner rolls things in a scene without a tank; leave the tank out, or "
                "what rolls"
            )


def _check_used(thing: Thing) -> None:
    """Refuse what no scene would use, rather than drop it."""
    phrase, family = thing.phrase, thing.noun.family
    goes = {"roll", "slide", "push", "throw", "meet", "ride", "run", "patrol", "drive", "cross"}
    moving = thing.target is not None or goes & {*thing.does}
    carries = family in CARRIERS or (thing.support is not None and thing.support.noun.family == "belt")
    posed = thing.target or thing.meets or thing.path or thing.rod or thing.inside or thing.place == "water"
    ill = family in ("pendulum", "seesaw") or (thing.support is not None and thing.support.noun.family == "seesaw")
    for given, problem in (
        (phrase.angle is not None and family != "ramp", "inclines a ramp, but not this"),
        (phrase.filled, "fills a tank, a bucket or a bowl with water, but not this"),
        (thing.speed is not None and not moving and not carries, "needs to be told how this moves"),
        (thing.spin is not None and family != "turntable", "turns a turntable at a rate, but not this"),
        (bool(thing.beside) and bool(posed or ill), "cannot place this beside something, with what else it does"),
        (
            family == "pendulum" and bool(set(phrase.measures) - {"x", "z", "mass"}),
            "cannot give a pendulum this measure",
        ),
        (phrase.scale is not None and phrase.length is not None, "takes a size or a length, not both"),
        ({"mass", "density"} <= set(phrase.measures), "takes a mass or a density, not both"),
    ):
        if given:
            raise NotUnderstood([thing.words], problem)
