"""A prompt becomes clauses, with no word left over.

The grammar and the vocabulary are data, in `language/`. Here are the two things between: tokens, each the longest entry
of the lexicon at its place or a number with its unit, and the phrases that the grammar's rules become.
"""

from __future__ import annotations

import difflib
import re
import textwrap
from collections.abc import Iterator
from functools import cache
from typing import Any

from lark import Lark, Token, Transformer, UnexpectedInput, v_args
from lark.exceptions import VisitError
from lark.lexer import Lexer

from wsim.errors import UserError
from wsim.rules.lexicon import Lexicon, Named, grammar_text, lexicon
from wsim.rules.phrases import Action, Clause, Phrase, Place
from wsim.rules.running import with_running

_WORD = re.compile(r"\d+(?:\.\d+)?|[^\W\d_]+/[^\W\d_]+(?:\^?\d)?|[^\W\d_]+(?:'[^\W\d_]+)?|\S")
_SHOWN = 6  # words of what is not in order


class NotUnderstood(UserError):  # noqa: N818 - it reads as the sentence it carries
    """The builtin planner does not know some of the prompt's words, or not in this order."""

    def __init__(self, words: list[str], reason: str) -> None:
        self.words = words
        quoted = ", ".join(f"{word!r}{_suggestion(word) if reason == _UNKNOWN else ''}" for word in words)
        super().__init__(
            f"the builtin planner {reason.rstrip(':')}: {quoted}. `wsim plan --words` lists what it knows; "
            "--planner-model MODEL lets a language model plan any sentence"
        )


_UNKNOWN = "does not know"
NOT_IN_THIS_ORDER = "knows these words, but not in this order"


def _suggestion(word: str) -> str:
    near = difflib.get_close_matches(word, sorted(lexicon().vocabulary), n=1, cutoff=0.75)
    return f" (did you mean {near[0]!r}?)" if near else ""


def known_words() -> str:
    """What the planner knows, for people: a paragraph for each kind of words."""
    known = lexicon()
    things = sorted(
        {
            *(key.replace("_", " ") for key in known.nouns),
            *known.words_of("GROUP"),
            *known.words_of("FLUID"),
            *known.words_of("GROUND"),
        }
    )
    kinds = {
        "things": things,
        "materials": known.words_of("MATERIAL"),
        "colours": known.words_of("COLOR"),
        "sizes": [*known.words_of("SCALE"), "a measure such as 20 cm or 2 kg"],
        "what they do": sorted(known.particles),
        "where": [*known.words_of("SIDE"), "on", "in", "between"],
    }
    return "\n".join(textwrap.fill(f"{kind}: {', '.join(words)}", 80) for kind, words in kinds.items())


def parse(prompt: str) -> list[Clause]:
    """Clauses of a prompt.

    Raises:
        NotUnderstood: names the words that are unknown, or the place where known words make no sentence.
    """
    text = " ".join(re.sub(r"(?<=\w)-(?=\w)", " ", prompt.lower()).split())
    tokens = _Tokens(text, lexicon())
    try:
        clauses: list[Clause] = _Clauses(tokens).transform(_parser().parse(tokens.all()))
    except UnexpectedInput as error:
        token = getattr(error, "token", None)
        at = len(text) if token is None or token.type == "$END" else token.start_pos
        raise tokens.fail(at) from None
    except VisitError as error:
        raise error.orig_exc from None
    if not clauses:
        raise NotUnderstood([prompt.strip()], "found nothing to build in")
    return clauses


class _Meant(Token):
    """A token with what its entry means."""

    meaning: Any = None


class _Given(Lexer):
    """Lark's lexer, where the tokens are there already."""

    def __init__(self, _conf: Any) -> None: ...

    def lex(self, lexer_state: Any, _parser_state: Any = None) -> Iterator[Token]:
        return iter(lexer_state)


@cache
def _parser() -> Lark:
    return Lark(grammar_text(), parser="lalr", lexer=_Given, propagate_positions=True, maybe_placeholders=False)


class _Tokens:
    """The prompt's words, and the tokens that they make."""

    def __init__(self, text: str, known: Lexicon) -> None:
        self.text = text
        self.known = known
        self.spans = [match.span() for match in _WORD.finditer(text)]
        self.words = [text[a:b] for a, b in self.spans]

    def all(self) -> list[Token]:
        """The tokens.

        Raises:
            NotUnderstood: a word is in no entry.
        """
        vocabulary = self.known.vocabulary
        unknown = [w for w in dict.fromkeys(self.words) if not w[0].isdigit() and w not in vocabulary]
        if unknown:
            raise NotUnderstood(unknown, _UNKNOWN)
        tokens: list[Token] = []
        at = 0
        while at < len(self.words):
            found = self._edges(at) or self._measure(at) or self._entry(at)
            if found is None:
                raise self.fail(self.spans[at][0])
            token, used = found
            at += used
            if token.type == "SIDE" and tokens and tokens[-1].type == "LENGTH":
                tokens[-1].type = "OFFSET"  # "20 cm behind": the distance, not a size
            if token.type == "LENGTH" and _drives(tokens):
                token.type = "WAY"  # "drives 100 m": how far, not the size of what follows
            tokens.append(token)
        return with_running(tokens)

    def fail(self, position: int) -> NotUnderstood:
        """The words from a position of the text on, not understood in this order."""
        rest = [word for word, (start, _) in zip(self.words, self.spans, strict=True) if start >= position]
        return NotUnderstood([" ".join(rest[:_SHOWN] or self.words[-1:])], NOT_IN_THIS_ORDER)

    def _token(self, kind: str, value: Any, at: int, used: int) -> tuple[Token, int]:
        start, end = self.spans[at][0], self.spans[at + used - 1][1]
        place = {"line": 1, "column": start, "end_line": 1, "end_column": end, "end_pos": end}
        token = _Meant(kind, self.text[start:end], start, **place)
        token.meaning = value
        return token, used

    def _entry(self, at: int) -> tuple[Token, int] | None:
        for used in range(min(self.known.longest, len(self.words) - at), 0, -1):
            entry = self.known.entries.get(tuple(self.words[at : at + used]))
            if entry is not None:
                return self._token(entry.terminal, entry.value, at, used)
        return None

    def _measure(self, at: int) -> tuple[Token, int] | None:
        """A number, with its unit if it has one."""
        if not self.words[at][0].isdigit():
            return None
        for most in (3, 2, 1):
            words = tuple(self.words[at + 1 : at + 1 + most])
            unit = self.known.units.get(words)
            if unit is not None:
                return self._token(unit[0], float(self.words[at]) * unit[1], at, len(words) + 1)
        if not self.words[at].isdigit():
            return self._token("NUMBER", float(self.words[at]), at, 1)
        return self._token("COUNT", int(self.words[at]), at, 1)

    def _edges(self, at: int) -> tuple[Token, int] | None:
        """ "20 x 10 x 5 cm", "20 by 10 by 5 cm"."""
        here = self.words[at : at + 6]
        if len(here) < 6 or {here[1], here[3]} - {"x", "by"} or not all(here[i][0].isdigit() for i in (0, 2, 4)):
            return None
        kind, factor = self.known.units.get((here[5],), ("", 0.0))
        if kind != "LENGTH":
            return None
        return self._token("EDGES", tuple(float(here[i]) * factor for i in (0, 2, 4)), at, 6)


def _drives(tokens: list[Token]) -> bool:
    """Whether what comes next is how far something drives: "drives", "drives forward for"."""
    last = next((token for token in reversed(tokens) if token.type not in ("FOR", "DIRECTION")), None)
    return last is not None and last.type == "VERB" and _meaning(last) == "drive"


def _is(child: Any, *kinds: str) -> bool:
    return isinstance(child, Token) and child.type in kinds


def _meaning(token: Any) -> Any:
    return token.meaning


@v_args(meta=True)
class _Clauses(Transformer):
    """The grammar's rules, each as what it means. A story is a list of subjects, actions and None for a full stop."""

    def __init__(self, tokens: _Tokens) -> None:
        super().__init__()
        self.tokens = tokens

    def _words(self, meta: Any) -> str:
        return "" if meta.empty else self.tokens.text[meta.start_pos : meta.end_pos]

    # ---- sentences
    def start(self, _meta: Any, children: list[Any]) -> list[Clause]:
        story = next((child for child in children if isinstance(child, list)), [])
        clauses: list[Clause] = []
        for item in story:
            fresh = not clauses or (isinstance(item, Phrase) and bool(clauses[-1].actions))
            if item is None or fresh:
                clauses.append(Clause())
            if isinstance(item, Phrase):
                clauses[-1].subjects.append(item)
            elif isinstance(item, Action):
                clauses[-1].actions.append(item)
        return [clause for clause in clauses if clause.subjects]

    def told(self, _meta: Any, children: list[Any]) -> list[Any]:
        return [*(c for c in children if isinstance(c, Phrase)), *children[-1]]

    def nothing(self, _meta: Any, _children: list[Any]) -> list[Any]:
        return []

    def more(self, _meta: Any, children: list[Any]) -> list[Any]:
        return list(children[-1])

    def stop(self, _meta: Any, children: list[Any]) -> list[Any]:
        return [None, *(children[-1] if isinstance(children[-1], list) else [])]

    def act(self, _meta: Any, children: list[Any]) -> list[Any]:
        return [*(c for c in children if isinstance(c, Action)), *children[-1]]

    act_again = act

    def joiners(self, _meta: Any, _children: list[Any]) -> None:
        return None

    breaks = sep = joiners

    # ---- things
    def subject(self, _meta: Any, children: list[Any]) -> Phrase:
        phrase: Phrase = children[0]
        phrase.places = children[1:]
        return phrase

    def det(self, _meta: Any, children: list[Any]) -> bool:
        return bool(_is(children[0], "THE"))

    def thing(self, meta: Any, children: list[Any]) -> Phrase:
        head = next(child for child in children if isinstance(child, Phrase) or _is(child, *_HEADS))
        phrase = head if isinstance(head, Phrase) else _phrase(head)
        phrase.words = self._words(meta)
        for child in children:
            if isinstance(child, bool):
                phrase.definite = child
            elif child is not head:
                self._modify(phrase, child)
        return phrase

    def _modify(self, phrase: Phrase, child: Any) -> None:
        token, changes = child if isinstance(child, tuple) else (child, _changes(child))
        for name, value in changes.items():
            given = phrase.measures if name in _MEASURES else phrase.__dict__
            if given.get(name) not in (None, False):
                raise self.tokens.fail(token.start_pos)
            given[name] = value

    def size(self, _meta: Any, children: list[Any]) -> tuple[Token, dict[str, Any]]:
        axis = _meaning(children[1]) if len(children) > 1 else "length"
        return children[0], {axis: _meaning(children[0])}

    def sized(self, _meta: Any, children: list[Any]) -> Any:
        return children[-1]

    weighed = sized

    def made(self, _meta: Any, children: list[Any]) -> tuple[Token, dict[str, Any]]:
        return children[0], {"material": _meaning(children[-1])}

    def measured(self, _meta: Any, children: list[Any]) -> tuple[Token, dict[str, Any]]:
        what, measure = _meaning(children[0]), children[1]
        kind = {"mass": "MASS", "density": "DENSITY"}.get(what, "LENGTH")
        if measure.type != kind:
            raise self.tokens.fail(children[0].start_pos)
        return children[0], {"length" if what == "edge" else what: _meaning(measure)}

    def tilted(self, _meta: Any, children: list[Any]) -> tuple[Token, dict[str, Any]]:
        return children[0], {"angle": _meaning(children[1])}

    def running(self, _meta: Any, children: list[Any]) -> tuple[Token, dict[str, Any]]:
        return children[0], {"runs": True, **{place.preposition: place.value for place in children[1:]}}

    def group(self, meta: Any, children: list[Any]) -> Phrase:
        phrase = Phrase("group", self._words(meta), arrangement=_meaning(children[0]))
        phrase.members = next((child for child in children if isinstance(child, Phrase)), None)
        if phrase.members is not None and phrase.members.kind not in self.tokens.known.nouns:
            raise self.tokens.fail(children[0].start_pos)
        return phrase

    def part(self, meta: Any, children: list[Any]) -> Phrase:
        owner = next((child for child in children if isinstance(child, Phrase)), None)
        return Phrase("part", self._words(meta), part=_meaning(children[0]), owner=owner)

    # ---- what they do
    def does(self, meta: Any, children: list[Any]) -> Action:
        verb = next(child for child in children if _is(child, "VERB"))
        action = Action(_meaning(verb), self._words(meta))
        action.target = next((child for child in children if isinstance(child, Phrase)), None)
        for place in (child for child in children if isinstance(child, Place)):
            self._place(action, place)
        known = self.tokens.known
        if (action.particle or "") not in (*known.particles[action.verb], *([""] if action.target else [])):
            raise self.tokens.fail(meta.start_pos)
        if action.target is not None and action.verb not in known.objects:
            raise self.tokens.fail(verb.start_pos)
        return action

    def _place(self, action: Action, place: Place) -> None:
        """Add a place to an action; "knocks over a stack" has a particle and a target."""
        over = place.preposition in ("over", "down") and action.verb in ("knock", "topple")
        if over and action.target is None and place.phrase is not None:
            action.particle, action.target = place.preposition, place.phrase
        elif place.preposition == "bare" and action.particle is None:
            action.particle = place.words
        else:
            action.places.append(place)

    def stands(self, meta: Any, children: list[Any]) -> Action:
        return Action("rest", self._words(meta), places=[child for child in children if isinstance(child, Place)])

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

    def at_angle(self, meta: Any, children: list[Any]) -> Place:
        return Place("angle", value=_meaning(children[1]), words=self._words(meta))

    def for_time(self, meta: Any, children: list[Any]) -> Place:
        return Place("time", value=_meaning(children[1]), words=self._words(meta))

    def toward(self, meta: Any, children: list[Any]) -> Place:
        return Place("toward", direction=_meaning(children[0]), words=self._words(meta))

    def to_share(self, meta: Any, children: list[Any]) -> Place:
        if _meaning(children[0]) != "to":
            raise self.tokens.fail(children[0].start_pos)
        return Place("share", value=round(_meaning(children[1]), 6), words=self._words(meta))

    def up_to(self, meta: Any, children: list[Any]) -> Place:
        return Place("up to", length=_meaning(children[1]), words=self._words(meta))

    def so_far(self, meta: Any, children: list[Any]) -> Place:
        return Place("way", length=_meaning(children[-1]), words=self._words(meta))

    def surfaced(self, meta: Any, children: list[Any]) -> Place:
        things = [*(child for child in children if isinstance(child, Phrase)), None, None]
        value = float(_meaning(children[1]))
        return Place(_meaning(children[0]), things[0], things[1], value=value, words=self._words(meta))

    def bare(self, _meta: Any, children: list[Any]) -> Place:
        return Place("bare", words=str(children[0]))


_HEADS = ("NOUN", "FLUID", "GROUND", "PRONOUN")
_MEASURES = ("x", "y", "z", "radius", "diameter", "mass", "density")


def _phrase(head: Token) -> Phrase:
    meaning = _meaning(head)
    if isinstance(meaning, Named):
        return Phrase(meaning.noun, "", plural=meaning.plural, filled=meaning.filled)
    kind = {"FLUID": "water", "GROUND": "ground", "PRONOUN": "pronoun"}[head.type]
    return Phrase(kind, "", part=str(head) if kind == "pronoun" else None)


_FIELDS = {"COUNT": "count", "SCALE": "scale", "MATERIAL": "material", "COLOR": "color", "EDGES": "edges"}
_FIELDS |= {"MASS": "mass", "ANGLE": "angle", "FILLED": "filled", "RUNNING": "runs"}


def _changes(token: Token) -> dict[str, Any]:
    return {_FIELDS[token.type]: True if token.type in ("FILLED", "RUNNING") else _meaning(token)}
