"""The grammar's rules of things, each as the phrase that it means."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from lark import Token, Transformer, v_args

from wsim.rules.lexicon import Named
from wsim.rules.liquids import Filled
from wsim.rules.phrases import Action, Phrase, Place
from wsim.rules.tokens import Tokens


def is_of(child: Any, *kinds: str) -> bool:
    """Whether a rule's child is a token of one of these terminals."""
    return isinstance(child, Token) and child.type in kinds


def meant(token: Any) -> Any:
    """What a token's entry of the lexicon means."""
    return token.meaning


@v_args(meta=True)
class Things(Transformer):
    """The rules of things."""

    def __init__(self, tokens: Tokens) -> None:
        super().__init__()
        self.tokens = tokens

    def _words(self, meta: Any) -> str:
        return "" if meta.empty else self.tokens.text[meta.start_pos : meta.end_pos]

    def subject(self, _meta: Any, children: list[Any]) -> Phrase | list[Phrase]:
        *_, phrase = all_of = phrases(children[:2])
        for each in all_of:
            each.only = is_of(children[0], "ONLY")
        for aside in children[1:]:  # "a cube, 10 cm wide, …"
            if is_of(aside, "COLOR") or isinstance(aside, tuple):
                self._modify(phrase, aside)
            elif isinstance(aside, Action):
                phrase.clauses.append(aside)
        phrase.places = self._given_on([phrase], [child for child in children[1:] if isinstance(child, Place)])
        return phrase if len(all_of) == 1 else all_of

    def _given_on(self, phrases: list[Phrase], places: list[Place]) -> list[Place]:
        """The places, less those that follow a relative clause: "on a belt that runs at 1 m/s" is of the belt."""
        kept: list[Place] = []
        of = next((phrase for phrase in phrases if any(one.relative for one in phrase.clauses)), None)
        for place in places:
            if of is not None:
                self._place(next(one for one in of.clauses if one.relative), place)
                of.words += f" {place.words}"
                continue
            kept.append(place)
            of = place.phrase if place.phrase is not None and any(o.relative for o in place.phrase.clauses) else None
        return kept

    def twins(self, meta: Any, children: list[Any]) -> list[Phrase]:
        """ "A heavy and a light ball": two things of one noun."""
        between = next(i for i, child in enumerate(children) if child is None)
        last = next(i for i, child in enumerate(children) if is_of(child, "NOUN"))
        first = self.thing(meta, [*children[:between], children[last]])
        second = self.thing(meta, children[between + 1 : last + 1])
        for phrase, words in ((first, children[:between]), (second, children[between + 1 : last])):
            phrase.words = " ".join(str(word) for word in (*words, children[last]) if isinstance(word, Token))
        return [first, second]

    def det(self, _meta: Any, children: list[Any]) -> Token:
        return children[0]

    def thing(self, meta: Any, children: list[Any]) -> Phrase:
        if len(children) == 1 and isinstance(children[0], Phrase) and children[0].choice:
            return children[0]
        heads = [child for child in children if isinstance(child, Phrase) or is_of(child, *_HEADS)]
        head = heads[0] if heads else self._stuff(children)
        phrase = head if isinstance(head, Phrase) else phrase_of(head)
        phrase.words, phrase.at = self._words(meta), meta.start_pos
        for child in children:
            if is_of(child, "THE", "ART", "POSS"):
                phrase.definite = not is_of(child, "ART")
            elif isinstance(child, Action):
                (phrase.owner or phrase if phrase.kind == "part" else phrase).clauses.append(child)
            elif child is not head:
                self._modify(phrase, child)
        return phrase

    def _stuff(self, children: list[Any]) -> Phrase:
        """What a material alone names, as in "a stone" or "a marble"."""
        head = [child for child in children if is_of(child, "MATERIAL")][-1]
        noun = self.tokens.known.stuff.get(meant(head))
        if noun is None:
            raise self.tokens.fail(head.end_pos)
        if noun != "ground":
            children.remove(head)
        return Phrase(noun, "")

    def _modify(self, phrase: Phrase, child: Any) -> None:
        if phrase.kind == "part" and phrase.owner is not None:
            phrase = phrase.owner  # "the edge of a table that is 0.8 m high"
        if is_of(child, "ING"):
            phrase.clauses.append(Action(meant(child), str(child), at=(child.start_pos or 0, child.end_pos or 0)))
            return
        token, changes = child if isinstance(child, tuple) else (child, changes_of(child))
        for name, value in changes.items():
            given = phrase.measures if name in _MEASURES else phrase.__dict__
            if given.get(name) not in (None, False, ()):
                raise self.tokens.fail(token.start_pos)
            given[name] = value

    def size(self, _meta: Any, children: list[Any]) -> tuple[Token, dict[str, Any]]:
        axis = meant(children[1]) if len(children) > 1 else "length"
        return children[0], {axis: meant(children[0])}

    def sized(self, meta: Any, children: list[Any]) -> Any:
        return self.size(meta, children) if is_of(children[0], "LENGTH") else children[-1]

    def told(self, _meta: Any, children: list[Any]) -> Any:
        return children[-1]

    def weighed(self, _meta: Any, children: list[Any]) -> tuple[Token, dict[str, Any]]:
        masses = tuple(meant(child) for child in children if is_of(child, "MASS"))
        return children[0], {"mass": masses[0]} if len(masses) == 1 else {"masses": masses}

    def made(self, _meta: Any, children: list[Any]) -> tuple[Token, dict[str, Any]]:
        return children[0], {"material": meant(children[-1])}

    owned = made

    def measured(self, _meta: Any, children: list[Any]) -> tuple[Token, dict[str, Any]]:
        what, measure = meant(children[0]), children[1]
        kind = {"mass": "MASS", "density": "DENSITY"}.get(what, "LENGTH")
        if measure.type != kind:
            raise self.tokens.fail(children[0].start_pos)
        return children[0], {"length" if what == "edge" else what: meant(measure)}

    def amount(self, meta: Any, children: list[Any]) -> Phrase:
        """ "2 litres of water", "10 cm of water"."""
        measure, filled = children
        if not str(filled).startswith("of "):
            raise self.tokens.fail(filled.start_pos)
        phrase = Phrase("water", self._words(meta), liquid=meant(filled).liquid, at=meta.start_pos)
        if measure.type == "VOLUME":
            phrase.volume = meant(measure)
        elif measure.type in ("FLOW", "RAINFALL"):
            phrase.measures[measure.type.lower()] = meant(measure)
        else:
            phrase.measures["z"] = meant(measure)
        return phrase

    def held(self, _meta: Any, children: list[Any]) -> tuple[Token, dict[str, Any]]:
        """ "Of red paint"."""
        return children[0], {"filled": Filled(meant(children[2]), color=meant(children[1]))}

    def rated(self, _meta: Any, children: list[Any]) -> tuple[Token, dict[str, Any]]:
        """ "Rain of 50 mm per hour"."""
        return children[0], {children[1].type.lower(): meant(children[1])}

    def filled_with(self, _meta: Any, children: list[Any]) -> tuple[Token, dict[str, Any]]:
        lead, *_, held = children
        return lead, {"filled": Filled(held.liquid, volume=held.volume, level=held.measures.get("z"))}

    def filled_to(self, _meta: Any, children: list[Any]) -> tuple[Token, dict[str, Any]]:
        """ "Filled with water up to 10 cm"."""
        filled, _, level = children
        return filled, {"filled": replace(meant(filled), level=meant(level))}

    def tilted(self, _meta: Any, children: list[Any]) -> tuple[Token, dict[str, Any]]:
        return children[0], {"angle": meant(children[1])}

    def doing(self, meta: Any, children: list[Any]) -> Action:
        whole = next((child for child in children if isinstance(child, Action)), None)
        if whole is not None:
            whole.relative = True
            return whole
        verb = next(child for child in children if is_of(child, "ING"))
        action = Action(meant(verb), self._words(meta), relative=True, at=span(meta))
        for place in (child for child in children if isinstance(child, Place)):
            self._place(action, place)
        return action

    def nth(self, meta: Any, children: list[Any]) -> Phrase:
        chosen = self._choice("nth", meta, children)
        chosen.nth = next(meant(child) for child in children if is_of(child, "NTH"))
        return chosen

    def some(self, meta: Any, children: list[Any]) -> Phrase:
        return self._choice("some", meta, children)

    def one(self, meta: Any, children: list[Any]) -> Phrase:
        return self._choice("some", meta, children)

    def other(self, meta: Any, children: list[Any]) -> Phrase:
        return self._choice("other", meta, children)

    def all(self, meta: Any, children: list[Any]) -> Phrase:
        chosen = self._choice("all", meta, children)
        return chosen.owner if chosen.owner is not None and chosen.owner.choice else chosen

    def described(self, meta: Any, children: list[Any]) -> Phrase:
        chosen = self._choice("described", meta, children)
        child = children[1]
        if is_of(child, "COMPARED"):
            chosen.part = meant(child)
        elif not (is_of(child, "COUNT") or (isinstance(child, Phrase))):
            self._modify(chosen, child)
        return chosen

    def _choice(self, which: str, meta: Any, children: list[Any]) -> Phrase:
        """Some of what was spoken of before."""
        of = next((child for child in children if isinstance(child, Phrase)), None)
        count = next((meant(child) for child in children if is_of(child, "COUNT")), None)
        return Phrase(
            "choice", self._words(meta), definite=True, count=count, choice=which, owner=of, at=meta.start_pos
        )

    def group(self, meta: Any, children: list[Any]) -> Phrase:
        phrase = Phrase("group", self._words(meta), arrangement=meant(children[0]))
        phrase.members = next((child for child in children if isinstance(child, Phrase)), None)
        if phrase.members is not None and phrase.members.kind not in self.tokens.known.nouns:
            raise self.tokens.fail(children[0].start_pos)
        return phrase

    def compound(self, meta: Any, children: list[Any]) -> Phrase:
        """ "A domino row"."""
        members = phrase_of(children[0])
        members.words = str(children[0])
        return Phrase("group", self._words(meta), arrangement=meant(children[1]), members=members)

    def kind(self, meta: Any, children: list[Any]) -> Phrase:
        return self.thing(meta, children)

    def weight(self, meta: Any, children: list[Any]) -> Phrase:
        """ "2 kg on one end"."""
        return Phrase("weight", self._words(meta), measures={"mass": meant(children[0])})

    def each_kind(self, meta: Any, children: list[Any]) -> Phrase:
        """ "Both balls": those that were spoken of, else as many."""
        phrase: Phrase = children[1]
        if str(children[0]) == "both" and phrase.count is None:
            phrase.count = 2
        return Phrase("choice", self._words(meta), definite=True, choice="all", members=phrase)

    def part(self, meta: Any, children: list[Any]) -> Phrase:
        owner = next((child for child in children if isinstance(child, Phrase)), None)
        side = next((meant(child) for child in children if is_of(child, "DIRECTION")), None)
        side = "other" if any(is_of(child, "OTHER") for child in children) else side
        named = next(meant(child) for child in children if is_of(child, "PART"))
        return Phrase("part", self._words(meta), part=named, owner=owner, choice=side or "")

    def _place(self, action: Action, place: Place) -> None:
        """Add a place to an action; "knocks over a stack" has a particle and a target."""
        over = place.preposition in ("over", "down") and action.verb in ("knock", "topple", "push")
        if over and action.target is None and place.phrase is not None:
            action.particle, action.target = place.preposition, place.phrase
        elif place.preposition == "bare" and action.particle is None:
            action.particle = place.words
        else:
            action.places.append(place)

    def is_(self, meta: Any, children: list[Any]) -> Action:
        """What a clause of its own says of a thing: "the ramp is at 20 degrees"."""
        described = Phrase("described", self._words(meta))
        self._modify(described, children[-1])
        return Action("be", self._words(meta), target=described, at=span(meta))


def phrases(children: list[Any]) -> list[Phrase]:
    """The things among a rule's children, of which one may be two: "a red and a blue ball"."""
    lists = [child if isinstance(child, list) else [child] for child in children]
    return [child for each in lists for child in each if isinstance(child, Phrase)]


def span(meta: Any) -> tuple[int, int]:
    """From and to where a rule's words are."""
    return (-1, -1) if meta.empty else (meta.start_pos, meta.end_pos)


_HEADS = ("NOUN", "THINGS", "ONE", "FLUID", "GROUND", "PRONOUN")
_MEASURES = ("x", "y", "z", "radius", "diameter", "mass", "density", "flow", "rainfall")


def phrase_of(head: Token) -> Phrase:
    """The phrase of a head alone."""
    meaning = meant(head)
    if isinstance(meaning, Named):
        return Phrase(meaning.noun, "", plural=meaning.plural, filled=meaning.filled)
    if head.type in ("THINGS", "ONE"):
        return Phrase("things" if head.type == "THINGS" else "one", "", plural=head.type == "THINGS")
    if head.type == "FLUID":
        return Phrase("water", "", liquid=meaning)
    kind = {"GROUND": "ground", "PRONOUN": "pronoun"}[head.type]
    return Phrase(kind, "", part=str(head) if kind == "pronoun" else None)


_FIELDS = {"COUNT": "count", "SCALE": "scale", "MATERIAL": "material", "COLOR": "color", "EDGES": "edges"}
_FIELDS |= {"MASS": "mass", "ANGLE": "angle", "FULL": "share", "WEIGHT": "weight", "SHAPE": "shape", "NTH": "nth"}


def changes_of(token: Token) -> dict[str, Any]:
    """What a token says of a thing, by the phrase\'s fields."""
    meaning = meant(token)
    if token.type == "FILLED":
        return {"filled": meaning} | ({"share": meaning.share} if meaning.share is not None else {})
    return {_FIELDS[token.type]: meaning}
