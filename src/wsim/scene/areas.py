"""Parts of terrain that have a surface of their own: which cells they hold, and the closed mesh of those."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wsim.scene.authoring import Handle
from wsim.scene.layers import Floats, polyline
from wsim.scene.roads import Road
from wsim.scene.validate import Call, shown

Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Area:
    """A part of terrain with a surface of its own: the cells whose middles it holds.

    Attributes:
        name: Of its shape, under the terrain's prim.
        outline: Its corners (x, y) in turn, from the terrain's middle [m].
        road: Instead of an outline: what this road covers.
        material, friction, restitution, rolling_friction, color: As of any object; what is not given is the terrain's.
    """

    name: str
    outline: Sequence[Sequence[float]] | None = None
    road: Road | None = None
    material: Handle | str | None = None
    friction: float | None = None
    restitution: float | None = None
    rolling_friction: float | None = None
    color: Sequence[float] | None = None

    def check(self, call: Call) -> None:
        """SceneError if a number of its surface is out of range."""
        if self.friction is not None:
            call.friction(self.friction)
        for field in ("restitution", "rolling_friction"):
            if getattr(self, field) is not None:
                call.fraction(field, getattr(self, field))
        if self.color is not None:
            call.color("color", self.color)

    def holds(self, call: Call, x: Floats, y: Floats) -> NDArray[np.bool_]:
        """Which places (x, y) are in it."""
        if (self.outline is None) == (self.road is None):
            call.fail("outline or road: give one of them")
        if self.road is not None:
            if not isinstance(self.road, Road):
                call.fail(f"road = {shown(self.road)} must be a Road")
            return self.road.covers(call, x, y)
        corners = polyline(call, self.outline, "outline", least=3)
        inside = np.zeros(x.shape, dtype=bool)
        for (ax, ay), (bx, by) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            if ay != by:
                inside ^= ((ay > y) != (by > y)) & (x < ax + (y - ay) * (bx - ax) / (by - ay))
        return inside


def divided(call: Call, areas: object, x: Floats, y: Floats) -> tuple[list[Area], Integers]:
    """The areas, and which of them each cell with its middle at (x, y) is in: its number from 1 on, 0 for none."""
    listed = call.listed("areas", areas, "a list of Area(...)")
    number = np.zeros(x.shape, dtype=np.int64)
    for k, area in enumerate(listed):
        if not isinstance(area, Area):
            call.fail(f'areas[{k}] = {shown(area)} must be an Area, e.g. Area("ice", outline=[...], friction=0.1)')
        one = Call(call.method, call.name, f"areas[{k}].")
        Call(call.method, area.name, f"areas[{k}].").identifier(("geometry", *(each.name for each in listed[:k])))
        area.check(one)
        number[area.holds(one, x, y)] = k + 1
    number = _joined(number)
    for k, area in enumerate(listed):
        if not (number == k + 1).any():
            call.fail(f"areas[{k}]: {shown(area.name)} holds the middle of no cell; make it larger, the cells finer, "
                      "or leave it out")  # fmt: skip
    return listed, number


def _joined(number: Integers) -> Integers:
    """No two parts touch in a corner only: a mesh that did would not be closed.

    Where some do, the highest of the four cells takes in a neighbour, of the two the lower: areas go over ground, and
    later ones over earlier ones, whichever way they run. Numbers rise only, so it ends.
    """
    while len(found := _touching(number)):
        for row, column in found:
            square = number[row : row + 2, column : column + 2]
            if len(_touching(square)):  # still, after its neighbours
                (top, aside), *_ = np.argwhere(square == square.max())
                lower = min([(top, 1 - aside), (1 - top, aside)], key=lambda at: int(square[at]))
                square[lower] = square[top, aside]
    return number


def _touching(number: Integers) -> Integers:
    """Squares of 2 x 2 cells, by their first (row, column), across which like ones touch in the middle only."""
    a, b, c, d = number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]
    return np.argwhere(((a == c) & (b != a) & (d != a)) | ((b == d) & (a != b) & (c != b)))


def closed(points: Floats, top: Integers, low: float) -> tuple[Floats, Integers, Integers]:
    """A closed mesh under some triangles: (V, 3) [m], (F, 3), the top's first, and which of `points` are its first.

    Args:
        points: (P, 3) [m].
        top: Triangles (T, 3), counter-clockwise seen from above.
        low: Of its level bottom [m].
    """
    used, mine = np.unique(top, return_inverse=True)
    mine = mine.reshape(top.shape)
    count = len(used)
    ends = np.concatenate([mine[:, [0, 1]], mine[:, [1, 2]], mine[:, [2, 0]]])
    key = ends[:, 0] * count + ends[:, 1]
    rim = ends[~np.isin(key, ends[:, 1] * count + ends[:, 0])]
    a, b = rim[:, 0], rim[:, 1]
    sides = np.concatenate([np.stack([a, a + count, b + count], 1), np.stack([a, b + count, b], 1)])
    above = points[used]
    under = np.column_stack([above[:, :2], np.full(count, low)])
    return np.concatenate([above, under]), np.concatenate([mine, mine[:, ::-1] + count, sides]), used
