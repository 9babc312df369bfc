"""Where the mouths of taps and drains are."""

from __future__ import annotations

from wsim.plan.layout.bodies import around, hollow, is_hollow
from wsim.plan.layout.errors import LayoutError
from wsim.plan.schema import OpeningPlan, Plan, Vec3


def mouth_of(plan: Plan, opening: OpeningPlan) -> Vec3:
    """The centre of a mouth [m], of a plan that is laid out.

    Raises:
        LayoutError: If a drain is in what is not hollow.
    """
    x, y, z = _origin(plan, opening)
    dx, dy, dz = opening.offset
    return x + dx, y + dy, z + dz


def _origin(plan: Plan, opening: OpeningPlan) -> Vec3:
    if opening.at is None:
        return 0.0, 0.0, 0.0
    item = plan.object(opening.at)
    box = around(item)
    middle = (box.low[0] + box.high[0]) / 2, (box.low[1] + box.high[1]) / 2
    if opening.kind == "tap":
        return (*middle, box.high[2])
    if not is_hollow(item) or item.pose is None:
        raise LayoutError(f"{opening.name}: {item.name} is not hollow; a drain is in the floor of a container")
    return (*middle, item.pose.position[2] + hollow(item).low[2])
