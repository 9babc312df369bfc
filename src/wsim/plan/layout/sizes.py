"""Sizes that rows give: HEIGHT, and the length of a bridge."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsim.plan.layout.bodies import entry, local_size
from wsim.plan.layout.boxes import TOUCH, turned
from wsim.plan.layout.errors import LayoutError
from wsim.plan.schema import External, PlanObject, Proxy

if TYPE_CHECKING:
    from wsim.plan.layout.rows import Row
    from wsim.plan.layout.world import World


def give_heights(world: World) -> None:
    """Scale what a HEIGHT row may scale: the stand-in of something that is yet to be found.

    Raises:
        LayoutError: the construction has a height of its own, and it is another one.
    """
    for row in world.rows:
        if row.predicate == "HEIGHT" and row.value is not None:
            world.items[row.item] = _as_high(world.items[row.item], row.value, row)


def _as_high(item: PlanObject, value: float, row: Row) -> PlanObject:
    height = local_size(item)[2]
    if abs(height - value) <= TOUCH:
        return item
    if not isinstance(item.construction, External) or item.primitive == "tank" or value <= 0.0:
        given = f"the asset {entry(item).id}" if item.primitive == "asset" else f"the size {item.size}"
        raise LayoutError(f"{row}: {given} is {height:g} m high; remove the row, or change the size")
    size = _scaled(item, value)
    return with_size(item, size)


def _scaled(item: PlanObject, value: float) -> tuple[float, ...]:
    size = item.size
    if item.primitive == "sphere":
        return (value / 2,)
    if item.primitive == "cylinder":
        return (size[0], value)
    if item.primitive == "capsule":
        if value <= 2 * size[0]:
            raise LayoutError(f"{item.name}: a capsule of radius {size[0]:g} m is higher than HEIGHT {value:g} m")
        return (size[0], value - 2 * size[0])
    return (*size[:2], value)


def with_size(item: PlanObject, size: tuple[float, ...]) -> PlanObject:
    """A copy whose primitive has this size [m]."""
    built = item.built
    if not isinstance(built, Proxy):
        raise LayoutError(f"{item.name}: its size is that of its {built.kind}; use a box")
    size = tuple(round(value, 6) for value in size)
    proxy = built.model_copy(update={"size": size})
    made = item.construction
    construction = made.model_copy(update={"stand_in": proxy}) if isinstance(made, External) else proxy
    return item.model_copy(update={"construction": construction})


def stretch_bridges(world: World) -> None:
    """Give each bridge its length: the gap between what carries it, and the overlap on both.

    Raises:
        LayoutError: it is no box, there is no gap, or the overlap is more than there is to lie on.
    """
    for row in world.rows:
        if row.predicate == "SPAN":
            item = world.items[row.item]
            if item.primitive != "box":
                raise LayoutError(f"{row}: a bridge is a box; {row.item} is a {item.primitive}")
            start, end = gap_between(world, row)
            length = end - start + 2 * (row.overlap or 0.0)
            world.items[row.item] = with_size(item, (length, *item.size[1:]))


def gap_between(world: World, row: Row) -> tuple[float, float]:
    """Where the line between the centres of a bridge's two references leaves the one and enters the other [m].

    Both are distances from the first one's centre.
    """
    a, b = row.ref or "", row.other or ""
    for name in (a, b):
        if name in world.items and name not in world.centre:
            raise LayoutError(f"{row}: {name} is no body that a bridge can rest on; name another object")
    (ax, ay), (bx, by) = world.box(a).center[:2], world.box(b).center[:2]
    apart = math.hypot(bx - ax, by - ay)
    if apart < TOUCH:
        raise LayoutError(f"{row}: {a} and {b} are over each other; move one of them")
    unit = ((bx - ax) / apart, (by - ay) / apart)
    out, back = _chord(world, a, unit), _chord(world, b, unit)
    gap = apart - out - back
    if gap <= TOUCH:
        raise LayoutError(f"{row}: there is no gap between {a} and {b}, they are {gap:g} m apart; give them a gap")
    for name, chord in ((a, out), (b, back)):
        if (row.overlap or 0.0) > 2 * chord + TOUCH:
            raise LayoutError(f"{row}: overlap {row.overlap:g} m is more than {name} has, {2 * chord:g} m; lower it")
    return out, apart - back


def _chord(world: World, name: str, unit: tuple[float, float]) -> float:
    """From a body's centre to its edge along a direction, in its own turned rectangle [m]."""
    single = name in world.items
    x, y, _ = local_size(world.items[name]) if single and not any(world.rotation(name)[:2]) else world.box(name).size
    yaw = world.yaw[name] if single and not any(world.rotation(name)[:2]) else 0.0
    u, v = turned(unit, -yaw)
    return min((x / 2) / abs(u) if abs(u) > 1e-9 else math.inf, (y / 2) / abs(v) if abs(v) > 1e-9 else math.inf)
