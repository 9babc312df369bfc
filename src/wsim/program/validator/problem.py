"""What is wrong with a program, where, and what may be meant."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from difflib import get_close_matches


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong with a program.

    Attributes:
        line: From 1.
        column: From 1.
        code: What kind of thing: "syntax", "import", "name", "attribute", "argument", "value", "unit", "deprecated",
            "order", "prim", "plan", "build", "control".
        message: What is wrong.
        nearest: The right entry with its signature, or what to write; "" where there is none.
    """

    line: int
    column: int
    code: str
    message: str
    nearest: str = ""

    @property
    def sentence(self) -> str:
        """One line for a person or a model."""
        end = f"; nearest: {self.nearest}" if self.nearest else ""
        return f"line {self.line}, column {self.column}: {self.message}{end} [{self.code}]"


class Problems:
    """The problems found so far: one for each place and kind, since a loop's body is read many times."""

    def __init__(self) -> None:
        self._found: dict[tuple[int, int, str], Problem] = {}
        self._quiet = 0

    def add(self, node: ast.AST, code: str, message: str, nearest: str = "") -> None:
        """Note a problem at a node, unless what is read now is to be passed over."""
        if not self._quiet:
            line, column = getattr(node, "lineno", 1), getattr(node, "col_offset", 0) + 1
            self._found.setdefault((line, column, code), Problem(line, column, code, message, nearest))

    @contextmanager
    def quiet(self) -> Iterator[None]:
        """Inside, nothing is noted: the program itself expects that something may be missing."""
        self._quiet += 1
        try:
            yield
        finally:
            self._quiet -= 1

    def sorted(self) -> list[Problem]:
        """All of them, in the order of the program."""
        return sorted(self._found.values(), key=lambda p: (p.line, p.column, p.code))


def spelt(name: str, known: Iterable[str], cutoff: float = 0.6) -> str:
    """The one of some names that is spelt most like a wrong one, in quotes; "" if none is near."""
    close = get_close_matches(name, list(known), n=1, cutoff=cutoff)
    return f'"{close[0]}"' if close else ""
