"""Ropes, springs and cables."""

from __future__ import annotations

from wsim.plan.schema import Cord
from wsim.program.compose.draft import Draft
from wsim.program.source import call, number, tuple_of

_NUMBERS = ("length", "stiffness", "damping", "rest_length", "radius", "mass_per_length")


def statements(draft: Draft) -> list[str]:
    """A call for each cord."""
    return [line for cord in draft.plan.cords for line in call(f"scene.{cord.kind}", _arguments(draft, cord))]


def _arguments(draft: Draft, cord: Cord) -> list[str]:
    ends = [draft.handles[end] if end is not None else "None" for end in (cord.a, cord.b)]
    arguments = [f'"{cord.name}"', *ends]
    for field in ("anchor_a", "anchor_b"):
        anchor = getattr(cord, field)
        arguments += [f"{field}={tuple_of(anchor)}"] if anchor is not None else []
    if cord.around:
        arguments.append(f"around=[{', '.join(_round(draft, each.object, each.side) for each in cord.around)}]")
    for field in _NUMBERS:
        value = getattr(cord, field)
        arguments += [f"{field}={number(value)}"] if value is not None else []
    return [*arguments, *([f"links={cord.links}"] if cord.links else []), *(["loose=True"] if cord.loose else [])]


def _round(draft: Draft, name: str, side: str | tuple[float, float, float]) -> str:
    if side == "over":
        return draft.handles[name]
    said = f'"{side}"' if isinstance(side, str) else tuple_of(side)
    return f"({draft.handles[name]}, {said})"
