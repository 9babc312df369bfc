"""The numbers of a prompt, in digits and in words, with their units."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from wsim.plan.asked import vocabulary as words
from wsim.plan.asked.tokens import Token, text_at

_ORDINAL = frozenset(("st", "nd", "rd", "th"))
Limit = Literal["", "least", "most", "since"]
_MORE = words.as_set("more greater faster higher further farther longer larger bigger heavier deeper taller")
_LESS = words.as_set("less fewer slower lower nearer closer shorter smaller lighter")
_AT = {"least": "least", "most": "most", "minimum": "least", "maximum": "most"}
_NOT_COUNTED = frozenset(["another", "of", "by", "end", "side"])


@dataclass(frozen=True)
class Number:
    """One of them.

    Attributes:
        first: Number of its first token.
        last: Of its last, which its unit has if it has one.
        value: In its unit.
        unit: SI, angles in degrees; empty of a bare number.
        bound: Whether something is to happen by then: "within 2 s".
        often: Whether it says how often: "three times", "twice".
        limit: "least" of what is to be more, "most" of what is to be less, "since" of a time from which on; else empty.
    """

    first: int
    last: int
    value: float
    unit: str
    bound: bool = False
    often: bool = False
    limit: Limit = ""


def numbers(said: Sequence[Token]) -> Iterator[Number]:
    """Each of them; edges share the unit of the last: "2 x 1 x 0.5 m"; what is a name's counts nothing: "box 1"."""
    found: list[tuple[int, int, float, str]] = []
    k = 0
    while k < len(said):
        read = _number(said, k)
        if read is None:
            k += 1
            continue
        end, value = read
        unit, size, past = _unit(said, end)
        if not unit and _is_name(said, k, end):
            k = end
            continue
        past, more = _and_a_half(said, past) if unit else (past, 0.0)
        found.append((k, past - 1, (value + more) * size, unit))
        k = past
    for i in range(len(found) - 2, -1, -1):
        (first, last, value, unit), (after, _, _, other) = found[i], found[i + 1]
        if not unit and other and after == last + 2 and _ties(said, first, last + 1):
            size = found[i + 1][2]
            scale = size / read_value if (read_value := _plain(said, after)) else 1.0
            found[i] = (first, last, value * scale, other)
    for first, last, value, unit in found:
        often = not unit and _is_often(said, first, last)
        bound = unit == "s" and _is_bound(said, first)
        yield Number(first, last, value, unit, bound, often, _limit(said, first, unit) if unit and not bound else "")


def _ties(said: Sequence[Token], first: int, k: int) -> bool:
    """Whether a number has the unit of the next by what is between them: "2 x 1 m", "between 2 and 3 m"."""
    between = text_at(said, k)
    return between in ("x", "×", "by", "to") or (between == "and" and text_at(said, first - 1) == "between")


def digits(text: str) -> bool:
    """Whether a token is a number in digits."""
    return text[:1] in set("0123456789")


def joined(said: Sequence[Token], k: int) -> bool:
    """Whether a number is the end of a name: "Go2"."""
    edge = said[k - 1].text == "x" and k > 1 and digits(said[k - 2].text)  # "20x30 cm"
    return k > 0 and said[k - 1].end == said[k].start and said[k - 1].text.isalpha() and not edge


def _is_bound(said: Sequence[Token], k: int) -> bool:
    """Whether a time is one by which something happens; "for less than 2 s" tells how long."""
    before = [token.text for token in said[max(0, k - 4) : k] if token.text not in ("a", "about")]
    if "for" in before[-3:]:
        return False
    return before[-1:] in (["within"], ["under"]) or tuple(before[-2:]) in words.BY_THEN


def _limit(said: Sequence[Token], k: int, unit: str) -> Limit:
    """Whether a number is a limit of what is to be: "faster than 2 m/s", "no more than 3 m", "after 2 s"."""
    one, two, three = (text_at(said, k - i) for i in (1, 2, 3))
    if unit == "s" and one == "after":
        return "since"
    if one == "than" and two in _MORE | _LESS:
        more = (two in _MORE) != (three in ("no", "not", "never"))
        return "least" if more else "most"
    if (two == "at" or one == "of") and (found := _AT.get(two if one == "of" else one)) is not None:
        return "least" if found == "least" else "most"
    if (two, one) == ("up", "to") or (unit == "m/s" and one in ("under", "below")):
        return "most"
    return "least" if unit == "m/s" and one in ("over", "above", "exceeds", "exceeding") else ""


def _is_often(said: Sequence[Token], first: int, last: int) -> bool:
    """Whether a number says how often, and not how much: "twice as heavy", "three times the mass"."""
    past = last + 1 + (text_at(said, last + 1) in ("times", "time"))
    if said[last].text != "twice" and past == last + 1:
        return False
    return text_at(said, past) not in words.COMPARES and not text_at(said, past).endswith("er")


def _is_name(said: Sequence[Token], k: int, end: int) -> bool:
    """Whether a bare number tells one thing from others, "ball two", "cart number 2", a model: it stands behind a noun
    and is no count of what comes after it."""
    before, after = text_at(said, k - 1), text_at(said, end)
    if k == 0 or end != k + 1 or "." in said[k].text or not _beside(said, k - 1) or said[k].text == "twice":
        return False
    if before in words.NUMBERED:
        return True
    named = words.stem(before) is None or text_at(said, k - 2) in words.DETERMINERS
    named &= before.isalpha() and before not in words.NO_NOUN | words.QUANTITIES and not before.endswith(("s", "ly"))
    counts = _beside(said, k) and not _is_no_noun(after)
    return named and not counts and after not in ("times", "time", "x", "×", "%", "/", "^")


def _beside(said: Sequence[Token], k: int) -> bool:
    """Whether a token and the next have no more than a space between them."""
    return k + 1 < len(said) and said[k + 1].start - said[k].end <= 1


def _is_no_noun(text: str) -> bool:
    return not text.isalpha() or text in words.NO_NOUN or text.endswith("ly") or words.stem(text) is not None


def _and_a_half(said: Sequence[Token], k: int) -> tuple[int, float]:
    """Where a number with a unit ends, and what it is more: "a second and a half"."""
    texts = [text_at(said, k + i) for i in range(3)]
    if texts[:2] == ["and", "a"] and texts[2] in words.PARTS and not _unit(said, k + 3)[0]:
        return k + 3, words.PARTS[texts[2]]
    return k, 0.0


def _plain(said: Sequence[Token], k: int) -> float:
    read = _number(said, k)
    return read[1] if read is not None else 0.0


def _number(said: Sequence[Token], k: int) -> tuple[int, float] | None:
    """Where a number that begins here ends, and what it is, without its unit."""
    token, after = said[k], text_at(said, k + 1)
    if digits(token.text):
        if after == "o'clock" or _is_of_a_ratio(said, k):
            return None
        if joined(said, k) or (after in _ORDINAL and said[k + 1].start == token.end):
            return None
        value = _read(token.text)
        if after == "/" and digits(text_at(said, k + 2)) and (share := _read(said[k + 2].text)):
            return k + 3, value / share
        return k + 1, value
    if token.text in words.PARTS and not token.text.startswith("third"):
        past = k + 1 + (after in ("a", "an")) + 2 * ([after, text_at(said, k + 2)] == ["of", "a"])
        return past, words.PARTS[token.text]
    if token.text in ("a", "an"):
        if after in words.SCALES:
            return k + 2, words.SCALES[after]
        return (k + 1, 1.0) if after in words.SPELLED or (after == "second" and _is_time(said, k)) else None
    if token.text == "twice":
        return k + 1, 2.0
    if token.text not in words.WORDS or (token.text == "one" and not _counts(said, k)):
        return None
    return _in_words(said, k)


def _is_of_a_ratio(said: Sequence[Token], k: int) -> bool:
    """Whether a number belongs to "1:10", of which the colon is no token: a character is between, and no word."""
    return any(
        i >= 0 and i + 1 < len(said) and digits(said[i].text) and digits(said[i + 1].text)
        and said[i + 1].start - said[i].end == 1 for i in (k - 1, k)
    )  # fmt: skip


def _is_time(said: Sequence[Token], k: int) -> bool:
    """Whether "a second" is a time, and not the second of some: "within a second", not "into a second ball"."""
    ends = not _beside(said, k + 1) or _is_no_noun(text_at(said, k + 2))
    return ends and text_at(said, k - 1) in words.BEFORE_TIMES


def _read(text: str) -> float:
    """Digits as a number: "1,000" is a thousand, "0,5" a half."""
    thousands = re.fullmatch(r"[0-9]+(,[0-9]{3})+(\.[0-9]+)?", text) is not None
    return float(text.replace(",", "") if thousands else text.replace(",", "."))


def _counts(said: Sequence[Token], k: int) -> bool:
    """Whether "one" is a number: with a unit, or in "one and a half"; "one of them", "the other one" are no counts."""
    after = text_at(said, k + 1)
    if after in _NOT_COUNTED or text_at(said, k - 1) in words.DETERMINERS:
        return False
    half = after == "and" and text_at(said, k + 2) == "a" and text_at(said, k + 3) in words.PARTS
    return _unit(said, k + 1)[2] > k + 1 or after in words.SCALES or half


def _in_words(said: Sequence[Token], k: int) -> tuple[int, float]:
    value, k = words.WORDS[said[k].text], k + 1
    if value >= 20.0 and 0.0 < words.WORDS.get(text_at(said, k), 0.0) < 10.0:
        value, k = value + words.WORDS[said[k].text], k + 1
    while text_at(said, k) in words.SCALES:
        value, k = value * words.SCALES[said[k].text], k + 1
    if text_at(said, k) in words.PARTS:
        return k + 1, value * words.PARTS[said[k].text]
    if [text_at(said, k), text_at(said, k + 1)] == ["and", "a"] and text_at(said, k + 2) in words.PARTS:
        return k + 3, value + words.PARTS[said[k + 2].text]
    return k, value


def _unit(said: Sequence[Token], k: int) -> tuple[str, float, int]:
    """A unit that begins here, how many of its SI unit it is, and where it ends."""
    if text_at(said, k) in ("°", "degrees", "deg") and text_at(said, k + 1) in ("c", "f", "celsius", "fahrenheit"):
        return "degC", 1.0, k + 2
    for length in range(min(words.LONGEST_UNIT, len(said) - k), 0, -1):
        found = words.UNITS.get(tuple(token.text for token in said[k : k + length]))
        if found is not None:
            return (*found, k + length)
    return "", 1.0, k
