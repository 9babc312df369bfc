"""A prompt becomes clauses: recursive descent over a closed vocabulary, with no word left over.

prompt  = clause (separator clause)*
clause  = ["there" is] things [action (joiner action)*]
things  = thing (joiner thing)*          thing  = [article] [count] adjective* noun [place*]
action  = [is] verb [particle] [thing] [particle] place*       |  is place+
place   = preposition (thing | length)
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from wsim.errors import UserError
from wsim.plan import words as w
from wsim.plan.materials import COLORS, MATERIALS

# What may stand after a verb; None: nothing.
_PARTICLES: dict[str, tuple[str | None, ...]] = {
    "knock": ("over", "down"),
    "topple": (None, "over"),
    "fall": (None, "over", "down", "in"),
    "drop": (None, "down", "in"),
}
_TOKEN = re.compile(r"\d+(?:\.\d+)?|[^\W\d_]+(?:'[^\W\d_]+)?|[,.;]|\S")


class NotUnderstood(UserError):  # noqa: N818 - it reads as the sentence it carries
    """The builtin planner does not know some of the prompt's words, or not in this order."""

    def __init__(self, words: list[str], reason: str) -> None:
        self.words = words
        quoted = ", ".join(f"{word!r}" for word in words)
        super().__init__(
            f"the builtin planner {reason}: {quoted}. It plans things in a tank of water and things on the ground, and "
            f"knows only these words — {w.known_words()}. Reword the prompt, or write the plan yourself and pass it: "
            "wsim generate --plan plan.json. A planner that uses a language model is not part of this version"
        )


@dataclass
class Phrase:
    """A thing as the prompt names it."""

    kind: str  # a value of words.NOUNS, or "group", "tank", "water", "ground", "part", "pronoun"
    words: str
    definite: bool = False
    plural: bool = False
    count: int | None = None
    material: str | None = None
    color: str | None = None
    scale: float | None = None  # against the default size
    length: float | None = None  # [m]
    members: Phrase | None = None  # of a group
    part: str | None = None  # "surface", "top" or "bottom", of `owner`
    owner: Phrase | None = None
    filled: bool = False  # a tank that was said to hold water
    places: list[Place] = field(default_factory=list)


@dataclass
class Place:
    """Where something is, goes to or comes from."""

    preposition: str
    phrase: Phrase | None = None
    length: float | None = None  # [m], "from 0.5 m"


@dataclass
class Action:
    """What a thing does."""

    verb: str
    words: str
    target: Phrase | None = None
    particle: str | None = None
    places: list[Place] = field(default_factory=list)


@dataclass
class Clause:
    """Things, and what they all do."""

    subjects: list[Phrase]
    actions: list[Action]
    words: str


def parse(prompt: str) -> list[Clause]:
    """Clauses of a prompt.

    Raises:
        NotUnderstood: names the words that are unknown, or the place where known words make no sentence.
    """
    tokens = _TOKEN.findall(re.sub(r"(?<=\w)-(?=\w)", " ", prompt.lower()))
    unknown = [token for token in dict.fromkeys(tokens) if not _number(token) and token not in w.VOCABULARY]
    if unknown:
        raise NotUnderstood(unknown, "does not know")
    parser = _Parser(tokens)
    clauses = parser.prompt()
    if not clauses:
        raise NotUnderstood([prompt.strip()], "found nothing to build in")
    return clauses


def _number(token: str) -> bool:
    return token[0].isdigit()


class _Parser:
    def __init__(self, tokens: list[str]) -> None:
        self.tokens = tokens
        self.at = 0

    # ---- tokens
    def peek(self, ahead: int = 0) -> str:
        index = self.at + ahead
        return self.tokens[index] if index < len(self.tokens) else ""

    def take(self) -> str:
        self.at += 1
        return self.tokens[self.at - 1]

    def accept(self, words: frozenset[str]) -> bool:
        if self.peek() in words:
            self.at += 1
            return True
        return False

    def text(self, start: int) -> str:
        return re.sub(r" ([,.;])", r"\1", " ".join(self.tokens[start : self.at]))

    def fail(self, at: int | None = None) -> NotUnderstood:
        start = self.at if at is None else at
        rest = self.tokens[start : start + 6] or self.tokens[-1:]
        return NotUnderstood([" ".join(rest)], "knows these words, but not in this order")

    # ---- sentences
    def prompt(self) -> list[Clause]:
        clauses: list[Clause] = []
        while True:
            while self.peek() in w.ENDS | w.JOINERS or (self.peek() == "with" and clauses):
                self.at += 1
            if not self.peek():
                return clauses
            clauses.append(self.clause())

    def clause(self) -> Clause:
        start = self.at
        if self.accept(frozenset({"there"})) and not self.accept(w.BE):
            raise self.fail()
        subjects = [self.thing(places=True)]
        while self._joined(self._starts_thing):
            subjects.append(self.thing(places=True))
        actions = []
        if self._starts_action():
            actions.append(self.action())
            while self._joined(self._starts_action):
                actions.append(self.action())
        clause = Clause(subjects, actions, self.text(start))
        if self.peek() and self.peek() not in w.ENDS | w.JOINERS | {"with"}:
            raise self.fail()
        return clause

    def _joined(self, starts: object) -> bool:
        """Skip joiners if what they join starts as asked."""
        mark = self.at
        while self.accept(w.JOINERS):
            pass
        if self.at > mark and callable(starts) and starts():
            return True
        self.at = mark
        return False

    def _starts_action(self) -> bool:
        return self.peek() in w.VERBS or self.peek() in w.BE

    def _starts_thing(self) -> bool:
        word = self.peek()
        return bool(word) and (
            _number(word)
            or word in w.ARTICLES
            or word in w.NUMBERS
            or word in MATERIALS
            or word in COLORS
            or word in w.SIZES
            or self._starts_noun()
        )

    def _starts_noun(self) -> bool:
        word = self.peek()
        return word in w.NOUNS or word in w.GROUPS | w.TANKS | w.WATER | w.GROUND | w.PRONOUNS or word in w.PARTS

    # ---- things
    def thing(self, places: bool = False) -> Phrase:
        start = self.at
        phrase = Phrase(kind="", words="", definite=self.peek() == "the")
        self.accept(w.ARTICLES)
        self._adjectives(phrase)
        self._noun(phrase)
        phrase.words = self.text(start)
        _check_adjectives(phrase)
        while places and self._starts_place():
            phrase.places.append(self.place())
        return phrase

    def _adjectives(self, phrase: Phrase) -> None:
        while True:
            word = self.peek()
            if word and _number(word) and self.peek(1) in w.UNITS:
                self._once(phrase.length is None)
                phrase.length = self.length()
            elif (word and _number(word)) or word in w.NUMBERS:
                self._once(phrase.count is None)
                if word not in w.NUMBERS and not word.isdigit():
                    raise self.fail()
                phrase.count = w.NUMBERS.get(word) or int(word)
                self.at += 1
            elif word in w.SIZES:
                self._once(phrase.scale is None)
                phrase.scale = w.SIZES[self.take()]
            elif word in MATERIALS:
                self._once(phrase.material is None)
                phrase.material = self.take()
            elif word in COLORS:
                self._once(phrase.color is None)
                phrase.color = self.take()
            else:
                return

    def _once(self, first: bool) -> None:
        if not first:
            raise self.fail()

    def _noun(self, phrase: Phrase) -> None:
        word = self.peek()
        if word in w.WATER and self.peek(1) in w.TANKS:
            self.at += 1
            phrase.filled = True
            word = self.peek()
        if not self._starts_noun():
            raise self.fail()
        self.at += 1
        if word in w.NOUNS:
            phrase.kind = w.NOUNS[word]
            phrase.plural = word in w.PLURALS
            if self.peek() == "of" and self.peek(1) and _number(self.peek(1)) and self.peek(2) in w.UNITS:
                self.at += 1
                self._once(phrase.length is None)
                phrase.length = self.length()
        elif word in w.GROUPS:
            phrase.kind = "group"
            if self.accept(frozenset({"of"})):
                phrase.members = self.thing()
                if phrase.members.kind not in w.NOUNS.values():
                    raise self.fail()
        elif word in w.TANKS:
            phrase.kind = "tank"
            phrase.filled = self._filling() or phrase.filled
        elif word in w.PARTS:
            phrase.kind = "part"
            phrase.part = word
            if self.accept(frozenset({"of"})):
                phrase.owner = self.thing()
        else:
            phrase.kind = "water" if word in w.WATER else "ground" if word in w.GROUND else "pronoun"

    def _filling(self) -> bool:
        """ "of water", "with water", "filled with water", "full of water"."""
        for lead in (("of",), ("with",), ("filled", "with"), ("full", "of")):
            ahead = [self.peek(i) for i in range(len(lead) + 1)]
            if ahead[:-1] == list(lead) and ahead[-1] in w.WATER:
                self.at += len(lead) + 1
                return True
        return False

    def length(self) -> float:
        """A number and its unit [m]."""
        number = self.take()
        if self.peek() not in w.UNITS:
            raise self.fail(self.at - 1)
        return float(number) * w.UNITS[self.take()]

    # ---- actions and places
    def action(self) -> Action:
        start = self.at
        be = self.accept(w.BE)
        if be and self.peek() not in w.VERBS:
            action = Action("rest", "")
            if not self._starts_place():
                raise self.fail()
        elif self.peek() in w.VERBS:
            action = Action(w.VERBS[self.take()], "")
        else:
            raise self.fail()
        self._particle(action)
        if self._starts_thing() and action.verb in ("hit", "knock", "topple", "hold"):
            action.target = self.thing()
            self._particle(action)
        while self._starts_place():
            action.places.append(self.place())
        action.words = self.text(start)
        if action.particle not in _PARTICLES.get(action.verb, (None,)):
            raise self.fail(start)
        return action

    def _particle(self, action: Action) -> None:
        if self.peek() not in w.PARTICLES or action.particle is not None:
            return
        if self.peek() == "in":
            mark = self.at
            self.at += 1
            if self._starts_thing():  # a preposition then
                self.at = mark
                return
            action.particle = "in"
            return
        action.particle = self.take()

    def _starts_place(self) -> bool:
        return self.peek() in w.PREPOSITIONS

    def place(self) -> Place:
        place = Place(self.take())
        if self.peek(1) == "height":
            self.accept(w.ARTICLES)
        if self.accept(frozenset({"height"})) and not self.accept(frozenset({"of"})):
            raise self.fail()
        if place.preposition == "from" or (self.peek() and _number(self.peek()) and self.peek(1) in w.UNITS):
            if not self.peek() or not _number(self.peek()) or self._noun_follows():
                place.phrase = self.thing()
                return place
            place.length = self.length()
            return place
        place.phrase = self.thing()
        return place

    def _noun_follows(self) -> bool:
        """Whether a length that comes next describes a thing: "on 20 cm boxes"."""
        return self.peek(2) in w.NOUNS or self.peek(2) in MATERIALS or self.peek(2) in COLORS


def _check_adjectives(phrase: Phrase) -> None:
    """Refuse adjectives that the noun cannot carry, rather than drop them."""
    if phrase.kind in w.NOUNS.values():
        return
    carried = [
        word
        for word in (phrase.material, phrase.color)
        if word is not None and not (phrase.kind == "tank" and word == "glass")
    ]
    sized = phrase.scale is not None or phrase.length is not None or (phrase.count is not None and phrase.count != 1)
    if carried or sized:
        raise NotUnderstood([phrase.words], "can give these words to a block or a ball, but not to this")
