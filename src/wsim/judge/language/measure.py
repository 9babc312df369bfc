"""What a predicate says of each frame: a value held against a limit, in a unit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.language.signals import Signals
    from wsim.plan.schema.formula import Predicate

    Floats = NDArray[np.float64]


@dataclass(eq=False)
class Measure:
    """One number at each frame of each world, and what it is held against.

    Arrays are (W, T), or broadcast to it. `scale` is what one unit of the number is worth beside others: margins of
    different units are compared as shares of their scales.
    """

    what: str  # of what the number is: "tilt"
    prim: str
    value: Floats
    limit: Floats | float
    unit: str
    scale: Floats | float
    limit_from: str
    at_most: NDArray[np.bool_] | bool = True
    expected: Floats | float | None = None

    @classmethod
    def about(cls, value: Floats, expected: Floats | float, tolerance: Floats | float, **rest: Any) -> Measure:
        """A number that is to be within a tolerance of another; the limit is that of the side on which it is."""
        above = np.asarray(value > expected)
        limit = np.where(above, expected + tolerance, expected - tolerance)
        return cls(value=value, limit=limit, at_most=above, expected=expected, scale=tolerance, **rest)

    @property
    def margin(self) -> Floats:
        """Distance to the limit (W, T), positive = satisfied; NaN where it is not finite."""
        room = np.where(self.at_most, self.limit - self.value, self.value - self.limit)
        return np.where(np.isfinite(room), room, np.nan)


Measurer = Callable[[Any, "Signals"], list[Measure]]
MEASURERS: dict[type[Predicate], Measurer] = {}


def measures(kind: type[Predicate]) -> Callable[[Measurer], Measurer]:
    """Register how a predicate is measured. All measures of a predicate must keep to their limits."""

    def register(measurer: Measurer) -> Measurer:
        MEASURERS[kind] = measurer
        return measurer

    return register
