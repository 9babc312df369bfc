"""What candidates differ in: a parameter of the program, and the values that it may take."""

from __future__ import annotations

import math
from collections.abc import Sequence
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
        along: Other parameters that go with it (`walked_together`): where it is at a share of its range, so are they.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str
    low: float = Field(allow_inf_nan=False)
    high: float = Field(allow_inf_nan=False)
    scale: Literal["linear", "log"] = "linear"
    start: float | None = Field(default=None, allow_inf_nan=False)
    values: tuple[float, ...] = ()
    along: tuple[Axis, ...] = Field(default=(), exclude_if=lambda along: not along)

    @model_validator(mode="after")
    def _is_a_range(self) -> Axis:
        if not self.values and not self.low < self.high:
            raise ValueError(f"{self.name}: low {self.low:g} is not below high {self.high:g}")
        if not math.isfinite(self.high - self.low):
            raise ValueError(f"{self.name}: from {self.low:g} to {self.high:g} is further than numbers go")
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

    @property
    def parameters(self) -> tuple[Axis, ...]:
        """It, and those that go with it."""
        return (self, *self.along)

    @property
    def label(self) -> str:
        """Its name, with those of the parameters that go with it."""
        return " & ".join(each.name for each in self.parameters)

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

    def shares(self, count: int) -> NDArray[np.float64]:
        """From end to end: one for each value of the list, or `count` of the range."""
        if self.values:
            return (np.arange(len(self.values)) + 0.5) / len(self.values)
        return np.linspace(0.0, 1.0, count) if count > 1 else np.array([0.5])


def walked_together(axes: Sequence[Axis], groups: Sequence[str]) -> list[Axis]:
    """Axes of which some go with others, rather than each with every value of each other.

    Lists are walked value by value, ranges from end to end; a range that goes with lists has as many values as they.

    Args:
        axes: They.
        groups: What each `--zip` says: names with commas between.

    Raises:
        UserError: If a group names one that is not varied or goes with others already, or lists differ in length.
    """
    known, found = {axis.name: axis for axis in axes}, {axis.name: axis for axis in axes}
    for group in groups:
        names = [name.strip() for name in group.split(",")]
        if len(set(names)) < 2 or len(set(names)) < len(names):
            raise UserError(f"--zip {group}: expected two parameters or more, each once, as --zip length,mass")
        if other := [name for name in names if name not in known]:
            raise UserError(f"--zip {group}: {other[0]!r} is not varied; what is: {', '.join(known)}")
        if again := [name for name in names if name not in found or found[name].along]:
            raise UserError(f"--zip {group}: {again[0]} goes with others already; name all of them in one --zip")
        lengths = {name: len(known[name].values) for name in names if known[name].values}
        if len(set(lengths.values())) > 1:
            said = ", ".join(f"{name} has {length}" for name, length in lengths.items())
            raise UserError(f"--zip {group}: lists are walked value by value, and {said}; give each as many")
        count = next(iter(lengths.values()), 0)
        lead, *along = [_listed(known[name], count) for name in names]
        found = {name: axis for name, axis in found.items() if name not in names[1:]}
        found[names[0]] = lead.model_copy(update={"along": tuple(along)})
    return list(found.values())


def _listed(axis: Axis, count: int) -> Axis:
    """A range as so many values from end to end; a list as it is, and every axis where there are to be none."""
    if axis.values or not count:
        return axis
    return axis.model_copy(update={"values": tuple(map(float, axis.at(axis.shares(count))))})


def _number(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text} is not finite")
    return value
