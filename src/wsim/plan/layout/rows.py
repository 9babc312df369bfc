"""A row as the layout takes it: one of `ROWS` of one object, and the row of the plan that it came from."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from wsim.plan.schema import PlanObject, Region, Relation
from wsim.plan.schema.predicates import ROWS, Predicate
from wsim.plan.schema.relations import ARGUMENTS


@dataclass(frozen=True, eq=False)
class Row:
    """One row, known by its identity; the fields are those of the schema's `Relation`."""

    item: str
    predicate: str
    source: Relation = field(repr=False)
    ref: str | None = None
    other: str | None = None
    axis: str | None = None
    gap: float | None = None
    value: float | None = None
    anchor: str | None = None
    by: str | None = None
    region: Region | None = None
    range: tuple[float, float] | None = None
    overlap: float | None = None
    group: str | None = None
    members: tuple[str, ...] = ()

    @classmethod
    def of(cls, item: str, source: Relation, predicate: str | None = None, **changes: Any) -> Row:
        """The row that a relation states, or one that a template makes of it: what is not given has its default."""
        spec = ROWS[predicate or source.predicate]
        stated = {**spec.defaults, **stated_by(source), **changes}
        taken = {name: value for name, value in stated.items() if name in (*spec.needs, *spec.takes)}
        return cls(item, spec.name, source, **{**taken, "members": tuple(taken.get("members", ()))})

    @property
    def spec(self) -> Predicate:
        """What the row means."""
        return ROWS[self.predicate]

    def __str__(self) -> str:
        source = self.source
        named = [name for name in (source.ref, source.other, source.axis, source.group) if name is not None]
        numbers = [f"{key} {value:g}" for key in ("value", "gap") if (value := getattr(source, key)) is not None]
        return " ".join([self.item, source.predicate, *named]) + (f" ({', '.join(numbers)})" if numbers else "")


def stated_by(relation: Relation) -> dict[str, Any]:
    """The arguments that a relation gives."""
    return {name: value for name in ARGUMENTS if (value := getattr(relation, name)) is not None}


def placing(item: PlanObject) -> bool:
    """Whether any of the object's rows says where it is or how it is turned."""
    return any(row.spec.places for row in item.relations)
