"""Which skills some words call for: by rare words in common, deterministic and offline."""

from __future__ import annotations

import re
import sqlite3
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from wsim.search.ranking import Ranking, meant
from wsim.search.vocabulary import Vocabulary
from wsim.search.words import stem
from wsim.skills.library import Skill, skills

WEIGHTS = {"name": 3.0, "description": 2.0, "headings": 1.0}  # what a word counts by where it stands


@dataclass(frozen=True)
class Picked:
    """A skill that some words call for, with its score and the words that count, the weightiest first."""

    skill: Skill
    score: float
    words: tuple[str, ...]


def pick(words: str, limit: int = 3, folder: Path | None = None) -> list[Picked]:
    """The skills that words call for, the best first; of equal ones in the order of their names.

    Args:
        words: A prompt, or what a plan speaks of: primitives, materials, kinds of joints and objectives. A word that
            comes often counts no more than once.
        limit: Most skills to return; fewer where fewer have a word in common.
        folder: Holds the skills; the shipped ones by default.

    Raises:
        ValueError: If limit is below 1.
        SkillError: If a skill's file is wrong.
    """
    if limit < 1:
        raise ValueError(f"limit = {limit} must be at least 1")
    library = skills(folder)
    ranking = _ranking(library)
    counted: dict[int, dict[str, float]] = {}
    # A stem is shown as it was said first.
    for each, said in {stem(word): word for word in reversed(_vocabulary().words(words))}.items():
        for number, score in ranking.scores(meant(each, _vocabulary(), ranking)).items():
            counted.setdefault(number, {})[said] = score
    found = [
        Picked(
            library[number],
            round(sum(scores.values()), 4),
            tuple(sorted(scores, key=lambda said: (scores[said], said), reverse=True)),
        )
        for number, scores in counted.items()
    ]
    return sorted(found, key=lambda picked: (-picked.score, picked.skill.name))[:limit]


@cache
def _vocabulary() -> Vocabulary:
    return Vocabulary.read(Path(__file__).with_name("vocabulary.toml"))


@cache
def _ranking(library: tuple[Skill, ...]) -> Ranking:
    base = sqlite3.connect(":memory:", check_same_thread=False)
    return Ranking.create(base, WEIGHTS, ((i, list(_columns(skill))) for i, skill in enumerate(library)))


def _columns(skill: Skill) -> Iterator[Sequence[str]]:
    """The stems of a skill's name, description and headings. What it is not for calls for another skill."""
    description = re.sub(r"\bNot [^.]*\.?$", "", skill.description)
    for text in (skill.name, description, " ".join(skill.headings)):
        yield _vocabulary().stems(text)
