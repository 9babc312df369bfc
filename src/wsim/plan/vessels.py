"""What a fluid of a plan fills: a tank, or something of the catalogue that is hollow."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsim.plan.layout.bodies import hollow, local_size

if TYPE_CHECKING:
    from wsim.plan.schema import Plan, PlanObject, Vec3


def vessel_of(plan: Plan, fluid: PlanObject) -> PlanObject | None:
    """What a fluid is said to be in."""
    row = fluid.relation("PLACE-IN")
    return next((item for item in plan.objects if row is not None and item.name == row.ref), None)


def filled_box(vessel: PlanObject, level: float | None, volume: float | None) -> Vec3:
    """The box that so much fluid takes up in a vessel [m]; of a round one, about.

    Its sides are between those of the box in its hollow and of the box round it all, and where a volume says how much
    there is it is as high as that.

    Raises:
        LayoutError: It is not hollow.
    """
    inside = hollow(vessel).size
    if vessel.primitive == "tank":
        x, y = inside[:2]
    else:
        x, y = (math.sqrt(a * b) for a, b in zip(inside[:2], local_size(vessel)[:2], strict=True))
    return x, y, (volume or 0.0) / (x * y) if level is None else level
