"""Taps, rain and drains."""

from __future__ import annotations

from wsim.plan.layout.openings import mouth_of
from wsim.plan.schema import OpeningPlan, Plan
from wsim.program.source import call, number, tuple_of


def statements(plan: Plan) -> list[str]:
    """A call for each."""
    lines: list[str] = []
    for opening in plan.openings:
        lines += call(f"scene.{opening.kind}", _arguments(plan, opening))
    return lines


def _arguments(plan: Plan, opening: OpeningPlan) -> list[str]:
    found = [f'"{opening.name}"', f'"{opening.fluid}"']
    if opening.rate is not None:
        found.append(f"rate={number(opening.rate)}")
    found.append(f"position={tuple_of(mouth_of(plan, opening))}")
    if opening.direction is not None:
        found.append(f"direction={tuple_of(opening.direction)}")
    if opening.size is not None:
        found.append(f"size={tuple_of(opening.size)}")
    for name, value in (
        ("radius", opening.radius), ("start", opening.start), ("stop", opening.stop), ("speed", opening.drop_speed),
    ):  # fmt: skip
        if value is not None:
            found.append(f"{name}={number(value)}")
    return found
