"""What candidates differ in: a parameter of the program, and the values that it may take."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from wsim.errors import UserError

if TYPE_CHECKING:
    from numpy.typing import NDArray

FORMS = "NAME=LOW:HIGH, NAME=log:LOW:HIGH or NAME=A,B,C"


class Axis(BaseModel):
    """One parameter and its range, or its values.

    Attributes:
        name: Of a `scene.param`.
        low: Least value.
        high: Greatest value.
        scale: How values are spread between them: evenly, or evenly in their logarithm.
        start: Where a search begins; None: in the middle.
        values: The only values that it takes, if there are any; `low` and `high` are then theirs.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str
    low: float = Field(allow_inf_nan=False)
    high: float = Field(allow_inf_nan=False)
    scale: Literal["linear", "log"] = "linear"
    start: float | None = Field(default=None, allow_inf_nan=False)
    values: tuple[float, ...] = ()

    @model_validator(mode="after")
    def _is_a_range(self) -> Axis:
        if not self.values and not self.low < self.high:
            raise ValueError(f"{self.name}: low {self.low:g} is not below high {self.high:g}")
        if self.scale == "log" and self.low <= 0.0:
            raise ValueError(f"{self.name}: low {self.low:g} has no logarithm; it must be above 0")
        return self

    @classmethod
    def parse(cls, text: str) -> Axis:
        """What `--vary` says: "wood_density=300:900", "stiffness=log:1:1000", "count=1,2,5".

        Raises:
            UserError: Naming what was given and what is understood.
        """
        name, equals, rest = text.partition("=")
        scale: Literal["linear", "log"] = "log" if rest.startswith("log:") else "linear"
        bounds, listed = rest.removeprefix("log:").split(":"), rest.split(",")
        try:
            if not equals or not name.isidentifier():
                raise ValueError("no name")
            if len(bounds) == 2:
                return cls(name=name, low=_number(bounds[0]), high=_number(bounds[1]), scale=scale)
            values = tuple(map(_number, listed))
            return cls(name=name, low=min(values), high=max(values), values=values)
        except ValueError as error:
            why = [str(each["ctx"]["error"]) for each in getattr(error, "errors", list)() if "ctx" in each]
            raise UserError(f"--vary {text}: {why[0] if why else f'expected {FORMS}'}") from error

    def at(self, share: NDArray[np.float64]) -> NDArray[np.float64]:
        """The values at shares in [0, 1) of the range; of a list, each value has an equal part."""
        if self.values:
            return np.asarray(self.values)[np.minimum((share * len(self.values)).astype(int), len(self.values) - 1)]
        if self.scale == "log":
            return np.exp(math.log(self.low) + share * math.log(self.high / self.low))
        return self.low + share * (self.high - self.low)

    def share(self, value: float) -> float:
        """Where a value is in the range, in [0, 1]: the inverse of `at`, or the middle of the nearest value's part."""
        if self.values:
            nearest = int(np.abs(np.asarray(self.values) - value).argmin())
            return (nearest + 0.5) / len(self.values)
        low, high, at = self.low, self.high, min(max(value, self.low), self.high)
        if self.scale == "log":
            low, high, at = math.log(low), math.log(high), math.log(at)
        return (at - low) / (high - low)

    def spread(self, count: int) -> NDArray[np.float64]:
        """Values from end to end: those of the list, or `count` of the range."""
        if self.values:
            return np.asarray(self.values)
        ends = np.linspace(0.0, 1.0, count) if count > 1 else np.array([0.5])
        return self.at(ends)


def _number(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text} is not finite")
    return value
