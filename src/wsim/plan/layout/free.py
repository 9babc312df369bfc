"""Places that hinder nothing, as a mixed-integer linear program, which SciPy's HiGHS solves.

Unknown are the coordinates that the rows leave free. Of two bodies that share a height one is left of the other, right
of it, before or behind it: a choice of four linear rows, of which the ones that are not chosen are lifted by more than
they can ask for ("big M"). Each body stays in its areas; together they stay as near as possible to where they would
best be, in the sum of the distances along X and Y. The search ends after a number of nodes: the same plan gives the
same places.
"""

from __future__ import annotations

import math
from collections import defaultdict
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from wsim.plan.layout.areas import Area, room_in
from wsim.plan.layout.boxes import TOUCH, Box, turned
from wsim.plan.rooms import between_walls

if TYPE_CHECKING:
    from wsim.plan.layout.equations import System, Var
    from wsim.plan.layout.space import Places, Space

SLACK = 1e-5  # by which what fits but for rounding may overlap [m]
ZERO = 1e-9
NEAR_NODES = 100  # of the search tree while it looks for the nearest places: a second for eight bodies on one tray
ANY_NODES = 250  # and for any places, if none were found on the way
LAST_RESORT = 60.0  # [s] for each: nodes end a search, and this only one that would hang
NEAR_ENOUGH = 0.02  # the share by which the sum of distances may be above the least
MOST_CHOICES = 1000  # more are not tried: dozens of bodies in one place are beyond the search
FEW = 40  # unknowns up to which the nearest places are looked for, and not just any
DIGITS = 6  # of the places [m]
INFEASIBLE = 2  # of the states that SciPy's solver ends in

Terms = dict[int, float]  # factors by the number of an unknown
Row = tuple[Terms, float, float]  # the sum of the terms is from one number to the other


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
        self.space, self.system, self.best, self.among = space, system, best, among
        self.free = sorted({var for name in loose for k in (0, 1) for var in system.value((k, name)).terms})
        self.number = {var: k for k, var in enumerate(self.free)}
        self.moving = [name for name in among if any(self._coordinate(k, name)[0] for k in (0, 1))]
        reach = self._reach()
        self.low, self.high = [-reach] * len(self.free), [reach] * len(self.free)
        self.whole = [0] * len(self.free)  # 1 for the unknowns that are 0 or 1
        self.cost = [0.0] * len(self.free)
        self.rows: list[Row] = []
        self.choices = 0
        self.impossible = False  # proven, so that to look further is of no use

    def run(self) -> dict[Var, float] | None:
        """The free coordinates [m]; none if there are no such places, or none were found in time."""
        self._stay_in_areas()
        if any(low > high for low, high in zip(self.low, self.high, strict=True)) or not self._stay_apart():
            return None
        if len(self.free) > FEW:
            return self._solve(ANY_NODES)
        self._stay_near()
        near = self._solve(NEAR_NODES)
        return near if near is not None or self.impossible else self._solve(ANY_NODES, anywhere=True)

    def _solve(self, nodes: int, anywhere: bool = False) -> dict[Var, float] | None:
        from scipy.optimize import Bounds, LinearConstraint, milp  # half a second, and few plans are so tight
        from scipy.sparse import csr_array  # likewise

        places = [(k, number) for k, (terms, _, _) in enumerate(self.rows) for number in terms]
        factors = [factor for terms, _, _ in self.rows for factor in terms.values()]
        shape = (len(self.rows), len(self.low))
        matrix = csr_array((factors, tuple(np.array(places, dtype=int).reshape(-1, 2).T)), shape=shape)
        found = milp(
            np.zeros(len(self.cost)) if anywhere else self.cost,
            integrality=self.whole,
            bounds=Bounds(self.low, self.high),
            constraints=LinearConstraint(matrix, [low for _, low, _ in self.rows], [high for _, _, high in self.rows]),
            options={"node_limit": nodes, "time_limit": LAST_RESORT, "mip_rel_gap": NEAR_ENOUGH},
        )
        self.impossible = found.status == INFEASIBLE
        if found.x is None:
            return None
        return {var: round(float(found.x[number]), DIGITS) for var, number in self.number.items()}

    def _reach(self) -> float:
        """How far from the origin anything may go [m]: beyond all there is, one after the other."""
        far = max((abs(value) for place in self.best.values() for value in place), default=0.0)
        return 2 * far + 2 * sum(sum(self.space.world.extents(name)[:2]) for name in self.moving) + 2.0

    def _coordinate(self, axis: int, name: str) -> tuple[Terms, float]:
        """A body's place along an axis: factors of the unknowns, and what it has beside them [m]."""
        total = self.system.value((axis, name))
        terms: Terms = {}
        const = total.const
        for var, factor in total.terms.items():
            if var in self.number:
                terms[self.number[var]] = factor
            else:
                const += factor * self.best[var[1]][var[0]]
        return terms, const

    def _apart(self, axis: int, name: str, other: str) -> tuple[Terms, float]:
        """How far a body is from another along an axis, likewise."""
        (terms, const), (others, other_const) = self._coordinate(axis, name), self._coordinate(axis, other)
        total = defaultdict(float, terms)
        for number, factor in others.items():
            total[number] -= factor
        return {number: factor for number, factor in total.items() if abs(factor) > ZERO}, const - other_const

    def _unknown(self, low: float, high: float, *, whole: bool = False, cost: float = 0.0) -> int:
        self.low.append(low)
        self.high.append(high)
        self.whole.append(int(whole))
        self.cost.append(cost)
        return len(self.low) - 1

    # Areas ---------------------------------------------------------------------------------------------------------

    def _stay_in_areas(self) -> None:
        room = room_of(self.space, self.best, self.among)
        for name in self.moving:
            for area in self.space.areas[name]:
                if area.kind != "base":
                    self._stay_in(name, area)
                elif room is not None and self.space.world.items[name].role != "background":
                    for axis in (0, 1):
                        terms, const = self._coordinate(axis, name)
                        half = self.space.world.extents(name)[axis] / 2
                        low, high = room.low[axis] + half - const, room.high[axis] - half - const
                        if low <= high:
                            self._between(terms, low, high)

    def _stay_in(self, name: str, area: Area) -> None:
        """Two bounds along the area's own axes, which are the world's unless the carrier is askew."""
        limits = room_in(self.space.world, name, area)
        offset = [self._apart(k, name, area.carrier) if area.carrier else self._coordinate(k, name) for k in (0, 1)]
        for axis, limit in enumerate(limits):
            u = turned((1.0, 0.0) if axis == 0 else (0.0, 1.0), area.yaw)
            terms: Terms = defaultdict(float)
            const = 0.0
            for k in (0, 1):
                for number, factor in offset[k][0].items():
                    terms[number] += u[k] * factor
                const += u[k] * (offset[k][1] - area.middle[k])
            self._between(terms, -limit - const, limit - const)

    def _between(self, terms: Terms, low: float, high: float) -> None:
        """A row, or the bounds of an unknown that is alone; what has no unknowns is as it is."""
        terms = {number: factor for number, factor in terms.items() if abs(factor) > ZERO}
        if len(terms) == 1:
            ((number, factor),) = terms.items()
            ends = sorted(((low - SLACK) / factor, (high + SLACK) / factor))
            self.low[number] = max(self.low[number], ends[0])
            self.high[number] = min(self.high[number], ends[1])
        elif terms:
            self.rows.append((terms, low - SLACK, high + SLACK))

    # No overlap ----------------------------------------------------------------------------------------------------

    def _stay_apart(self) -> bool:
        """A choice for each two boxes that must be apart; false if two have none, or if there are too many."""
        moving = set(self.moving)
        parts = [(name, box) for name in self.among for box in self.space.parts.get(name, [])]
        for (name, box), (other, wall) in combinations(parts, 2):
            if name == other or not {name, other} & moving or frozenset((name, other)) in self.space.exempt:
                continue
            if min(box.high[2], wall.high[2]) - max(box.low[2], wall.low[2]) <= TOUCH:
                continue
            if not self._choose(name, box, other, wall) or self.choices > MOST_CHOICES:
                return False
        return True

    def _choose(self, name: str, box: Box, other: str, wall: Box) -> bool:
        offsets = [self._apart(k, name, other) for k in (0, 1)]
        if not any(terms for terms, _ in offsets):
            return True  # the rows say how they are to each other
        sides: list[tuple[Terms, float, float]] = []  # terms + const <= 0 is the side; at most so much else
        for k, (terms, const) in enumerate(offsets):
            for sign, reaches in ((1.0, box.high[k] - wall.low[k]), (-1.0, wall.high[k] - box.low[k])):
                signed = {number: sign * factor for number, factor in terms.items()}
                over = sign * const + reaches - SLACK
                least, most = self._span(signed)
                if most + over <= ZERO:
                    return True  # wherever they go
                if least + over <= ZERO:
                    sides.append((signed, over, most + over))
        chosen: Terms = {}
        for terms, over, most in sides:
            number = self._unknown(0.0, 1.0, whole=True)
            chosen[number] = 1.0
            self.rows.append(({**terms, number: most}, -math.inf, most - over))
        self.rows.append((chosen, 1.0, 1.0))
        self.choices += 1
        return bool(sides)

    def _span(self, terms: Terms) -> tuple[float, float]:
        """The least and the most that terms can add up to."""
        ends = [sorted((factor * self.low[n], factor * self.high[n])) for n, factor in terms.items()]
        return sum(low for low, _ in ends), sum(high for _, high in ends)

    # Nearness ------------------------------------------------------------------------------------------------------

    def _stay_near(self) -> None:
        """A distance along X and Y from the best places, one for each coordinate that moves alone."""
        seen = set()
        for name in self.moving:
            for axis in (0, 1):
                terms, const = self._coordinate(axis, name)
                key = frozenset(terms.items())
                if not terms or key in seen:
                    continue
                seen.add(key)
                target = self.best[name][axis] - const
                distance = self._unknown(0.0, math.inf, cost=1.0)
                self.rows.append(({**terms, distance: -1.0}, -math.inf, target))
                self.rows.append(({**terms, distance: 1.0}, target, math.inf))


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
