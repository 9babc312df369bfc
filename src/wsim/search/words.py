"""Words as searches compare them: split as people and as programs write them, and without their endings."""

from __future__ import annotations

import re
from difflib import SequenceMatcher

_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")
_PLURALS = (  # an ending, what it was before, and the fewest letters before it: "ties" is no plural of "ty"
    ("ies", "y", 3), ("lves", "lf", 1), ("oes", "o", 3), ("sses", "ss", 1), ("xes", "x", 1), ("ches", "ch", 1),
    ("shes", "sh", 1),
)  # fmt: skip
_VOWEL = re.compile("[aeiouy]")
_VERBS = ("ing", "ied", "ed")  # endings of a verb; they may follow one of the others: "jittering"
_OTHERS = ("ation", "ness", "ment", "able", "ible", "ity", "ion", "er", "en", "ly", "e", "y")
_DOUBLING = frozenset(["ing", "ed", "able", "er", "en"])  # before these a short word's last letter is written twice
_SHORTEST = 3  # letters of a stem
ALIKE = 0.8  # share of two words' letters from which one may be a slip for the other
SHORTEST = 4  # letters of a word that may be a slip: shorter ones are like too many others


def split(text: str) -> list[str]:
    """The words and numbers of a text in lower case; names are split where their case, _ or - does it."""
    return [word.lower() for word in _WORD.findall(text)]


def singular(word: str) -> str:
    """A noun in the singular, by the rules of English spelling: shelves, benches, dominoes, desks."""
    for ending, instead, least in _PLURALS:
        if word.endswith(ending) and len(word) - len(ending) >= least:
            return word.removesuffix(ending) + instead
    return word.removesuffix("s") if len(word) > 3 and not word.endswith(("ss", "us", "is")) else word


def stem(word: str) -> str:
    """What is left of an English word without its endings: "sliding", "slides" and "slide" are one."""
    return _without(_OTHERS, _without(_VERBS, singular(word.lower())))


def _without(endings: tuple[str, ...], word: str) -> str:
    for ending in endings:
        rest = word.removesuffix(ending)
        if rest == word or len(rest) < _SHORTEST or not _VOWEL.search(rest) or word.endswith("eed"):
            continue
        if ending == "ied":
            return rest + "y"
        # "slid" and "roll" are whole; "dropp" of "dropped" is not
        twice = ending in _DOUBLING and len(rest) > _SHORTEST and rest[-1] == rest[-2] and rest[-1] not in "ls"
        return rest[:-1] if twice else rest
    return word


def alike(one: str, other: str) -> float:
    """The share of their letters that two words have in common, 0 where neither can be a slip for the other."""
    if min(len(one), len(other)) < SHORTEST:
        return 0.0
    share = SequenceMatcher(None, one, other).ratio()
    return share if share >= ALIKE else 0.0
