"""What a validation case is, and what running it gives."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Value:
    """What was measured beside what is known, and the range that counts as the same.

    The range is an experiment's spread, or what theory and a case's set-up leave open; the case says which.
    """

    measured: float
    reference: float
    low: float
    high: float
    unit: str

    @classmethod
    def within(cls, measured: float, reference: float, percent: float, unit: str) -> Value:
        """A value that may be off by so many percent of the reference."""
        room = 0.01 * percent * abs(reference)
        return cls(measured, reference, reference - room, reference + room, unit)

    @property
    def percent(self) -> float:
        """How far off it is [% of the reference]."""
        return 100.0 * abs(self.measured / self.reference - 1.0)

    @property
    def spreads(self) -> float:
        """How far off it is, over the range to that side: 1 is at its end."""
        off = self.measured - self.reference
        return abs(off) / ((self.high - self.reference) if off > 0.0 else (self.reference - self.low))

    def __str__(self) -> str:
        """Measured / reference / tolerance."""
        return f"{self.measured:.4g} / {self.reference:.4g} / {self.low:.4g} to {self.high:.4g} {self.unit}"


@dataclass
class Measured:
    """One run of a case at one spacing.

    `errors` holds a value for every key of the case's `reach`, in the same unit; `figures` are numbers worth a place
    in the table beside them; `curves` are lines for the plot, label -> (x, y), where a label that begins with
    "reference" is drawn in black. `values` has, for those errors that come of one number, that number.
    """

    errors: dict[str, float]
    figures: dict[str, float] = field(default_factory=dict)
    curves: dict[str, tuple[np.ndarray, np.ndarray]] = field(default_factory=dict)
    particles: int = 0
    simulated_seconds: float = 0.0
    wall_seconds: float = 0.0
    values: dict[str, Value] = field(default_factory=dict)


@dataclass(frozen=True)
class Case:
    """A flow with a known answer.

    `reach[key]` is the largest error that counts as reached, `unit[key]` what it is measured in ("%", "J", …).
    `coarse` and `fine` are spacings [m], coarsest first; at least two each, so that convergence shows. `run` takes the
    Warp device's name and a spacing.
    """

    name: str
    title: str
    reference: str
    reach: dict[str, float]
    unit: dict[str, str]
    coarse: tuple[float, ...]
    fine: tuple[float, ...]
    run: Callable[[str, float], Measured]
    axes: tuple[str, str] = ("", "")
