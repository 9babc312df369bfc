"""The search's numbers: TF-IDF weights of words, and vectors of meaning from latent semantic analysis.

Deerwester et al. 1990, "Indexing by latent semantic analysis": words that occur in the same docstrings get vectors
that point the same way, so that a text is found by words that it does not use.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.linalg import svds

from wsim.program.api.entry import Entry
from wsim.program.api.words import words

Floats = NDArray[np.float32]
DIMENSIONS = 64
_NAME, _SUMMARY, _REST = 3.0, 2.0, 1.0  # what a word counts by where it stands
_DOC = 1200  # characters of a docstring that are read


@dataclass(frozen=True)
class Term:
    """One word: the entries that it occurs in, with its weight in each, how rare it is, and its vector of meaning."""

    ids: NDArray[np.int32]
    weights: Floats
    rarity: float
    vector: Floats


def build(entries: Sequence[Entry]) -> tuple[dict[str, Term], Floats]:
    """Terms by word, and the entries' vectors of meaning, (entries, DIMENSIONS), of length 1."""
    counts = [_counts(entry) for entry in entries]
    documents = Counter(word for count in counts for word in count)
    vocabulary = {word: i for i, word in enumerate(sorted(documents))}
    rarity = np.log((1 + len(entries)) / (1 + np.array([documents[word] for word in vocabulary], dtype=float)))
    rows = np.repeat(np.arange(len(counts)), [len(count) for count in counts])
    columns = np.array([vocabulary[word] for count in counts for word in count])
    values = (1.0 + np.log([weight for count in counts for weight in count.values()])) * rarity[columns]
    lengths = np.sqrt(np.bincount(rows, values**2, len(counts)))
    matrix = csr_array((values / np.maximum(lengths[rows], 1e-9), (rows, columns)), (len(counts), len(vocabulary)))

    rank = min(DIMENSIONS, min(matrix.shape) - 1)
    start = np.random.default_rng(0).normal(size=min(matrix.shape))  # so that every build gives the same
    left, strength, right = svds(matrix, k=rank, v0=start)
    meaning = _unit(np.pad(left * strength, ((0, 0), (0, DIMENSIONS - rank))))
    of_words = np.pad(right.T, ((0, 0), (0, DIMENSIONS - rank))).astype(np.float32)
    by_word = matrix.tocsc()
    terms = {}
    for word, i in vocabulary.items():
        part = slice(by_word.indptr[i], by_word.indptr[i + 1])
        terms[word] = Term(
            by_word.indices[part].astype(np.int32), by_word.data[part].astype(np.float32), rarity[i], of_words[i]
        )
    return terms, meaning


def _counts(entry: Entry) -> Counter[str]:
    """The words of an entry and what they count."""
    found: Counter[str] = Counter()
    extra = " ".join(parameter.name for parameter in entry.parameters) if entry.source == "wsim" else ""
    texts = ((_NAME, entry.short), (_REST, entry.parent.rpartition(".")[2]), (_SUMMARY, entry.summary))
    for weight, text in (*texts, (_REST, entry.doc[:_DOC]), (_REST, extra)):
        for word in words(text):
            found[word] += weight  # type: ignore[assignment]
    return found


def _unit(vectors: NDArray[np.float64]) -> Floats:
    return (vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-9)).astype(np.float32)
