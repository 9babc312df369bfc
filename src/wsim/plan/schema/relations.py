"""Rows of the topology: a predicate, and the arguments that it takes."""

from __future__ import annotations

from difflib import get_close_matches
from typing import Annotated, Literal

from pydantic import Field, model_validator

from wsim.plan.schema.base import Name, NotNegative, Number, Positive, Strict
from wsim.plan.schema.predicates import PREDICATES, Predicate

ARGUMENTS = ("ref", "other", "axis", "gap", "value", "anchor", "by", "region", "range", "overlap", "group", "members")


class Region(Strict):
    """An upright rectangle on the ground [m]."""

    low: tuple[Number, Number]
    high: tuple[Number, Number]

    @model_validator(mode="after")
    def _ordered(self) -> Region:
        if not (self.low[0] < self.high[0] and self.low[1] < self.high[1]):
            raise ValueError(f"low {self.low} must be below high {self.high} along X and Y; swap them")
        return self


class Relation(Strict):
    """One row of the topology: `predicate` applied to the object, with its arguments."""

    predicate: Annotated[str, Field(max_length=60)]
    ref: Name | None = None
    other: Name | None = None  # the second reference of a bridge
    axis: Name | None = None  # the object that a mirror plane goes through
    gap: NotNegative | None = None  # [m], between faces
    value: NotNegative | None = None  # [m]: a height or a depth
    anchor: Name | None = None  # a named surface of `ref`
    by: Literal["top", "center"] | None = None
    region: Region | None = None
    range: tuple[Number, Number] | None = None  # [deg]
    overlap: Positive | None = None  # [m], of a bridge's end on what carries it
    group: Name | None = None
    members: list[Name] | None = Field(None, max_length=1000)

    @model_validator(mode="after")
    def _arguments(self) -> Relation:
        spec = PREDICATES.get(self.predicate)
        if spec is None:
            near = get_close_matches(self.predicate, PREDICATES, n=1, cutoff=0.4)
            way = f"did you mean {near[0]}?" if near else f"the predicates are {', '.join(PREDICATES)}"
            raise ValueError(f"there is no predicate {self.predicate!r}; {way}")
        given = {name for name in ARGUMENTS if getattr(self, name) is not None}
        for name in spec.needs:
            if name not in given:
                raise ValueError(f'{self.predicate} needs "{name}": {_MEANS[name]}')
        strange = sorted(given - set(spec.needs) - set(spec.takes))
        if strange:
            takes = ", ".join((*spec.needs, *spec.takes)) or "no arguments"
            raise ValueError(f'{self.predicate} takes {takes}; remove "{strange[0]}"')
        return self

    @property
    def spec(self) -> Predicate:
        """What the predicate takes and means."""
        return PREDICATES[self.predicate]

    def refs(self) -> list[tuple[str, str]]:
        """Every object that the row names, with the argument that names it."""
        named = [(field, getattr(self, field)) for field in ("ref", "other", "axis")]
        named += [(f"members.{i}", name) for i, name in enumerate(self.members or [])]
        return [(field, name) for field, name in named if name is not None]

    def sentence(self) -> str:
        """The row as a person says it."""
        values = {name: getattr(self, name) for name in ARGUMENTS}
        values["members"] = ", ".join(self.members or [])
        values["ref"] = self.ref or "the ground"
        values["value"] = "" if self.value is None else f"{self.value:g}"
        words = self.spec.words.format(**values)
        words += f", {self.gap:g} m apart" if self.gap is not None and self.spec.kind == "side" else ""
        return words + (f" at its {self.anchor}" if self.anchor else "")


_MEANS = {
    "ref": "the name of another object",
    "other": "the name of a second object",
    "axis": "the name of the object that the mirror plane goes through",
    "value": "a height or depth in metres",
    "group": "the group's name",
    "members": "a list of objects' names",
}
