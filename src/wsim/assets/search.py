"""Find assets by what people call them: ranked, deterministic, and with what matched."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import takewhile
from typing import Literal

from wsim.assets.catalogue import Asset, load_catalogue
from wsim.search.words import alike, singular, split

Kind = Literal["id", "name", "stem", "phrase", "words", "fuzzy"]

# The best that each kind of match can reach. Above a half, the noun itself is what the asset is called.
ID, NAME, STEM, PHRASE, WORDS, FUZZY = 1.0, 0.9, 0.8, 0.7, 0.45, 0.3
ASIDE = 0.5  # what counts less: a name after a preposition ("a lamp on a desk" is a lamp), a word that only describes

_ARTICLES = frozenset({"a", "an", "the", "some", "any", "my", "your", "one"})
_PREPOSITIONS = frozenset(
    {"of", "on", "in", "with", "for", "at", "from", "under", "near", "by", "to", "behind", "beside", "without"}
    | {"that", "which", "full", "filled", "made", "next"}
)


@dataclass(frozen=True)
class Hit:
    """An asset that a search found.

    `score` lies in 0..1, 1 for the id itself. `kind` says how it matched: by its id, by a name, by either in the plural
    or written apart, by a name within the words, by single words of names, category and description, or by a slip of
    the pen. `matched` is what of the asset matched.
    """

    asset: Asset
    score: float
    kind: Kind
    matched: str


def search(words: str, limit: int = 5, catalogue: Mapping[str, Asset] | None = None) -> list[Hit]:
    """Assets that may be meant, the best first; of equal ones in the order of their ids.

    Args:
        words: A noun or a phrase: "desk", "three wooden chairs", "cofee cup".
        limit: Most hits to return.
        catalogue: What to search in; the shipped assets by default.

    Raises:
        ValueError: If limit is below 1.
    """
    if limit < 1:
        raise ValueError(f"limit = {limit} must be at least 1")
    query = [word for word in split(words) if word not in _ARTICLES]
    if not query:
        return []
    assets = (load_catalogue() if catalogue is None else catalogue).values()
    found = (max(_matches(asset, query), key=lambda hit: hit.score, default=None) for asset in assets)
    hits = [hit for hit in found if hit is not None]
    return sorted(hits, key=lambda hit: (-hit.score, hit.asset.id))[:limit]


def _stems(words: Sequence[str]) -> tuple[str, ...]:
    return tuple(singular(word) for word in words)


def _matches(asset: Asset, query: list[str]) -> Iterator[Hit]:
    """All ways in which an asset matches, in no order."""
    stems = _stems(query)
    head = tuple(takewhile(lambda word: word not in _PREPOSITIONS, stems)) or stems
    for name in dict.fromkeys((asset.id, *asset.names)):
        of_id = name == asset.id
        words = split(name)
        noun = _stems(words)
        if words == query:
            yield Hit(asset, ID if of_id else NAME, "id" if of_id else "name", name)
        elif noun == stems or "".join(noun) == "".join(stems):
            yield Hit(asset, STEM if of_id else STEM - 0.02, "stem", name)
        else:
            yield from _within(asset, name, noun, head, stems)
            yield from _slip(asset, name, query, head)
    yield from _by_words(asset, head)


def _within(
    asset: Asset, name: str, called: tuple[str, ...], head: tuple[str, ...], stems: tuple[str, ...]
) -> Iterator[Hit]:
    """A name among other words; one at the end of the head is the noun that the others describe."""
    count = len(called)
    ends = [k + count for k in range(len(stems) - count + 1) if stems[k : k + count] == called]
    if not ends:
        return
    in_head = [end for end in ends if end <= len(head)]
    noun = len(head) in in_head
    share = count / len(stems)
    score = PHRASE - 0.15 * (1.0 - share) - (0.0 if noun else 0.25)
    yield Hit(asset, round(score if in_head else ASIDE * score, 4), "phrase", name)


def _by_words(asset: Asset, head: tuple[str, ...]) -> Iterator[Hit]:
    """Single words; the last one of the head must be a noun of them: "wooden stool" is no wooden table."""
    named = [split(name) for name in asset.names]
    sources = (
        (1.0, [words[-1] for words in named]),  # the noun of a name
        (0.9, split(asset.category)),
        (ASIDE, [word for words in named for word in words]),
        (ASIDE, split(asset.description)),
    )
    weights: dict[str, float] = {}
    for weight, words in sources:
        for word in _stems(words):
            weights.setdefault(word, weight)
    if weights.get(head[-1], 0.0) <= ASIDE:
        return
    score = WORDS * sum(weights.get(word, 0.0) for word in head) / len(head)
    yield Hit(asset, round(score, 4), "words", " ".join(word for word in head if word in weights))


def _slip(asset: Asset, name: str, query: list[str], head: tuple[str, ...]) -> Iterator[Hit]:
    """A name that is nearly the query, or nearly its noun."""
    for said, most in ((" ".join(query), FUZZY), (head[-1], 0.9 * FUZZY)):
        share = alike(said, name)
        if share:
            yield Hit(asset, round(most * share, 4), "fuzzy", name)
