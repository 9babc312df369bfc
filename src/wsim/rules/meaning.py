"""Clauses become a cast: which things there are, where they are, and what each is to do."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

from wsim.assets import get
from wsim.errors import UserError
from wsim.rules import flows, holds
from wsim.rules.actions import MOVES, act, meet
from wsim.rules.cast import CARRIERS, Cast, Thing
from wsim.rules.contents import check_amount, depth_of
from wsim.rules.later import later
from wsim.rules.lexicon import lexicon
from wsim.rules.liquids import Filled
from wsim.rules.partly import others
from wsim.rules.phrases import Action, Clause, Phrase, Place
from wsim.rules.places import CARRIED, UPRIGHT, common, do, put_inside, stand, support
from wsim.rules.poured import pour
from wsim.rules.reader import EACH_OTHER, Reader
from wsim.rules.tokens import NotUnderstood
from wsim.rules.used import check_used


def understand(clauses: list[Clause]) -> Cast:
    """Who does what, where.

    Raises:
        NotUnderstood: a thing or an action cannot be bound to the scene.
        UserError: the prompt contradicts itself.
    """
    reader = Reader()
    reader.alone = holds.stand_alone(clauses)
    for clause in [each for one in clauses for each in _of_the_last(one)]:
        _clause(reader, clause)
    _settle(reader)
    for found in (reader.cast.said, reader.cast.named):
        found[:] = [(now, said) for thing, said in found for now in reader.now(thing)]  # type: ignore[misc]
    return reader.cast


def _of_the_last(clause: Clause) -> list[Clause]:
    """ "A laptop on a desk and a chair stands behind it": that is said of the last alone, by what is named before."""
    places = [place for action in clause.actions for place in action.places]
    back = any(place.phrase is not None and place.phrase.part in ("it", "them") for place in places)
    if len(clause.subjects) < 2 or not back:
        return [clause]
    named = replace(clause, subjects=clause.subjects[:-1], actions=[])
    return [named, replace(clause, subjects=clause.subjects[-1:])]


def _clause(reader: Reader, clause: Clause) -> None:
    """Take in one clause."""
    _say_held(clause)
    flows.comes_later(clause)
    did = {id(thing): [*thing.does] for thing in reader.cast.things}
    subjects: list[Thing] = []
    scenery = []
    pending: list[Thing] = []
    given: list[Thing] = []
    for phrase in clause.subjects:
        if clause.given and not clause.actions and holds.poured_into(reader.last, phrase):
            continue
        if reader.is_scenery(phrase):
            if flows.is_source(phrase):
                flows.named(reader, phrase)
            else:
                reader.scenery(phrase)
            scenery.append(phrase)
            continue
        found = reader.subjects(phrase, clause.actions)
        if phrase.nth is not None and any(thing.group for thing in found):
            clause.actions = [_of_one(phrase, action) for action in clause.actions]
        subjects += found
        pending += found
        if clause.given and not clause.actions:
            _given(reader, [*given, *found] if _inside(phrase) else found, phrase)
            given = [] if phrase.places else [*given, *found]
            continue
        if phrase.places and not clause.again:  # "a cork ball and an iron ball in a tank": both are in it
            before = pending[: -len(found)] if found and not clause.given else []
            if before and any(place.phrase is not None and place.phrase.part == "it" for place in phrase.places):
                reader.last, pending = before[-1:], found  # "a table and a laptop on it"
            for thing in pending:
                stand(reader, thing, phrase.places)
            pending = []
        for said in phrase.clauses if not clause.again else ():
            _together(reader, found, said)
    if any(phrase.only for phrase in clause.subjects):
        _only(reader, clause, subjects)
    if clause.within is not None:
        for thing in subjects:
            _within(reader, thing, clause.within)
    whole = [phrase.owner for phrase in clause.subjects if phrase.kind == "choice" and phrase.owner is not None]
    named = [phrase for phrase in whole if phrase.kind in lexicon().nouns]
    if named:
        reader.spoken = [one for phrase in named for one in reader.now(reader.thing(phrase))]
    if any(p.members is not None or p.kind not in ("choice", "pronoun", "part") for p in clause.subjects):
        if clause.given:
            reader.earlier.append((reader.spoken, reader.chosen))
        reader.spoken, reader.chosen = [*subjects], []
    for number, action in enumerate(clause.actions):
        last = _last(reader, clause.actions[number - 1]) if action.relative and number else None
        if last is not None:
            _together(reader, [last], action)
        elif not _of_scenery(reader, clause, scenery, subjects, action):
            _together(reader, subjects, action)
        for phrase in _places_of(action):
            _say(reader, phrase, subjects)
    for phrase in clause.subjects if not clause.again else ():
        for place in phrase.places:
            for each in (place.phrase, place.other):
                if each is not None:
                    _say(reader, each, subjects)
    if clause.then:
        later(reader, clause, subjects, did)
    if subjects:
        reader.last = [thing for thing in subjects if thing in reader.cast.things] or reader.last


def _only(reader: Reader, clause: Clause, things: list[Thing]) -> None:
    """ "Only the cork floats": all else in the water does not, which has to be so where the prompt says it."""
    verbs = [action.verb for action in clause.actions]
    if len(verbs) != 1 or verbs[0] not in ("float", "sink"):
        raise NotUnderstood([clause.words], "knows of things of which only some float or sink, not of this")
    reader.cast.only += [(thing, verbs[0]) for thing in things]


def _inside(phrase: Phrase) -> bool:
    """Whether it is said to be in something, as what is named with it then is: "with a ball and a brick in it"."""
    return any(place.preposition in ("in", "inside") for place in phrase.places)


def _given(reader: Reader, things: list[Thing], phrase: Phrase) -> None:
    """ "A desk with a monitor, and a mouse in front of it": on the desk, but for other furniture; "it" is the last."""
    for thing in things:
        carriers = [one for one in reader.last if one.noun.family in _CARRY and one.noun.key not in UPRIGHT]
        carrier = next((one for one in carriers if one.count == 1), None)
        asset = get(thing.noun.asset) if thing.noun.asset is not None else None
        small = asset is None or not asset.category.startswith(FURNITURE)
        stand(reader, thing, phrase.places)
        if carrier is not None and small and thing.place is None and thing.noun.family in CARRIED:
            if carrier.noun.family == "vessel":
                put_inside(reader, thing, carrier)
            else:
                support(reader, thing, carrier)
            do(thing, "ride" if carrier.noun.family in CARRIERS else "rest")
        reader.last = [thing, *reader.last]
    for said in phrase.clauses:
        _together(reader, things, said)


def _last(reader: Reader, action: Action) -> Thing | None:
    """What an action names last, of which "which" speaks; None of the tank, the water and the ground."""
    named = [phrase for phrase in _places_of(action) if phrase.kind == "group" or phrase.kind in lexicon().nouns]
    return reader.thing(named[-1]) if named and not reader.is_scenery(named[-1]) else None


def _of_one(phrase: Phrase, action: Action) -> Action:
    """What one of a row is said to do, where it comes to the same for the row: the first tips it, and each of it falls.

    Raises:
        NotUnderstood: The row would be planned as if all of it did so.
    """
    agents = [place for place in action.places if place.preposition == "by"]
    plain = action.target is None and action.particle != "off" and len(agents) == len(action.places)
    if plain and action.verb in PASSIVE and phrase.nth == 1:
        pushed = action.verb == "push" and not agents
        return replace(action, particle="over") if pushed else action
    if plain and not agents and action.verb in ("topple", "fall"):
        return action
    raise NotUnderstood(
        [f"{phrase.words} {action.words}"], "lets one of a row be tipped or fall over with the rest, not"
    )


def _together(reader: Reader, subjects: list[Thing], action: Action) -> None:
    """Let some things do what is said: two that go at each other as a pair, the rest each for itself."""
    each_other = [place for place in action.places if place.phrase is not None and place.phrase.part in EACH_OTHER]
    meets = action.verb in ("collide", "hit", "touch") and not any(
        p.preposition in ("with", "into") for p in action.places
    )
    agents = [place for place in action.places if place.preposition == "by" and place.phrase is not None]
    if (not agents and meets and (action.target is None or action.target.part in EACH_OTHER)) or (
        each_other and action.verb in ("roll", "slide", "move", "push", "run")
    ):
        if not (meets and any("meet" in thing.does for thing in subjects)):
            meet(reader, subjects, action)
        elif not all(common(reader, thing, place) for place in action.places for thing in subjects):
            raise NotUnderstood([action.words], "lets two things collide, but not so:")
        return
    if agents and action.target is None and action.verb in PASSIVE:
        _by(reader, subjects, action, agents[0])
        return
    if len(subjects) > 1 and all(thing.count == 1 for thing in subjects):
        action = _arranged(reader, subjects, action)
    if action.verb == "hold" and action.target is not None and action.target.kind != "water":
        _hold(reader, subjects, action)
        return
    back = any(place.phrase is not None and place.phrase.kind == "pronoun" for place in action.places)
    if back and action.verb in ("roll", "slide", "go") and any(thing.noun.family == "solid" for thing in subjects):
        subjects = [thing for thing in subjects if thing.noun.family == "solid"]  # "a ramp, and a ball rolls down it"
    for thing in subjects:
        carrier = thing.support if thing.support is not None and thing.support.noun.family == "turntable" else None
        if action.verb == "run" and carrier is not None:
            thing = carrier
        if action.verb == "carry" and action.target is None and thing.noun.family == "solid":
            action = replace(action, verb="ride")  # "is carried to the end"
        if action.verb in ("move", "run") and thing.noun.family == "solid" and action.target is None:
            action = replace(action, verb="roll" if thing.round else "slide")
        act(reader, thing, action)


def _by(reader: Reader, subjects: list[Thing], action: Action, agent: Place) -> None:
    """ "Is hit by a ball": what the agent does to it."""
    assert agent.phrase is not None
    if len(subjects) != 1:
        raise NotUnderstood([action.words], "lets one thing be hit by another; name one:")
    target = Phrase("the", subjects[0].words)
    reader.named[id(target)] = subjects[0]
    reader.kept.append(target)
    for thing in reader.subjects(agent.phrase, []):
        places = [place for place in action.places if place is not agent]
        act(reader, thing, replace(action, target=target, places=places))


def _arranged(reader: Reader, things: list[Thing], action: Action) -> Action:
    """Several that are named one by one, in a stack or a row: what is left to say of each."""
    rows = [p for p in action.places if p.phrase is not None and p.phrase.kind == "group" and not p.phrase.members]
    stacked = action.verb == "stack" or any(place.preposition == "stacked" for place in action.places)
    arranged = {place.phrase.arrangement for place in rows if place.phrase is not None}
    if stacked or arranged == {"stack"}:
        reader.cast.assume(things[0].words, "at the bottom", "the prompt does not say which is on which")
        for lower, upper in pairwise(things):
            support(reader, upper, lower)
            do(upper, "rest")
        places = [place for place in action.places if place not in rows and place.preposition != "stacked"]
        stand(reader, things[0], places)
        do(things[0], "rest")
        return replace(action, verb="rest", places=[])
    if action.verb == "rest" and arranged == {"row"}:
        reader.cast.assume(things[0].words, "in a row from right to left", "the prompt does not say along which line")
        return replace(action, places=[place for place in action.places if place not in rows])
    return action


def _hold(reader: Reader, subjects: list[Thing], action: Action) -> None:
    """ "A bucket holds three stones": they are in it."""
    if len(subjects) != 1 or subjects[0].noun.family != "vessel" or action.target is None or action.places:
        words = " ".join([*(thing.words for thing in subjects), action.words])
        raise NotUnderstood([words], "knows of a bowl or a bucket that holds things, but not this")
    for thing in reader.subjects(action.target, []):
        put_inside(reader, thing, subjects[0])
        do(thing, "rest")


def _within(reader: Reader, thing: Thing, place: Place) -> None:
    """In the tank, or on the table or ramp, that the clause before names."""
    if thing.support is None and thing.inside is None and thing.path is None:
        if place.preposition == "down":
            assert place.phrase is not None
            support(reader, thing, reader.thing(place.phrase))
        else:
            stand(reader, thing, [place])


def _say_held(clause: Clause) -> None:
    """ "A tank that holds water" is one that is filled."""
    for phrase in [*clause.subjects, *(each for action in clause.actions for each in _places_of(action))]:
        for said in phrase.clauses:
            if said.verb == "hold" and said.target is not None and said.target.kind == "water":
                held = said.target
                phrase.filled = Filled(held.liquid, volume=held.volume, level=depth_of(held))
                phrase.clauses = [one for one in phrase.clauses if one is not said]


def _places_of(action: Action) -> list[Phrase]:
    found = [action.target, *(each for place in action.places for each in (place.phrase, place.other))]
    return [phrase for phrase in found if phrase is not None]


def _say(reader: Reader, phrase: Phrase, subjects: list[Thing]) -> None:
    """What a relative clause says of a thing that another clause names; if that stands still, of the subject."""
    inner = [phrase.owner] if phrase.owner is not None else []
    for each in [*inner, *([phrase.members] if phrase.members is not None else [])]:
        _say(reader, each, subjects)
    if not phrase.clauses:
        return
    if reader.is_scenery(phrase):
        raise NotUnderstood([phrase.words], "lets blocks and balls act, but not a tank, water or the ground")
    named = phrase.kind != "pronoun" and (phrase.kind != "group" or phrase.members is not None)
    thing = reader.thing(phrase) if named else None  # "a ball on it that rolls off": the ball does
    for said in phrase.clauses:
        stands = said.verb == "rest" and any(place.phrase is not None for place in said.places)
        own = thing is not None and (thing.noun.family in _ACTS or stands or said.verb in ("run", "move", "tilt"))
        for one in [thing] if own and thing is not None else subjects:
            act(reader, one, said)


PASSIVE = ("hit", "knock", "topple", "push", "touch", "carry")
_CARRY = ("furniture", "vessel", *CARRIERS)  # families of what has on it, or in it, what it is said to be with
FURNITURE = "furniture"  # of the catalogue's categories: what stands beside a table, not on it
_ACTS = ("solid", "belt", "turntable", "pendulum", "seesaw", "robot", "vehicle")


def _of_scenery(reader: Reader, clause: Clause, scenery: list[Phrase], subjects: list[Thing], action: Action) -> bool:
    """Whether an action is the tank's or the water's, and is done with."""
    if not scenery and subjects and not flows.sourced(action) and holds.held(reader.cast, subjects, action):
        return True
    if flows.flows(reader, clause, scenery, subjects, action):
        return True
    if action.verb == "pour":
        if subjects or any(phrase.kind != "water" for phrase in scenery):
            raise NotUnderstood([clause.words], "pours water, but not this")
        pour(reader, action)
        return True
    if action.verb == "hold":
        held = action.target
        if held is not None and held.kind != "water" and not scenery:
            return False
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


def _settle(reader: Reader) -> None:
    """Give each thing whose place is open the one that the rest of the scene leaves for it."""
    for thing in [one for one in reader.cast.things if one.count > 1 and one.noun.family in _SINGLE]:
        reader.split(thing)
    others(reader)
    for thing in reader.cast.things:
        _share_table(thing)
        check_used(thing, struck=any(one.target is thing for one in reader.cast.things))
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
    check_amount(reader.cast)
    for flow in reader.cast.flows:
        flow.settle()
    if not reader.cast.things and not reader.cast.wet and reader.cast.pour is None and not reader.cast.flows:
        raise NotUnderstood(["the prompt"], "found nothing to build in")


def _check_water(cast: Cast) -> None:
    """Refuse what is stacked or rolls where there is water."""
    for thing in cast.things:
        if thing.group and thing.place == "water":
            raise UserError(
                f"{thing.words!r}: the builtin planner stacks things on the ground, not in water; unstack them, or "
                "leave the water out"
            )


_SINGLE = ("ramp", "seesaw", "belt", "turntable")  # families that are built one by one


def _share_table(thing: Thing) -> None:
    """What is hit by a thing that goes along a table stands on that table, too."""
    target, on = thing.target, thing.support
    if target is None or on is None or target.support is not None or thing.off:
        return
    if on.noun.family == "furniture" and target.noun.family == "solid":
        target.support = on
