"""A prompt becomes clauses, with no word left over.

The grammar and the vocabulary are data, in `language/`. Here are the two things between: tokens, each the longest entry
of the lexicon at its place or a number with its unit, and the phrases that the grammar's rules become.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from typing import Any

from lark import Lark, Token, Transformer, UnexpectedInput, v_args
from lark.exceptions import VisitError
from lark.lexer import Lexer

from wsim.rules.lexicon import Named, grammar_text, lexicon
from wsim.rules.phrases import Action, Clause, Phrase, Place
from wsim.rules.tokens import NOT_IN_THIS_ORDER, NotUnderstood, Tokens

__all__ = ["NOT_IN_THIS_ORDER", "NotUnderstood", "parse"]


def parse(prompt: str) -> list[Clause]:
    """Clauses of a prompt.

    Raises:
        NotUnderstood: names the words that are unknown, or the place where known words make no sentence.
    """
    tokens = Tokens(prompt, lexicon())
    try:
        clauses: list[Clause] = _Clauses(tokens).transform(_parser().parse(tokens.all()))
    except UnexpectedInput as error:
        token = getattr(error, "token", None)
        at = len(tokens.text) if token is None or token.start_pos is None else token.start_pos
        raise tokens.fail(at) from None
    except VisitError as error:
        raise error.orig_exc from None
    if not clauses:
        raise NotUnderstood([prompt.strip()], "found nothing to build in")
    return clauses


class _Given(Lexer):
    """Lark's lexer, where the tokens are there already."""

    def __init__(self, _conf: Any) -> None: ...

    def lex(self, lexer_state: Any, _parser_state: Any = None) -> Iterator[Token]:
        return iter(lexer_state)


@cache
def _parser() -> Lark:
    return Lark(grammar_text(), parser="earley", lexer=_Given, propagate_positions=True, maybe_placeholders=False)


def _is(child: Any, *kinds: str) -> bool:
    return isinstance(child, Token) and child.type in kinds


def _meaning(token: Any) -> Any:
    return token.meaning


@v_args(meta=True)
class _Clauses(Transformer):
    """The grammar's rules, each as what it means."""

    def __init__(self, tokens: Tokens) -> None:
        super().__init__()
        self.tokens = tokens

    def _words(self, meta: Any) -> str:
        return "" if meta.empty else self.tokens.text[meta.start_pos : meta.end_pos]

    # ---- sentences
    def start(self, _meta: Any, children: list[Any]) -> list[Clause]:
        return next((child for child in children if isinstance(child, list)), [])

    def story(self, _meta: Any, children: list[Any]) -> list[Clause]:
        """The clauses; those after "a tank in which" say where their things are, up to the next full stop."""
        clauses: list[Clause] = []
        within, later = None, None
        for before, child in pairwise([None, *children]):
            if isinstance(child, Clause) and before == "list" and clauses and self._list(clauses[-1], child):
                continue
            if isinstance(child, Place) and child.preposition == "after":
                later = child
            elif isinstance(child, Place):
                within = child
            elif isinstance(child, Clause):
                if before is None and clauses and clauses[-1].inverted and _names(child):
                    clauses[-1].subjects += child.subjects  # "in a tank there is a stone and a log"
                    continue
                if before is None and clauses:
                    _gapped(clauses[-1], child)
                if before == "with" and clauses and clauses[-1].actions and not child.actions:
                    _beside_it(clauses[-1], child)
                child.within, child.given = within, before == "with"
                clauses.append(_delayed(child, later))
            elif isinstance(child, tuple):  # "a chair faces a table on which a vase stands"
                clauses += [_delayed(one, later) for one in child]
            elif isinstance(child, str):
                within, later = (None if child == "stop" else within), None
        return clauses

    def full(self, _meta: Any, children: list[Any]) -> Clause:
        subjects = _phrases(children)
        actions = [child for child in children if isinstance(child, Action)]
        for before, action in pairwise(children):  # "hits a tower, which topples"
            if isinstance(action, Action) and action is not actions[0] and _is(before, "REL"):
                action.relative = True
        return Clause(subjects, actions)

    bare = full

    def _list(self, clause: Clause, named: Clause) -> bool:
        """Put in the place of "five things" what they are, after a colon; whether the clause names such."""
        ones = all(phrase.kind == "one" for phrase in named.subjects)  # "three crates: a small one, …"
        at = next((i for i, p in enumerate(clause.subjects) if p.kind == "things" or (ones and p.plural)), None)
        if at is None or named.actions:
            return False
        for phrase in named.subjects if ones else []:
            phrase.kind = clause.subjects[at].kind
            phrase.material = phrase.material or clause.subjects[at].material
            phrase.color = phrase.color or clause.subjects[at].color
        things = clause.subjects[at]
        count = sum(phrase.count or 1 for phrase in named.subjects)
        if things.count not in (None, count):
            raise NotUnderstood([things.words], f"is told of {count} things after the colon, not of")
        named.subjects[-1].places += things.places
        clause.subjects[at : at + 1] = named.subjects
        return True

    def command(self, meta: Any, children: list[Any]) -> Clause:
        """ "Drop a ball into a tank": what it does, or has done to it, by what comes after "with"."""
        lead = next(i for i, child in enumerate(children) if _is(child, "COMMAND"))
        by = next((i for i, child in enumerate(children) if _is(child, "USING")), len(children))
        action = Action(_meaning(children[lead]), self._words(meta))
        things = _phrases(children[lead + 1 : by])
        places = [child for child in children[lead + 1 : by] if isinstance(child, Place)]
        for place in self._given_on(things[-1:], places):
            self._place(action, place)
        if (action.particle or "") not in (*self.tokens.known.particles[action.verb], ""):
            raise self.tokens.fail(children[lead].start_pos)
        if action.verb == "fill" and not all(thing.filled for thing in things):
            raise self.tokens.fail(children[lead].start_pos)
        action.places += [Place("by", child, words=child.words) for child in children[by:] if isinstance(child, Phrase)]
        action.places += [child for child in children[by:] if isinstance(child, Place)]
        return Clause(things, [action])

    def apposed(self, meta: Any, children: list[Any]) -> Clause:
        """ "One red and the other blue"."""
        tokens = [child for child in children[:-1] if isinstance(child, Token)]
        which = next(token for token in tokens if _is(token, "COUNT", "OTHER", "NTH"))
        chosen = self._choice({"COUNT": "some", "OTHER": "other", "NTH": "nth"}[which.type], meta, tokens)
        if which.type == "NTH":
            chosen.nth = _meaning(which)
        return Clause([chosen], [self.is_(meta, children)])

    def chained(self, _meta: Any, children: list[Any]) -> tuple[Clause, ...]:
        """ "On a table stands a lamp, and beside it a mug"."""
        first = next(child for child in children if isinstance(child, Clause))
        leads = [child for child in children if isinstance(child, Place)]
        subjects = [child for child in children if isinstance(child, Phrase)]
        verb = first.actions[0].verb
        to = first.actions[0].places[0]
        for lead in leads:  # "to the left of a barrel there is a crate, and to the right of it a pillar"
            if to.preposition == lead.preposition == "side" and lead.phrase is not None and lead.phrase.part == "it":
                lead.phrase = to.phrase
        then = [
            Clause([subject], [Action(verb, f"{lead.words} {subject.words}", places=[lead])])
            for lead, subject in zip(leads, subjects, strict=True)
        ]
        return first, *then

    def fronted(self, _meta: Any, children: list[Any]) -> Place:
        """ "In a tank of water, …"."""
        return next(child for child in children if isinstance(child, Place))

    def embedded(self, meta: Any, children: list[Any]) -> tuple[Clause, Clause]:
        """What the first clause ends with is where the things of the second are."""
        outer, lead, inner = children
        ends = [*outer.subjects, *(each for a in outer.actions for each in (a.target, *(p.phrase for p in a.places)))]
        last = [phrase for phrase in ends if phrase is not None][-1]
        inner.within = Place(_meaning(lead), last, words=self._words(meta))
        return outer, inner

    def inverted(self, meta: Any, children: list[Any]) -> Clause:
        """ "On the table stands a bottle", "on it there is a bottle"."""
        subjects = _phrases(children)
        places = [child for child in children if isinstance(child, Place)]
        said = next(child for child in children if _is(child, "VERB", "BE"))
        verb = "rest" if _is(said, "BE") else _meaning(said)
        return Clause(subjects, [Action(verb, self._words(meta), places=places)], inverted=True)

    def within(self, meta: Any, children: list[Any]) -> Place:
        phrase = next(child for child in children if isinstance(child, Phrase))
        phrase.filled = phrase.filled or any(_is(child, "FILLED") for child in children)
        return Place(_meaning(children[-1]), phrase, words=self._words(meta))

    def link(self, _meta: Any, children: list[Any]) -> Any:
        return children[0]

    def breaks(self, _meta: Any, children: list[Any]) -> str:
        marks = [child for child in children if _is(child, "BREAK", "WITH")]
        if len(marks) == 1 and (marks[0].type == "WITH" or str(marks[0]) == ":"):
            return "with" if marks[0].type == "WITH" else "list"
        return "stop" if any(_is(child, "BREAK") and str(child) in _STOPS for child in children) else "break"

    def sep(self, _meta: Any, children: list[Any]) -> str:
        return "stop" if str(children[0]) in _STOPS else "break"

    def joiners(self, _meta: Any, _children: list[Any]) -> None:
        return None

    opening = joiners

    # ---- things
    def subject(self, _meta: Any, children: list[Any]) -> Phrase | list[Phrase]:
        *_, phrase = all_of = _phrases(children[:2])
        for each in all_of:
            each.only = _is(children[0], "ONLY")
        for aside in children[1:]:  # "a cube, 10 cm wide, …"
            if _is(aside, "COLOR") or isinstance(aside, tuple):
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
        last = next(i for i, child in enumerate(children) if _is(child, "NOUN"))
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
        heads = [child for child in children if isinstance(child, Phrase) or _is(child, *_HEADS)]
        head = heads[0] if heads else self._stuff(children)
        phrase = head if isinstance(head, Phrase) else _phrase(head)
        phrase.words = self._words(meta)
        for child in children:
            if _is(child, "THE", "ART", "POSS"):
                phrase.definite = not _is(child, "ART")
            elif isinstance(child, Action):
                (phrase.owner or phrase if phrase.kind == "part" else phrase).clauses.append(child)
            elif child is not head:
                self._modify(phrase, child)
        return phrase

    def _stuff(self, children: list[Any]) -> Phrase:
        """What a material alone names, as in "a stone" or "a marble"."""
        head = [child for child in children if _is(child, "MATERIAL")][-1]
        noun = self.tokens.known.stuff.get(_meaning(head))
        if noun is None:
            raise self.tokens.fail(head.end_pos)
        if noun != "ground":
            children.remove(head)
        return Phrase(noun, "")

    def _modify(self, phrase: Phrase, child: Any) -> None:
        if phrase.kind == "part" and phrase.owner is not None:
            phrase = phrase.owner  # "the edge of a table that is 0.8 m high"
        if _is(child, "ING"):
            phrase.clauses.append(Action(_meaning(child), str(child)))
            return
        token, changes = child if isinstance(child, tuple) else (child, _changes(child))
        for name, value in changes.items():
            given = phrase.measures if name in _MEASURES else phrase.__dict__
            if given.get(name) not in (None, False, ()):
                raise self.tokens.fail(token.start_pos)
            given[name] = value

    def size(self, _meta: Any, children: list[Any]) -> tuple[Token, dict[str, Any]]:
        axis = _meaning(children[1]) if len(children) > 1 else "length"
        return children[0], {axis: _meaning(children[0])}

    def sized(self, meta: Any, children: list[Any]) -> Any:
        return self.size(meta, children) if _is(children[0], "LENGTH") else children[-1]

    def told(self, _meta: Any, children: list[Any]) -> Any:
        return children[-1]

    def weighed(self, _meta: Any, children: list[Any]) -> tuple[Token, dict[str, Any]]:
        masses = tuple(_meaning(child) for child in children if _is(child, "MASS"))
        return children[0], {"mass": masses[0]} if len(masses) == 1 else {"masses": masses}

    def made(self, _meta: Any, children: list[Any]) -> tuple[Token, dict[str, Any]]:
        return children[0], {"material": _meaning(children[-1])}

    owned = made

    def measured(self, _meta: Any, children: list[Any]) -> tuple[Token, dict[str, Any]]:
        what, measure = _meaning(children[0]), children[1]
        kind = {"mass": "MASS", "density": "DENSITY"}.get(what, "LENGTH")
        if measure.type != kind:
            raise self.tokens.fail(children[0].start_pos)
        return children[0], {"length" if what == "edge" else what: _meaning(measure)}

    def tilted(self, _meta: Any, children: list[Any]) -> tuple[Token, dict[str, Any]]:
        return children[0], {"angle": _meaning(children[1])}

    def doing(self, meta: Any, children: list[Any]) -> Action:
        whole = next((child for child in children if isinstance(child, Action)), None)
        if whole is not None:
            whole.relative = True
            return whole
        verb = next(child for child in children if _is(child, "ING"))
        action = Action(_meaning(verb), self._words(meta), relative=True)
        for place in (child for child in children if isinstance(child, Place)):
            self._place(action, place)
        return action

    def nth(self, meta: Any, children: list[Any]) -> Phrase:
        chosen = self._choice("nth", meta, children)
        chosen.nth = next(_meaning(child) for child in children if _is(child, "NTH"))
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
        if _is(child, "COMPARED"):
            chosen.part = _meaning(child)
        elif not (_is(child, "COUNT") or (isinstance(child, Phrase))):
            self._modify(chosen, child)
        return chosen

    def _choice(self, which: str, meta: Any, children: list[Any]) -> Phrase:
        """Some of what was spoken of before."""
        of = next((child for child in children if isinstance(child, Phrase)), None)
        count = next((_meaning(child) for child in children if _is(child, "COUNT")), None)
        return Phrase("choice", self._words(meta), definite=True, count=count, choice=which, owner=of)

    def group(self, meta: Any, children: list[Any]) -> Phrase:
        phrase = Phrase("group", self._words(meta), arrangement=_meaning(children[0]))
        phrase.members = next((child for child in children if isinstance(child, Phrase)), None)
        if phrase.members is not None and phrase.members.kind not in self.tokens.known.nouns:
            raise self.tokens.fail(children[0].start_pos)
        return phrase

    def compound(self, meta: Any, children: list[Any]) -> Phrase:
        """ "A domino row"."""
        members = _phrase(children[0])
        members.words = str(children[0])
        return Phrase("group", self._words(meta), arrangement=_meaning(children[1]), members=members)

    def kind(self, meta: Any, children: list[Any]) -> Phrase:
        return self.thing(meta, children)

    def weight(self, meta: Any, children: list[Any]) -> Phrase:
        """ "2 kg on one end"."""
        return Phrase("weight", self._words(meta), measures={"mass": _meaning(children[0])})

    def each_kind(self, meta: Any, children: list[Any]) -> Phrase:
        """ "Both balls": those that were spoken of, else as many."""
        phrase: Phrase = children[1]
        if str(children[0]) == "both" and phrase.count is None:
            phrase.count = 2
        return Phrase("choice", self._words(meta), definite=True, choice="all", members=phrase)

    def part(self, meta: Any, children: list[Any]) -> Phrase:
        owner = next((child for child in children if isinstance(child, Phrase)), None)
        side = next((_meaning(child) for child in children if _is(child, "DIRECTION")), None)
        side = "other" if any(_is(child, "OTHER") for child in children) else side
        named = next(_meaning(child) for child in children if _is(child, "PART"))
        return Phrase("part", self._words(meta), part=named, owner=owner, choice=side or "")

    # ---- what they do
    def does(self, meta: Any, children: list[Any]) -> Action:
        verb = next(child for child in children if _is(child, "VERB", "ING"))
        action = Action(_meaning(verb), self._words(meta))
        action.target = next((child for child in children if isinstance(child, Phrase)), None)
        inner = [action.target] if action.target is not None else []
        for place in self._given_on(inner, [child for child in children if isinstance(child, Place)]):
            self._place(action, place)
        known = self.tokens.known
        if (action.particle or "") not in (*known.particles[action.verb], *([""] if action.target else [])):
            raise self.tokens.fail(meta.start_pos)
        if action.target is not None and action.verb not in known.objects:
            raise self.tokens.fail(verb.start_pos)
        return action

    def _place(self, action: Action, place: Place) -> None:
        """Add a place to an action; "knocks over a stack" has a particle and a target."""
        over = place.preposition in ("over", "down") and action.verb in ("knock", "topple", "push")
        if over and action.target is None and place.phrase is not None:
            action.particle, action.target = place.preposition, place.phrase
        elif place.preposition == "bare" and action.particle is None:
            action.particle = place.words
        else:
            action.places.append(place)

    def negated(self, meta: Any, children: list[Any]) -> Action:
        """ "Does not slide": what it does in place of that."""
        verb = next(child for child in children if _is(child, "VERB", "ING"))
        instead = self.tokens.known.negated.get(_meaning(verb))
        if instead is None:
            raise self.tokens.fail(meta.start_pos)
        action = Action("rest" if instead == "still" else instead, self._words(meta))
        action.places = [child for child in children if isinstance(child, Place) and child.preposition != "bare"]
        action.places += [Place("still", words=str(verb))] if instead == "still" else []
        return action

    def stands(self, meta: Any, children: list[Any]) -> Action:
        places = self._given_on([], [child for child in children if isinstance(child, Place)])
        return Action("rest", self._words(meta), places=places)

    def is_(self, meta: Any, children: list[Any]) -> Action:
        """What a clause of its own says of a thing: "the ramp is at 20 degrees"."""
        described = Phrase("described", self._words(meta))
        self._modify(described, children[-1])
        return Action("be", self._words(meta), target=described)

    # ---- where
    def at_thing(self, meta: Any, children: list[Any]) -> Place:
        lead, phrase = children
        if lead.type in ("AT", "FROM") and len(lead.split()) > 1:  # "at a height of the box"
            raise self.tokens.fail(lead.start_pos)
        key = _meaning(lead) if lead.type == "PREP" else str(lead)
        return Place(key, phrase, words=self._words(meta))

    def at_side(self, meta: Any, children: list[Any]) -> Place:
        return Place("side", children[1], side=_meaning(children[0]), words=self._words(meta))

    def at_offset(self, meta: Any, children: list[Any]) -> Place:
        offset, side, phrase = children[-3:]
        return Place("side", phrase, side=_meaning(side), length=_meaning(offset), words=self._words(meta))

    def between(self, meta: Any, children: list[Any]) -> Place:
        things = [child for child in children if isinstance(child, Phrase)]
        return Place("between", things[0], things[1] if len(things) > 1 else None, words=self._words(meta))

    def from_length(self, meta: Any, children: list[Any]) -> Place:
        return Place("from", length=_meaning(children[1]), words=self._words(meta))

    def at_speed(self, meta: Any, children: list[Any]) -> Place:
        kind = "spin" if children[1].type == "SPIN" else "speed"
        return Place(kind, value=_meaning(children[1]), words=self._words(meta))

    def after(self, meta: Any, children: list[Any]) -> Place:
        time = next(_meaning(child) for child in children if _is(child, "TIME"))
        return Place("after", value=time, words=self._words(meta))

    def at_force(self, meta: Any, children: list[Any]) -> Place:
        return Place("force", value=_meaning(children[1]), words=self._words(meta))

    def at_angle(self, meta: Any, children: list[Any]) -> Place:
        return Place("angle", value=_meaning(children[1]), words=self._words(meta))

    def for_time(self, meta: Any, children: list[Any]) -> Place:
        return Place("time", value=_meaning(children[1]), words=self._words(meta))

    def toward(self, meta: Any, children: list[Any]) -> Place:
        return Place("toward", direction=_meaning(children[0]), words=self._words(meta))

    def to_share(self, meta: Any, children: list[Any]) -> Place:
        if _is(children[0], "PREP") and _meaning(children[0]) != "to":
            raise self.tokens.fail(children[0].start_pos)
        return Place("share", value=round(_meaning(children[1]), 6), words=self._words(meta))

    def up_to(self, meta: Any, children: list[Any]) -> Place:
        length = next(_meaning(child) for child in children if _is(child, "LENGTH"))
        if _is(children[-1], "DIMENSION") and _meaning(children[-1]) not in ("y", "z"):  # "deep" or "high"
            raise self.tokens.fail(children[-1].start_pos)
        return Place("up to", length=length, words=self._words(meta))

    def so_far(self, meta: Any, children: list[Any]) -> Place:
        return Place("way", length=_meaning(children[-1]), words=self._words(meta))

    def surfaced(self, meta: Any, children: list[Any]) -> Place:
        things = [*(child for child in children if isinstance(child, Phrase)), None, None]
        value = float(_meaning(children[1]))
        return Place(_meaning(children[0]), things[0], things[1], value=value, words=self._words(meta))

    def so_often(self, meta: Any, children: list[Any]) -> Place:
        return Place("often", value=_meaning(children[-1]), words=self._words(meta))

    def at_spot(self, meta: Any, children: list[Any]) -> Place:
        phrase = children[-1] if len(children) > 1 else None
        return Place("spot", phrase, direction=_meaning(children[0]), words=self._words(meta))

    def manner(self, meta: Any, children: list[Any]) -> Place:
        lead = children[0]  # "stays there": where it is
        return Place("still" if _is(lead, "THERE") else _meaning(lead), words=self._words(meta))

    def alone(self, _meta: Any, children: list[Any]) -> Place:
        return Place("bare", words=str(children[0]))


def _delayed(clause: Clause, later: Place | None) -> Clause:
    """What happens after a time: "after two seconds a ball and a box fall"."""
    if later is not None and not clause.actions:
        raise NotUnderstood([later.words], "needs to be told what happens")
    for action in clause.actions if later is not None else []:
        action.places.append(later)
    return clause


def _names(clause: Clause) -> bool:
    """Whether a clause names things and says no more of them; "one at each end" does, of those before."""
    return not clause.actions and all(phrase.kind != "choice" for phrase in clause.subjects)


def _gapped(clause: Clause, named: Clause) -> None:
    """ "Drop a ball into a tank and a box onto a table": the verb is said once."""
    places = named.subjects[-1].places if named.subjects else []
    goes = bool(places) and all(place.preposition in _GOALS for place in places)
    last = clause.actions[-1] if clause.actions else None
    ends = last is not None and (last.target or (last.places and last.places[-1].phrase))
    if (
        ends and not places and not named.actions and last is not None
    ):  # "rolls into a box and a brick": is it hit, too?
        raise NotUnderstood([f"{last.words} and {named.words}"], "cannot tell what is said of the last of these")
    if named.actions or not goes or len(clause.actions) != 1 or clause.actions[0].target is not None:
        return
    words = " ".join(place.words for place in places)
    named.actions = [Action(clause.actions[0].verb, f"{clause.actions[0].verb} {words}", places=places)]
    named.subjects[-1].places = []


def _beside_it(clause: Clause, named: Clause) -> None:
    """Refuse "drop a ball with a brick", which is of both; "a ball is dropped on a table with a mug on it" is not."""
    last = clause.actions[-1]
    if last.target is None and not last.places and last.verb not in ("rest", "float", "run", "tilt", "stack", "swing"):
        raise NotUnderstood([f"{last.words} with {named.words}"], "cannot tell what is said of the last of these")


_GOALS = ("into", "onto", "down", "off", "towards", "against", "via")  # where one goes, and nothing stands


def _phrases(children: list[Any]) -> list[Phrase]:
    """The things among a rule's children, of which one may be two: "a red and a blue ball"."""
    lists = [child if isinstance(child, list) else [child] for child in children]
    return [child for each in lists for child in each if isinstance(child, Phrase)]


_STOPS = (".", "!")
_HEADS = ("NOUN", "THINGS", "ONE", "FLUID", "GROUND", "PRONOUN")
_MEASURES = ("x", "y", "z", "radius", "diameter", "mass", "density")


def _phrase(head: Token) -> Phrase:
    meaning = _meaning(head)
    if isinstance(meaning, Named):
        return Phrase(meaning.noun, "", plural=meaning.plural, filled=meaning.filled)
    if head.type in ("THINGS", "ONE"):
        return Phrase("things" if head.type == "THINGS" else "one", "", plural=head.type == "THINGS")
    kind = {"FLUID": "water", "GROUND": "ground", "PRONOUN": "pronoun"}[head.type]
    return Phrase(kind, "", part=str(head) if kind == "pronoun" else None)


_FIELDS = {"COUNT": "count", "SCALE": "scale", "MATERIAL": "material", "COLOR": "color", "EDGES": "edges"}
_FIELDS |= {"MASS": "mass", "ANGLE": "angle", "FILLED": "filled", "WEIGHT": "weight", "SHAPE": "shape", "NTH": "nth"}


def _changes(token: Token) -> dict[str, Any]:
    return {_FIELDS[token.type]: True if token.type == "FILLED" else _meaning(token)}
