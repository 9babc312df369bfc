"""What gets by or through another object: targets of where it starts, of what it meets, and of the step."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.shapes import kind_of
from wsim.judge.repair.place import over, overlapping_start
from wsim.judge.repair.rule import ROOM, add_collision, collides, shapes_of, shorter_step, time_step
from wsim.judge.verdict import Finding, RepairTarget

if TYPE_CHECKING:
    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Container


def beside(evidence: Evidence, prim: str, ref: str) -> RepairTarget:
    """What comes down beside what is to carry it."""
    why = f"it must come down over {ref}"
    return over(evidence, prim, ref, why) or RepairTarget(
        kind="settlement", prim=prim, parameter="position", direction="change", unit="m", why=why
    )


def fallen_through(evidence: Evidence, prim: str, ref: str) -> RepairTarget:
    """What went through another object: one of the two collides with nothing, or it was too fast for the step."""
    for owner in (ref, prim):
        if not collides(evidence, owner):
            return add_collision(owner)
    return tunnelled(evidence, prim, ref)


def tunnelled(evidence: Evidence, prim: str, ref: str) -> RepairTarget:
    """In a step a body may cross half of the thinnest thing in its way, or it passes between two steps.

    Ericson (2005), Real-Time Collision Detection, section 5.5.
    """
    start = overlapping_start(evidence, prim)
    if start is not None:
        return start
    shapes = [shape for owner in (prim, ref) for shape in shapes_of(evidence, owner)]
    sizes = [kind_of(shape).thinnest for shape in shapes if shape.kind != "plane"]
    speed = float(np.linalg.norm(evidence.body_qd[:, evidence.index(prim), :3], axis=1).max())
    now = time_step(evidence)
    if not sizes or not now or speed <= 0.0 or not math.isfinite(speed):
        return shorter_step(evidence, 0.5, "it passes what should stop it between two steps")
    share = min(0.5, 0.5 * min(sizes) / speed / now)
    return shorter_step(
        evidence, share, f"at {speed:.3g} m/s it may cross half of {min(sizes):.3g} m in a step, or it passes through"
    )


def missed(evidence: Evidence, prim: str, ref: str, gap: float | None) -> RepairTarget:
    """Two that are to meet pass by each other at a gap [m], or, if it is None, through each other."""
    lacking = next((owner for owner in (prim, ref) if not collides(evidence, owner)), None)
    if lacking is not None:
        return add_collision(lacking)
    if gap is None:
        return tunnelled(evidence, prim, ref)
    why = f"it passes {gap:.3g} m beside {ref}: aim it there"
    return RepairTarget(
        kind="physical parameter", prim=prim, parameter="velocity", direction="change", unit="m/s", why=why
    )


def too_small(evidence: Evidence, prim: str, beyond: float) -> RepairTarget:
    """A container that a body gets out of, by so much [m]."""
    container = evidence.container(prim)
    more = 2 * beyond * (1.0 + ROOM)
    x, y, z = container.inner_size if container is not None else (0.0, 0.0, 0.0)
    return RepairTarget(
        kind="geometry", prim=prim, parameter="inner_size", direction="raise",
        vector=None if container is None else (x + more, y + more, z), unit="m",
        why="a body gets out of it: room for its way",
    )  # fmt: skip


def started_in(evidence: Evidence, prim: str, container: Container) -> bool:
    """Whether a body's centre starts over a container's floor."""
    at = evidence.local(container, evidence.body_q[:1, evidence.index(prim), :3])[0]
    return bool(np.all(np.abs(at[:2]) <= np.array(container.inner_size[:2]) / 2))


def pushed_over(finding: Finding, evidence: Evidence) -> RepairTarget:
    """To tip a body, a push must bring the energy that lifts its centre over its edge."""
    i = evidence.index(finding.prim or "")
    body = evidence.world.bodies[i]
    low, high = evidence.ends(i)
    height = float(high[0] - low[0])
    lift = 0.5 * (math.hypot(height, evidence.solid(i).smallest) - height)
    work = body.mass * evidence.gravity * lift
    why = f"to tip it over its edge takes {work:.3g} J: a faster or heavier push, or a hit higher up"
    return RepairTarget(
        kind="physical parameter", prim=body.prim, parameter="velocity", direction="raise", unit="m/s", why=why
    )
