"""Which bodies may overlap, and which do: the boxes that stand in each other's way while places are found."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from wsim.plan.layout.areas import Area, areas, check_room_above, rider_of, room_in
from wsim.plan.layout.bodies import convex, is_hollow
from wsim.plan.layout.boxes import TOUCH, Box, turned
from wsim.plan.layout.errors import LayoutError
from wsim.plan.layout.heights import support, top
from wsim.plan.schema import Pose

if TYPE_CHECKING:
    from wsim.plan.layout.equations import System
    from wsim.plan.layout.rows import Row
    from wsim.plan.layout.world import World

SCENERY = ("background", "terrain")
Places = dict[str, tuple[float, float]]


class Space:
    """The boxes of some bodies, whose places in the plane the `system` settles in part."""

    def __init__(self, world: World, system: System, names: list[str]) -> None:
        self.world = world
        self.system = system
        self.names = names
        inside = set(names)
        self.areas: dict[str, list[Area]] = {}
        for name in names:
            check_room_above(world, name)
            kept = [area for area in areas(world, name) if area.carrier is None or area.carrier in inside]
            self.areas[name] = kept
        self.parts = {name: parts(world, name) for name in names if _in_the_way(world, name)}
        self.exempt = exempt(world, inside)
        self.depth = _depths(world, names, {n: a[0].carrier for n, found in self.areas.items() if (a := found[-1:])})

    def check_determined(self) -> None:
        """Refuse what the rows put where nothing carries it, or outside what holds it.

        Raises:
            LayoutError: names the rows that put it there, and by how much.
        """
        for name in self.names:
            for area in self.areas[name]:
                if area.kind == "base":
                    continue
                limits = room_in(self.world, name, area)
                offset = [self._offset(name, area, axis) for axis in (0, 1)]
                allowed = area.half if area.kind == "top" else limits
                for k, limit in enumerate(allowed):
                    off = _along(offset, k, area.yaw) - limit
                    if off > TOUCH:
                        raise self._misplaced(name, area, off)

    def _misplaced(self, name: str, area: Area, off: float) -> LayoutError:
        rows = [row for axis in (0, 1) for row in self._why(name, area, axis)]
        what = "its centre is not over what carries it" if area.kind == "top" else "it is not inside"
        by = "; ".join(dict.fromkeys(map(str, rows))) or "the poses given"
        return LayoutError(f"{area.row}: {what}, by {off:.3g} m; it is placed by {by}; change one of them")

    def _offset(self, name: str, area: Area, axis: int) -> float | None:
        terms = {(axis, name): 1.0, **({(axis, area.carrier): -1.0} if area.carrier else {})}
        total = self.system.reduce(terms)
        return None if total.terms else total.const - area.middle[axis]

    def _why(self, name: str, area: Area, axis: int) -> list[Row]:
        terms = {(axis, name): 1.0, **({(axis, area.carrier): -1.0} if area.carrier else {})}
        return [row for row, _ in self.system.reduce(terms).why]

    def troubled(self, places: Places, among: list[str]) -> set[str]:
        """The bodies among these that overlap another of them, or are not in their area, and are free to move."""
        found = set()
        for name in among:
            if any(not self._inside(name, area, places) for area in self.areas[name]):
                found.add(name)
        for a, b in self._overlaps(places, among):
            known = a in found and b in found  # where all stand in one place, this spares most of n^2 looks
            if not known and frozenset((a, b)) not in self.exempt and self._may_part(a, b):
                found |= {a, b}
        return found

    def _may_part(self, a: str, b: str) -> bool:
        """Whether the rows leave the two free against each other."""
        return any(self.system.value((k, a)).terms != self.system.value((k, b)).terms for k in (0, 1))

    def _inside(self, name: str, area: Area, places: Places) -> bool:
        if area.kind == "base" or all(self._offset(name, area, axis) is not None for axis in (0, 1)):
            return True  # the rows say where it is; `check_determined` has looked
        from_x, from_y = places[area.carrier] if area.carrier else (0.0, 0.0)
        x, y = places[name]
        along, across = turned((x - from_x - area.middle[0], y - from_y - area.middle[1]), -area.yaw)
        limit = room_in(self.world, name, area)
        return abs(along) <= limit[0] + TOUCH / 2 and abs(across) <= limit[1] + TOUCH / 2

    def _overlaps(self, places: Places, among: list[str]) -> Iterator[tuple[str, str]]:
        owners = [name for name in among for _ in self.parts.get(name, [])]
        if not owners:
            return
        boxes = [(places[name], box) for name in among for box in self.parts.get(name, [])]
        low = np.array([(b.low[0] + p[0], b.low[1] + p[1], b.low[2]) for p, b in boxes])
        high = np.array([(b.high[0] + p[0], b.high[1] + p[1], b.high[2]) for p, b in boxes])
        for i in range(len(owners) - 1):
            deep = np.minimum(high[i + 1 :], high[i]) - np.maximum(low[i + 1 :], low[i])
            for j in np.flatnonzero(deep.min(axis=1) > TOUCH).tolist():
                if owners[i] != owners[i + 1 + j]:
                    yield owners[i], owners[i + 1 + j]


def _along(offset: list[float | None], axis: int, yaw: float) -> float:
    """How far an offset reaches along an axis turned by `yaw`; 0 while the part of it that counts is open [m]."""
    u = turned((1.0, 0.0) if axis == 0 else (0.0, 1.0), yaw)
    total = 0.0
    for factor, value in zip(u, offset, strict=True):
        if abs(factor) > 1e-9:
            if value is None:
                return 0.0
            total += factor * value
    return abs(total)


def parts(world: World, name: str) -> list[Box]:
    """What is in the way of a body: boxes from its centre in the plane, at their heights in the world [m].

    It is the whole box, unless something is put in it: then it is its walls.
    """
    item, low = world.items[name], world.bottom[name]
    if name in world.holders and is_hollow(item):
        posed = item.model_copy(update={"pose": Pose(position=(0.0, 0.0, low), rotation_deg=world.rotation(name))})
        return [solid.box() for solid in convex(posed)]
    x, y, z = world.extents(name)
    return [Box((-x / 2, -y / 2, low), (x / 2, y / 2, low + z))]


def _in_the_way(world: World, name: str) -> bool:
    """A bridge's length hangs on where its ends are: it is looked at when all is placed."""
    return world.row(name, "SPAN") is None and world.items[name].registration.collision != "none"


def exempt(world: World, names: set[str]) -> set[frozenset[str]]:
    """Pairs whose boxes may overlap.

    They are bodies that a joint holds together; walls, floors and other background that stands still; what stands on a
    named surface inside the box of what carries it, a chair's seat for one, and what that carries in turn; what is in a
    hollow that stands askew, whose walls' boxes would fill it; what is in a free body of fluid.
    """
    found = {frozenset((joint.child, joint.parent)) for joint in world.plan.joints if joint.parent is not None}
    still = [n for n in sorted(names) if world.items[n].role in SCENERY and world.items[n].state == "static"]
    found |= {frozenset(pair) for pair in combinations(still, 2)}
    riders: dict[str, list[str]] = {}
    for name in world.bodies:
        below = rider_of(world, name)
        if below is not None:
            riders.setdefault(below, []).append(name)
    for name in names:
        row = support(world, name) if name not in world.kept else None
        if row is None or row.ref not in world.items or not _within(world, row):
            continue
        todo, seen = [name], set()
        while todo:
            one = todo.pop()
            if one not in seen:
                seen.add(one)
                todo += riders.get(one, [])
        found |= {frozenset((one, row.ref)) for one in seen if one != row.ref}
    return found


def _within(world: World, row: Row) -> bool:
    ref = row.ref or ""
    if ref not in world.bodies:
        return False
    if world.items[ref].primitive == "fluid":
        return True
    if row.predicate == "PLACE-IN":
        return abs(world.yaw[ref] % 90.0) > 1e-6
    if row.anchor is None:
        return False
    return top(world, ref, row.anchor) < world.bottom[ref] + world.extents(ref)[2] - TOUCH


def _depths(world: World, names: list[str], carriers: dict[str, str | None]) -> dict[str, int]:
    """How many bodies are below each; a wall or another background comes before all."""
    found: dict[str, int] = {}
    for start in names:
        path = []
        name: str | None = start
        while name is not None and name not in found and name not in path:
            path.append(name)
            name = carriers.get(name)
        depth = found.get(name, 0) if name is not None else -1
        for one in reversed(path):
            depth += 1
            found[one] = -1 if world.items[one].role == "background" and depth == 0 else depth
    return found
