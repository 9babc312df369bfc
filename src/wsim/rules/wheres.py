"""The grammar's rules of where, when and how, each as the place that it means."""

from __future__ import annotations

from typing import Any

from lark import v_args

from wsim.rules.phrases import Phrase, Place
from wsim.rules.things import Things, is_of, meant


@v_args(meta=True)
class Wheres(Things):
    """The rules of places, in a wide sense: how fast, how far, for how long and after what time, too."""

    def at_thing(self, meta: Any, children: list[Any]) -> Place:
        lead, phrase = children
        if lead.type in ("AT", "FROM") and len(lead.split()) > 1:  # "at a height of the box"
            raise self.tokens.fail(lead.start_pos)
        key = meant(lead) if lead.type == "PREP" else str(lead)
        return Place(key, phrase, words=self._words(meta))

    def at_side(self, meta: Any, children: list[Any]) -> Place:
        return Place("side", children[1], side=meant(children[0]), words=self._words(meta))

    def at_offset(self, meta: Any, children: list[Any]) -> Place:
        offset, side, phrase = children[-3:]
        return Place("side", phrase, side=meant(side), length=meant(offset), words=self._words(meta))

    def between(self, meta: Any, children: list[Any]) -> Place:
        things = [child for child in children if isinstance(child, Phrase)]
        return Place("between", things[0], things[1] if len(things) > 1 else None, words=self._words(meta))

    def from_length(self, meta: Any, children: list[Any]) -> Place:
        return Place("from", length=meant(children[1]), words=self._words(meta))

    def at_speed(self, meta: Any, children: list[Any]) -> Place:
        kind = {"SPIN": "spin", "FLOW": "flow", "RAINFALL": "rainfall"}.get(children[1].type, "speed")
        return Place(kind, value=meant(children[1]), words=self._words(meta))

    def after(self, meta: Any, children: list[Any]) -> Place:
        time = next(meant(child) for child in children if is_of(child, "TIME"))
        return Place("after", value=time, words=self._words(meta))

    def at_force(self, meta: Any, children: list[Any]) -> Place:
        return Place("force", value=meant(children[1]), words=self._words(meta))

    def at_angle(self, meta: Any, children: list[Any]) -> Place:
        return Place("angle", value=meant(children[1]), words=self._words(meta))

    def for_time(self, meta: Any, children: list[Any]) -> Place:
        return Place("time", value=meant(children[1]), words=self._words(meta))

    def in_time(self, meta: Any, children: list[Any]) -> Place:
        return Place("in time", value=meant(children[1]), words=self._words(meta))

    def toward(self, meta: Any, children: list[Any]) -> Place:
        return Place("toward", direction=meant(children[0]), words=self._words(meta))

    def to_share(self, meta: Any, children: list[Any]) -> Place:
        if is_of(children[0], "PREP") and meant(children[0]) != "to":
            raise self.tokens.fail(children[0].start_pos)
        return Place("share", value=round(meant(children[1]), 6), words=self._words(meta))

    def up_to(self, meta: Any, children: list[Any]) -> Place:
        length = next(meant(child) for child in children if is_of(child, "LENGTH"))
        if is_of(children[-1], "DIMENSION") and meant(children[-1]) not in ("y", "z"):  # "deep" or "high"
            raise self.tokens.fail(children[-1].start_pos)
        return Place("up to", length=length, words=self._words(meta))

    def so_far(self, meta: Any, children: list[Any]) -> Place:
        return Place("way", length=meant(children[-1]), words=self._words(meta))

    def surfaced(self, meta: Any, children: list[Any]) -> Place:
        things = [*(child for child in children if isinstance(child, Phrase)), None, None]
        value = float(meant(children[1]))
        return Place(meant(children[0]), things[0], things[1], value=value, words=self._words(meta))

    def so_often(self, meta: Any, children: list[Any]) -> Place:
        return Place("often", value=meant(children[-1]), words=self._words(meta))

    def at_spot(self, meta: Any, children: list[Any]) -> Place:
        phrase = children[-1] if len(children) > 1 else None
        return Place("spot", phrase, direction=meant(children[0]), words=self._words(meta))

    def manner(self, meta: Any, children: list[Any]) -> Place:
        lead = children[0]  # "stays there": where it is
        return Place("still" if is_of(lead, "THERE") else meant(lead), words=self._words(meta))

    def alone(self, _meta: Any, children: list[Any]) -> Place:
        return Place("bare", words=str(children[0]))
