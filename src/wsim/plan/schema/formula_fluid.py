"""Bodies and fluid: predicates of the language of objectives."""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import model_validator

from wsim.plan.schema.base import NotNegative, Number, Positive
from wsim.plan.schema.predicate import Named, Predicate, ordered_range, quantity


class Floats(Predicate):
    """The object's draft is that of Archimedes, for its own shape and mass."""

    op: Literal["floats"] = "floats"
    alone: ClassVar[Literal["finally"]] = "finally"
    object: Named
    fluid: Named
    within: Positive | None = quantity("m", None)


class Sinks(Predicate):
    """The object is under the surface, and on the floor of the fluid's container."""

    op: Literal["sinks"] = "sinks"
    alone: ClassVar[Literal["finally"]] = "finally"
    object: Named
    fluid: Named
    within: Positive | None = quantity("m", None)


class Submerged(Predicate):
    """The object's highest point is below the surface."""

    op: Literal["submerged"] = "submerged"
    alone: ClassVar[Literal["finally"]] = "finally"
    object: Named
    fluid: Named
    within: NotNegative = quantity("m", 0.0)


class FillsTo(Predicate):
    """The fluid's surface stands at a height above the floor of its container."""

    op: Literal["fills_to"] = "fills_to"
    alone: ClassVar[Literal["finally"]] = "finally"
    fluid: Named
    level: Positive = quantity("m")
    within: Positive | None = quantity("m", None)


class Fills(Predicate):
    """At least a share of the fluid is in a vessel, below its rim."""

    op: Literal["fills"] = "fills"
    alone: ClassVar[Literal["finally"]] = "finally"
    fluid: Named
    ref: Named
    share: NotNegative = quantity("1", 0.9, le=1.0)


class LevelIn(Predicate):
    """What of the fluid is in a vessel stands there at a height above the vessel's floor."""

    op: Literal["level_in"] = "level_in"
    alone: ClassVar[Literal["finally"]] = "finally"
    fluid: Named
    ref: Named
    level: Positive = quantity("m")
    within: Positive | None = quantity("m", None)


class SwirlsBetween(Predicate):
    """The fluid turns as a whole about its middle, about an axis of the world, at a rate: a vortex."""

    op: Literal["swirls_between"] = "swirls_between"
    fluid: Named
    axis: Literal["x", "y", "z"]
    low: Number = quantity("deg/s")
    high: Number = quantity("deg/s")

    @model_validator(mode="after")
    def _range(self) -> SwirlsBetween:
        ordered_range(self.op, self.low, self.high)
        return self


PREDICATES: tuple[type[Predicate], ...] = (
    Floats, Sinks, Submerged, FillsTo, Fills, LevelIn, SwirlsBetween,
)  # fmt: skip
