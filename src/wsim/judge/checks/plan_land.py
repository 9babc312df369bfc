"""Checks of the stage's terrain, and of what is scattered on it, against the plan's."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.geometry.shapes import kind_of
from wsim.judge.checks.check import Checks, listed
from wsim.judge.checks.counterparts import Comparing
from wsim.judge.verdict import RepairTarget
from wsim.plan.authored import asset_of
from wsim.plan.layout.land import divided, survey
from wsim.plan.schema import FromScatter, FromTerrain
from wsim.scene.rocks import FLATTEST, STANDS
from wsim.scene.world import Shape, Static

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import ArrayLike, NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import PlanObject
    from wsim.scene.terrain import Terrain

    Floats = NDArray[np.float64]

# Places of a cell along x and along y: of each of its triangles one at least, on no line of a grid or across one.
_PLACES = (np.array([0.2618, 0.7291]), np.array([0.2137, 0.7764]))
_DIRECTIONS = np.array([(math.cos(k * math.pi / 16), math.sin(k * math.pi / 16)) for k in range(32)]).T
LAYERS, SCATTER = "the plan's terrain", "the plan's scatter"


@dataclass
class CheckPlanTerrain(Comparing):
    """Terrain is one solid ground, as wide and as high as the plan's layers make it, its areas where the plan's are."""

    of_world = True

    height: float = 0.05  # [m]: of the ground anywhere, and of where it ends
    covered: float = 0.02  # of its area
    edge: float = 0.25  # of a cell, by which an area may be wider all round

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each thing that differs, or one for none."""
        items = evidence.plan.objects if evidence.plan is not None else []
        made = {static.prim: static for static in evidence.world.statics}
        lands = [item for item in items if item.primitive == "terrain" and evidence.prim(item.name) in made]
        found = [f for item in lands for f in self._land(evidence, made[evidence.prim(item.name)], item)]
        return found or ([self.passed("Terrain is as the plan's layers make it")] if lands else [])

    def _land(self, evidence: Evidence, made: Static, item: PlanObject) -> Iterator[Finding]:
        assert isinstance(item.built, FromTerrain)
        solid = [shape for shape in made.shapes if shape.kind == "mesh" and shape.collides and shape.exact]
        if len(solid) < len(made.shapes) or not solid:
            yield self._other(made, "is not solid ground whose triangles collide, which the plan's terrain is")
            return
        if others := [*self._parts(evidence, made, item)]:
            yield from others
            return
        if evidence.varied:
            return
        tops = [_Top.of(shape) for shape in solid]
        area, covered = math.prod(item.built.extent), sum(float(top.areas.sum()) for top in tops)
        if abs(covered / area - 1.0) > self.covered:
            yield self._other(made, f"covers {covered:.4g} m^2; the plan's terrain {area:.4g} m^2")
            return
        ground, points = survey(item), np.concatenate([top.points for top in tops])
        half, wide = 0.5 * np.array(item.built.extent), np.max([top.wide for top in tops], axis=0)
        cell = 2.0 * half / ground.cells[::-1]
        if (wide > 1.01 * cell).any():
            yield self._other(
                made, f"has triangles of {listed(tuple(wide))} m; the plan's cells are {cell.max():.3g} m"
            )
            return
        ends = np.concatenate([points[:, :2].min(axis=0) + half, points[:, :2].max(axis=0) - half])
        if np.abs(ends).max() > self.height:
            yield self._other(made, f"ends up to {np.abs(ends).max():.3g} m from where the plan's terrain does")
            return
        yield from self._high(made, points, np.concatenate([top.upper for top in tops]), ground, half)
        yield from self._once(made, np.concatenate([top.flat for top in tops]), ground.cells, half)
        yield from self._areas(made, item, tops)

    def _parts(self, evidence: Evidence, made: Static, item: PlanObject) -> Iterator[Finding]:
        """Meshes that are no part of the plan's ground, and parts that are missing."""
        assert isinstance(item.built, FromTerrain)
        names = ["geometry", *(area.name for area in item.built.areas)]
        parts = [shape.prim.removeprefix(f"{made.prim}/") for shape in made.shapes]
        for name in sorted({part for part in parts if part not in names or parts.count(part) > 1}):
            yield self.differs(made.prim, f"has a part {name} that {LAYERS} has not", LAYERS, "shape", "remove")
        lacks = [] if evidence.varied else [names[k] for k in np.unique(divided(item)) if names[k] not in parts]
        for name in lacks:
            yield self._other(made, f"has no part {name}, which the plan's terrain has")

    def _high(
        self, made: Static, points: Floats, upper: NDArray[np.bool_], ground: Terrain, half: Floats
    ) -> Iterator[Finding]:  # fmt: skip
        """Whether its upper side is as high as the plan's, and nothing of it is above that."""
        x, y = np.clip(points[:, :2], -half, half).T
        above = points[:, 2] - ground.heights(x, y)
        off = np.where(upper, np.abs(above), np.maximum(above, 0.0))
        worst = int(off.argmax())
        if off[worst] > self.height:
            yield self.measured(
                f"{made.prim} is not as high as the plan's layers make it: at "
                f"{listed(tuple(float(v) for v in points[worst]))} m it is {off[worst]:.3g} m off",
                float(off[worst]), self.height, "m", expected=0.0, prim=made.prim, time=0.0,
                limit_from="the plan's layers",
                target=RepairTarget(kind="geometry", prim=made.prim, parameter="layers", direction="change"),
            )  # fmt: skip

    def _once(self, made: Static, flat: Floats, cells: tuple[int, int], half: Floats) -> Iterator[Finding]:
        """Whether there is ground at each place of the plan's cells, and once; `flat`: its triangles from above."""
        x, y = (edge * (2.0 * ((np.arange(n)[:, None] + at) / n).ravel() - 1.0)
                for edge, n, at in zip(half, cells[::-1], _PLACES, strict=True))  # fmt: skip
        times = _covered(flat, x, y)
        inner = np.ix_(np.abs(y) < half[1] - self.height, np.abs(x) < half[0] - self.height)
        if (other := times[inner] != 1).any():
            j, i = np.argwhere(other)[0]
            at = f"({x[inner[1].ravel()][i]:.3g}, {y[inner[0].ravel()][j]:.3g}) m"
            says = f"has {times[inner][j, i]} surfaces to stand on at {at}, as at {other.mean():.1%} of its places"
            yield self._other(made, f"{says}; the plan's terrain has one everywhere")

    def _areas(self, made: Static, item: PlanObject, tops: list[_Top]) -> Iterator[Finding]:
        """Whether each part of the ground is in the area that the plan has there."""
        assert isinstance(item.built, FromTerrain)
        areas, wanted = item.built.areas, divided(item)
        numbers = {area.name: k + 1 for k, area in enumerate(areas)}
        middles, size = np.concatenate([top.middles for top in tops]), np.concatenate([top.areas for top in tops])
        has = np.concatenate([np.full(len(top.areas), numbers.get(top.name, 0)) for top in tops])
        rows, columns = wanted.shape
        i, j = (
            np.clip(((middles[:, k] / edge + 0.5) * n).astype(int), 0, n - 1)
            for k, (edge, n) in enumerate(zip(item.built.extent, (columns, rows), strict=True))
        )
        planned, cell = wanted[j, i], item.built.extent[0] / columns
        for k, area in enumerate(areas):
            off = float(size[(planned == k + 1) != (has == k + 1)].sum())
            length = sum(math.dist(a, b) for a, b in pairwise(area.points))
            limit = self.edge * cell * 2.0 * (length + area.width)
            if off > limit:
                yield self.measured(
                    f"{made.prim}: its area {area.name} is not where the plan has it, by {off:.3g} of "
                    f"{size[planned == k + 1].sum():.3g} m^2",
                    off, limit, "m^2", expected=0.0, prim=made.prim, time=0.0,
                    limit_from=f"{self.edge:g} of a cell along its edges",
                    target=RepairTarget(kind="geometry", prim=made.prim, parameter=area.name, direction="change"),
                )  # fmt: skip

    def _other(self, made: Static, says: str) -> Finding:
        return self.differs(made.prim, says, LAYERS, "shape")


@dataclass(frozen=True)
class _Top:
    """A part of the ground: its corners, which of them its upper side has, and the triangles of that."""

    name: str
    points: Floats  # (corners, 3) [m]
    upper: NDArray[np.bool_]  # (corners,)
    middles: Floats  # (triangles, 3) [m]
    areas: Floats  # (triangles,), from above [m^2]
    flat: Floats  # (triangles, 3 corners, 2), from above [m]
    wide: Floats  # (2,): of any triangle, upper or not, along x and y at most [m]

    @classmethod
    def of(cls, shape: Shape) -> _Top:
        points, triangles = _in_world(shape), np.asarray(shape.triangles)
        corners = points[triangles]
        a, b, c = (corners[:, k] for k in range(3))
        twice = _cross(b - a, c - a)
        up = twice > 0.0
        upper = np.zeros(len(points), dtype=bool)
        upper[triangles[up]] = True
        wide = np.ptp(corners[:, :, :2], axis=1).max(axis=0)
        return cls(
            shape.prim.rsplit("/", 1)[-1], points, upper, corners[up].mean(axis=1), 0.5 * twice[up],
            corners[up][:, :, :2], wide,
        )  # fmt: skip


def _cross(one: Floats, other: Floats) -> Floats:
    """Of vectors from above: positive where the other is to the left."""
    return np.asarray(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])


def _covered(flat: Floats, x: Floats, y: Floats) -> NDArray[np.int64]:
    """How many of the triangles are over each place (len(y), len(x)) of a grid [m], none wider than a few of these."""
    times = np.zeros((len(y), len(x)), dtype=np.int64)
    low, high = flat.min(axis=1), flat.max(axis=1)
    first, last = ([np.searchsorted(line, end[:, k]) for k, line in enumerate((x, y))] for end in (low, high))
    for i in range(int((last[0] - first[0]).max(initial=0))):
        for j in range(int((last[1] - first[1]).max(initial=0))):
            near = (first[0] + i < last[0]) & (first[1] + j < last[1])
            column, row, corners = first[0][near] + i, first[1][near] + j, flat[near]
            at = np.stack([x[column], y[row]], axis=-1)
            ends = [(corners[:, k], corners[:, (k + 1) % 3]) for k in range(3)]
            inside = np.all([_cross(end - start, at - start) > 0.0 for start, end in ends], axis=0)
            np.add.at(times, (row[inside], column[inside]), 1)
    return times


@dataclass
class CheckPlanScatter(Comparing):
    """What is scattered is of the plan's sort and size, lies on the terrain, and keeps away from what the plan says."""

    of_world = True

    near: float = 0.1  # [m]: of where it may be
    least: float = 0.1  # of a rock's least length, whose corners leave some of it out
    lies: float = 0.5  # of its height, that is above the ground at least
    part: float = 0.01  # [m]: of where a part of a thing of the catalogue is on it

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each thing that is otherwise, or one for none."""
        items = {item.name: item for item in evidence.plan.objects} if evidence.plan is not None else {}
        spread = [item for item in items.values() if isinstance(item.built, FromScatter)]
        solid = {static.prim: static for static in evidence.world.statics if static.shapes}
        found: list[Finding] = []
        for item in spread if not evidence.varied else ():
            assert isinstance(item.built, FromScatter)
            made = [solid[prim] for name in item.prims if (prim := evidence.prim(name)) in solid]
            things = [_Thing.of(each) for each in made]
            for k, thing in enumerate(things):
                faults = [
                    *(self._stone(thing, item) if item.rocks else self._sort(thing, item.built.what)),
                    *self._clear(thing, item.built),
                    *self._lies(thing, items[item.built.on], item.rocks),
                    *self._apart(thing, things[:k]),
                ]
                found += faults[:1]
        return found or ([self.passed("What is scattered is as the plan has it")] if spread else [])

    def _stone(self, thing: _Thing, item: PlanObject) -> Iterator[Finding]:
        assert isinstance(item.built, FromScatter)
        shapes, (low, high) = thing.made.shapes, item.built.size
        if [(shape.kind, shape.collides, shape.exact) for shape in shapes] != [("mesh", True, True)]:
            yield self.differs(thing.prim, "is no rock, one solid mesh", SCATTER, "shape")
            return
        stone = shapes[0].model_copy(update={"prim": thing.prim})
        long, bounds = max(stone.size), (low * (1.0 - self.least), high * (1.0 + self.share))
        if not bounds[0] <= long <= bounds[1]:
            yield self.between(
                f"{thing.prim} is {long:.3g} m long; the plan's rocks {low:g} to {high:g} m", long, bounds, "m",
                expected=0.5 * (low + high), prim=thing.prim, time=0.0, limit_from="the plan's size",
                target=RepairTarget(kind="geometry", prim=thing.prim, parameter="size"),
            )  # fmt: skip
        flat, limit = min(stone.size), FLATTEST * (1.0 - self.least) * long
        if flat < limit:
            yield self.measured(
                f"{thing.prim} is {flat:.3g} m across where it is least; the plan's rocks of {long:.3g} m are "
                f"{limit:.3g} m or more", flat, limit, "m", at_most=False, expected=FLATTEST * long, prim=thing.prim,
                time=0.0, limit_from=f"{FLATTEST:g} of its length",
                target=RepairTarget(kind="geometry", prim=thing.prim, parameter="size", direction="change"),
            )  # fmt: skip
        yield from self._upright(thing, stone.rotation)
        # What a material of the plan gives it CheckPlanLooks asks.
        given = Shape(prim="", kind="mesh", size=stone.size) if item.material is None else stone
        yield from self.surface(stone, given.model_copy(update={"surface_velocity": (0.0, 0.0, 0.0)}), SCATTER)

    def _upright(self, thing: _Thing, turn: ArrayLike) -> Iterator[Finding]:
        lean = math.degrees(math.acos(max(-1.0, min(1.0, float(rotate(np.array(turn), np.eye(3)[2])[2])))))
        if lean > self.turn:
            yield self.turned(thing.prim, "leans", lean, SCATTER, "rotation_deg")

    def _sort(self, thing: _Thing, what: tuple[str, ...]) -> Iterator[Finding]:
        """Whether it is one of these things of the catalogue; what is told is how it differs from the likest."""
        unlike = min(([*self._unlike(thing, asset)] for asset in what), key=len)
        for each in unlike[:1]:
            says = f"is no {' or '.join(what)} as the catalogue has it: {each.message}"
            yield self.differs(thing.prim, says, SCATTER, "shape")

    def _unlike(self, thing: _Thing, asset: str) -> Iterator[Finding]:
        """How it differs from a thing of the catalogue that is put where it is, turned about the vertical as it is."""
        made, wanted = thing.made.shapes, asset_of(asset)
        if not wanted:
            yield self.differs(thing.prim, f"is not {asset}, which is no one thing of the catalogue", SCATTER, "shape")
            return
        turn = multiply(np.array(made[0].rotation), conjugate(np.array(wanted[0].rotation)))
        place = np.array(made[0].position) - rotate(turn, np.array(wanted[0].position))
        put = [
            shape.model_copy(update={
                "position": tuple((place + rotate(turn, np.array(shape.position))).tolist()),
                "rotation": tuple(multiply(turn, np.array(shape.rotation)).tolist()),
            })
            for shape in wanted
        ]  # fmt: skip
        yield from self._upright(thing, turn)
        yield from self.shapes(thing.prim, made, put, self.part, f"the catalogue's {asset}")

    def _lies(self, thing: _Thing, land: PlanObject, rock: bool) -> Iterator[Finding]:
        """Whether it is on the ground, and neither over nor under it.

        A rock lies in the ground at its middle; a thing of the catalogue stands on the lowest ground about it.
        """
        assert isinstance(land.built, FromTerrain)
        half = 0.5 * np.array(land.built.extent)
        beyond = float((np.abs(thing.corners[:, :2]) - half).max())
        if beyond > self.near:
            yield self._off(thing, f"reaches {beyond:.3g} m beyond {land.name}", beyond, self.near)
            return
        x, y = np.clip(thing.middle, -half, half)
        ground = survey(land).height(float(x), float(y))
        if thing.low > ground + self.near:
            yield self._off(thing, f"hangs {thing.low - ground:.3g} m over {land.name}", thing.low - ground, self.near)
        about = np.concatenate([thing.corners[:, :2], thing.middle + STANDS * _DIRECTIONS.T])
        lowest = ground if rock else float(survey(land).heights(*np.clip(about, -half, half).T).min())
        buried, limit = lowest - thing.low, (1.0 - self.lies) * (thing.high - thing.low)
        if buried > limit:
            yield self._off(thing, f"is {buried:.3g} m deep in {land.name}", buried, limit)

    def _clear(self, thing: _Thing, scatter: FromScatter) -> Iterator[Finding]:
        for each in scatter.clear:
            far = _distance(each.points, thing.middle) - thing.half
            if far < each.by - self.near:
                yield self.measured(
                    f"{thing.prim} is {far:.3g} m from a line of clear; the plan keeps {each.by:g} m clear", far,
                    each.by - self.near, "m", at_most=False, expected=each.by, prim=thing.prim, time=0.0,
                    limit_from="the plan's clear", target=self._place(thing),
                )  # fmt: skip

    def _apart(self, thing: _Thing, others: list[_Thing]) -> Iterator[Finding]:
        for other in others:
            over = thing.half + other.half - math.dist(thing.middle, other.middle)
            if over > self.near:
                yield self._off(thing, f"lies over {other.prim}", over, self.near)

    def _off(self, thing: _Thing, says: str, value: float, limit: float) -> Finding:
        return self.measured(
            f"{thing.prim} {says}", value, limit, "m", expected=0.0, prim=thing.prim, time=0.0, limit_from=SCATTER,
            target=self._place(thing),
        )  # fmt: skip

    @staticmethod
    def _place(thing: _Thing) -> RepairTarget:
        return RepairTarget(kind="geometry", prim=thing.prim, parameter="position", direction="change")


@dataclass(frozen=True)
class _Thing:
    """Something that is scattered, as it lies [m]: its corners, its middle from above, and half of what it is wide."""

    made: Static
    corners: Floats
    middle: Floats
    half: float  # of its narrower side, which is never more than what it was given room for

    @classmethod
    def of(cls, made: Static) -> _Thing:
        corners = np.concatenate([_in_world(shape) for shape in made.shapes])
        widths = np.ptp(corners[:, :2] @ _DIRECTIONS, axis=0)
        middle = 0.5 * (corners[:, :2].min(axis=0) + corners[:, :2].max(axis=0))
        return cls(made, corners, middle, 0.5 * float(widths.min()))

    @property
    def prim(self) -> str:
        return self.made.prim

    @property
    def low(self) -> float:
        return float(self.corners[:, 2].min())

    @property
    def high(self) -> float:
        return float(self.corners[:, 2].max())


def _distance(points: tuple[tuple[float, float], ...], at: Floats) -> float:
    """From a place to the nearest of a line's points, or to its only one [m]."""
    ends = np.array(points if len(points) > 1 else points * 2)
    a, along = ends[:-1], np.diff(ends, axis=0)
    share = np.clip(np.sum((at - a) * along, axis=1) / np.maximum(np.sum(along**2, axis=1), 1e-12), 0.0, 1.0)
    return float(np.hypot(*(at - a - share[:, None] * along).T).min())


def _in_world(shape: Shape) -> Floats:
    """A shape's corners in the world [m]."""
    turned = rotate(np.array(shape.rotation), np.asarray(kind_of(shape).surface().vertices, dtype=np.float64))
    return np.asarray(turned + np.array(shape.position))


CHECKS: Checks = (CheckPlanTerrain, CheckPlanScatter)
