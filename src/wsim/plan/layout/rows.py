"""A row as the layout takes it: a primitive predicate of one object, and the row of the plan that it came from.

Beside the primitive rows of the schema there are four kinds that only templates make:

| kind | meaning |
| --- | --- |
| LEVEL-TOPS | top faces of the object and of `ref` level |
| LEVEL-BOTTOMS | bottom faces level |
| LEVEL-CENTERS | centres level |
| SPAN | a box whose length, heading and centre come from the gap between `ref` and `other`, on both tops |
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from wsim.plan.schema import PlanObject, Region, Relation

LEVELS = ("LEVEL-TOPS", "LEVEL-BOTTOMS", "LEVEL-CENTERS")
SUPPORTS = (
    "PLACE-ON-BASE",
    "PLACE-ON",
    "PLACE-IN",
    "PLACE-ANYWHERE",
    "SPAWNED-ABOVE",
    "FLOATS-AT-SURFACE",
    "SUBMERGED",
)
SIDES: dict[str, tuple[int, float]] = {
    "FRONT-OF": (0, 1.0),
    "BACK-OF": (0, -1.0),
    "LEFT-OF": (1, 1.0),
    "RIGHT-OF": (1, -1.0),
}
EDGES: dict[str, tuple[int, float]] = {
    "ALIGN-FRONT": (0, 1.0),
    "ALIGN-BACK": (0, -1.0),
    "ALIGN-LEFT": (1, 1.0),
    "ALIGN-RIGHT": (1, -1.0),
}
CENTERS = {"ALIGN-CENTER-FB": 0, "ALIGN-CENTER-LR": 1}
PLACELESS = ("GROUP", "CONTAINS-FLUID", "HEIGHT")  # rows that say nothing of where their object is


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
        """The row that a relation states, or one that a template makes of it."""
        given = {name: getattr(source, name) for name in Relation.model_fields if name not in ("predicate", "members")}
        given["members"] = tuple(source.members or ())
        return cls(item, predicate or source.predicate, source, **{**given, **changes})

    def __str__(self) -> str:
        source = self.source
        named = [name for name in (source.ref, source.other, source.axis, source.group) if name is not None]
        numbers = [f"{key} {value:g}" for key in ("value", "gap") if (value := getattr(source, key)) is not None]
        return " ".join([self.item, source.predicate, *named]) + (f" ({', '.join(numbers)})" if numbers else "")


def placing(item: PlanObject) -> bool:
    """Whether any of the object's rows says where it is or how it is turned."""
    return any(row.predicate not in PLACELESS for row in item.relations)
