"""What happens by time or after an event, in a plan."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from wsim import quantities
from wsim.limits import MAX_DURATION, MAX_KEYS
from wsim.plan.schema.base import Name, NotNegative, Number, Sparse, Strict, Vec3

Value = Annotated[float, Field(ge=-quantities.MAX_EFFORT, le=quantities.MAX_EFFORT, allow_inf_nan=False)]
Pair = tuple[Name, Name]


class EventPlan(Sparse):
    """What a schedule's times count from: the first moment at which it is so; one of the five."""

    touch: Pair | None = None  # two objects
    body: Name | None = None  # its origin, along the axis [m]
    joint: Name | None = None  # [deg] or [m]
    start: Name | None = None  # of a schedule: its first key
    end: Name | None = None  # its last key
    axis: Literal["X", "Y", "Z"] | None = None
    above: Number | None = None
    below: Number | None = None
    delay: NotNegative | None = None  # [s]

    @property
    def kind(self) -> str:
        """Which of the five."""
        return next(name for name in _EVENTS if getattr(self, name) is not None)

    @model_validator(mode="after")
    def _one(self) -> EventPlan:
        kinds = [name for name in _EVENTS if getattr(self, name) is not None]
        if len(kinds) != 1:
            raise ValueError(f"an event is one of {', '.join(_EVENTS)}; this has {' and '.join(kinds) or 'none'}")
        bounds = [name for name in ("above", "below") if getattr(self, name) is not None]
        if len(bounds) != (kinds[0] in ("body", "joint")):
            raise ValueError('"above" or "below", one of them, goes with "body" and "joint", and with no other event')
        if (self.axis is not None) != (kinds[0] == "body"):
            raise ValueError('"axis" ("X", "Y" or "Z") goes with "body", which needs it')
        return self


_EVENTS = ("touch", "body", "joint", "start", "end")


class SchedulePlan(Strict):
    """A quantity of a joint, an object or a pair by time; until its first key it is as stated elsewhere."""

    name: Name
    of: Name | Pair
    quantity: quantities.Name
    times: tuple[NotNegative, ...] = Field(min_length=1, max_length=MAX_KEYS)  # [s], rising
    values: tuple[Value | tuple[Value, Value, Value], ...] = Field((), max_length=MAX_KEYS)  # one for each of times
    linear: bool | None = None  # straight from key to key; left out: of a position alone
    point: Vec3 | None = None  # where a force acts, in the body's frame [m]
    after: EventPlan | None = None  # what the times count from

    @model_serializer(mode="wrap")
    def _written(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Without what it does not say."""
        return {name: value for name, value in write(self).items() if value is not None and value != ()}

    @model_validator(mode="after")
    def _keys(self) -> SchedulePlan:
        count = 0 if self.quantity == "release" else len(self.times)
        if any(later <= one for one, later in pairwise(self.times)) or self.times[-1] > MAX_DURATION:
            raise ValueError(f"times {list(self.times)} must rise, to {MAX_DURATION:g} s at most")
        if len(self.values) != count:
            takes = "a release takes none" if not count else f"give one for each of {count} times"
            raise ValueError(f"values has {len(self.values)} entries; {takes}")
        if self.quantity == "release" and len(self.times) > 1:
            raise ValueError("a release is at one time; it lets go for good")
        if self.point is not None and self.quantity != "force":
            raise ValueError(f'"point" is where a "force" acts; this is a {self.quantity!r}')
        return self
