"""What every predicate of the language of objectives is made of: names, places and quantities with their units."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

from wsim.plan.schema.base import Number, Vec3
from wsim.plan.schema.nodes import Node

Named = Annotated[str, Field(pattern=r"^(/?[A-Za-z_][A-Za-z0-9_]*)(/[A-Za-z_][A-Za-z0-9_]*)*$", max_length=200)]
Place = Named | Vec3  # an object, or a point [m]


def quantity(unit: str, *default: float | None, **bounds: Any) -> Any:
    """A field that holds a number of a unit; required where no default is given."""
    return Field(*default, json_schema_extra={"unit": unit}, **bounds)


class Predicate(Node):
    """Something that a frame of a recording shows, with a margin. `alone` is how it is read outside of any time."""

    op: str
    alone: ClassVar[Literal["always", "eventually", "finally", "finally[0]", "now"]] = "always"
    NAMES: ClassVar[tuple[str, ...]] = ("object", "ref", "fluid", "target", "center", "on")

    def objects_named(self) -> set[str]:
        """The objects that it names."""
        return {name for field in self.NAMES if isinstance(name := getattr(self, field, None), str)}


def ordered_range(op: str, low: float, high: float) -> None:
    """ValueError where a range ends before it begins."""
    if high < low:
        raise ValueError(f"{op}: low {low:g} is above high {high:g}; swap them")


class Ranged(Predicate):
    """A number of the object, against another object if one is named, in a range; either end may be negative."""

    object: Named
    axis: Literal["x", "y", "z"]
    low: Number
    high: Number
    of: Named | None = None
    NAMES: ClassVar[tuple[str, ...]] = (*Predicate.NAMES, "of")

    @model_validator(mode="after")
    def _range(self) -> Ranged:
        ordered_range(self.op, self.low, self.high)
        return self
