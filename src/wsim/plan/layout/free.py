"""Places that hinder nothing, found by constraint programming (OR-tools CP-SAT) on a grid of millimetres.

Unknown are the coordinates that the rows leave free. Bodies that share a height must not overlap in the plane; each
stays in its areas; together they stay as near as possible to where they would best be. One worker, a fixed seed and a
limit in deterministic time: the same plan gives the same places.
"""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from wsim.plan.layout.areas import Area, room_in
from wsim.plan.layout.boxes import TOUCH, Box, turned
from wsim.plan.rooms import between_walls

if TYPE_CHECKING:
    from wsim.plan.layout.equations import System, Var
    from wsim.plan.layout.space import Places, Space

MM = 1000.0
SLACK = 0.4  # by which a box, or an area's edge, may be rounded in favour of a fit [mm]
PATIENCE = 0.1  # deterministic time; from once to ten times as long in seconds
LAST_RESORT = 0.6  # [s]: with coordinates of many digits deterministic time may stand almost still
NEARER = 0.05  # the same, to come nearer to the best places
FEW = 40  # unknowns up to which the nearest places are looked for, and not just any
FINE = 1000  # factors that are no whole numbers are rounded to a thousandth

Rect = tuple[int, int, int, int]  # x low, y low, x high, y high [mm]


@dataclass(frozen=True)
class _Group:
    """Bodies whose places differ by constants: the sums of free coordinates that they share."""

    x: tuple[tuple[Var, float], ...]
    y: tuple[tuple[Var, float], ...]


class Search:
    """One problem: where `loose` bodies go among others.

    Args:
        space: Boxes, areas and pairs that may overlap.
        system: What is settled; its free coordinates are the unknowns.
        best: Where each body would best be [m].
        loose: The bodies to place.
        among: The bodies that are looked at; those that do not move with `loose` stay at their best place.
    """

    def __init__(self, space: Space, system: System, best: Places, loose: list[str], among: list[str]) -> None:
        from ortools.sat.python import cp_model  # takes 0.6 s to import

        self.cp: Any = cp_model
        self.space, self.system, self.best, self.among = space, system, best, among
        self.free = {var for name in loose for k in (0, 1) for var in system.value((k, name)).terms}
        self.moving = [name for name in among if self._moves(name)]
        self.model: Any = cp_model.CpModel()
        self.reach = self._reach()
        self.unknowns: dict[Var, Any] = {}
        for var in sorted(self.free):
            self.unknowns[var] = self.model.new_int_var(-self.reach, self.reach, f"{var}")
            self.model.add_hint(self.unknowns[var], round(best[var[1]][var[0]] * MM))
        self._sums: dict[tuple[tuple[Var, float], ...], Any] = {}

    def run(self, patience: float = PATIENCE) -> dict[Var, float] | None:
        """The free coordinates [m]; none if there are no such places, or none were found in time."""
        self._stay_in_areas()
        self._stay_apart()
        found = self._solve(patience)
        if found is None or len(self.unknowns) > FEW:
            return found
        # Any places first, then the nearest: looking for both at once may spend all its time and have neither.
        self.model.clear_hints()
        for var, value in found.items():
            self.model.add_hint(self.unknowns[var], round(value * MM))
        self._stay_near()
        return self._solve(NEARER) or found

    def _solve(self, patience: float) -> dict[Var, float] | None:
        solver = self.cp.CpSolver()
        solver.parameters.num_workers = 1
        solver.parameters.random_seed = self.space.world.plan.simulation.seed % 2**31
        solver.parameters.max_deterministic_time = patience
        solver.parameters.max_time_in_seconds = LAST_RESORT
        status = solver.solve(self.model)
        if status not in (self.cp.OPTIMAL, self.cp.FEASIBLE):
            return None
        return {var: solver.value(unknown) / MM for var, unknown in self.unknowns.items()}

    def _moves(self, name: str) -> bool:
        return any(var in self.free for k in (0, 1) for var in self.system.value((k, name)).terms)

    def _reach(self) -> int:
        """How far from the origin anything may go [mm]: beyond all there is, one after the other."""
        far = max((abs(value) for place in self.best.values() for value in place), default=0.0)
        edges = sum(sum(self.space.world.extents(name)[:2]) for name in self.moving)
        return math.ceil((2 * far + 2 * edges + 2.0) * MM)

    def _key(self, axis: int, name: str) -> tuple[tuple[Var, float], ...]:
        terms = self.system.value((axis, name)).terms
        return tuple(sorted((var, factor) for var, factor in terms.items() if var in self.free))

    def _const(self, axis: int, name: str) -> float:
        """What a coordinate has beside the unknowns [mm]: its constant, and free coordinates that stay."""
        total = self.system.value((axis, name))
        stays = sum(f * self.best[var[1]][var[0]] for var, f in total.terms.items() if var not in self.free)
        return (total.const + stays) * MM

    def _sum(self, key: tuple[tuple[Var, float], ...]) -> Any:
        """The unknown part of a coordinate as one whole number [mm]."""
        if key not in self._sums:
            if all(abs(factor - round(factor)) < 1e-9 for _, factor in key):
                self._sums[key] = sum(round(factor) * self.unknowns[var] for var, factor in key)
            else:
                whole = self.model.new_int_var(-4 * self.reach, 4 * self.reach, "sum")
                fine = sum(round(FINE * factor) * self.unknowns[var] for var, factor in key)
                self.model.add_linear_constraint(FINE * whole - fine, -FINE // 2, FINE // 2)
                self._sums[key] = whole
        return self._sums[key]

    # Areas ---------------------------------------------------------------------------------------------------------

    def _stay_in_areas(self) -> None:
        room = room_of(self.space, self.best, self.among)
        for name in self.moving:
            for area in self.space.areas[name]:
                if area.kind != "base":
                    self._stay_in(name, area)
                elif room is not None and self.space.world.items[name].role != "background":
                    half = [edge / 2 for edge in self.space.world.extents(name)[:2]]
                    for axis in (0, 1):
                        low = (room.low[axis] + half[axis]) * MM - self._const(axis, name)
                        high = (room.high[axis] - half[axis]) * MM - self._const(axis, name)
                        key = self._key(axis, name)
                        if key and low <= high:
                            self._between(self._sum(key), low, high)

    def _stay_in(self, name: str, area: Area) -> None:
        """Two bounds along the area's own axes, which are the world's unless the carrier is askew."""
        limits = room_in(self.space.world, name, area)
        offset = [self._relative(axis, name, area) for axis in (0, 1)]
        if not any(terms for terms, _ in offset):
            return
        for axis, limit in enumerate(limits):
            u = turned((1.0, 0.0) if axis == 0 else (0.0, 1.0), area.yaw)
            terms: dict[Var, float] = defaultdict(float)
            const = 0.0
            for k in (0, 1):
                for var, factor in offset[k][0].items():
                    terms[var] += u[k] * factor
                const += u[k] * offset[k][1]
            whole = all(abs(f - round(f)) < 1e-9 for f in terms.values())
            scale = 1 if whole else FINE
            total = sum(round(scale * f) * self.unknowns[var] for var, f in terms.items())
            if any(round(scale * f) for f in terms.values()):
                self._between(total, scale * (-limit * MM - const), scale * (limit * MM - const), scale)

    def _relative(self, axis: int, name: str, area: Area) -> tuple[dict[Var, float], float]:
        """A body's place from an area's middle: factors of the unknowns, and the rest [mm]."""
        terms = dict(self._key(axis, name))
        const = self._const(axis, name) - area.middle[axis] * MM
        if area.carrier is not None:
            for var, factor in self._key(axis, area.carrier):
                terms[var] = terms.get(var, 0.0) - factor
            const -= self._const(axis, area.carrier)
        return {var: f for var, f in terms.items() if abs(f) > 1e-9}, const

    def _between(self, total: Any, low: float, high: float, scale: int = 1) -> None:
        slack = SLACK * scale
        self.model.add_linear_constraint(total, math.ceil(low - slack), math.floor(high + slack))

    # No overlap ----------------------------------------------------------------------------------------------------

    def _stay_apart(self) -> None:
        parts = [(name, box) for name in self.among for box in self.space.parts.get(name, [])]
        moving = set(self.moving)
        seen: set[frozenset[int]] = set()
        for height in sorted({box.low[2] for _, box in parts}):
            level = height + TOUCH
            here = frozenset(i for i, (_, box) in enumerate(parts) if box.low[2] < level < box.high[2] - TOUCH / 2)
            if any(here <= other for other in seen) or not any(parts[i][0] in moving for i in here):
                continue
            seen.add(here)
            for group in self._separable([parts[i] for i in sorted(here)]):
                self._no_overlap(group)

    def _separable(self, parts: list[tuple[str, Box]]) -> list[list[tuple[str, Box]]]:
        """Sets that cover every pair of bodies that must be apart, and no pair that may overlap."""
        names = {name for name, _ in parts}
        pairs = [pair for pair in self.space.exempt if pair <= names]
        if not pairs:
            return [parts]
        often: dict[str, int] = defaultdict(int)
        for pair in pairs:
            for name in pair:
                often[name] += 1
        odd: list[str] = []  # each exempt pair has one of them: what carries many first
        for pair in sorted(pairs, key=lambda p: (-max(often[n] for n in p), sorted(p))):
            if not pair & set(odd):
                odd.append(max(sorted(pair), key=lambda n: often[n]))
        plain = [part for part in parts if part[0] not in odd]
        sets = [plain]
        for k, name in enumerate(odd):
            own = [part for part in parts if part[0] == name]
            sets.append(own + [part for part in plain if frozenset((name, part[0])) not in self.space.exempt])
            for other in odd[:k]:
                if frozenset((name, other)) not in self.space.exempt:
                    sets.append(own + [part for part in parts if part[0] == other])
        return sets

    def _no_overlap(self, parts: list[tuple[str, Box]]) -> None:
        rects: dict[_Group, list[Rect]] = defaultdict(list)
        for name, box in parts:
            x, y = self._const(0, name), self._const(1, name)
            rect = (
                math.floor(box.low[0] * MM + x + SLACK),
                math.floor(box.low[1] * MM + y + SLACK),
                math.ceil(box.high[0] * MM + x - SLACK),
                math.ceil(box.high[1] * MM + y - SLACK),
            )
            rects[_Group(self._key(0, name), self._key(1, name))] += [rect]
        if len(rects) < 2:
            return
        x_intervals, y_intervals = [], []
        for group, found in rects.items():
            for x0, y0, x1, y1 in disjoint(found):
                x_intervals.append(self._interval(group.x, x0, x1))
                y_intervals.append(self._interval(group.y, y0, y1))
        self.model.add_no_overlap_2d(x_intervals, y_intervals)

    def _interval(self, key: tuple[tuple[Var, float], ...], low: int, high: int) -> Any:
        start = self._sum(key) + low if key else low
        single = not key or (len(key) == 1 and abs(abs(key[0][1]) - 1.0) < 1e-9)
        if not single:  # an interval starts at one unknown and a constant
            begin = self.model.new_int_var(-8 * self.reach, 8 * self.reach, "begin")
            self.model.add(begin == start)
            start = begin
        return self.model.new_fixed_size_interval_var(start, high - low, "")

    # Nearness ------------------------------------------------------------------------------------------------------

    def _stay_near(self) -> None:
        """Least sum of the distances along X and Y from the best places, one for each coordinate that moves alone."""
        off = []
        seen = set()
        for name in self.moving:
            for axis in (0, 1):
                key = self._key(axis, name)
                if not key or key in seen:
                    continue
                seen.add(key)
                target = round(self.best[name][axis] * MM - self._const(axis, name))
                distance = self.model.new_int_var(0, 8 * self.reach, "off")
                self.model.add_abs_equality(distance, self._sum(key) - target)
                off.append(distance)
        self.model.minimize(sum(off))


def room_of(space: Space, best: Places, among: list[str]) -> Box | None:
    """The room between the static background boxes that have a place."""
    walls = []
    for name in among:
        item = space.world.items[name]
        if item.role == "background" and item.state == "static":
            x, y = best[name]
            for box in space.parts.get(name, []):
                low, high = (box.low[0] + x, box.low[1] + y), (box.high[0] + x, box.high[1] + y)
                walls.append(Box((*low, box.low[2]), (*high, box.high[2])))
    return between_walls(walls)


def disjoint(rects: list[Rect]) -> list[Rect]:
    """Rectangles that cover the same, and do not overlap each other."""
    found: list[Rect] = []
    for rect in rects:
        pieces = [rect]
        for other in found:
            pieces = [rest for piece in pieces for rest in _without(piece, other)]
        found += pieces
    return found


def _without(a: Rect, b: Rect) -> list[Rect]:
    """What of one rectangle is not in the other."""
    ax0, ay0, ax1, ay1 = a
    bx0, by0, bx1, by1 = b
    if ax1 <= bx0 or bx1 <= ax0 or ay1 <= by0 or by1 <= ay0:
        return [a]
    low, high = max(ay0, by0), min(ay1, by1)
    rests = [(ax0, ay0, ax1, by0), (ax0, by1, ax1, ay1), (ax0, low, bx0, high), (bx1, low, ax1, high)]
    return [(x0, y0, x1, y1) for x0, y0, x1, y1 in rests if x1 > x0 and y1 > y0]
