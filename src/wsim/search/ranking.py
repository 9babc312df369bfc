"""Documents ranked by the words that they share with a query: SQLite's full-text index FTS5, and its BM25.

Robertson and Zaragoza, The probabilistic relevance framework: BM25 and beyond, 2009: a word counts by how few documents
have it, by how often this one has it, with less for each time, and by how short the document is. What stands in a
column counts by the column's weight.
"""

from __future__ import annotations

import math
import sqlite3
from collections.abc import Iterable, Mapping, Sequence

from wsim.search.vocabulary import Vocabulary
from wsim.search.words import alike

SLIP = 0.5  # what a word counts that is nearly the one that was said

Documents = Iterable[tuple[int, Sequence[Sequence[str]]]]  # the number of each, and its words, column by column


class Ranking:
    """Documents of stemmed words, in a data base that may hold more.

    Args:
        base: Has the tables that `create` made.
        weights: What a word counts in each column.
    """

    def __init__(self, base: sqlite3.Connection, weights: Mapping[str, float]) -> None:
        self._base = base
        self._query = (
            f"SELECT rowid, -bm25(ranked, {', '.join(str(float(w)) for w in weights.values())}) "
            "FROM ranked WHERE ranked MATCH ?"
        )

    @classmethod
    def create(cls, base: sqlite3.Connection, weights: Mapping[str, float], documents: Documents) -> Ranking:
        """Write documents into new tables of a data base."""
        # Of a table without positions (detail=column) bm25 gives zeros.
        base.execute(f"CREATE VIRTUAL TABLE ranked USING fts5({', '.join(weights)}, content='', tokenize='ascii')")
        base.execute("CREATE VIRTUAL TABLE ranked_words USING fts5vocab(ranked, row)")
        base.executemany(
            f"INSERT INTO ranked (rowid, {', '.join(weights)}) VALUES (?{', ?' * len(weights)})",
            ((number, *(" ".join(words) for words in columns)) for number, columns in documents),
        )
        return cls(base, weights)

    def having(self, word: str) -> dict[int, float]:
        """The documents that have a stem, and what it counts in each."""
        return dict(self._base.execute(self._query, (f'"{word}"',)))

    def scores(self, either: Mapping[str, float]) -> dict[int, float]:
        """The documents that have any of some stems of one meaning, and what these count there together.

        That is the root of the sum of their squares: a document that says a thing in three words counts more than one
        that says it in one, but not three times as much, as three things that were asked for do.

        Args:
            either: What each stem counts, as `meant` gives it.
        """
        found: dict[int, float] = {}
        for word, weight in either.items():
            for number, score in self.having(word).items():
                found[number] = math.hypot(found.get(number, 0.0), weight * score)
        return found

    def knows(self, word: str) -> bool:
        """Whether any document has a stem."""
        return self._base.execute("SELECT 1 FROM ranked_words WHERE term = ?", (word,)).fetchone() is not None

    def near(self, word: str) -> str:
        """The stem that one which no document has may be a slip for; "" if there is none.

        Both start with one letter: that one is seldom wrong, and it spares the comparison with all others.
        """
        near = self._base.execute(
            "SELECT term FROM ranked_words WHERE term >= ? AND term < ? AND abs(length(term) - ?) <= 2 ORDER BY term",
            (word[:1], chr(ord(word[0]) + 1), len(word)),
        )
        best = max((row[0] for row in near), key=lambda term: alike(word, term), default="")
        return best if alike(word, best) else ""


def meant(word: str, vocabulary: Vocabulary, *rankings: Ranking) -> dict[str, float]:
    """The stems that one of a query may mean, and what each counts: itself, and those of its meaning.

    One that neither the vocabulary nor any document has may be a slip for one that the first ranking has.
    """
    if vocabulary.knows(word) or any(ranking.knows(word) for ranking in rankings):
        return vocabulary.widened(word)
    near = rankings[0].near(word)
    return vocabulary.widened(near, SLIP) if near else {}
