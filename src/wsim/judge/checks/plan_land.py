"""The check of the stage's terrain, and what is scattered on it, against the plan's."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import rotate
from wsim.judge.checks.check import Check, Checks, listed
from wsim.judge.verdict import RepairTarget
from wsim.plan.layout.land import survey
from wsim.plan.schema import FromScatter, FromTerrain

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import PlanObject
    from wsim.scene.world import Shape, Static

    Floats = NDArray[np.float64]


@dataclass
class CheckPlanTerrain(Check):
    """Terrain is as wide and as high as the plan's layers make it, and what is scattered on it as large as it says."""

    of_world = True

    height: float = 0.05  # [m]: of the ground anywhere
    share: float = 0.02  # of its area
    size: float = 0.05  # of a rock's greatest length

    def evaluate(self, evidence: Evidence) -> list[Finding]:
        """One finding for each that differs, or one for none."""
        items = evidence.plan.objects if evidence.plan is not None else []
        made = {static.prim: static for static in evidence.world.statics}
        lands = [item for item in items if item.primitive == "terrain" and evidence.prim(item.name) in made]
        found = [f for item in lands for f in self._land(evidence, made[evidence.prim(item.name)], item)]
        for item in items:
            if isinstance(item.built, FromScatter) and item.rocks:
                stones = [made[prim] for name in item.prims if (prim := evidence.prim(name)) in made]
                found += [f for stone in stones for f in self._stone(stone, item.built.size[1])]
        return found or ([self.passed("Terrain is as the plan's layers make it")] if lands else [])

    def _land(self, evidence: Evidence, made: Static, item: PlanObject) -> Iterator[Finding]:
        assert isinstance(item.built, FromTerrain)
        solid = [shape for shape in made.shapes if shape.kind == "mesh" and shape.collides]
        if len(solid) < len(made.shapes) or not solid:
            yield self._differs(made, f"{made.prim} is not solid ground of triangles, which the plan's terrain is")
            return
        corners = [_in_world(shape) for shape in solid]
        covered = sum(_from_above(at, shape) for at, shape in zip(corners, solid, strict=True))
        area = math.prod(item.built.extent)
        if abs(covered / area - 1.0) > self.share:
            yield self._differs(made, f"{made.prim} covers {covered:.4g} m^2; the plan's terrain {area:.4g} m^2")
            return
        named = {each.prim.rsplit("/", 1)[-1] for each in solid}
        for lacking in (each.name for each in item.built.areas if each.name not in named):
            yield self._differs(made, f"{made.prim} has no area {lacking}, which the plan's terrain has")
        if evidence.varied:
            return
        ground = survey(item)
        top = np.concatenate([_upper(at, shape) for at, shape in zip(corners, solid, strict=True)])
        if len(np.unique(top[:, :2].round(6), axis=0)) < ground.count:
            yield self._differs(
                made, f"{made.prim} has fewer corners than the plan's terrain, which has {ground.count}"
            )
            return
        x, y = (np.clip(top[:, k], -0.5 * edge, 0.5 * edge) for k, edge in enumerate(item.built.extent))
        off = np.abs(top[:, 2] - ground.heights(x, y))
        worst = int(off.argmax()) if len(off) else 0
        if not len(off) or off[worst] > self.height:
            where = listed(tuple(float(v) for v in top[worst])) if len(off) else "nowhere"
            yield self.measured(
                f"{made.prim} is not as high as the plan's layers make it: at {where} m it is "
                f"{float(off[worst]) if len(off) else math.inf:.3g} m off",
                float(off[worst]) if len(off) else math.inf, self.height, "m", expected=0.0, prim=made.prim, time=0.0,
                limit_from="the plan's layers",
                target=RepairTarget(kind="geometry", prim=made.prim, parameter="layers", direction="change"),
            )  # fmt: skip

    def _stone(self, made: Static, most: float) -> Iterator[Finding]:
        long = max((max(shape.size) for shape in made.shapes if shape.size), default=0.0)
        limit = most * (1.0 + self.size)
        if long > limit:
            yield self.measured(
                f"{made.prim} is {long:.3g} m long; the plan's rocks at most {most:g} m", long, limit, "m",
                prim=made.prim, time=0.0, limit_from="the plan's size",
                target=RepairTarget(kind="geometry", prim=made.prim, parameter="size", direction="lower"),
            )  # fmt: skip

    def _differs(self, made: Static, message: str) -> Finding:
        target = RepairTarget(kind="geometry", prim=made.prim, parameter="shape", direction="change")
        return self.failed(message, prim=made.prim, time=0.0, limit_from="the plan's terrain", target=target)


def _in_world(shape: Shape) -> Floats:
    """A mesh's corners in the world [m]."""
    turned = rotate(np.array(shape.rotation), np.asarray(shape.vertices, dtype=np.float64))
    return np.asarray(turned + np.array(shape.position))


def _from_above(corners: Floats, shape: Shape) -> float:
    """Area of a mesh's upward triangles as seen from above [m^2]."""
    return float(0.5 * np.maximum(_twice(corners, shape), 0.0).sum())


def _upper(corners: Floats, shape: Shape) -> Floats:
    """Those of a mesh's corners that an upward triangle has."""
    return corners[np.unique(np.asarray(shape.triangles)[_twice(corners, shape) > 0.0])]


def _twice(corners: Floats, shape: Shape) -> Floats:
    """Twice the area of each triangle as seen from above, below 0 of those that face down [m^2]."""
    a, b, c = (corners[np.asarray(shape.triangles)[:, k]] for k in range(3))
    return np.asarray((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0]))


CHECKS: Checks = (CheckPlanTerrain,)
