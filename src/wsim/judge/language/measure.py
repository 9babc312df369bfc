"""What a predicate says of each frame: a value held against a limit, in a unit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.language.signals import Signals
    from wsim.judge.verdict import Finding, RepairTarget
    from wsim.plan.schema.formula import Predicate

    Floats = NDArray[np.float64]


@dataclass(eq=False)
class Measure:
    """One number at each frame of each world, and what it is held against.

    Arrays are (W, T), or broadcast to it. `scale` is what one unit of the number is worth beside others: margins of
    different units are compared as shares of their scales. `band` is both limits of what has two. `note` is what a
    finding says besides, where it fails; `single` is, of means, the measure that they are of, `last` their last frame.
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
    band: tuple[Floats | float, Floats | float] | None = None
    note: str = ""
    single: Measure | None = None
    last: int = -1

    @classmethod
    def about(cls, value: Floats, expected: Floats | float, tolerance: Floats | float, **rest: Any) -> Measure:
        """A number that is to be within a tolerance of another."""
        return cls.between(value, (expected - tolerance, expected + tolerance), expected, scale=tolerance, **rest)

    @classmethod
    def between(
        cls, value: Floats, band: tuple[Floats | float, Floats | float], expected: Floats | float, **rest: Any
    ) -> Measure:
        """A number between two limits; the one that counts is that of the side of what is expected on which it is."""
        above = np.asarray(value > expected)
        return cls(
            value=value, limit=np.where(above, band[1], band[0]), at_most=above, expected=expected, band=band, **rest
        )

    def averaged(self, shape: tuple[int, int], low: int, high: int) -> Measure:
        """The same of the mean number over the frames [low, high), (W, 1), against the mean of its limits."""
        frames = slice(low, high)

        def mean(numbers: Floats | float) -> Floats:
            return np.asarray(np.broadcast_to(numbers, shape)[:, frames].mean(axis=1, keepdims=True))

        same: dict[str, Any] = {
            "what": f"mean {self.what}", "prim": self.prim, "unit": self.unit, "limit_from": self.limit_from,
            "note": self.note, "single": self, "last": high - 1, "scale": mean(self.scale),
        }  # fmt: skip
        expected = None if self.expected is None else mean(self.expected)
        if self.band is not None and expected is not None:
            return self.between(mean(self.value), (mean(self.band[0]), mean(self.band[1])), expected, **same)
        at_most = np.broadcast_to(self.at_most, shape)[:, high - 1 : high]
        return Measure(value=mean(self.value), limit=mean(self.limit), at_most=at_most, expected=expected, **same)

    @property
    def margin(self) -> Floats:
        """Distance to the limit (W, T), positive = satisfied; NaN where it is not finite."""
        room = np.where(self.at_most, self.limit - self.value, self.value - self.limit)
        return np.where(np.isfinite(room), room, np.nan)


Measurer = Callable[[Any, "Signals"], list[Measure]]
MEASURERS: dict[type[Predicate], Measurer] = {}


Mender = Callable[[Any, "Finding", "Evidence"], "RepairTarget"]
MENDERS: dict[type[Predicate], Mender] = {}


def mends(*kinds: type[Predicate]) -> Callable[[Mender], Mender]:
    """Register what is to be changed where a predicate fails: a rule of it, of a finding about it and the evidence."""

    def register(mender: Mender) -> Mender:
        MENDERS.update(dict.fromkeys(kinds, mender))
        return mender

    return register


def measures(kind: type[Predicate]) -> Callable[[Measurer], Measurer]:
    """Register how a predicate is measured. All measures of a predicate must keep to their limits."""

    def register(measurer: Measurer) -> Measurer:
        MEASURERS[kind] = measurer
        return measurer

    return register
