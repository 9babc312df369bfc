"""Search a store by words and by meaning."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wsim.program.api.entry import Entry
from wsim.program.api.store import Store
from wsim.program.api.vectors import Floats
from wsim.program.api.words import related, stem, words

_RELATED = 0.55  # what a word of the same meaning counts, beside the word itself
_MEANING = 0.45  # what nearness of meaning counts, beside shared words
_NAMED = 0.5  # a name made of the words asked for
_EXACT = 3.0  # a name that is asked for as it is written
# What a program reaches for first. A word's rarity says nothing of that.
_FIRST = {"wsim": 1.6, "schema": 0.95, "pxr": 0.9, "numpy": 0.95, "python": 0.8, "newton": 0.85, "warp": 0.8}


_KIND = {"module": 0.5, "attribute": 0.75, "property": 0.85, "schema attribute": 0.9}


@dataclass(frozen=True)
class Hit:
    """An entry that was found, and how well it fits; greater is better."""

    entry: Entry
    score: float


class Searcher:
    """Searches one store."""

    def __init__(self, store: Store) -> None:
        self._store = store
        self._meaning: Floats = store.meaning()
        names = store.names()
        first = [_FIRST.get(source, 0.8) * _KIND.get(kind, 1.0) for source, kind in store.sorts()]
        self._first = np.array(first, np.float32)
        # What a module of wsim.scene keeps for itself is not what a program reaches for.
        inner = [name.startswith("wsim.") and not _public(name) for name in names]
        self._first[inner] *= 0.4
        self._depth = np.array([1 + name.count(".") for name in names], np.float32)
        self._parts = [frozenset(words(name.rpartition(".")[2])) for name in names]

    def search(self, text: str, limit: int) -> list[Hit]:
        """The entries that fit best, best first."""
        asked = _weighted(text)
        lexical = np.zeros(len(self._first), np.float32)
        vector = np.zeros(self._meaning.shape[1], np.float32)
        total = 0.0
        for word, weight in asked.items():
            term = self._store.term(word)
            if term is None:
                continue
            lexical[term.ids] += weight * term.rarity * term.weights
            vector += weight * term.rarity * term.vector
            total += (weight * term.rarity) ** 2
        named = [i for word in _names(text) for i in self._store.ids(word)]
        if total == 0.0 and not named:
            return []
        total = total or 1.0
        near = self._meaning @ (vector / max(float(np.linalg.norm(vector)), 1e-9))
        score = (lexical / np.sqrt(total) + _MEANING * np.maximum(near, 0.0)) * self._first
        score[named] += _EXACT * self._first[named] / self._depth[named]
        plain = {stem(word) for word in words(text)} | set(words(text))
        for i in np.argsort(-score)[: 8 * limit]:
            if self._parts[i]:
                score[i] *= 1.0 + _NAMED * len(self._parts[i] & plain) / len(self._parts[i])
        best = [int(i) for i in np.argsort(-score, kind="stable")[:limit] if score[i] > 0.0]
        return [Hit(entry, float(score[i])) for entry, i in zip(self._store.entries(best), best, strict=True)]


def _names(text: str) -> list[str]:
    """What of a text is a name as a program writes it: a single word, or one that no sentence has."""
    parts = text.split()
    return [p.rpartition(".")[2] for p in parts if len(parts) == 1 or "_" in p or p[1:] != p[1:].lower()]


def _weighted(text: str) -> dict[str, float]:
    asked = dict.fromkeys(words(text), 1.0)
    for word in list(asked):
        for other in related(word):
            asked[other] = max(asked.get(other, 0.0), _RELATED)
    return asked


def _public(name: str) -> bool:
    """Whether a name of wsim's is one that programs import or call."""
    if name.startswith("wsim.program."):
        return name.startswith("wsim.program.control_world.Control") and "Layout" not in name
    if name.startswith("wsim.scene."):
        return name.removeprefix("wsim.scene.")[:1].isupper()
    return name in ("wsim.scene", "wsim.run", "wsim.assets.search", "wsim.assets.get")
