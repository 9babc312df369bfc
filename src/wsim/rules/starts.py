"""Beside, behind or under a thing: where something starts. Where it comes to is nothing that a row could give."""

from __future__ import annotations

from wsim.rules.cast import Thing
from wsim.rules.phrases import Action
from wsim.rules.tokens import NotUnderstood

_IS = ("is ", "are ", "was ", "were ")
_ENDS = ("land", "stop", "bounce", "roll", "slide", "move", "go", "fall", "drop", "push", "hit", "fly", "throw")
_MOVING = {"roll", "slide", "push", "throw", "swing", "meet", "ride"}
_PASSES = ("roll", "slide", "move", "go", "push", "fly", "throw", "drive")  # what goes under a thing would start there
_HOW = ("SPAWNED-ABOVE", "FACING-TO", "FACING-OPPOSITE-TO")  # as it starts, whatever it does


def check_starts(thing: Thing, action: Action) -> None:
    """Refuse "rolls and lands behind a box", "rolls under a table".

    Args:
        thing: Of the cast, with what it was said to do so far.
        action: What it is said to do now.

    Raises:
        NotUnderstood: It says beside what it comes to be.
    """
    told = action.verb in _ENDS or (action.verb == "rest" and not action.words.startswith(_IS))
    goes = thing.off or (told and bool(_MOVING & {*thing.does}))
    for place in action.places:
        if place.preposition not in ("side", "between"):
            continue
        predicate = place.side.predicate if place.side is not None else "between"
        if (goes and predicate not in _HOW) or (predicate == "under" and action.verb in _PASSES):
            raise NotUnderstood([action.words], "says where things start, not where they come to:")
