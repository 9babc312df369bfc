"""Words as the search compares them: split, stemmed, and joined with those of one meaning."""

from __future__ import annotations

import re
from collections.abc import Iterable

_PART = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")
_STOP = frozenset(
    [
        "a",
        "an",
        "the",
        "of",
        "to",
        "in",
        "on",
        "at",
        "by",
        "is",
        "are",
        "be",
        "was",
        "it",
        "its",
        "this",
        "that",
        "these",
        "those",
        "and",
        "or",
        "if",
        "as",
        "for",
        "from",
        "with",
        "what",
        "which",
        "how",
        "do",
        "does",
        "i",
        "me",
        "my",
        "we",
        "you",
        "your",
        "can",
        "may",
        "will",
        "one",
        "use",
        "used",
        "using",
        "get",
        "gets",
        "set",
        "value",
        "values",
        "return",
        "returns",
        "given",
        "give",
        "not",
        "no",
        "than",
        "then",
        "so",
        "when",
        "where",
        "see",
        "also",
        "default",
        "optional",
        "none",
        "true",
        "false",
        "type",
        "object",
        "name",
        "must",
        "should",
        "such",
        "e",
        "g",
        "i",
    ]
)
_ENDINGS = (
    "ations", "ation", "ities", "ments", "ment", "ness", "able", "ible", "ings", "ing", "ions", "ion", "ies", "ied",
    "ers", "er", "ors", "or", "ed", "ly", "ity", "es", "s", "y", "e",
)  # fmt: skip
# Words of one meaning, as people say them and as the packages write them.
_THESAURUS = (
    "hinge revolute pivot door knee elbow rotate swing axle",
    "slider prismatic slide rail piston drawer linear",
    "ball spherical socket",
    "weld fixed glue attach rigidly fasten",
    "motor drive actuator servo actuate engine",
    "heavy weight mass density weigh",
    "bouncy bounce restitution elastic rebound",
    "slippery friction grip rub slide sticky rough",
    "colour color paint tint hue red green blue",
    "transparent opacity see-through glass clear",
    "sweep sweepable parameter param vary tunable tune range variable",
    "water fluid liquid sph pour",
    "tank container aquarium pool basin",
    "thick viscosity viscous honey syrup",
    "deep depth level fill full",
    "camera view look eye viewpoint picture photo",
    "lamp light sunlight sun illumination bright sky",
    "floor ground plane terrain",
    "cube box block brick crate cuboid",
    "ball sphere orb marble",
    "rod cylinder pipe post pole disc disk wheel",
    "pill capsule",
    "speed velocity fast moving",
    "spin angular rotation rotate turn",
    "orientation rotation attitude angle tilt yaw pitch roll",
    "place position location where put translate",
    "immovable static fixed stationary anchored",
    "kinematic conveyor prescribed moving",
    "force push pull thrust shove",
    "torque twist moment",
    "duration length long time seconds run",
    "step timestep substep",
    "gravity fall weightless moon",
    "random seed noise jitter rng rand",
    "limit stop bound range",
    "spring stiffness elastic",
    "damper damping dashpot",
    "file mesh obj stl model triangle import",
    "catalogue asset library furniture ready-made",
    "collide collision contact hit touch",
    "hull convex decomposition approximation",
    "attribute property field",
    "save write export",
    "evenly spaced linspace arange",
)


def stem(word: str) -> str:
    """A word without its ending: "hinged", "hinges" and "hinge" give the same."""
    word = word.lower()
    for ending in _ENDINGS:
        if word.endswith(ending) and len(word) - len(ending) >= 3:
            word = word[: -len(ending)]
            break
    return word[:-1] if len(word) > 3 and word[-1] == word[-2] and word[-1] not in "ls" else word


def words(text: str) -> list[str]:
    """The stemmed words of a text; names are split where their case or an underscore does it."""
    return [stem(part) for part in _PART.findall(text) if len(part) > 1 and part.lower() not in _STOP]


def parts(name: str) -> set[str]:
    """The stemmed words of a name, those too that say little in a text."""
    return {stem(part) for part in _PART.findall(name)}


def related(word: str) -> frozenset[str]:
    """Stems that mean what a stem means."""
    return _RELATED.get(word, frozenset())


def _groups(lines: Iterable[str]) -> dict[str, frozenset[str]]:
    found: dict[str, set[str]] = {}
    for line in lines:
        group = {stem(word) for word in line.split()}
        for word in group:
            found.setdefault(word, set()).update(group - {word})
    return {word: frozenset(others) for word, others in found.items()}


_RELATED = _groups(_THESAURUS)
