"""How high each body's bottom is: from the one row that says what carries it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.plan.layout.bodies import STANDS, hollow, surface
from wsim.plan.layout.boxes import TOUCH
from wsim.plan.layout.errors import LayoutError
from wsim.plan.layout.world import in_order

if TYPE_CHECKING:
    from wsim.plan.layout.rows import Row
    from wsim.plan.layout.world import World


def raise_bodies(world: World) -> None:
    """Fill in `world.bottom`.

    Raises:
        LayoutError: two rows say how high a body starts, supports go round in a circle, or a fluid is too shallow.
    """
    needs = {name: _needs(world, name) for name in world.items}
    for name in in_order(needs, "supports"):
        if name in world.bodies:
            world.bottom[name] = _bottom(world, name)
    for row in world.rows:
        if row.spec.kind == "level" and row.item in world.bottom:
            _check_level(world, row)


def support(world: World, name: str) -> Row | None:
    """The row that says how high a body starts; PLACE-ANYWHERE without `ref` gives way to another.

    Raises:
        LayoutError: two rows say it.
    """
    rows = [row for row in world.of[name] if row.spec.carries]
    firm = [row for row in rows if row.predicate != "PLACE-ANYWHERE" or row.ref is not None] or rows[:1]
    if len(firm) > 1:
        raise LayoutError(f"{firm[0]}, and {firm[1]}: both say how high {name} starts; keep one of them")
    return firm[0] if firm else None


def source(world: World, name: str) -> tuple[str, Row] | None:
    """Where a body that names no support takes its height from: a faces-level row, a mirror, a copy, a group."""
    row = world.row_of(name, "level") or world.row(name, "SYMMETRY-ALONG")
    if row is not None and row.ref is not None:
        return row.ref, row
    unit = world.unit_of.get(name)
    return (unit.anchor, unit.row) if unit is not None else None


def _needs(world: World, name: str) -> list[tuple[str, Row]]:
    if name in world.kept:
        return []
    row = support(world, name)
    if row is not None:
        refs = [ref for ref in (row.ref, row.other) if ref is not None]
        return [(one, row) for ref in refs for one in world.names(ref)]
    taken = source(world, name)
    found = [(one, taken[1]) for one in world.names(taken[0])] if taken is not None else []
    unit = world.unit_of.get(name)
    if unit is not None and unit.row.predicate == "COPY-GROUP":
        found += [(one, unit.row) for one in world.groups[unit.row.group or ""].all]
    return found


def _bottom(world: World, name: str) -> float:
    item = world.items[name]
    if name in world.kept and item.pose is not None:
        return item.pose.position[2] - (0.0 if item.primitive in STANDS else world.extents(name)[2] / 2)
    row = support(world, name)
    if row is None:
        return _taken(world, name)
    if row.predicate == "SPAN":
        return _level_tops(world, row)
    if row.ref is None:
        return world.base + (row.value or 0.0)
    if row.predicate == "PLACE-IN":
        return floor(world, row.ref)
    over = top(world, row.ref, row.anchor)
    if row.predicate == "FLOATS-AT-SURFACE":
        return over + (row.gap or 0.0)
    if row.predicate == "SUBMERGED":
        return _submerged(world, row, over)
    return over + (row.value or 0.0)


def _taken(world: World, name: str) -> float:
    found = source(world, name)
    if found is None:
        return world.base
    ref, row = found
    high = world.extents(name)[2]
    if row.spec.kind == "level" and row.spec.sign > 0:
        return highest(world, ref) - high
    if row.spec.kind == "level" and row.spec.sign == 0:
        return (bottom(world, ref) + highest(world, ref) - high) / 2
    unit = world.unit_of.get(name)
    if row.predicate == "COPY-GROUP" and unit is not None:
        copied = world.groups[row.group or ""]
        original = copied.members[unit.members.index(name)]
        return world.bottom[unit.anchor] + world.bottom[original] - world.bottom[copied.anchor]
    return bottom(world, ref)


def _check_level(world: World, row: Row) -> None:
    """A row that asks for level faces beside one that says what carries the body: both must hold."""
    low, ref_low = world.bottom[row.item], bottom(world, row.ref or "")
    high, ref_high = low + world.extents(row.item)[2], highest(world, row.ref or "")
    off = {1.0: high - ref_high, -1.0: low - ref_low, 0.0: (low + high - ref_low - ref_high) / 2}[row.spec.sign]
    if abs(off) > TOUCH:
        other = support(world, row.item) or (source(world, row.item) or (None, None))[1]
        raise LayoutError(f"{row}: it is {off:+.3g} m from there, by {other}; remove one of the two rows")


def _level_tops(world: World, row: Row) -> float:
    a, b = top(world, row.ref or "", None), top(world, row.other or "", None)
    if abs(a - b) > TOUCH:
        raise LayoutError(f"{row}: the top of {row.ref} is at {a:g} m, that of {row.other} at {b:g} m; make them level")
    return max(a, b)


def _submerged(world: World, row: Row, over: float) -> float:
    high = world.extents(row.item)[2]
    low = over - (row.value or 0.0) - (high / 2 if row.by == "center" else high)
    ground = _fluid_floor(world, row.ref or "")
    if low < ground - TOUCH:
        raise LayoutError(
            f"{row}: its bottom would be {over - low:g} m under the surface, and the fluid is {over - ground:g} m "
            "deep; lower the depth, or raise the surface"
        )
    return low


def bottom(world: World, ref: str) -> float:
    """Height of the lowest point of a body or a group [m]."""
    item = world.items.get(ref)
    if item is not None and item.primitive == "ground":
        return world.base
    if item is not None and ref not in world.bottom:
        return _fluid_floor(world, ref)
    return min(world.bottom[name] for name in world.names(ref))


def top(world: World, ref: str, anchor: str | None) -> float:
    """Height of what a body, a group or a fluid carries things on [m]."""
    item = world.items.get(ref)
    if item is None:
        return max(world.bottom[name] + world.extents(name)[2] for name in world.names(ref))
    if item.primitive == "ground":
        return world.base
    if item.primitive == "fluid":
        return fluid_surface(world, ref)
    if any(world.rotation(ref)[:2]) and anchor is None:
        return world.bottom[ref] + world.extents(ref)[2]
    return world.bottom[ref] + surface(item, anchor)[2]


def highest(world: World, ref: str) -> float:
    """Height of the highest point of a body, a group or a fluid [m]; of a tank, which has no top, the rim."""
    item = world.items.get(ref)
    if item is not None and item.primitive == "tank":
        return world.bottom[ref] + world.extents(ref)[2]
    return top(world, ref, None)


def floor(world: World, container: str) -> float:
    """Height of the floor of a hollow [m]."""
    if container not in world.items:
        raise LayoutError(f"{container} is a group and has no hollow; name one of its members")
    return world.bottom[container] + hollow(world.items[container]).low[2]


def fluid_surface(world: World, fluid: str) -> float:
    """Height of a fluid's still surface [m].

    Raises:
        LayoutError: nothing says how high it is, or it is above the rim.
    """
    container = world.container(fluid)
    row = world.row(fluid, "FREE-SURFACE-AT")
    if row is not None and row.value is not None and container is not None:
        deep = hollow(world.items[container]).size[2]
        if row.value > deep + TOUCH:
            raise LayoutError(f"{row}: the hollow of {container} is {deep:g} m deep; lower the surface")
        return floor(world, container) + row.value
    if fluid in world.bottom:
        return world.bottom[fluid] + world.extents(fluid)[2]
    raise LayoutError(f"{fluid}: its surface is unknown; give it PLACE-IN and FREE-SURFACE-AT, or a size and a place")


def _fluid_floor(world: World, fluid: str) -> float:
    container = world.container(fluid)
    if fluid in world.bottom:
        return world.bottom[fluid]
    return floor(world, container) if container is not None else world.base
