"""What the search knows of the words that people and packages have for one thing."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from wsim.search.vocabulary import Vocabulary


@cache
def vocabulary() -> Vocabulary:
    """The vocabulary of the API's search."""
    return Vocabulary.read(Path(__file__).with_name("vocabulary.toml"))
