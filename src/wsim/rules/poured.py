"""A block of liquid that is poured: into what, from how high, and up to where."""

from __future__ import annotations

from wsim.rules.cast import Pour
from wsim.rules.phrases import Action
from wsim.rules.reader import Reader
from wsim.rules.tokens import NotUnderstood


def pour(reader: Reader, action: Action) -> None:
    """Take in that liquid is poured into a tank or a vessel.

    Raises:
        NotUnderstood: It is poured elsewhere, or so as it cannot be.
    """
    if action.target is not None:
        raise NotUnderstood([action.words], "pours a liquid into a tank, a bucket or a bowl, not so:")
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
    held = reader.cast.filled
    if held is not None and held.level is not None:
        if level not in (None, held.level):
            raise NotUnderstood([action.words], "is told twice how high this is to stand:")
        level = held.level
    reader.cast.pour = Pour(vessel, height, level)
