"""A text as the words, numbers and signs that it is made of."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

_DIGITS = r"[0-9]+(?:,[0-9]{3})+(?![0-9])(?:\.[0-9]+)?|[0-9]+[.,][0-9]+|[0-9]+"
_TOKEN = re.compile(rf"{_DIGITS}|[^\W\d_]+(?:['’][^\W\d_]+)?|[/^%°²³×]|[.;:!?,()]")
_STOPS = frozenset(".;:!?,()")
_ENDS = frozenset(".;:!?")


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


def tokens(text: str) -> list[Token]:
    """The tokens of a text, punctuation too."""
    return [Token(found[0].lower().replace("’", "'"), found.start(), found.end()) for found in _TOKEN.finditer(text)]


@dataclass(frozen=True)
class Words:
    """The tokens of a text that are no punctuation.

    Attributes:
        said: Those.
        opens: Numbers of those with which a sentence begins.
        breaks: And of those that stand behind any punctuation.
    """

    said: tuple[Token, ...]
    opens: frozenset[int]
    breaks: frozenset[int]

    @staticmethod
    def of(text: str) -> Words:
        """Of a text."""
        said: list[Token] = []
        opens, breaks = {0}, {0}
        for token in tokens(text):
            if not token.stops:
                said.append(token)
                continue
            breaks.add(len(said))
            opens.update({len(said)} if token.text in _ENDS else ())
        return Words(tuple(said), frozenset(opens), frozenset(breaks))


def text_at(said: Sequence[Token], k: int) -> str:
    """A token's text; empty beyond the ends."""
    return said[k].text if 0 <= k < len(said) else ""
