"""Vessels of the catalogue that are said to hold a liquid: a mug of coffee, a bowl half full of water."""

from __future__ import annotations

from collections.abc import Iterator

from wsim.assets import get
from wsim.errors import UserError
from wsim.rules import contents
from wsim.rules.cast import Cast, Thing
from wsim.rules.lexicon import Noun, lexicon
from wsim.rules.liquids import Filled
from wsim.rules.phrases import Action, Clause, Phrase, Place
from wsim.rules.tokens import NotUnderstood

_STILL = ("rest", "be", "hold", "fill", "face")  # what is said of what a vessel that holds a liquid stands among
_IN = ("in", "into", "inside")


def fillable(noun: Noun) -> bool:
    """Whether a thing is one of the catalogue's that are hollow."""
    asset = get(noun.asset) if noun.asset is not None else None
    return asset is not None and asset.hollow is not None and noun.family in ("solid", "vessel")


def stand_alone(clauses: list[Clause]) -> bool:
    """Whether nothing is in, or comes into, what holds a liquid: then a bowl of water is that bowl, and no tank."""
    for clause in clauses:
        actions = [*clause.actions, *(said for phrase in clause.subjects for said in phrase.clauses)]
        if clause.within is not None or any(action.verb not in _STILL for action in actions):
            return False
        wet = len(clause.subjects) == 1 and clause.subjects[0].kind == "water"
        if any(place.preposition in _IN for place in _places(clause)) and not wet:
            return False
    return True


def _places(clause: Clause) -> Iterator[Place]:
    for phrase in clause.subjects:
        yield from phrase.places
    for action in clause.actions:
        yield from action.places


def held(cast: Cast, things: list[Thing], action: Action) -> bool:
    """Take in that things hold a liquid: "a mug holds tea", "a vase is filled with water"; False for all else."""
    full = next((place.full for place in action.places if place.preposition == "full"), None)
    target = action.target
    if action.verb == "hold" and target is not None and target.kind == "water":
        filled = Filled(target.liquid, volume=target.volume, level=contents.depth_of(target), color=target.color)
    elif action.verb == "fill" and full is not None and full.filled and target is None:
        filled = full.filled
    elif action.verb == "fill" and len(things) == 1 and things[0].phrase.filled and target is None:
        filled = things[0].phrase.filled  # "fill a mug with tea"
    else:
        return False
    others = [place for place in action.places if place.preposition != "full"]
    if len(things) != 1 or not fillable(things[0].noun) or others:
        return False
    phrase = things[0].phrase
    if phrase.filled and phrase.filled != filled:
        raise UserError(f"{action.words!r}: the prompt says before what it holds")
    phrase.filled = filled
    phrase.share = filled.share if filled.share is not None else phrase.share
    return True


def poured_into(things: list[Thing], phrase: Phrase) -> bool:
    """Take in what a vessel is named with: "a bowl with 3 cm of water in it"; False for all else."""
    if phrase.kind != "water" or len(things) != 1 or not fillable(things[0].noun) or things[0].phrase.filled:
        return False
    back = all(place.preposition in _IN and place.phrase is not None and place.phrase.part in ("it", "them")
               for place in phrase.places)  # fmt: skip
    if not back:
        return False
    level = contents.depth_of(phrase)
    things[0].phrase.filled = Filled(phrase.liquid, volume=phrase.volume, level=level, color=phrase.color)
    return True


def holding(cast: Cast) -> Thing | None:
    """The vessel that holds a liquid, which stands still.

    Raises:
        NotUnderstood: It cannot, or there are several, or a tank beside it.
    """
    found = [thing for thing in cast.things if thing.phrase.filled or thing.phrase.share]
    if not found:
        return None
    thing, phrase = found[0], found[0].phrase
    if not fillable(thing.noun):
        raise NotUnderstood([phrase.words], "fills tanks, and what of the catalogue is hollow, but not this:")
    if not phrase.filled:
        raise NotUnderstood([phrase.words], "needs to be told with what this is full:")
    if len(found) > 1 or thing.count > 1 or cast.wet or cast.flows or cast.pour is not None:
        raise NotUnderstood([phrase.words], "fills one vessel in a scene, or one tank, and not this as well:")
    moves = {*thing.does} - {"rest"}
    loads = [one for one in cast.things if thing in (one.inside, one.into, one.support, one.target, one.path)]
    if moves or loads or thing.target is not None or thing.rod is not None or thing.inside is not None:
        raise NotUnderstood(
            [phrase.words], "lets what is full of a liquid stand still with nothing in it, but not this:"
        )
    contents.fill(cast, phrase.filled, phrase.words)
    cast.water = phrase.words
    return thing


def takes(phrase: Phrase) -> bool:
    """Whether a phrase names a vessel that is said to hold a liquid."""
    noun = lexicon().nouns.get(phrase.kind)
    return noun is not None and bool(phrase.filled) and fillable(noun)
