"""The objectives of a plan, with what each says of which objects."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import inf
from typing import TYPE_CHECKING, Any

from wsim.plan.schema.formula import Predicate

if TYPE_CHECKING:
    from wsim.plan.schema import Objective, Plan
    from wsim.plan.schema.nodes import Node


@dataclass(frozen=True)
class Said:
    """A predicate, or a plain kind of objective.

    Attributes:
        where: Its path in the plan.
        name: The kind, or the predicate's name.
        fields: Of the predicate; of a kind `object` and `ref`.
        denied: It stands under a `not`.
        throughout: It is to hold all the time, from the start on.
        whole: And to the end.
        optional: It is one of several alternatives.
        plain: Nothing says when: it is asked as its predicate by itself is, alone or in an "and".
        end: The latest time that it is asked at [s]; infinite where that is the end of the run.
    """

    where: str
    name: str
    fields: dict[str, Any]
    denied: bool = False
    throughout: bool = False
    whole: bool = False
    optional: bool = False
    plain: bool = True
    end: float = inf

    @property
    def object(self) -> str | None:
        """What it is said of."""
        return self.fields.get("object")

    @property
    def ref(self) -> str | None:
        """Against what."""
        return self.fields.get("ref")


# Kinds and predicates that by themselves are of every moment.
THROUGHOUT = ("stays_on", "stays_inside", "stays_within", "touches_only", "never_touches")


def said(plan: Plan) -> list[Said]:
    """All of them, in the plan's order."""
    found: list[Said] = []
    for number, objective in enumerate(plan.objectives):
        where = f"objectives.{number}"
        if objective.formula is None:
            found.append(_kind(where, objective))
        else:
            alone = objective.formula if isinstance(objective.formula, Predicate) else None
            always = alone is not None and alone.alone == "always"
            found += list(_of(objective.formula, Said(f"{where}.formula", "", {}, False, always, always), None))
    return found


def _kind(where: str, objective: Objective) -> Said:
    fields = {"object": objective.object, "ref": objective.ref}
    throughout = objective.kind in THROUGHOUT
    return Said(where, objective.kind, fields, throughout=throughout, whole=throughout)


def _of(node: Node, under: Said, at: float | None) -> Iterator[Said]:
    """The predicates of a formula, each with what the operators above it say of when.

    Args:
        node: The formula.
        under: What is said of it so far.
        at: The latest time that it is asked at [s]; None where nothing says when.
    """
    op = str(getattr(node, "op", ""))
    if op not in ("and", "not") and not isinstance(node, Predicate):
        under = replace(under, plain=False)
    if isinstance(node, Predicate):
        under = replace(under, end=inf if at is None else at)
        fields = {name: getattr(node, name) for name in type(node).model_fields if name != "op"}
        yield replace(under, name=op, fields=fields)
        return
    if op in ("or", "then", "until", "eventually", "finally", "mean"):  # it need not hold at the start, or not at all
        under = replace(under, throughout=False, whole=False, optional=under.optional or op == "or")
    if op == "always":
        window = getattr(node, "window", None)
        under = replace(under, throughout=window is None or window[0] == 0.0, whole=window is None)
    if op in ("always", "eventually"):
        window = getattr(node, "window", None)
        at = (at or 0.0) + (inf if window is None or window[1] is None else window[1])
    elif op in ("then", "until", "finally", "mean"):
        at = inf
    if op == "not":
        under = replace(under, denied=not under.denied)
    for part in node.parts():
        yield from _of(part, under, at)
