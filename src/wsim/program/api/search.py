"""Search a store by words, those of the same meaning, and names as programs write them."""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from wsim.program.api.entry import Entry
from wsim.program.api.store import Store
from wsim.program.api.vocabulary import vocabulary

_NAMED = 0.25  # a name made of the words asked for
_EXACT = 60.0  # a name that is asked for as it is written
_TAKES = 2 * _EXACT  # one that a call of the scene takes: it is what sets it
_CALLS = "wsim.scene.Scene."
# What a program reaches for first. A word's rarity says nothing of that.
_FIRST = {"wsim": 1.6, "schema": 0.95, "pxr": 0.9, "numpy": 0.95, "python": 0.8, "newton": 0.6, "warp": 0.6}
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
        self._names = store.names()
        self._takers = _takers(store, self._names)
        self._first = [
            _FIRST.get(source, 0.8) * _KIND.get(kind, 1.0) * (0.4 if _inner(name) or self._told(name, kind) else 1.0)
            for name, (source, kind) in zip(self._names, store.sorts(), strict=True)
        ]

    def search(self, text: str, meant: Iterable[Mapping[str, float]], limit: int) -> list[Hit]:
        """The entries that fit best, best first.

        Args:
            text: What is asked for.
            meant: Of each of its words, the stems that it may mean and what they count.
            limit: Most entries to return.
        """
        found: dict[int, float] = {}
        for either in meant:
            for i, score in self._store.ranking.scores(either).items():
                found[i] = found.get(i, 0.0) + score * self._first[i]
        for i in {i for name in _names(text) for i in self._store.ids(name)}:
            found[i] = found.get(i, 0.0) + _EXACT * self._first[i] / (1 + self._names[i].count("."))
        for name in _names(text):
            for i, arguments in self._takers.get(name, {}).items():  # the less a call takes besides, the likelier it is
                found[i] = found.get(i, 0.0) + _TAKES * self._first[i] / arguments
        said = set(vocabulary().stems(text))
        for i in _best(found, 8 * limit):
            parts = set(vocabulary().stems(self._names[i].rpartition(".")[2]))
            if parts:
                found[i] *= 1.0 + _NAMED * len(parts & said) / len(parts)
        best = _best(found, limit)
        return [Hit(entry, found[i]) for entry, i in zip(self._store.entries(best), best, strict=True)]

    def _told(self, name: str, kind: str) -> bool:
        """Whether a field only tells what a call of the scene was given: that call is what sets it."""
        return kind == "attribute" and name.startswith("wsim.scene.") and name.rpartition(".")[2] in self._takers


def _takers(store: Store, names: list[str]) -> dict[str, dict[int, int]]:
    """The calls of the scene that take an argument of a name, and how many arguments each has."""
    calls = [i for i, name in enumerate(names) if name.startswith(_CALLS)]
    found: dict[str, dict[int, int]] = {}
    for i, entry in zip(calls, store.entries(calls), strict=True):
        for parameter in entry.parameters:
            found.setdefault(parameter.name, {})[i] = len(entry.parameters)
    return found


def _inner(name: str) -> bool:
    """Whether a name of wsim's is none that programs import or call, but what a module keeps for itself."""
    if name.startswith("wsim.program."):
        return not name.startswith("wsim.program.control_world.Control") or "Layout" in name
    if name.startswith("wsim.scene."):
        if name.startswith("wsim.scene.VehicleSpec."):  # what follows from it; its numbers are its arguments
            return True
        return not name.removeprefix("wsim.scene.")[:1].isupper()
    return name.startswith("wsim.") and name not in ("wsim.scene", "wsim.run", "wsim.assets.search", "wsim.assets.get")


def _names(text: str) -> set[str]:
    """What of a text is a name as a program writes it: a single word, or one that no sentence has."""
    parts = text.split()
    named = {p.rpartition(".")[2] for p in parts if len(parts) == 1 or "_" in p or p[1:] != p[1:].lower()}
    return named | {name.replace("_", "") for name in named}


def _best(found: Mapping[int, float], limit: int) -> list[int]:
    return heapq.nsmallest(limit, found, key=lambda i: (-found[i], i))
