"""How fast what sinks may drive a fluid out from under it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import UP, lengths

if TYPE_CHECKING:
    from wsim.judge.evidence.evidence import Evidence
    from wsim.scene.world import Fluid

GAP = 0.25  # of a spacing: what a particle is flattened to before it is out from under what lands on it


def squeezed_speed(evidence: Evidence, fluid: Fluid, free: float) -> float:
    """The speed at which a landing body drives a fluid out over its rim [m/s].

    Two level faces that close at v, h apart, of area A and perimeter P: by continuity the fluid leaves at v A / (P h),
    at any depth, and as fast as the gap is thin. h is the least that a fluid of particles resolves.

    Args:
        evidence: Of bodies that go into the fluid.
        fluid: That is driven out.
        free: The most that counts of a body's own speed, of the longest fall there is [m/s].
    """
    up, motion, most = evidence.up, evidence.motion, 0.0
    surface = float(np.array(fluid.center) @ up + 0.5 * np.array(fluid.size) @ np.abs(up))
    for i in np.flatnonzero(~motion.kinematic):
        low = evidence.ends(int(i))[0]
        sinking = np.where(low < surface, -(motion.v[:, i] @ up), 0.0)
        frame = int(np.argmax(sinking))
        if sinking[frame] <= 0.0:
            continue
        q = evidence.body_q[frame : frame + 1, i, 3:]
        across = np.cross(up, UP if abs(up @ UP) < 0.9 else np.array([1.0, 0.0, 0.0]))
        sides = (across / lengths(across), np.cross(up, across / lengths(across)))
        a, b = (float(np.subtract(*evidence.solid(int(i)).reach(q, side)[::-1])[0]) for side in sides)
        rim = a * b / (2.0 * (a + b))
        most = max(most, min(float(sinking[frame]), free) * rim / (GAP * fluid.spacing))
    return most
