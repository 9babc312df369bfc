"""One body after the other, each at the free place nearest to where it would best be.

For each box that is in the way there is a rectangle of places that a body cannot take. The nearest place left lies on
edges of such rectangles, so only their crossings are tried. It is quick, and enough unless space is tight: then one
body can take the place that another needs, and the solver (`free`) has to find an order.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wsim.plan.layout.areas import Area, room_in
from wsim.plan.layout.boxes import TOUCH, Box, turned
from wsim.plan.schema.predicates import GAP

if TYPE_CHECKING:
    from wsim.plan.layout.equations import System, Var
    from wsim.plan.layout.space import Places, Space

CHUNK = 4000  # places tried at once
MOST_EDGES = (20, 60, 160)  # of the edges along an axis, nearest first: as many as it takes
SLIVER = 1e-7  # [m]: a place on an edge is free


def place_nearby(
    space: Space, system: System, best: Places, loose: list[str], among: list[str], room: Box | None
) -> dict[Var, float] | None:
    """Values of the free coordinates of `loose` [m]; none if a body finds no place, or hangs on several coordinates.

    The arguments are those of `free.Search`; `room` is where what stands on the base stays.
    """
    turn = {name: k for k, name in enumerate(among)}
    order = sorted(loose, key=lambda n: (space.depth[n], -_footprint(space, n), turn[n]))
    for gap in (GAP, 0.0):  # with some air about each, if there is room for it
        filling = _Filling(space, system, best, loose, among, room, gap)
        if all(filling.place(name) for name in order):
            return filling.values
    return None


def _footprint(space: Space, name: str) -> float:
    x, y, _ = space.world.extents(name)
    return x * y


class _Filling:
    def __init__(
        self, space: Space, system: System, best: Places, loose: list[str], among: list[str], room: Box | None,
        gap: float,
    ) -> None:  # fmt: skip
        self.gap = gap
        self.space, self.system, self.best, self.room = space, system, best, room
        self.open = {var for name in loose for k in (0, 1) for var in system.value((k, name)).terms}
        self.values: dict[Var, float] = {}
        self.waiting = {name for name in among if self._unknown(name)}
        self.rank = {name: k for k, name in enumerate(space.names)}
        self.users: dict[Var, set[str]] = {}
        for name in self.waiting:
            for var in self._unknown(name):
                self.users.setdefault(var, set()).add(name)
        self.standing: list[tuple[str, Box]] = []
        for name in among:
            if name not in self.waiting:
                self._stand(name, best[name])

    def _unknown(self, name: str) -> set[Var]:
        return {
            v for k in (0, 1) for v in self.system.value((k, name)).terms if v in self.open and v not in self.values
        }

    def _stand(self, name: str, at: tuple[float, float]) -> None:
        for box in self.space.parts.get(name, []):
            low, high = (box.low[0] + at[0], box.low[1] + at[1]), (box.high[0] + at[0], box.high[1] + at[1])
            self.standing.append((name, Box((*low, box.low[2]), (*high, box.high[2]))))

    def place(self, name: str) -> bool:
        """Give a body's coordinates their values, and with them those of all that is tied to it."""
        unknown = self._unknown(name)
        if not unknown:
            return True
        axes = [self.system.value((k, name)).terms for k in (0, 1)]
        own: list[Var | None] = []
        for terms in axes:
            mine = [var for var in terms if var in unknown]
            if len(mine) > 1 or any(abs(abs(terms[var]) - 1.0) > 1e-9 for var in mine):
                return False
            own.append(mine[0] if mine else None)
        if own[0] is not None and own[0] == own[1]:
            return False
        users = set().union(*(self.users[var] for var in unknown)) & self.waiting
        tied = sorted((n for n in users if self._unknown(n) <= unknown), key=self.rank.__getitem__)
        found = self._nearest(name, own, tied)
        if found is None:
            return False
        for k, var in enumerate(own):
            if var is not None:
                terms = axes[k]
                rest = self._at(name)[k]  # with the unknown at zero
                self.values[var] = (found[k] - rest) / terms[var]
        for one in tied:
            self.waiting.discard(one)
            self._stand(one, self._at(one))
        return True

    def _at(self, name: str) -> tuple[float, float]:
        """A body's centre as far as it is known; what is unknown counts as zero."""
        place = []
        for k in (0, 1):
            total = self.system.value((k, name))
            value = total.const
            for var, factor in total.terms.items():
                value += factor * (self.values.get(var, 0.0) if var in self.open else self.best[var[1]][var[0]])
            place.append(value)
        return (place[0], place[1])

    def _nearest(self, name: str, own: list[Var | None], tied: list[str]) -> tuple[float, float] | None:
        """The nearest free centre of a body, for all that moves with it."""
        here, wish = self._at(name), self._wish(name)
        moves = [var is not None for var in own]
        factors = [self.system.value((k, name)).terms[var] if var else 0.0 for k, var in enumerate(own)]
        shifts = {}
        for one in tied:
            # How the other moves when this one does: with it, against it, or not at all.
            turns = [
                self.system.value((k, one)).terms.get(var, 0.0) / factors[k] if var is not None else 0.0
                for k, var in enumerate(own)
            ]
            crossed = [own[1 - k] in self.system.value((k, one)).terms for k in (0, 1) if own[1 - k] is not None]
            if any(crossed) or any(turn not in (0.0, 1.0, -1.0) for turn in turns):
                return None
            shifts[one] = turns
        limits = [bound for one in tied for bound in self._bounds(one, here, shifts[one])]
        return _first_free(wish, here, moves, self._blocked(tied, here, shifts), limits)

    def _wish(self, name: str) -> tuple[float, float]:
        """Where the body would best be: with its carrier, if that was moved."""
        for area in self.space.areas[name][:1]:
            if area.carrier is not None and not self._unknown(area.carrier):
                then, now = self.best[area.carrier], self._at(area.carrier)
                return (self.best[name][0] + now[0] - then[0], self.best[name][1] + now[1] - then[1])
        return self.best[name]

    def _blocked(
        self, tied: list[str], here: tuple[float, float], shifts: dict[str, list[float]]
    ) -> list[tuple[float, float, float, float]]:
        """Centres that the body cannot have: open rectangles x low, x high, y low, y high."""
        found = []
        for one in tied:
            at, (tx, ty) = self._at(one), shifts[one]
            for box in self.space.parts.get(one, []):
                for other, wall in self.standing:
                    if min(box.high[2], wall.high[2]) - max(box.low[2], wall.low[2]) <= TOUCH:
                        continue
                    if frozenset((one, other)) in self.space.exempt:
                        continue
                    spans = []
                    for k, turn in ((0, tx), (1, ty)):
                        low = wall.low[k] - self.gap - box.high[k] - at[k]
                        high = wall.high[k] + self.gap - box.low[k] - at[k]
                        if turn == 0.0:
                            spans += [-1e9, 1e9] if low < -SLIVER and high > SLIVER else [1e9, 1e9]
                        else:
                            ends = sorted((here[k] + low / turn, here[k] + high / turn))
                            spans += ends
                    if spans[0] < 1e9 and spans[2] < 1e9:
                        found.append((spans[0], spans[1], spans[2], spans[3]))
        return found

    def _bounds(
        self, one: str, here: tuple[float, float], turns: list[float]
    ) -> list[tuple[float, float, float, float]]:
        """Half planes a x + b y in [low, high] for the body's centre, from the areas of one that moves with it."""
        found = []
        at = self._at(one)
        for area in self.space.areas[one]:
            if area.kind == "base":
                found += self._in_room(one, at, here, turns)
                continue
            if area.carrier is not None and self._unknown(area.carrier):
                continue  # it moves as well: their distance is settled, or looked at when that one is placed
            middle = self._middle(area)
            for axis, limit in enumerate(room_in(self.space.world, one, area)):
                u = turned((1.0, 0.0) if axis == 0 else (0.0, 1.0), area.yaw)
                a, b = u[0] * turns[0], u[1] * turns[1]
                const = sum(u[k] * (at[k] - turns[k] * here[k] - middle[k]) for k in (0, 1))
                found.append((a, b, -limit - const, limit - const))
        return found

    def _in_room(
        self, one: str, at: tuple[float, float], here: tuple[float, float], turns: list[float]
    ) -> list[tuple[float, float, float, float]]:
        if self.room is None or self.space.world.items[one].role == "background":
            return []
        found = []
        for k in (0, 1):
            half = self.space.world.extents(one)[k] / 2
            rest = at[k] - turns[k] * here[k]
            bound = (self.room.low[k] + half - rest, self.room.high[k] - half - rest)
            found.append((turns[0] if k == 0 else 0.0, turns[1] if k == 1 else 0.0, *bound))
        return found

    def _middle(self, area: Area) -> tuple[float, float]:
        x, y = self._at(area.carrier) if area.carrier is not None else (0.0, 0.0)
        return (x + area.middle[0], y + area.middle[1])


def _first_free(
    wish: tuple[float, float],
    here: tuple[float, float],
    moves: list[bool],
    blocked: list[tuple[float, float, float, float]],
    limits: list[tuple[float, float, float, float]],
) -> tuple[float, float] | None:
    """The place nearest to the wish that no open rectangle holds and all half planes have."""
    rects = np.array(blocked).reshape(-1, 4)
    axes = [_edges(k, wish, here, rects, limits) if moves[k] else np.array([here[k]]) for k in (0, 1)]
    for most in MOST_EDGES:
        x, y = (grid.ravel() for grid in np.meshgrid(axes[0][:most], axes[1][:most], indexing="ij"))
        # Nothing that is left out is nearer than this.
        seen = min((abs(axes[k][most] - wish[k]) for k in (0, 1) if len(axes[k]) > most), default=np.inf)
        far = np.hypot(x - wish[0], y - wish[1])
        order = np.argsort(far, kind="stable")
        if most != MOST_EDGES[-1]:
            order = order[far[order] <= seen]
        for start in range(0, len(order), CHUNK):
            part = order[start : start + CHUNK]
            good = _inside(x[part], y[part], limits) & _clear(x[part], y[part], rects)
            if good.any():
                first = part[int(np.argmax(good))]
                return (float(x[first]), float(y[first]))
    return None


def _edges(
    k: int,
    wish: tuple[float, float],
    here: tuple[float, float],
    rects: Any,
    limits: list[tuple[float, float, float, float]],
) -> Any:
    """Coordinates along an axis where something ends, and the wish itself, nearest first."""
    bounds = [wish[k]]
    for a, b, low, high in limits:
        factor, other = (a, b) if k == 0 else (b, a)
        if abs(factor) > 1e-9 and abs(other) < 1e-9:
            ends = sorted((low / factor, high / factor))
            bounds += [*ends, min(max(wish[k], ends[0]), ends[1])]
    edges = np.concatenate([bounds, rects[:, 2 * k], rects[:, 2 * k + 1]])
    values = np.unique(np.round(edges[np.abs(edges) < 1e8], 6))
    return values[np.argsort(np.abs(values - wish[k]), kind="stable")]


def _inside(px: Any, py: Any, limits: list[tuple[float, float, float, float]]) -> Any:
    good = px == px
    for a, b, low, high in limits:
        value = a * px + b * py
        good = good & (value >= low - TOUCH / 2) & (value <= high + TOUCH / 2)
    return good


def _clear(px: Any, py: Any, rects: Any) -> Any:
    edge = 2e-6  # places are rounded to a micrometre
    hit = np.zeros(len(px), dtype=bool)
    near = rects[
        (rects[:, 0] < px.max()) & (rects[:, 1] > px.min()) & (rects[:, 2] < py.max()) & (rects[:, 3] > py.min())
    ]
    for x0, x1, y0, y1 in near:
        hit |= (px > x0 + edge) & (px < x1 - edge) & (py > y0 + edge) & (py < y1 - edge)
    return ~hit
