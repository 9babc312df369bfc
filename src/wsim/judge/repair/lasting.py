"""What goes on where it should have ended: bodies that do not come to rest, and fluids that run out."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.shapes import kind_of
from wsim.judge.evidence.final_window import span_for
from wsim.judge.repair.drive import by_drive, drive_of
from wsim.judge.repair.matter import damped
from wsim.judge.repair.rule import FARTHEST, ROOM, add_collision, collides, longer_run, shorter_step
from wsim.judge.verdict import Finding, RepairTarget

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Container, Fluid

    Floats = NDArray[np.float64]


def settled(finding: Finding, evidence: Evidence) -> RepairTarget:
    """What dies down needs time, by its own decay; what does not is kept going by its drive, or the solver."""
    prim = finding.prim or ""
    if drive_of(evidence, prim) is not None:
        driven = by_drive(evidence, prim, None, "its drive keeps it going")
        if driven is not None and driven.suggested is not None:
            return driven
    i = evidence.index(prim)
    speed = np.linalg.norm(evidence.body_qd[:, i, :3], axis=1)
    end = float(evidence.time[-1])
    moving = np.flatnonzero(speed > (finding.limit or 0.0))
    stands = int(moving[-1]) + 1 if len(moving) else 0
    if finding.limit and stands < len(speed):  # it does come to rest, and the final window begins before
        wanted = (1.0 + ROOM / 2) * span_for(float(evidence.time[stands] - evidence.time[0]))
        if wanted > end - float(evidence.time[0]):
            return longer_run(
                evidence, wanted, f"it stands from {evidence.time[stands]:.3g} s on: that is to be long enough"
            )
    half = min(1.0, 0.25 * (end - float(evidence.time[0])))
    late = evidence.time > end - half
    early = (evidence.time > end - 2 * half) & ~late
    before, after = (float(np.sqrt(np.mean(speed[part] ** 2))) for part in (early, late))
    if after >= before or not finding.limit or not finding.value:
        return shorter_step(
            evidence, 0.5, "it does not die down: contacts or fluid keep it going; half the step is the first to try"
        )
    rate = math.log(before / after) / half
    wanted = end + max(0.0, math.log((1.0 + ROOM) * finding.value / finding.limit)) / rate + half
    if wanted > FARTHEST["duration"] * end:
        return damped(evidence, i, f"its speed falls by half in {math.log(2) / rate:.2g} s: no run is that long")
    return longer_run(evidence, wanted, f"its speed falls by half in {math.log(2) / rate:.2g} s: by then it is at rest")


def leak(finding: Finding, evidence: Evidence) -> RepairTarget:
    """Over the rim: higher walls. Through a wall: one that is as thick as the particles need, or a shorter step."""
    fluid = evidence.fluid(finding.prim or "")
    container = evidence.container_of(fluid)
    if container is None:
        return RepairTarget(
            kind="missing object", prim=fluid.container, direction="add", why="the fluid has no container"
        )
    exit_heights = _exits(evidence, container, fluid)
    rim = container.inner_size[2]
    if len(exit_heights) and np.mean(exit_heights > rim - fluid.spacing) > 0.5:
        return RepairTarget(
            kind="geometry", prim=container.prim, parameter="inner_size.z", direction="raise", current=rim,
            suggested=max(float(exit_heights.max()), rim) + fluid.spacing, unit="m",
            why="it goes over the rim; this is how high it is where it does, and a spacing more",
        )  # fmt: skip
    if not collides(evidence, container.prim):
        return add_collision(container.prim)
    static = evidence.static(container.prim)
    wall = (
        min((kind_of(shape).thinnest for shape in static.shapes), default=math.inf) if static is not None else math.inf
    )
    if wall < fluid.spacing:
        return RepairTarget(
            kind="geometry", prim=container.prim, parameter="wall", direction="raise", current=wall,
            suggested=fluid.spacing, unit="m", why="it goes through a wall that is thinner than a particle",
        )  # fmt: skip
    return shorter_step(evidence, 0.5, "it goes through walls that are thick enough: half the step is the first to try")


def _exits(evidence: Evidence, container: Container, fluid: Fluid) -> Floats:
    """Height above the inner floor at which each particle that gets out did so, (n,) [m]."""
    track = evidence.track(fluid)
    out = evidence.containment(container, fluid).strayed
    gone = np.flatnonzero(out.any(axis=0))
    first = np.argmax(out[:, gone], axis=0)
    # Between two frames one may fall below the rim that it came over: it was above it at the frame before.
    when = np.stack([first, np.maximum(first - 1, 0)])
    where = evidence.local(container, np.asarray(track.position[when, gone], dtype=np.float64))
    heights: Floats = where[..., 2].max(axis=0) + container.inner_size[2] / 2
    return heights
