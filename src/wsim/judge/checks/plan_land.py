"""Checks of the stage's terrain, and of what is scattered on it, against the plan's."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from wsim.defaults import FRICTION
from wsim.geometry.rotations import rotate
from wsim.geometry.shapes import kind_of
from wsim.judge.checks.check import Checks, listed
from wsim.judge.checks.counterparts import Comparing
from wsim.judge.verdict import RepairTarget
from wsim.plan.authored import asset_of
from wsim.plan.layout.land import divided, survey
from wsim.plan.schema import FromScatter, FromTerrain
from wsim.scene.contact import friction_of
from wsim.scene.world import Static

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import PlanObject
    from wsim.scene.terrain import Terrain
    from wsim.scene.world import Shape

    Floats = NDArray[np.float64]

_DIRECTIONS = np.array([(math.cos(k * math.pi / 16), math.sin(k * math.pi / 16)) for k in range(16)]).T
LAYERS, SCATTER = "the plan's terrain", "the plan's scatter"


@dataclass
class CheckPlanTerrain(Comparing):
    """Terrain is as wide and as high as the plan's layers make it, and its areas are where the plan has them."""

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
        solid = [shape for shape in made.shapes if shape.kind == "mesh" and shape.collides]
        if len(solid) < len(made.shapes) or not solid:
            yield self._other(made, "is not solid ground of triangles, which the plan's terrain is")
            return
        tops = [_Top.of(shape) for shape in solid]
        area, covered = math.prod(item.built.extent), sum(float(top.areas.sum()) for top in tops)
        if abs(covered / area - 1.0) > self.covered:
            yield self._other(made, f"covers {covered:.4g} m^2; the plan's terrain {area:.4g} m^2")
            return
        if evidence.varied:
            return
        ground, corners = survey(item), np.concatenate([top.corners for top in tops])
        if len(np.unique(corners[:, :2].round(6), axis=0)) < ground.count:
            yield self._other(made, f"has fewer corners than the plan's terrain, which has {ground.count}")
            return
        half = 0.5 * np.array(item.built.extent)
        ends = np.concatenate([corners[:, :2].min(axis=0) + half, corners[:, :2].max(axis=0) - half])
        if np.abs(ends).max() > self.height:
            yield self._other(made, f"ends up to {np.abs(ends).max():.3g} m from where the plan's terrain does")
            return
        yield from self._high(made, corners, ground, half)
        yield from self._areas(made, item, tops)

    def _high(self, made: Static, corners: Floats, ground: Terrain, half: Floats) -> Iterator[Finding]:
        x, y = np.clip(corners[:, :2], -half, half).T
        off = np.abs(corners[:, 2] - ground.heights(x, y))
        worst = int(off.argmax())
        if off[worst] > self.height:
            yield self.measured(
                f"{made.prim} is not as high as the plan's layers make it: at "
                f"{listed(tuple(float(v) for v in corners[worst]))} m it is {off[worst]:.3g} m off",
                float(off[worst]), self.height, "m", expected=0.0, prim=made.prim, time=0.0,
                limit_from="the plan's layers",
                target=RepairTarget(kind="geometry", prim=made.prim, parameter="layers", direction="change"),
            )  # fmt: skip

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
    """The upper side of a mesh: what it is called, its corners, and of its triangles middles and areas from above."""

    name: str
    corners: Floats
    middles: Floats
    areas: Floats  # [m^2]

    @classmethod
    def of(cls, shape: Shape) -> _Top:
        points, triangles = _in_world(shape), np.asarray(shape.triangles)
        a, b, c = (points[triangles[:, k]] for k in range(3))
        twice = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
        up = twice > 0.0
        middles = (a + b + c)[up] / 3.0
        return cls(shape.prim.rsplit("/", 1)[-1], points[np.unique(triangles[up])], middles, 0.5 * twice[up])


@dataclass
class CheckPlanScatter(Comparing):
    """What is scattered is of the plan's sort and size, lies on the terrain, and keeps away from what the plan says."""

    of_world = True

    near: float = 0.1  # [m]: of where it may be
    least: float = 0.1  # of a rock's least length, whose corners leave some of it out
    lies: float = 0.5  # of its height, that is above the ground at least

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each thing that is otherwise, or one for none."""
        items = {item.name: item for item in evidence.plan.objects} if evidence.plan is not None else {}
        spread = [item for item in items.values() if isinstance(item.built, FromScatter)]
        statics = {static.prim: static for static in evidence.world.statics}
        found: list[Finding] = []
        for item in spread if not evidence.varied else ():
            assert isinstance(item.built, FromScatter)
            made = [statics[prim] for name in item.prims if (prim := evidence.prim(name)) in statics]
            things = [_Thing.of(each) for each in made]
            for k, thing in enumerate(things):
                faults = [
                    *(self._stone(thing, item) if item.rocks else self._sort(thing, item.built.what)),
                    *self._clear(thing, item.built),
                    *self._lies(thing, items[item.built.on]),
                    *self._apart(thing, things[:k]),
                ]
                found += faults[:1]
        return found or ([self.passed("What is scattered is as the plan has it")] if spread else [])

    def _stone(self, thing: _Thing, item: PlanObject) -> Iterator[Finding]:
        assert isinstance(item.built, FromScatter)
        shapes, (low, high) = thing.made.shapes, item.built.size
        if [(shape.kind, shape.collides) for shape in shapes] != [("mesh", True)]:
            yield self.differs(thing.prim, "is no rock, one solid mesh", SCATTER, "shape")
            return
        long, bounds = max(shapes[0].size), (low * (1.0 - self.least), high * (1.0 + self.share))
        if not bounds[0] <= long <= bounds[1]:
            yield self.between(
                f"{thing.prim} is {long:.3g} m long; the plan's rocks {low:g} to {high:g} m", long, bounds, "m",
                expected=0.5 * (low + high), prim=thing.prim, time=0.0, limit_from="the plan's size",
                target=RepairTarget(kind="geometry", prim=thing.prim, parameter="size"),
            )  # fmt: skip
        if item.material is None:
            yield from self.number(thing.prim, "a friction", friction_of(shapes[0]), FRICTION, self.grip * FRICTION,
                                   "1", SCATTER, "friction")  # fmt: skip

    def _sort(self, thing: _Thing, what: tuple[str, ...]) -> Iterator[Finding]:
        if not any(self._alike(thing, asset) for asset in what):
            yield self.differs(thing.prim, f"is no {' or '.join(what)} as the catalogue has it", SCATTER, "shape")

    def _alike(self, thing: _Thing, asset: str) -> bool:
        """Whether it has the shapes of a thing of the catalogue, as far from each other, and stands upright."""
        made, wanted = thing.made.shapes, asset_of(asset)
        if [(s.kind, s.collides, len(s.size)) for s in made] != [(s.kind, s.collides, len(s.size)) for s in wanted]:
            return False
        one = _Thing.of(Static(prim="", shapes=wanted))
        numbers = [(friction_of(a), friction_of(b)) for a, b in zip(made, wanted, strict=True)]
        numbers += [(x, y) for a, b in zip(made, wanted, strict=True) for x, y in zip(a.size, b.size, strict=True)]
        numbers += [
            (math.dist(a.position, made[0].position), math.dist(b.position, wanted[0].position))
            for a, b in zip(made, wanted, strict=True)
        ]
        numbers.append((thing.high - thing.low, one.high - one.low))
        return all(abs(has - to) <= self.share * to + 1e-3 for has, to in numbers)

    def _lies(self, thing: _Thing, land: PlanObject) -> Iterator[Finding]:
        """Whether it is on the ground, and neither over nor under it."""
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
        buried, limit = ground - thing.low, (1.0 - self.lies) * (thing.high - thing.low)
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
