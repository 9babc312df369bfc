"""What the objectives share: one planned objective put to the evidence, and what carries a body."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import conjugate, rotate, sides_of
from wsim.geometry.shapes import top_under
from wsim.judge.checks.check import Check
from wsim.judge.evidence.contact import distance
from wsim.judge.evidence.recorded import MissingError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import Objective
    from wsim.scene.world import Fluid, Static

    Floats = NDArray[np.float64]


@dataclass
class ObjectiveCheck(Check):
    """One objective of the plan. A prim that is not there is a failed finding, not an error."""

    objective: Objective

    def run(self, evidence: Evidence) -> list[Finding]:
        """The findings, each with the objective's sentence and its object's prim and line."""
        key = self.objective.model_dump_json()
        if key not in evidence.answers:
            evidence.answers[key] = self._answers(evidence)
        return evidence.answers[key]

    def _answers(self, evidence: Evidence) -> list[Finding]:
        prim = evidence.prim(self.objective.object)
        try:
            found = self.evaluate(evidence)
        except MissingError as error:
            found = [self.failed(f"{prim}: {error.args[0]}")]
        except Exception as error:  # noqa: BLE001 - as for every check
            found = [self.failed(f"{prim}: {self.name} could not be evaluated: {type(error).__name__}: {error}")]
        for finding in found:
            finding.objective = self.sentence
            finding.prim = finding.prim or prim
            finding.line = finding.line or evidence.line(finding.prim)
        return found

    @property
    def sentence(self) -> str:
        """The objective in words."""
        given = self.objective
        return given.sentence or " ".join(word for word in (given.object, given.kind, given.ref) if word)

    def ref(self) -> str:
        """The other object's name; MissingError."""
        if self.objective.ref is None:
            raise MissingError(f'"{self.objective.kind}" needs another object, and the plan names none')
        return self.objective.ref


Objectives = dict[str, type[ObjectiveCheck]]  # by their kind in a plan


@dataclass
class Support:
    """What a body is to rest on."""

    top: Floats  # its height at each frame, (T,) [m]
    over: NDArray[np.bool_]  # whether the body's centre is over it, (T,)
    fluid: Fluid | None = None  # the fluid that stands on it
    name: str = ""


def support_of(evidence: Evidence, i: int, prim: str) -> Support:
    """The top of a container's floor, a static object or another body, under body i; MissingError."""
    frames = len(evidence.time)
    where = evidence.body_q[:, i, :3]
    container = evidence.container(prim)
    if container is not None:
        p = evidence.local(container, where)
        half = np.array(container.inner_size) / 2
        over = (np.abs(p[:, 0]) <= half[0]) & (np.abs(p[:, 1]) <= half[1])
        fluid = next((f for f in evidence.world.fluids if f.container == prim), None)
        floor = np.array(container.inner_center) - rotate(np.array(container.rotation), np.array([0.0, 0.0, half[2]]))
        return Support(np.full(frames, floor @ evidence.up), over, fluid, "the inner floor of " + prim)
    static = evidence.static(prim)
    if static is not None:
        return _on_static(static, where, evidence.ends(i)[1], evidence.up)
    j = evidence.index(prim)
    top = evidence.ends(j)[1]
    low, high = _footprint(evidence, j)
    at = where @ sides_of(evidence.up).T
    over = np.all((at >= low) & (at <= high), axis=1)
    return Support(top, over, None, prim)


def height_over(evidence: Evidence, i: int, prim: str, support: Support) -> Floats:
    """How far body i is off what carries it (T,) [m]: the gap of their surfaces, where it is above it.

    Seen from the support, which may tilt or be a slope: the height of the body's lowest point over it says nothing of
    that. In a container it is the height over the floor, for the walls may be near; over a mesh, whose distance is not
    measured, and where it is under the support, it is the difference of their heights.
    """
    heights = evidence.ends(i)[0] - support.top
    if evidence.container(prim) is not None:
        return heights
    gap = distance(evidence, evidence.world.bodies[i].prim, prim)
    if evidence.static(prim) is not None:
        above = evidence.body_q[:, i, :3] @ evidence.up > support.top
    else:
        j = evidence.index(prim)
        own = rotate(conjugate(evidence.body_q[:1, j, 3:]), evidence.up[None])  # what pointed up at the start
        apart = evidence.body_q[:, i, :3] - evidence.body_q[:, j, :3]
        above = np.sum(apart * rotate(evidence.body_q[:, j, 3:], np.broadcast_to(own, apart.shape)), axis=1) > 0.0
    return np.where(above & np.isfinite(gap), gap, heights)


def _on_static(static: Static, where: Floats, high: Floats, up: Floats) -> Support:
    """The highest that a static object's shapes reach at each position.

    But for those that end above the body, for a shelf has boards; where all of them do, it is the highest.
    """
    shapes = [shape for shape in static.shapes if shape.collides] or static.shapes
    tops = np.stack([np.full(len(where), -np.inf), *(top_under(shape, where, up) for shape in shapes)])
    below = np.max(np.where(tops <= high, tops, -np.inf), axis=0)
    top = np.where(np.isfinite(below), below, np.max(tops, axis=0))
    return Support(top, np.isfinite(top), None, static.prim)


def _footprint(evidence: Evidence, j: int) -> tuple[Floats, Floats]:
    """The bounding rectangle of a body seen from above, at each frame, (T, 2) each."""
    q = evidence.body_q[:, j]
    lows, highs = [], []
    for surface in evidence.solid(j).surfaces:
        points = (rotate(q[:, None, 3:], surface.vertices[None]) + q[:, None, :3]) @ sides_of(evidence.up).T
        lows.append(points.min(axis=1))
        highs.append(points.max(axis=1))
    return np.min(lows, axis=0), np.max(highs, axis=0)
