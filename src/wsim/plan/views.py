"""Cameras that show the whole of a laid-out plan."""

from __future__ import annotations

import math

from wsim.plan.layout import solids
from wsim.plan.schema import CameraPlan, Plan, Vec3

FIELD_OF_VIEW = 50.0  # horizontal, the default of wsim.scene [deg]
ASPECT = 9 / 16
MARGIN = 1.2


def bounds(plan: Plan) -> tuple[Vec3, Vec3]:
    """Lowest and highest corner of everything placed [m]; a metre round the origin if nothing is."""
    boxes = [box for item in plan.objects for box in solids(item)]
    if not boxes:
        return (-0.5, -0.5, 0.0), (0.5, 0.5, 1.0)
    low = [min(box.low[axis] for box in boxes) for axis in range(3)]
    high = [max(box.high[axis] for box in boxes) for axis in range(3)]
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def cameras(plan: Plan, above: float | None = None) -> list[CameraPlan]:
    """A view from the side, a little off the axis, and one from the top.

    Args:
        plan: A plan with poses.
        above: A height that the side view looks across from slightly higher up, such as a water surface [m].
    """
    low, high = bounds(plan)
    centre = tuple((a + b) / 2 for a, b in zip(low, high, strict=True))
    width, depth, height = (b - a for a, b in zip(low, high, strict=True))
    half = math.tan(math.radians(FIELD_OF_VIEW / 2))
    distance = MARGIN * max(width / 2 / half, height / 2 / (half * ASPECT)) + depth / 2
    level = above if above is not None else centre[2]
    side = CameraPlan(
        name="side",
        eye=_rounded(centre[0] - 0.18 * distance, centre[1] - distance, level + 0.22 * distance),
        target=_rounded(centre[0], centre[1], centre[2]),
    )
    up = MARGIN * max(width / 2 / half, depth / 2 / (half * ASPECT)) + high[2]
    # Looking straight down, "up" in the picture would be undefined: the eye stands a little to the side of it.
    top = CameraPlan(
        name="top",
        eye=_rounded(centre[0], centre[1] - 0.05 * up, up),
        target=_rounded(centre[0], centre[1], low[2]),
    )
    return [side, top]


def _rounded(x: float, y: float, z: float) -> Vec3:
    return (round(x, 3) + 0.0, round(y, 3) + 0.0, round(z, 3) + 0.0)
