"""A prompt becomes clauses, with no word left over.

The grammar and the vocabulary are data, in `language/`. Here are the two things between: tokens, each the longest entry
of the lexicon at its place or a number with its unit, and the phrases that the grammar's rules become.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from typing import Any

from lark import Lark, Token, UnexpectedInput, v_args
from lark.exceptions import VisitError
from lark.lexer import Lexer

from wsim.rules.lexicon import grammar_text, lexicon
from wsim.rules.phrases import Action, Clause, Phrase, Place
from wsim.rules.stories import beside_it, delayed, gapped, had, list_of, names_only, parted
from wsim.rules.things import is_of, meant, phrases, span
from wsim.rules.tokens import NOT_IN_THIS_ORDER, NotUnderstood, Tokens
from wsim.rules.wheres import Wheres

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


@v_args(meta=True)
class _Clauses(Wheres):
    """The grammar's rules, each as what it means."""

    def start(self, _meta: Any, children: list[Any]) -> list[Clause]:
        return next((child for child in children if isinstance(child, list)), [])

    def story(self, _meta: Any, children: list[Any]) -> list[Clause]:
        """The clauses; those after "a tank in which" say where their things are, up to the next full stop."""
        clauses: list[Clause] = []
        within, later = None, None
        for before, child, after in zip([None, *children], children, [*children[1:], None], strict=False):
            if isinstance(child, Clause) and before == "list" and clauses and list_of(clauses[-1], child):
                continue
            if isinstance(child, Place) and child.preposition == "after":
                later = child
            elif isinstance(child, Place):
                within = child
            elif isinstance(child, Clause):
                if before is None and clauses and clauses[-1].inverted and names_only(child):
                    clauses[-1].subjects += child.subjects  # "in a tank there is a stone and a log"
                    continue
                if before is None and clauses:
                    gapped(clauses[-1], child, has=after == "with")
                if before == "with" and clauses and clauses[-1].actions and not child.actions:
                    beside_it(clauses[-1], child)
                child.within, child.given = within, before == "with"
                if child.given and clauses:
                    parted(clauses)
                    clauses += [delayed(one, later) for one in had(clauses[-1], child, self.tokens.text)]
                else:
                    clauses.append(delayed(child, later))
            elif isinstance(child, tuple):  # "a chair faces a table on which a vase stands"
                clauses += [delayed(one, later) for one in child]
            elif isinstance(child, str):
                within, later = (None if child == "stop" else within), None
        return clauses

    def full(self, meta: Any, children: list[Any]) -> Clause:
        subjects = phrases(children)
        actions = [child for child in children if isinstance(child, Action)]
        for before, action in pairwise(children):  # "hits a tower, which topples"
            if isinstance(action, Action) and action is not actions[0] and is_of(before, "REL"):
                action.relative = True
        return Clause(subjects, actions, then=self.tokens.text[: meta.start_pos].rstrip(" ,").endswith(_LATER))

    bare = full

    def command(self, meta: Any, children: list[Any]) -> Clause:
        """ "Drop a ball into a tank": what it does, or has done to it, by what comes after "with"."""
        lead = next(i for i, child in enumerate(children) if is_of(child, "COMMAND"))
        by = next((i for i, child in enumerate(children) if is_of(child, "USING")), len(children))
        action = Action(meant(children[lead]), self._words(meta), at=span(meta))
        things = phrases(children[lead + 1 : by])
        places = [child for child in children[lead + 1 : by] if isinstance(child, Place)]
        for place in self._given_on(things[-1:], places):
            if place.phrase is None:
                self._place(action, place)
            else:
                action.places.append(place)
        if (action.particle or "") not in (*self.tokens.known.particles[action.verb], ""):
            raise self.tokens.fail(children[lead].start_pos)
        action.places += [Place("by", child, words=child.words) for child in children[by:] if isinstance(child, Phrase)]
        action.places += [child for child in children[by:] if isinstance(child, Place)]
        return Clause(things, [action])

    def apposed(self, meta: Any, children: list[Any]) -> Clause:
        """ "One red and the other blue"."""
        tokens = [child for child in children[:-1] if isinstance(child, Token)]
        which = next(token for token in tokens if is_of(token, "COUNT", "OTHER", "NTH"))
        chosen = self._choice({"COUNT": "some", "OTHER": "other", "NTH": "nth"}[which.type], meta, tokens)
        if which.type == "NTH":
            chosen.nth = meant(which)
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
        inner.within = Place(meant(lead), last, words=self._words(meta))
        return outer, inner

    def inverted(self, meta: Any, children: list[Any]) -> Clause:
        """ "On the table stands a bottle", "on it there is a bottle"."""
        subjects = phrases(children)
        places = [child for child in children if isinstance(child, Place)]
        said = next(child for child in children if is_of(child, "VERB", "BE"))
        verb = "rest" if is_of(said, "BE") else meant(said)
        return Clause(subjects, [Action(verb, self._words(meta), places=places, at=span(meta))], inverted=True)

    def within(self, meta: Any, children: list[Any]) -> Place:
        phrase = next(child for child in children if isinstance(child, Phrase))
        phrase.filled = phrase.filled or next((meant(child) for child in children if is_of(child, "FILLED")), None)
        return Place(meant(children[-1]), phrase, words=self._words(meta))

    def link(self, _meta: Any, children: list[Any]) -> Any:
        return children[0]

    def breaks(self, _meta: Any, children: list[Any]) -> str:
        marks = [child for child in children if is_of(child, "BREAK", "WITH")]
        if len(marks) == 1 and (marks[0].type == "WITH" or str(marks[0]) == ":"):
            return "with" if marks[0].type == "WITH" else "list"
        return "stop" if any(is_of(child, "BREAK") and str(child) in _STOPS for child in children) else "break"

    def sep(self, _meta: Any, children: list[Any]) -> str | None:
        if is_of(children[0], "JOIN", "COMMA"):
            return None
        return "stop" if str(children[0]) in _STOPS else "break"

    def joiners(self, _meta: Any, _children: list[Any]) -> None:
        return None

    opening = joiners

    def does(self, meta: Any, children: list[Any]) -> Action:
        verb = next(child for child in children if is_of(child, "VERB", "ING"))
        action = Action(meant(verb), self._words(meta), at=span(meta))
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

    def fills(self, meta: Any, children: list[Any]) -> Action:
        """ "A tank fills with water from a tap"."""
        verb = next(child for child in children if is_of(child, "VERB", "ING"))
        if meant(verb) != "fill":
            raise self.tokens.fail(verb.end_pos or 0)
        return self.is_full(meta, [child for child in children if child is not verb])

    def is_full(self, meta: Any, children: list[Any]) -> Action:
        """ "A tank is filled with water"."""
        action = Action("fill", self._words(meta), at=span(meta))
        full = Phrase("tank", self._words(meta))
        self._modify(
            full, next(child for child in children if isinstance(child, tuple) or is_of(child, "FILLED", "FULL"))
        )
        action.places = [Place("full", words=self._words(meta), full=full)]
        action.places += [child for child in children if isinstance(child, Place)]
        return action

    def negated(self, meta: Any, children: list[Any]) -> Action:
        """ "Does not slide": what it does in place of that."""
        verb = next(child for child in children if is_of(child, "VERB", "ING"))
        instead = self.tokens.known.negated.get(meant(verb))
        if instead is None:
            raise self.tokens.fail(meta.start_pos)
        action = Action("rest" if instead == "still" else instead, self._words(meta), at=span(meta))
        action.places = [child for child in children if isinstance(child, Place) and child.preposition != "bare"]
        action.places += [Place("still", words=str(verb))] if instead == "still" else []
        return action

    def stands(self, meta: Any, children: list[Any]) -> Action:
        places = self._given_on([], [child for child in children if isinstance(child, Place)])
        return Action("rest", self._words(meta), places=places, at=span(meta))


_STOPS = (".", "!")
_LATER = ("then", "after which")  # before what comes later
