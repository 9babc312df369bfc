"""What comes "then": it goes on by itself, or is let go later; nothing else would keep the order."""

from __future__ import annotations

from wsim.rules.cast import Thing
from wsim.rules.phrases import Clause
from wsim.rules.reader import Reader
from wsim.rules.tokens import NotUnderstood

THEN = 1.0  # after which is let go what falls then [s]
_GOING = {"drop", "roll", "slide", "push", "throw", "swing", "topple", "meet", "run"}  # what sets or keeps one going


def later(reader: Reader, clause: Clause, things: list[Thing], before: dict[int, list[str]]) -> None:
    """ "Then": what goes on, or is hit, does so in its time; what else falls then is let go later.

    Raises:
        NotUnderstood: It would start with all the rest.
    """
    for thing in things:
        did = before.get(id(thing), [])
        new = [what for what in thing.does if what not in did]
        starts = _GOING if id(thing) in before else _GOING | {"float", "sink", "submerge"}
        met = any(thing in (one.target, one.support, one.meets) for one in reader.cast.things)
        if "drop" in new and not _GOING & {*did} and thing.delay is None:
            thing.delay = THEN
            reader.cast.assume(thing.words, f"let go after {THEN:g} s", "the prompt says then, not when")
        elif starts & {*new} and not _GOING & {*did} and not met and thing.delay is None:
            raise NotUnderstood([f"then {clause.words}"], "starts what moves at once; say 'after two seconds', not")
