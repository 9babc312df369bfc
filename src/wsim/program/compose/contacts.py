"""The laws of pairs of objects."""

from __future__ import annotations

from wsim.plan.schema import Plan
from wsim.program.source import call, number


def statements(plan: Plan) -> list[str]:
    """A call for each pair."""
    lines: list[str] = []
    for contact in plan.contacts:
        given = {name: getattr(contact, name) for name in ("friction", "restitution", "rolling")}
        stated = [f"{name}={number(value)}" for name, value in given.items() if value is not None]
        lines += call("scene.contact", [f'"{contact.object}"', f'"{contact.ref}"', *stated])
    return lines
