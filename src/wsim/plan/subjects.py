"""What a plan asks something of."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from wsim.plan.schema import Plan


def asked_about(plan: Plan) -> list[str]:
    """Names of the objects that its objectives name, in their order, each once; the ground is not among them."""
    known = {item.name for item in plan.objects if item.primitive != "ground" and item.role != "terrain"}
    found = [name for objective in plan.objectives for name in _texts(objective.model_dump(exclude={"sentence"}))]
    return [name for name in dict.fromkeys(map(str, found)) if name in known]


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for each in value.values():
            yield from _texts(each)
    elif isinstance(value, list | tuple):
        for each in value:
            yield from _texts(each)
