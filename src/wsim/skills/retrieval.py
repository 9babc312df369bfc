"""Which skills some words call for: by rare words in common, deterministic and offline.

A word counts by where a skill has it (name, headings, description) and by how few skills have it: its inverse document
frequency (Spärck Jones, A statistical interpretation of term specificity and its application in retrieval, 1972).
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from wsim.skills.library import Skill, skills

NAME, HEADING, DESCRIPTION = 3.0, 1.0, 2.0  # what a word counts by where it stands
_IDENTIFIER = re.compile(r"(?<=[a-z0-9])(?=[A-Z])")  # joint_revolute and CheckPenetration are words too
_PLURALS = (("ies", "y"), ("sses", "ss"), ("xes", "x"), ("ches", "ch"), ("shes", "sh"), ("s", ""))
_ENDINGS = ("ation", "ingly", "ness", "ment", "ing", "ion", "ed", "er", "en", "ly", "e", "y")
_SHORTEST = 3  # letters of a stem
_SMALL_WORDS = """
a about all an and any are as at be beside both but by can do each for from has have his how in into is it its let like
made make makes may no not of on one or other over own same say should so some stand such than that the their them then
there they this those to two under up use used using was what when where which while who whose with within without would
wsim world worlds object objects body bodies thing things program prompt speak speaks name names ask asks something
someone skill skills new simple small large big
"""
_COMMON = frozenset(_SMALL_WORDS.split())


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
    index = _index(skills(folder))
    asked = {stem(word): word for word in reversed(list(_split(words)))}  # a stem is shown as it was said first
    found = []
    for skill, weights in index:
        counted = sorted(((weights[each], said) for each, said in asked.items() if each in weights), reverse=True)
        if counted:
            score = sum(weight for weight, _ in counted)
            found.append(Picked(skill, round(score, 4), tuple(said for _, said in counted)))
    return sorted(found, key=lambda picked: (-picked.score, picked.skill.name))[:limit]


def stem(word: str) -> str:
    """What is left of an English word without its endings: "sliding", "slides" and "slide" are one."""
    word = word.lower()
    for plural, singular in _PLURALS:
        if word.endswith(plural) and not word.endswith(("ss", "us", "is")) and len(word) - len(plural) >= _SHORTEST:
            word = word.removesuffix(plural) + singular
            break
    for ending in _ENDINGS:
        if word.endswith(ending) and len(word) - len(ending) >= _SHORTEST:
            word = word.removesuffix(ending)
            break
    # "oscillat" and "slid" are whole; "dropp" of "dropped" is not
    return word[:-1] if len(word) > _SHORTEST and word[-1] == word[-2] and word[-1] not in "ls" else word


def _split(text: str) -> Iterator[str]:
    for word in re.findall(r"[a-z]+", _IDENTIFIER.sub(" ", text).lower()):
        if len(word) > 1 and word not in _COMMON:
            yield word


@cache
def _index(library: tuple[Skill, ...]) -> list[tuple[Skill, dict[str, float]]]:
    """What each stem weighs in each skill."""
    places = [(skill, _places(skill)) for skill in library]
    count = {word: sum(word in words for _, words in places) for _, words in places for word in words}
    return [
        (skill, {word: place * math.log((1 + len(library)) / count[word]) for word, place in words.items()})
        for skill, words in places
    ]


def _places(skill: Skill) -> dict[str, float]:
    """The stems of a skill, by the best place that each stands in. What it is not for calls for another skill."""
    description = re.sub(r"\bNot [^.]*\.?$", "", skill.description)
    found: dict[str, float] = {}
    for weight, text in ((NAME, skill.name), (DESCRIPTION, description), (HEADING, " ".join(skill.headings))):
        for word in _split(text):
            found.setdefault(stem(word), weight)
    return found
