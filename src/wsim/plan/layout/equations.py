"""Linear equations between coordinates, kept solved, with the rows that each coordinate comes from.

Every coordinate that an equation settles is written as a sum of coordinates that none settles. When an equation says
what others rule out, the rows in conflict are exactly those whose equations add up to the contradiction.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wsim.plan.layout.rows import Row

Var = tuple[int, str]  # the axis, 0 for X and 1 for Y, and the body whose centre it is
SAME = 5e-4  # equations that differ by less say the same: plans are written to the millimetre [m]
ZERO = 1e-9


@dataclass
class Sum:
    """Coordinates with factors, plus a constant [m], and the rows that it was made with."""

    terms: dict[Var, float] = field(default_factory=dict)
    const: float = 0.0
    why: dict[tuple[Row, int], float] = field(default_factory=dict)

    def add(self, other: Sum, factor: float) -> None:
        """Add a multiple of another sum."""
        for key, value in other.terms.items():
            _collect(self.terms, key, factor * value)
        for why, value in other.why.items():
            _collect(self.why, why, factor * value)
        self.const += factor * other.const


def _collect(into: dict, key: object, value: float) -> None:
    total = into.get(key, 0.0) + value
    if abs(total) < ZERO:
        into.pop(key, None)
    else:
        into[key] = total


class Conflict(Exception):  # noqa: N818 - what it is, between two modules
    """Rows that cannot hold together."""

    def __init__(self, rows: list[Row], off: float) -> None:
        self.rows = rows
        self.off = off
        super().__init__(rows)


class System:
    """The equations so far."""

    def __init__(self) -> None:
        self.solved: dict[Var, Sum] = {}
        self._users: dict[Var, set[Var]] = {}

    def copy(self) -> System:
        """One that can be added to without changing this one; it does not know the rows any more."""
        other = System()
        other.solved = {var: Sum(dict(s.terms), s.const) for var, s in self.solved.items()}
        other._users = {var: set(users) for var, users in self._users.items()}
        return other

    def value(self, var: Var) -> Sum:
        """A coordinate as a sum of free ones."""
        return self.solved[var] if var in self.solved else Sum({var: 1.0})

    def reduce(self, terms: dict[Var, float]) -> Sum:
        """A sum of coordinates as a sum of free ones."""
        total = Sum()
        for var, factor in terms.items():
            total.add(self.value(var), factor)
        return total

    def add(self, terms: dict[Var, float], const: float, row: Row | None) -> None:
        """State that the terms add up to `const`.

        Raises:
            Conflict: they cannot.
        """
        left = self.reduce(terms)
        if row is not None:
            _collect(left.why, (row, next(iter(terms))[0]), 1.0)
        left.const -= const  # the terms and this add up to zero
        if not left.terms:
            if abs(left.const) > SAME:
                rows = list(dict.fromkeys(row for row, _ in left.why))
                raise Conflict(rows, left.const)
            return
        # The coordinate on which the fewest depend is the cheapest to replace; the later one, so that the result does
        # not hang on the order in which Python hashes.
        pivot = min(left.terms, key=lambda var: (-round(abs(left.terms[var]), 9), len(self._users.get(var, ()))))
        factor = left.terms.pop(pivot)
        settled = Sum()
        settled.add(left, -1.0 / factor)
        self._settle(pivot, settled)

    def _settle(self, pivot: Var, settled: Sum) -> None:
        for user in self._users.pop(pivot, set()):
            old = self.solved[user]
            factor = old.terms.pop(pivot)
            old.add(settled, factor)
            for var in settled.terms:
                if var in old.terms:
                    self._users.setdefault(var, set()).add(user)
                else:
                    self._users.get(var, set()).discard(user)
        self.solved[pivot] = settled
        for var in settled.terms:
            self._users.setdefault(var, set()).add(pivot)
