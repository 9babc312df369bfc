"""What an objective is made of."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from wsim.plan.schema.formula import Not

if TYPE_CHECKING:
    from wsim.plan.schema import Objective
    from wsim.plan.schema.nodes import Node


def nodes(objective: Objective) -> Iterator[tuple[Node, bool]]:
    """All nodes of its formula, with whether each is denied."""

    def below(node: Node, denied: bool) -> Iterator[tuple[Node, bool]]:
        yield node, denied
        for part in node.parts():
            yield from below(part, denied ^ isinstance(node, Not))

    if objective.formula is not None:
        yield from below(objective.formula, False)


def speaks_of(objective: Objective) -> set[str]:
    """All things that it speaks of."""
    found = {name for name in (objective.object, objective.ref) if name is not None}
    return found | (set() if objective.formula is None else objective.formula.names())
