"""The room that a scene is in, if it has one: the space between static background boxes, or inside a container."""

from __future__ import annotations

import math

from wsim.plan.layout.boxes import Box

LEAST_WALLS = 3  # two walls facing each other are a corridor, open at its ends


def between_walls(walls: list[Box]) -> Box | None:
    """The free box between upright walls, seen from their common middle; open above unless something is over it.

    Returns:
        The box, or none if fewer than three sides are walled. A side without a wall ends where the others end.
    """
    if len(walls) < LEAST_WALLS:
        return None
    low = [min(wall.low[axis] for wall in walls) for axis in range(3)]
    high = [max(wall.high[axis] for wall in walls) for axis in range(3)]
    middle = [(a + b) / 2 for a, b in zip(low, high, strict=True)]
    found = 0
    for axis in (0, 1):
        across = 1 - axis
        facing = [wall for wall in walls if wall.low[across] <= middle[across] <= wall.high[across]]
        before = [wall.high[axis] for wall in facing if wall.high[axis] <= middle[axis]]
        behind = [wall.low[axis] for wall in facing if wall.low[axis] >= middle[axis]]
        found += bool(before) + bool(behind)
        low[axis] = max(before, default=low[axis])
        high[axis] = min(behind, default=high[axis])
    over = [wall.low[2] for wall in walls if wall.low[2] > middle[2] and _covers(wall, middle)]
    under = [wall.high[2] for wall in walls if wall.high[2] < middle[2] and _covers(wall, middle)]
    low[2], high[2] = max(under, default=low[2]), min(over, default=high[2])
    if found < LEAST_WALLS or not all(map(math.isfinite, (*low, *high))):
        return None
    return Box((low[0], low[1], low[2]), (high[0], high[1], high[2]))


def _covers(wall: Box, middle: list[float]) -> bool:
    return all(wall.low[axis] <= middle[axis] <= wall.high[axis] for axis in (0, 1))
