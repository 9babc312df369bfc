"""Where each body is in the plane: rows become equations between the centres of their boxes, axis by axis."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsim.plan.layout.boxes import turned
from wsim.plan.layout.equations import Conflict, System, Var
from wsim.plan.layout.errors import LayoutError
from wsim.plan.layout.settle import Wish, settle
from wsim.plan.layout.sizes import gap_between

if TYPE_CHECKING:
    from wsim.plan.layout.rows import Row
    from wsim.plan.layout.world import Unit, World


def arrange(world: World) -> None:
    """Fill in `world.centre`: first each group by itself, then everything, with groups as wholes.

    Raises:
        LayoutError: rows contradict each other, or what is free fits nowhere.
    """
    for unit in world.groups.values():
        unit.offsets = _inner(world, unit)
    for unit in world.units.values():
        if unit.row.predicate == "COPY-GROUP":
            unit.offsets = _copied(world, unit)
    names = set(world.bodies)
    system = _system(world, names, [row for row in world.rows if row.item in names])
    for unit in world.units.values():
        for name, (x, y) in unit.offsets.items():
            _state(system, {(0, name): 1.0, (0, unit.anchor): -1.0}, x, unit.row)
            _state(system, {(1, name): 1.0, (1, unit.anchor): -1.0}, y, unit.row)
    world.centre.update(settle(world, system, list(world.bodies), _in_line(world, world.rows, names)))


def _inner(world: World, unit: Unit) -> dict[str, tuple[float, float]]:
    """Where a group's members are from its anchor, by the rows among them."""
    names = [name for name in unit.all if name in world.bodies]
    if len(names) < len(unit.all):
        lost = next(name for name in unit.all if name not in world.bodies)
        raise LayoutError(f"{unit.row}: {lost} has no place of its own; take it out of the group")
    inside = set(names)
    rows = [row for row in world.rows if row.item in inside and _refs(world, row) <= inside]
    system = _system(world, inside, rows)
    x, y = 0.0, 0.0
    pose = world.items[unit.anchor].pose
    if unit.anchor in world.kept and pose is not None:
        x, y = pose.position[:2]
    else:
        _state(system, {(0, unit.anchor): 1.0}, 0.0, None)
        _state(system, {(1, unit.anchor): 1.0}, 0.0, None)
    found = settle(world, system, names, _in_line(world, rows, inside))
    return {name: (found[name][0] - x, found[name][1] - y) for name in unit.members}


def _copied(world: World, unit: Unit) -> dict[str, tuple[float, float]]:
    """The original's arrangement, turned with the copy's anchor."""
    original = world.groups[unit.row.group or ""]
    turn = world.yaw[unit.anchor] - world.yaw[original.anchor]
    pairs = zip(unit.members, original.members, strict=True)
    return {name: turned(original.offsets[like], turn) for name, like in pairs}


def _refs(world: World, row: Row) -> set[str]:
    named = [ref for ref in (row.ref, row.other, row.axis) if ref is not None]
    return {name for ref in named for name in (world.names(ref) if ref in world.items or ref in world.groups else ())}


def _system(world: World, names: set[str], rows: list[Row]) -> System:
    """The equations of these rows among these bodies."""
    system = System()
    for name in world.bodies:
        pose = world.items[name].pose
        if name in names and name in world.kept and pose is not None:
            system.add({(0, name): 1.0}, pose.position[0], None)
            system.add({(1, name): 1.0}, pose.position[1], None)
    for row in rows:
        for terms, const in _equations(world, row):
            _state(system, terms, const, row)
    return system


def _in_line(world: World, rows: list[Row], names: set[str]) -> list[Wish]:
    """Neighbours would stand in line, across the side that relates them."""
    made: list[Wish] = []
    for row in rows:
        if row.spec.kind == "side" and row.item in names:
            made += _between(world, row, 1 - row.spec.axis, 0.0, 0.0, 0.0)
    return made


def _state(system: System, terms: dict[Var, float], const: float, row: Row | None) -> None:
    try:
        system.add(terms, const, row)
    except Conflict as conflict:
        rows = "; ".join(map(str, conflict.rows)) or str(row)
        if len(conflict.rows) < 2:
            rows += ", and the poses given"
        axis = "X" if next(iter(terms))[0] == 0 else "Y"
        raise LayoutError(
            f"these rows contradict each other by {abs(conflict.off):.3g} m along {axis}: {rows}; "
            "remove or change one of them"
        ) from None


def _equations(world: World, row: Row) -> list[tuple[dict[Var, float], float]]:
    axis, sign = row.spec.axis, row.spec.sign
    if row.spec.kind == "side":
        return _between(world, row, axis, -sign, sign, sign * (row.gap or 0.0))
    if row.spec.kind == "alignment":
        return _between(world, row, axis, sign, sign, 0.0)
    if row.predicate == "SYMMETRY-ALONG":
        return _mirrored(world, row)
    return _over_gap(world, row) if row.predicate == "SPAN" else []


def _between(
    world: World, row: Row, axis: int, mine: float, theirs: float, gap: float
) -> list[tuple[dict[Var, float], float]]:
    """One face of the object, -1 low, +1 high or 0 the middle, `gap` from one of the reference's.

    An anchor's rows place its whole group; a row among the members of one group is about the members.
    """
    ref = row.ref or ""
    if ref not in world.bodies and ref not in world.groups:
        raise LayoutError(f"{row}: {ref} has no sides; name a body")
    unit = world.units.get(row.item)
    whole = unit is not None and not set(world.names(ref)) & set(unit.all)
    low, high = _span(world, row.item, axis, whole)
    ref_low, ref_high = _span(world, world.owner(ref), axis, ref in world.groups)
    at = (low + high) / 2 + mine * (high - low) / 2
    ref_at = (ref_low + ref_high) / 2 + theirs * (ref_high - ref_low) / 2
    owner = world.owner(ref)
    if owner == row.item:
        raise LayoutError(f"{row}: {row.item} is the anchor of {ref}; name another object")
    return [({(axis, row.item): 1.0, (axis, owner): -1.0}, gap + ref_at - at)]


def _span(world: World, name: str, axis: int, whole: bool) -> tuple[float, float]:
    if whole:
        return world.span(name, axis)
    half = world.extents(name)[axis] / 2
    return -half, half


def _mirrored(world: World, row: Row) -> list[tuple[dict[Var, float], float]]:
    """c' = p + M (c - p), with M the reflection about the direction of the axis object's heading."""
    item, ref, axis = row.item, world.owner(row.ref or ""), world.owner(row.axis or "")
    if axis not in world.bodies or ref not in world.bodies:
        raise LayoutError(f"{row}: {row.axis} and {row.ref} must be bodies with a place")
    c, s = math.cos(2 * math.radians(world.yaw[axis])), math.sin(2 * math.radians(world.yaw[axis]))
    made: list[tuple[dict[Var, float], float]] = []
    for k, (m0, m1) in enumerate(((c, s), (s, -c))):
        terms: dict[Var, float] = {(k, item): 1.0}
        for j, m in enumerate((m0, m1)):
            same = 1.0 if j == k else 0.0
            for name, factor in ((ref, -m), (axis, m - same)):
                if abs(factor) > 1e-12:
                    terms[(j, name)] = terms.get((j, name), 0.0) + factor
        made.append(({var: f for var, f in terms.items() if abs(f) > 1e-12}, 0.0))
    return made


def _over_gap(world: World, row: Row) -> list[tuple[dict[Var, float], float]]:
    """A bridge's middle is on the line between the two centres, in the middle of the gap."""
    a, b = world.owner(row.ref or ""), world.owner(row.other or "")
    share = 0.5
    if all(name in world.centre for name in (a, b)):
        start, end = gap_between(world, row)
        (ax, ay), (bx, by) = world.centre[a], world.centre[b]
        share = (start + end) / 2 / math.hypot(bx - ax, by - ay)
    return [({(k, row.item): 1.0, (k, a): share - 1.0, (k, b): -share}, 0.0) for k in (0, 1)]
