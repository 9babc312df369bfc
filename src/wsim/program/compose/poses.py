"""Where an object is."""

from __future__ import annotations

from wsim.errors import UserError
from wsim.plan.schema import PlanObject
from wsim.program.source import tuple_of


def position(item: PlanObject) -> tuple[float, float, float]:
    """An object's position [m].

    Raises:
        UserError: If it has no pose.
    """
    if item.pose is None:
        raise UserError(f"{item.name} has no pose; lay the plan out before composing its program")
    return item.pose.position


def rotation(item: PlanObject) -> list[str]:
    """The argument that turns an object; none where it is not turned."""
    if item.pose is None or not any(item.pose.rotation_deg):
        return []
    return [f"rotation_deg={tuple_of(item.pose.rotation_deg)}"]
