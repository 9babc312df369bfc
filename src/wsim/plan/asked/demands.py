"""What a prompt demands, found by its words alone: what happens, numbers with their units, places, manners."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

from wsim.plan.asked import vocabulary as words

Kind = Literal["verb", "state", "beyond", "number", "relation", "manner"]
REQUIRED: tuple[Kind, ...] = ("verb", "state", "beyond", "number")
_DIGITS = r"[0-9]+(?:,[0-9]{3})+(?![0-9])(?:\.[0-9]+)?|[0-9]+[.,][0-9]+|[0-9]+"
_TOKEN = re.compile(rf"{_DIGITS}|[^\W\d_]+(?:['’][^\W\d_]+)?|[/^%°²³×]|[.;:!?,()]")
_STOPS = frozenset(".;:!?,()")
_ENDS = frozenset(".;:!?")
_ORDINAL = frozenset(("st", "nd", "rd", "th"))
_NOT_COUNTED = frozenset(["another", "of", "by", "end", "side"])


@dataclass(frozen=True)
class Token:
    """A word, number or sign of a text, in lower case, and where it stands in it."""

    text: str
    start: int
    end: int

    @property
    def stops(self) -> bool:
        """Whether it is punctuation, which is no part of any clause's words."""
        return self.text in _STOPS


@dataclass(frozen=True)
class Demand:
    """Something that a prompt asks for.

    Attributes:
        kind: What it is. A "verb" happens, a "state" is so, what is "beyond" nothing in wsim does.
        text: As the prompt has it.
        first: Number of its first token among those that are no punctuation.
        last: Of its last.
        base: Of a verb, its base form.
        value: Of a number, in `unit`.
        unit: SI, angles in degrees; empty of a bare number.
    """

    kind: Kind
    text: str
    first: int
    last: int
    base: str = ""
    value: float | None = None
    unit: str = ""

    @property
    def quoted(self) -> str:
        """As messages name it."""
        return f"'{self.text}'"


def tokens(text: str) -> list[Token]:
    """The tokens of a text, punctuation too."""
    return [Token(found[0].lower().replace("’", "'"), found.start(), found.end()) for found in _TOKEN.finditer(text)]


@lru_cache(maxsize=64)
def demands(prompt: str) -> tuple[Demand, ...]:
    """All that a prompt demands, in its order."""
    return tuple(sorted(_found(prompt), key=lambda each: (each.first, each.last)))


def _found(prompt: str) -> Iterator[Demand]:
    every = tokens(prompt)
    said = [token for token in every if not token.stops]
    opens = {0} | {sum(not t.stops for t in every[:k]) for k, token in enumerate(every) if token.text in _ENDS}

    def made(kind: Kind, first: int, last: int, **more: object) -> Demand:
        return Demand(kind, prompt[said[first].start : said[last].end], first, last, **more)  # type: ignore[arg-type]

    taken: set[int] = set()
    for first, last, value, unit in _numbers(said):
        taken.update(range(first, last + 1))
        yield made("number", first, last, value=value, unit=unit)
    for k, token in enumerate(said):
        if k in taken:
            continue
        base = words.stem(token.text)
        if base is not None and _is_verb(said, k, base, k in opens):
            yield made(_kind_of(base), k, k, base=base)
        elif token.text in words.MANNERS or (
            token.text.endswith("ly") and len(token.text) > 4 and token.text not in words.NO_MANNER
        ):
            if not (token.text in ("hard", "fast") and _text(said, k - 1) in words.DETERMINERS):
                yield made("manner", k, k)
        elif token.text in words.RELATIONS:
            yield made("relation", k, k)


def _kind_of(base: str) -> Kind:
    if base in words.BEYOND:
        return "beyond"
    return "verb" if base in words.MOTIONS or base in words.CAUSES else "state"


def _text(said: Sequence[Token], k: int) -> str:
    return said[k].text if 0 <= k < len(said) else ""


def _is_verb(said: Sequence[Token], k: int, base: str, opens: bool) -> bool:
    """Whether a word that may be a verb's form is one here: "slides"; not "a slide", "the falls", "a rolling ball"."""
    word, before = said[k].text, _text(said, k - 1)
    if before in words.DETERMINERS and before != "that":
        return False
    counted = before in words.WORDS or before in words.SCALES or (_digits(before) and not _joined(said, k - 1))
    beside = before in ("to", "on", "its", "further") or _text(said, k + 1) == "of"
    if before == "of" or (counted and word == base) or (word == "left" and beside):
        return False
    if word.endswith("ing") and word != base:
        # Between an article and a noun it describes; after a noun, a comma or a verb it tells what goes on.
        return before not in words.PREPOSITIONS or before in ("by", "without", "before", "after", "while")
    if word == base and word not in words.SAME_PAST:
        if opens or before in words.BEFORE_BASE:
            return True
        plural = before.endswith("s") and not before.endswith("ss")
        return plural or _set_going(said, k)
    if word.endswith("s") and word != base:
        return not (counted or (before in words.PREPOSITIONS and before not in ("out", "over", "down", "up", "off")))
    return True


def _set_going(said: Sequence[Token], k: int) -> bool:
    """Whether a base form follows "let it ..." or two subjects: "a ball and a cube fall"."""
    here = [token.text for token in said[max(0, k - 5) : k]]
    return bool({"let", "lets", "make", "makes", "watch", "see", "and"} & set(here)) and here[-1:] != ["and"]


def _numbers(said: Sequence[Token]) -> Iterator[tuple[int, int, float, str]]:
    """(first, last, value, unit) of each number; edges share the unit of the last: "2 x 1 x 0.5 m"."""
    found: list[tuple[int, int, float, str]] = []
    k = 0
    while k < len(said):
        read = _number(said, k)
        if read is None:
            k += 1
            continue
        end, value = read
        unit, size, past = _unit(said, end)
        found.append((k, past - 1, value * size, unit))
        k = past
    for i in range(len(found) - 2, -1, -1):
        (first, last, value, unit), (after, _, _, other) = found[i], found[i + 1]
        if not unit and other and after == last + 2 and _text(said, last + 1) in ("x", "×", "by", "to"):
            size = found[i + 1][2]
            scale = size / read_value if (read_value := _plain(said, after)) else 1.0
            found[i] = (first, last, value * scale, other)
    yield from found


def _plain(said: Sequence[Token], k: int) -> float:
    read = _number(said, k)
    return read[1] if read is not None else 0.0


def _number(said: Sequence[Token], k: int) -> tuple[int, float] | None:
    """Where a number that begins here ends, and what it is, without its unit."""
    token, after = said[k], _text(said, k + 1)
    if _digits(token.text):
        if _joined(said, k) or (after in _ORDINAL and said[k + 1].start == token.end):
            return None
        value = _read(token.text)
        if after == "/" and _digits(_text(said, k + 2)) and (share := _read(said[k + 2].text)):
            return k + 3, value / share
        return k + 1, value
    if token.text in words.PARTS and not token.text.startswith("third"):
        return (k + 2 if after in ("a", "an") else k + 1), words.PARTS[token.text]
    if token.text in ("a", "an"):
        if after in words.SCALES:
            return k + 2, words.SCALES[after]
        return (k + 1, 1.0) if after in words.SPELLED else None
    if token.text == "twice":
        return k + 1, 2.0
    if token.text not in words.WORDS or (token.text == "one" and not _counts(said, k)):
        return None
    return _in_words(said, k)


def _digits(text: str) -> bool:
    return text[:1] in set("0123456789")


def _read(text: str) -> float:
    """Digits as a number: "1,000" is a thousand, "0,5" a half."""
    thousands = re.fullmatch(r"[0-9]+(,[0-9]{3})+(\.[0-9]+)?", text) is not None
    return float(text.replace(",", "") if thousands else text.replace(",", "."))


def _joined(said: Sequence[Token], k: int) -> bool:
    """Whether a number is the end of a name: "Go2"."""
    return k > 0 and said[k - 1].end == said[k].start and said[k - 1].text.isalpha()


def _counts(said: Sequence[Token], k: int) -> bool:
    """Whether "one" is a number: with a unit, or in "one and a half"; "one of them", "the other one" are no counts."""
    after = _text(said, k + 1)
    if after in _NOT_COUNTED or _text(said, k - 1) in words.DETERMINERS:
        return False
    return _unit(said, k + 1)[2] > k + 1 or after in words.SCALES or after == "and"


def _in_words(said: Sequence[Token], k: int) -> tuple[int, float]:
    value, k = words.WORDS[said[k].text], k + 1
    if value >= 20.0 and 0.0 < words.WORDS.get(_text(said, k), 0.0) < 10.0:
        value, k = value + words.WORDS[said[k].text], k + 1
    while _text(said, k) in words.SCALES:
        value, k = value * words.SCALES[said[k].text], k + 1
    if _text(said, k) in words.PARTS:
        return k + 1, value * words.PARTS[said[k].text]
    if [_text(said, k), _text(said, k + 1)] == ["and", "a"] and _text(said, k + 2) in words.PARTS:
        return k + 3, value + words.PARTS[said[k + 2].text]
    return k, value


def _unit(said: Sequence[Token], k: int) -> tuple[str, float, int]:
    """A unit that begins here, how many of its SI unit it is, and where it ends."""
    for length in range(min(words.LONGEST_UNIT, len(said) - k), 0, -1):
        found = words.UNITS.get(tuple(token.text for token in said[k : k + length]))
        if found is not None:
            return (*found, k + length)
    return "", 1.0, k
