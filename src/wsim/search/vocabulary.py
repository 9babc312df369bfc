"""What a search knows of language: words that say nothing, and words of one meaning. Each search has its own, as data.

small = "a an the of"
same = ["hinge revolute pivot", "water fluid liquid"]
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from pathlib import Path

from wsim.search.words import split, stem

_ENGLISH = Path(__file__).with_name("english.toml")
RELATED = 0.55  # what a word of the same meaning counts, beside the word itself


class Vocabulary:
    """Words that say nothing, and words of one meaning.

    Args:
        small: Words that a search leaves out.
        same: Groups of words that mean the same, each apart by spaces. A word may stand in several.
    """

    def __init__(self, small: str = "", same: Iterable[str] = ()) -> None:
        self._small = frozenset(small.split())
        found: dict[str, set[str]] = {}
        for line in same:
            group = {stem(word) for word in split(line)}
            for word in group:
                found.setdefault(word, set()).update(group - {word})
        self._related = {word: frozenset(others) for word, others in found.items()}

    @classmethod
    def read(cls, file: Path) -> Vocabulary:
        """The vocabulary in a TOML file, with the spellings that every search knows."""
        own, shared = (tomllib.loads(each.read_text(encoding="utf-8")) for each in (file, _ENGLISH))
        return cls(own["small"], [*own["same"], *shared["same"]])

    def words(self, text: str) -> list[str]:
        """The words of a text that say something, as they stand there, in lower case."""
        return [word for word in split(text) if len(word) > 1 and word not in self._small]

    def stems(self, text: str) -> list[str]:
        """The stems of the words of a text that say something."""
        return [stem(word) for word in self.words(text)]

    def related(self, word: str) -> frozenset[str]:
        """Stems that mean what a stem means."""
        return self._related.get(word, frozenset())

    def knows(self, word: str) -> bool:
        """Whether a stem has others of its meaning."""
        return word in self._related

    def widened(self, word: str, counts: float = 1.0) -> dict[str, float]:
        """A stem, and those that mean what it means, with what each counts."""
        return {**dict.fromkeys(self.related(word), RELATED * counts), word: counts}
