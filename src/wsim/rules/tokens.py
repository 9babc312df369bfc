"""A prompt's words as tokens: each the longest entry of the lexicon at its place, or a number with its unit."""

from __future__ import annotations

import difflib
import re
from collections.abc import Sequence
from typing import Any

from lark import Token

from wsim.errors import UserError
from wsim.rules.lexicon import Lexicon, Named, lexicon

_WORD = re.compile(r"\d+(?:\.\d+)?|[^\W\d_]+/[^\W\d_]+(?:\^?\d)?|[^\W\d_]+(?:'[^\W\d_]+)?|\S")
_SHOWN = 6  # words of what is not in order
_NEAR = 0.84  # how alike a word must be to be suggested, with the same first letter
_TIMES = ("times", "time")
_CROSSES = ("drive", "drives", "cross", "crosses", "driving", "crossing", "leaves", "reaches")
UNKNOWN = "does not know"
NOT_IN_THIS_ORDER = "knows these words, but not in this order"


class NotUnderstood(UserError):  # noqa: N818 - it reads as the sentence it carries
    """The builtin planner does not know some of the prompt's words, or not in this order."""

    def __init__(self, words: list[str], reason: str) -> None:
        self.words = words
        quoted = ", ".join(f"{word!r}{_suggestion(word) if reason == UNKNOWN else ''}" for word in words)
        super().__init__(
            f"the builtin planner {reason.rstrip(':')}: {quoted}. `wsim plan --words` lists what it knows; "
            "--planner-model MODEL lets a language model plan any sentence"
        )


def _suggestion(word: str) -> str:
    alike = sorted(known for known in lexicon().vocabulary if known[:1] == word[:1])
    near = difflib.get_close_matches(word, alike, n=1, cutoff=_NEAR)
    return f" (did you mean {near[0]!r}?)" if near else ""


class Meant(Token):
    """A token with what its entry means."""

    meaning: Any = None


class Tokens:
    """The prompt's words, and the tokens that they make."""

    def __init__(self, prompt: str, known: Lexicon) -> None:
        self.text = as_read(prompt)
        self.known = known
        self.spans = [match.span() for match in _WORD.finditer(self.text)]
        self.words = [self.text[a:b] for a, b in self.spans]

    def all(self) -> list[Meant]:
        """The tokens.

        Raises:
            NotUnderstood: a word is in no entry.
        """
        vocabulary = self.known.vocabulary
        unknown = [w for w in dict.fromkeys(self.words) if not w[0].isdigit() and w not in vocabulary]
        if unknown:
            raise NotUnderstood(unknown, UNKNOWN)
        tokens: list[Meant] = []
        at = 0
        while at < len(self.words):
            found = self._edges(at) or self._cups(at) or self._measure(at) or self._often(at) or self._entry(at)
            if found is None:
                raise self.fail(self.spans[at][0])
            token, used = found
            at += used
            if token.type == "SHAPE" and tokens and tokens[-1].type == "LENGTH":
                token.type, token.meaning = "DIMENSION", token.meaning[0]  # "1 m long"
            if token.type == "SIDE" and tokens and (tokens[-1].type == "LENGTH" or _is_height(tokens)):
                # "20 cm behind", "is dropped 2 m behind": the distance, not a size or height.
                tokens[-1].type = "OFFSET"
            last = tokens[-1].type if tokens else ""
            if token.type == "COUNT" and str(token) == "one" and last in _LOOKS:
                token.type = "ONE"  # "a small one"
            if token.type == "MEASURE" and last == "LENGTH":
                token.type = "DIMENSION"  # "of 10 cm diameter"
            if token.type in ("NOUN", *_LOOKS) and last == "VERB" and str(tokens[-1]) in _DONE and len(tokens) > 1:
                tokens[-1].type = "ING" if tokens[-2].type in ("COUNT", "ART", "THE", *_LOOKS) else "VERB"
            if token.type == "LENGTH" and (last == "FOR" or last == "AFTER"):
                token.type = "WAY"  # "for 40 m"
            if token.type == "LENGTH" and last == "NOUN" and any(_is_drive(one) for one in tokens):
                token.type = "WAY"  # "drive a truck 50 m"
            if token.type in ("BREAK", "JOIN") and tokens and str(tokens[-1]) in _BELOW:
                tokens[-1].type, tokens[-1].meaning = "MANNER", "below"  # "falls into a bucket below."
            if token.type == "LENGTH" and (_drives(tokens) or _falls(tokens)):
                token.type = "WAY"  # "drives 100 m": how far, not the size of what follows
            if token.type in ("VERB", "COMMAND") and str(token) in _ALSO_NOUNS and last in ("ART", "THE", *_LOOKS):
                token.type, token.meaning = "NOUN", Named(str(token), plural=False)
            tokens.append(token)
        return _commanded(tokens, self.known)

    def fail(self, position: int) -> NotUnderstood:
        """The words from a position of the text on, not understood in this order."""
        rest = [word for word, (start, _) in zip(self.words, self.spans, strict=True) if start >= position]
        return NotUnderstood([" ".join(rest[:_SHOWN] or self.words[-1:])], NOT_IN_THIS_ORDER)

    def _token(self, kind: str, value: Any, at: int, used: int) -> tuple[Meant, int]:
        start, end = self.spans[at][0], self.spans[at + used - 1][1]
        place = {"line": 1, "column": start, "end_line": 1, "end_column": end, "end_pos": end}
        token = Meant(kind, self.text[start:end], start, **place)
        token.meaning = value
        return token, used

    def _entry(self, at: int) -> tuple[Meant, int] | None:
        for used in range(min(self.known.longest, len(self.words) - at), 0, -1):
            entry = self.known.entries.get(tuple(self.words[at : at + used]))
            if entry is None or (_named(entry.value) == "pontoon" and not {*_CROSSES} & {*self.words}):
                continue
            if entry.terminal == "FILLED_WITH" and not self._measured(at + used):
                continue  # "filled with a hose"
            if used > 1 and entry.value == "hit" and self._flows(at):
                continue  # "runs into a box" hits it, water "runs into a tank"
            kind = "ING" if entry.terminal == "VERB" and self.words[at].endswith("ing") else entry.terminal
            return self._token(kind, entry.value, at, used)
        return None

    def _cups(self, at: int) -> tuple[Meant, int] | None:
        """ "Two cups of water", where it is poured or filled in: else a cup is a thing."""
        number = (1.0, 1) if self.words[at] == "a" else self._number(at)
        if number is None or not {*_POURED} & {*self.words}:
            return None
        past = at + number[1]
        if self.words[past : past + 1] not in (["cup"], ["cups"]) or self.words[past + 1 : past + 2] != ["of"]:
            return None
        return self._token("VOLUME", number[0] * CUP, at, number[1] + 1)

    def _measured(self, at: int) -> bool:
        """Whether a measure of a liquid comes next, or its colour."""
        if at >= len(self.words):
            return False
        if self.words[at] == "a" and self.words[at + 1 : at + 2] == ["quarter"]:
            at += 1
        return self.words[at] in self.known.colors or bool(self._cups(at) or self._measure(at))

    def _flows(self, at: int) -> bool:
        """Whether what comes before is a liquid, or what it comes from."""
        entries = [self.known.entries.get((word,)) for word in self.words[max(0, at - 3) : at]]
        return any(one is not None and (one.terminal == "FLUID" or _named(one.value) == "tap") for one in entries)

    def _measure(self, at: int) -> tuple[Meant, int] | None:
        """A number, with its unit if it has one."""
        found = self._number(at) if at < len(self.words) else None
        if found is None:
            return None
        value, digits = found
        if at + digits >= len(self.words) and not self.words[at][0].isdigit():
            return None
        for most in (4, 3, 2, 1):
            words = tuple(self.words[at + digits : at + digits + most])
            unit = self.known.units.get(words) if len(words) == most else None
            if unit is not None and (self.words[at][0].isdigit() or len(words[0]) > 2):
                return self._token(unit[0], value * unit[1], at, digits + most)
        if not self.words[at][0].isdigit():
            return None
        if not self.words[at].isdigit():
            return self._token("NUMBER", value, at, 1)
        return self._token("COUNT", int(value), at, 1)

    def _number(self, at: int) -> tuple[float, int] | None:
        """A number in digits or in words, and how many of these it takes: "0.5", "two", "half a", "one and a half"."""
        here = self.words[at : at + 4]
        if here[0][0].isdigit():
            return float(here[0]), 1
        if here[0] in ("half", "quarter"):
            past = 3 if here[1:3] == ["of", "a"] else 2 if here[1:2] in (["a"], ["an"]) else 1
            return 0.5 if here[0] == "half" else 0.25, past
        entry = self.known.entries.get((here[0],))
        if entry is None or entry.terminal != "COUNT":
            return (1.0, 1) if here[0] in ("a", "an") and _long_unit(self.known, here[1:2]) else None
        half = here[1:] == ["and", "a", "half"]
        return float(entry.value) + 0.5 * half, 4 if half else 1

    def _often(self, at: int) -> tuple[Meant, int] | None:
        """ "3 times", "twice"."""
        number = self._number(at)
        if number is None or self.words[at + number[1] : at + number[1] + 1] not in [[word] for word in _TIMES]:
            return None
        return self._token("TIMES", int(number[0]), at, number[1] + 1)

    def _edges(self, at: int) -> tuple[Meant, int] | None:
        """ "20 x 10 x 5 cm", "20 by 10 by 5 cm"."""
        here = self.words[at : at + 6]
        if len(here) < 6 or {here[1], here[3]} - {"x", "by"} or not all(here[i][0].isdigit() for i in (0, 2, 4)):
            return None
        kind, factor = self.known.units.get((here[5],), ("", 0.0))
        if kind != "LENGTH":
            return None
        return self._token("EDGES", tuple(float(here[i]) * factor for i in (0, 2, 4)), at, 6)


_LOOKS = ("SCALE", "COLOR", "MATERIAL", "WEIGHT", "SHAPE")
_POURED = ("pour", "pours", "poured", "pouring", "filled", "fills", "fill")
CUP = 0.0002365882365  # of the United States [m^3]
_ALSO_NOUNS = ("drain",)  # verbs' forms that are things after an article
_DONE = ("stacked", "piled", "submerged")  # what is said before a thing: "two stacked crates"
_STRUCK = ("hit", "knock", "topple", "push")  # verbs of what one does with something
_BELOW = ("below", "underneath", "beneath")
_SHORT = (
    (r"[\u2018\u2019]", "'"),
    (r"\b(there|it|that|what|here)'s\b", r"\1 is"),
    (r"\b(they|we|you)'re\b", r"\1 are"),
    (r"\bi'd\b", "i would"),
    (r"\blet's\b", "let"),
    (r"\bit (?:is raining|rains)\b", "rain falls"),
    (r"\b(is|are|was|were|does|do|did)n't\b", r"\1 not"),
)


def as_read(prompt: str) -> str:
    """The prompt in lower case, with one space between words and nothing shortened."""
    return " ".join(re.sub(r"(?<=\w)-(?=\w)", " ", _in_full(prompt.lower())).split())


def _in_full(text: str) -> str:
    """ "There's", "doesn't": in full."""
    for short, full in _SHORT:
        text = re.sub(short, full, text)
    return text


def _commanded(tokens: list[Meant], known: Lexicon) -> list[Meant]:
    """The tokens, with what is commanded as such: a verb's own form where a clause starts, or where "someone" does it.

    "And" goes on commanding only in a sentence that commands: "two balls roll and hit a box" does not.
    """
    commands, opens, verb = False, True, ""
    for at, token in enumerate(tokens):
        before = tokens[at - 1].type if at else "BREAK"
        after = tokens[at + 1].type if at + 1 < len(tokens) else "BREAK"
        words = tuple(str(token).split())
        if before in ("BREAK", "WITH"):
            commands, opens = commands and str(tokens[at - 1]) == "with", True
        starts = before in ("BREAK", "SHOW") or (before in ("JOIN", "COMMA") and (commands or opens))
        if before == "MOTOR" and token.type == "VERB" and token.meaning == "run":
            tokens[at - 1].type, token.type = "SHOW", "COMMAND"
        elif before == "ACTOR" and words in {**known.third, **known.commands}:
            token.type, token.meaning = "COMMAND", {**known.third, **known.commands}[words]
        elif starts and words in known.commands and after not in ("OF", "BREAK", "JOIN"):
            token.type, token.meaning, commands = "COMMAND", known.commands[words], True
            verb = token.meaning
        elif token.type == "WITH" and verb == "fill" and commands:
            token.type = "USING"  # "fill a tank with a hose"
        elif token.type == "WITH" and before == "VERB" and tokens[at - 1].meaning == "fill":
            token.type = "BY"  # "a tank is filled with a hose"
        elif token.type == "WITH" and commands and verb in _STRUCK and after != "FORCE":
            token.type = "USING"  # "knock a tower over with a ball"
        elif token.type in ("VERB", "ING", "BE", "COMMAND"):
            opens = False
    for token in tokens:
        token.type = "SHOW" if token.type == "ACTOR" else token.type
    return tokens


def _is_drive(token: Token) -> bool:
    return token.type in ("VERB", "COMMAND") and getattr(token, "meaning", None) == "drive"


def _named(value: Any) -> str:
    return value.noun if isinstance(value, Named) else ""


def _long_unit(known: Lexicon, words: list[str]) -> bool:
    """Whether "a" may count a unit: "a metre" does, "a second ball" does not."""
    return known.units.get(tuple(words), ("",))[0] in ("LENGTH", "MASS", "VOLUME") and len(words[0]) > 2


def _falls(tokens: Sequence[Token]) -> bool:
    """Whether what comes next is how far something falls: "falls 2 m"."""
    return bool(tokens) and tokens[-1].type == "VERB" and getattr(tokens[-1], "meaning", None) in ("fall", "drop")


def _is_height(tokens: Sequence[Token]) -> bool:
    """Whether what came last was taken for how far something falls."""
    return tokens[-1].type == "WAY" and _falls(tokens[:-1])


def _drives(tokens: Sequence[Token]) -> bool:
    """Whether what comes next is how far something drives: "drives", "drives forward for"."""
    last = next((token for token in reversed(tokens) if token.type not in ("FOR", "DIRECTION")), None)
    return last is not None and last.type in ("VERB", "ING") and getattr(last, "meaning", None) == "drive"
