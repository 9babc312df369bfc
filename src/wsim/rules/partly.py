"""What is said of some of several, or of one alone: the others float where those sink, and sink where they float."""

from __future__ import annotations

from wsim.rules.places import do
from wsim.rules.reader import Reader

_INSTEAD = {"float": "sink", "sink": "float"}


def others(reader: Reader) -> None:
    """Let all else in the water do the other than what only some do, or what is said of some of several."""
    cast = reader.cast
    for verb in {verb for _, verb in cast.only}:
        alone = {id(thing) for thing, one in cast.only if one == verb}
        for thing in cast.things:
            if id(thing) not in alone and thing.place == "water":
                do(thing, _INSTEAD[verb])
    for some, rest in reader.partly:
        ends = {end for thing in some for end in _INSTEAD if end in thing.does}
        if len(ends) != 1 or not rest or any({*_INSTEAD, "submerge"} & {*thing.does} for thing in rest):
            continue
        instead = _INSTEAD[ends.pop()]
        for thing in rest:
            do(thing, instead)
            thing.place = thing.place or "water"
        choice = f"the other {len(rest)}: to {instead}" if len(rest) > 1 else f"the other: to {instead}"
        cast.assume(rest[0].words, choice, f"the prompt says what {len(some)} of {len(some) + len(rest)} do")
