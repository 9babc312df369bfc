"""What an engine's own time step leaves of momentum, where it steps joints' positions and not bodies' places.

A step of first order takes q' by M(q)^-1 and moves q after: the momentum A(q) q' of what hangs together is then off by
dt^2 (2 A'(q', q'') + A'' q' / 2), which of a body that turns at w, its mass at l from its joint, is m l dt (2 w w' +
w^3 dt / 2) a step. Nothing pushes, and no force of the world explains it.

A joint that is a constraint, as one that closes a loop, may break or lets go, gives its impulse where its anchor is as
a step begins. Between frames the arm is half of a step's turn further on, w dt / 2: a torque of l F w dt / 2 beside
the anchor, of a force F, on a body that turns at w.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.evidence.joints import anchors_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence

    Floats = NDArray[np.float64]


def step_error(evidence: Evidence) -> Floats:
    """How much of each body's force over its mass, and torque over m R, may be due to steps, (T - 1, B, 2) [m/s^2]."""
    motion = evidence.motion
    found = np.zeros((len(motion.h), len(motion.mass), 2))
    if evidence.world.stepped == "neither":
        return found
    rate, change = np.linalg.norm(motion.w, axis=2), np.linalg.norm(np.diff(motion.w, axis=0), axis=2)
    fastest, h = np.maximum(rate[1:], rate[:-1]), motion.h
    dt, off = np.minimum(motion.dt, h), np.zeros_like(fastest)
    found[..., 1] = _of_constraints(evidence, fastest, dt)  # the push itself is what it is, wherever it acts
    if evidence.world.stepped != "joints":
        return found
    for i, links in enumerate(_chains(evidence)):
        if links:
            length = np.max([np.linalg.norm(motion.com[:, i] - place, axis=1) for _, place in links], axis=0)
            rows = [i, *(row for row, _ in links)]
            w, dw = fastest[:, rows].max(axis=1), change[:, rows].max(axis=1)
            off[:, i] = np.maximum(length[1:], length[:-1]) * (2.0 * w * dw * dt / h + 0.5 * w**3 * dt)
    for unit in np.unique(motion.unit[motion.jointed]):
        rows_of = np.flatnonzero(motion.unit == unit)
        mass = motion.mass[rows_of]  # it ends in any of the bodies, the more the heavier they are
        found[:, rows_of] += ((off[:, rows_of] @ mass)[:, None] * mass / np.sum(mass**2))[..., None]
    return found


def _of_constraints(evidence: Evidence, fastest: Floats, dt: Floats) -> Floats:
    """What the arms of joints that are constraints miss, over masses and radii, (T - 1, B) [m/s^2]."""
    motion, found = evidence.motion, np.zeros_like(fastest)
    passed = np.linalg.norm(motion.acceleration - motion.gravity, axis=2) * motion.mass
    row = {body.prim: i for i, body in enumerate(evidence.world.bodies)}
    for joint in evidence.world.joints:
        if not joint.closing or not joint.child_anchor:
            continue
        anchors = anchors_of(evidence, joint)
        for prim in (joint.parent, joint.child):
            i = row.get(prim or "")
            if i is None or motion.kinematic[i]:
                continue
            length = np.linalg.norm(motion.com[:, i] - anchors.below, axis=1).max()
            share = length / max(length, float(motion.radius[i]))
            force = passed[:, motion.unit == motion.unit[i]].sum(axis=1)  # all that hangs together may pass it on
            found[:, i] += 0.5 * dt * fastest[:, i] * share * force / motion.mass[i]
    return found


def _chains(evidence: Evidence) -> list[list[tuple[int, Floats]]]:
    """Of each body the bodies that it hangs from, itself first, and where their joints are, (T, 3) [m]."""
    row = {body.prim: i for i, body in enumerate(evidence.world.bodies)}
    above = {joint.child: joint for joint in evidence.world.joints if not joint.closing and joint.child_anchor}
    chains = []
    for body in evidence.world.bodies:
        chain: list[tuple[int, Floats]] = []
        joint = above.get(body.prim)
        while joint is not None and len(chain) < len(row):
            chain.append((row[joint.child], anchors_of(evidence, joint).below))
            joint = above.get(joint.parent or "")
        chains.append(chain)
    return chains
