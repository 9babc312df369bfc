"""What happens by time or after an event."""

from __future__ import annotations

import json

from wsim.plan.schema import EventPlan, SchedulePlan
from wsim.program.compose.draft import Draft
from wsim.program.source import call, number, tuple_of


def statements(draft: Draft) -> list[str]:
    """A call for each schedule."""
    lines: list[str] = []
    for each in draft.plan.schedules:
        if each.after is not None:
            draft.imports.add("Event")
        lines += call("scene.schedule", _arguments(each))
    return lines


def _arguments(each: SchedulePlan) -> list[str]:
    found = [json.dumps(each.name), _of(each.of), json.dumps(each.quantity)]
    found.append(f"times={_list([number(time) for time in each.times])}")
    if each.values:
        said = [tuple_of(value) if isinstance(value, tuple) else number(value) for value in each.values]
        found.append(f"values={_list(said)}")
    if each.linear is not None:
        found.append(f"linear={each.linear}")
    if each.point is not None:
        found.append(f"point={tuple_of(each.point)}")
    return found if each.after is None else [*found, f"after={_event(each.after)}"]


def _of(of: str | tuple[str, str]) -> str:
    return json.dumps(of) if isinstance(of, str) else f"({', '.join(map(json.dumps, of))})"


def _event(event: EventPlan) -> str:
    given = {name: value for name, value in event if value is not None}
    said = {
        name: number(value) if isinstance(value, float) else _of(value) for name, value in given.items()
    }  # fmt: skip
    return f"Event({', '.join(f'{name}={text}' for name, text in said.items())})"


def _list(items: list[str]) -> str:
    return f"[{', '.join(items)}]"
