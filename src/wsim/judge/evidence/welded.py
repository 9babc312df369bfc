"""Bodies that fixed joints make one, and the fluid's lift on them that nothing holds down."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.evidence.layers import mass_displaced, needed_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Fluid

    Floats = NDArray[np.float64]

HALVINGS = 40  # of a height, to where single precision ends


def welded(evidence: Evidence, i: int) -> list[int]:
    """A body and those that fixed joints, one after another, hold to it."""
    index = {body.prim: k for k, body in enumerate(evidence.world.bodies)}
    fixed = [(index.get(j.parent or ""), index.get(j.child)) for j in evidence.world.joints if j.kind == "fixed"]
    found = {i}
    while more := {k for pair in fixed if found & {*pair} for k in pair if k is not None} - found:
        found |= more
    return sorted(found)


def held(evidence: Evidence, parts: list[int]) -> bool:
    """Whether a joint or a cord ties bodies to anything but each other, or they go their own way."""
    prims = {evidence.world.bodies[k].prim for k in parts}
    joints = [{joint.parent, joint.child} for joint in evidence.world.joints]
    tied = any(prims & ends and not ends <= prims for ends in joints)
    tied |= any(guide.body in prims for cord in evidence.world.cords for guide in cord.path)
    return tied or any(evidence.world.bodies[k].kinematic for k in parts)


def displaced(evidence: Evidence, i: int, fluid: Fluid) -> tuple[float, float]:
    """What a body and those that are one with it must displace to float, and their own volume [m^3]."""
    parts = welded(evidence, i)
    mass = sum(evidence.world.bodies[k].mass for k in parts)
    volume = sum(evidence.solid(k).volume for k in parts)
    return needed_of(evidence, fluid, mass, volume), volume


def volume_of(evidence: Evidence, poses: dict[int, tuple[Floats, Floats]], height: float) -> float:
    """How much of bodies, at places and turns, is below a height [m^3]."""
    return sum(evidence.solid(k).volume_below(q, float(at[2]), height) for k, (at, q) in poses.items())


def still_draft(evidence: Evidence, i: int, needed: float) -> float:
    """Depth of a body's lowest point in still fluid [m], as it and what is one with it are turned at the end.

    Args:
        evidence: What happened.
        i: The body.
        needed: What they displace together [m^3].
    """
    parts = welded(evidence, i)
    if len(parts) == 1:
        solid = evidence.solid(i)
        return solid.draft(evidence.resting_pose(i)[1], min(needed, solid.volume))
    poses = {k: evidence.resting_pose(k) for k in parts}
    ends = np.array([[end[evidence.window].mean() for end in evidence.ends(k)] for k in parts])
    low, high = float(ends[:, 0].min()), float(ends[:, 1].max())
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if volume_of(evidence, poses, middle) < needed else (low, middle)
    return (low + high) / 2 - float(evidence.ends(i)[0][evidence.window].mean())


def unheld_lift(evidence: Evidence, i: int, fluid: Fluid) -> float | None:
    """Archimedes' lift on a body less its weight and what contacts press it down with, over the final window [N].

    A body that lies still has none: what is left over would raise it. With what fixed joints hold to it; None where
    something else holds it.
    """
    parts, here = welded(evidence, i), evidence.window
    if held(evidence, parts):
        return None
    poses = {k: evidence.resting_pose(k) for k in parts}
    under = mass_displaced(evidence, fluid, lambda z: volume_of(evidence, poses, z))
    mass = sum(evidence.world.bodies[k].mass for k in parts)
    pushed = np.asarray(evidence.recording.contact_force[here][:, parts], dtype=np.float64) @ evidence.up
    rising = evidence.body_qd[here][:, i, :3] @ evidence.up
    span = float(evidence.time[here][-1] - evidence.time[here][0])
    gained = mass * float(rising[-1] - rising[0]) / span if span > 0.0 else 0.0
    return float((under - mass) * evidence.gravity + pushed.sum(axis=1).mean() - gained)
