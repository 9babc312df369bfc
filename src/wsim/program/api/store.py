"""The index in one file: an SQLite data base that is read a row at a time, so that opening it costs nothing."""

from __future__ import annotations

import contextlib
import json
import os
import sqlite3
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from pathlib import Path

from wsim.program.api.entry import Entry
from wsim.program.api.vocabulary import vocabulary
from wsim.search.ranking import Ranking

_TABLES = """
CREATE TABLE entries (id INTEGER PRIMARY KEY, name TEXT UNIQUE, parent TEXT, short TEXT, source TEXT, kind TEXT,
    data TEXT);
"""
_INDEXES = "CREATE INDEX by_parent ON entries (parent); CREATE INDEX by_short ON entries (short);"
# What a word counts by where it stands.
_WEIGHTS = {"short": 6.0, "parent": 3.0, "summary": 4.0, "doc": 1.0, "parameters": 3.0}
_DOC = 1200  # characters of a docstring that are read


class Store:
    """Entries, and what the search needs, in a data base."""

    def __init__(self, connection: sqlite3.Connection) -> None:
        self._base = connection
        self.ranking = Ranking(connection, _WEIGHTS)
        self.find = lru_cache(maxsize=None)(self._find)
        self.children = lru_cache(maxsize=None)(self._children)

    @classmethod
    def of(cls, entries: Iterable[Entry]) -> Store:
        """A store in memory; of two entries with one name the first counts."""
        kept = list({entry.name: entry for entry in reversed(list(entries))}.values())[::-1]
        base = sqlite3.connect(":memory:", check_same_thread=False)
        base.executescript(_TABLES)
        base.executemany(
            "INSERT INTO entries VALUES (?, ?, ?, ?, ?, ?, ?)",
            (
                (i, e.name, e.parent, e.short.lower(), e.source, e.kind, json.dumps(e.as_data(), separators=(",", ":")))
                for i, e in enumerate(kept)
            ),
        )
        Ranking.create(base, _WEIGHTS, ((i, list(_columns(entry))) for i, entry in enumerate(kept)))
        base.executescript(_INDEXES)
        base.commit()
        return cls(base)

    @classmethod
    def open(cls, file: Path) -> Store | None:
        """The store in a file; None if there is none, or it is not whole."""
        if not file.is_file():
            return None
        try:
            base = sqlite3.connect(f"{file.absolute().as_uri()}?mode=ro&immutable=1", uri=True, check_same_thread=False)
            base.execute("SELECT 1 FROM ranked_words LIMIT 1").fetchone()
        except sqlite3.Error:
            return None
        return cls(base)

    def save(self, file: Path) -> bool:
        """Write the store, whole or not at all; False where the folder cannot be written."""
        side = None
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
            handle, side = tempfile.mkstemp(prefix=f".{file.name}.", dir=file.parent)
            os.close(handle)
            with contextlib.closing(sqlite3.connect(side)) as target:
                self._base.backup(target)
            Path(side).replace(file)
        except (OSError, sqlite3.Error):
            if side is not None:
                Path(side).unlink(missing_ok=True)
            return False
        return True

    def entries(self, ids: Sequence[int]) -> list[Entry]:
        """Entries by number, in the order asked for."""
        marks = ",".join("?" * len(ids))
        rows = self._base.execute(f"SELECT id, data FROM entries WHERE id IN ({marks})", [int(i) for i in ids])
        found = {number: Entry.from_data(json.loads(data)) for number, data in rows}
        return [found[int(i)] for i in ids]

    def _find(self, name: str) -> Entry | None:
        row = self._base.execute("SELECT data FROM entries WHERE name = ?", (name,)).fetchone()
        return Entry.from_data(json.loads(row[0])) if row else None

    def _children(self, parent: str) -> frozenset[str]:
        """The last parts of the names below a name."""
        rows = self._base.execute("SELECT substr(name, length(parent) + 2) FROM entries WHERE parent = ?", (parent,))
        return frozenset(row[0] for row in rows)

    def ending(self, last: str) -> list[str]:
        """Whole names whose last part is this one, whatever its case."""
        rows = self._base.execute("SELECT name FROM entries WHERE short = ? ORDER BY id", (last.lower(),))
        return [row[0] for row in rows]

    def shorts(self) -> list[str]:
        """The last parts of all names."""
        return [row[0] for row in self._base.execute("SELECT DISTINCT short FROM entries")]

    def ids(self, last: str) -> list[int]:
        """Numbers of the entries whose last part is this one, whatever its case."""
        return [row[0] for row in self._base.execute("SELECT id FROM entries WHERE short = ?", (last.lower(),))]

    def modules(self) -> list[str]:
        """Names of the modules."""
        return [row[0] for row in self._base.execute("SELECT name FROM entries WHERE kind = 'module'")]

    def schemas(self) -> list[str]:
        """Names of the USD schemas."""
        return [row[0] for row in self._base.execute("SELECT name FROM entries WHERE kind = 'schema'")]

    def schema_attributes(self) -> list[str]:
        """Names of the attributes of all schemas, without the schemas'; * stands for the name of an instance."""
        rows = self._base.execute(
            "SELECT substr(name, length(parent) + 2) FROM entries WHERE kind = 'schema attribute'"
        )
        return sorted({row[0] for row in rows})

    def sorts(self) -> list[tuple[str, str]]:
        """Source and kind of each entry, by number."""
        return [(row[0], row[1]) for row in self._base.execute("SELECT source, kind FROM entries ORDER BY id")]

    def names(self) -> list[str]:
        """The whole name of each entry, by number."""
        return [row[0] for row in self._base.execute("SELECT name FROM entries ORDER BY id")]


def _columns(entry: Entry) -> Iterator[list[str]]:
    """The stems of an entry's name, of what it is in, of its docstring and of its parameters."""
    own = " ".join(parameter.name for parameter in entry.parameters) if entry.source == "wsim" else ""
    for text in (entry.short, entry.parent.rpartition(".")[2], entry.summary, entry.doc[:_DOC], own):
        yield vocabulary().stems(text)
