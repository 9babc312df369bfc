"""What moves under or against bodies and is moved by none: belts' surfaces, kinematic bodies; and the work they may do.

A contact's force F works F . v on a body whose surface moves at v there, and friction and impacts only take energy
in the carrier's own frame, F . (v - u) <= 0: what a carrier of velocity u gives is at most u . J, J the impulse of its
contacts. Where the carrier is all that a body may touch, J is what changed the body's momentum, less gravity's share.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.rotations import rotate
from wsim.judge.evidence.scheduled import belt, fastest

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.evidence import Evidence
    from wsim.judge.evidence.placed import Placed

    Floats = NDArray[np.float64]


def leads(evidence: Evidence) -> NDArray[np.bool_]:
    """Which bodies are kinematic, and move at some time, (B,)."""
    motion = evidence.motion
    goes = motion.kinematic.copy()
    goes[goes] = (motion.speed[:, goes] != 0.0).any(axis=0) | (motion.w[:, goes] != 0.0).any(axis=(0, 2))
    return goes


def carriers(evidence: Evidence) -> list[Placed]:
    """The colliding shapes that move, and are moved by nothing that they touch."""
    goes = leads(evidence)
    return [
        shape
        for shape in evidence.placed
        if any(fastest(evidence.world, shape.shape)) or (shape.body >= 0 and goes[shape.body])
    ]


def surface_speed(evidence: Evidence) -> float:
    """Of the fastest belt [m/s]."""
    speeds = [math.hypot(*fastest(evidence.world, shape.shape)) for shape in evidence.placed]
    return max(speeds, default=0.0)


def rides(evidence: Evidence, i: int, intervals: NDArray[np.intp]) -> bool:
    """Whether body i may touch a carrier in any of the intervals between frames."""
    return any(bool(evidence.motion.approaches(shape, i, intervals).any()) for shape in carriers(evidence))


def carried_work(evidence: Evidence, pulled: Floats) -> Floats:
    """The most that carriers may have given to each body since the start, (T, B) [J].

    Args:
        evidence: Of a recording that does not say what contacts gave.
        pulled: What springs gave each body in each interval, (T - 1, B, 3) [N s].
    """
    motion = evidence.motion
    frames, bodies = motion.speed.shape
    work = np.zeros((frames, bodies))
    moving = carriers(evidence)
    if not moving or frames < 2:
        return work
    every = np.arange(frames - 1)
    impulse = motion.mass[:, None] * (motion.acceleration - motion.gravity) * motion.h[:, None, None] - pulled
    size, tied = np.linalg.norm(impulse, axis=2), _tied(evidence)
    loose = np.flatnonzero(~motion.kinematic)
    by_carrier = np.zeros((frames - 1, bodies))
    beside = np.zeros((frames - 1, bodies), dtype=bool)
    near = np.zeros((frames - 1, bodies), dtype=bool)
    fastest = np.zeros(frames - 1)
    for i in loose:
        for shape in evidence.placed:
            if shape.body == i:
                continue
            here = motion.approaches(shape, int(i), every)
            if any(shape is one for one in moving):
                u, spread = _velocity(evidence, shape, int(i))
                given = np.einsum("ki,ki->k", u, impulse[:, i]) + spread * size[:, i]
                beside[:, i] |= near[:, i] & here
                near[:, i] |= here
                by_carrier[:, i] = np.where(here, np.maximum(given, 0.0), by_carrier[:, i])
                fastest = np.maximum(fastest, np.where(here, np.linalg.norm(u, axis=1) + spread, 0.0))
            else:
                beside[:, i] |= here
    # Beside something else, or tied to it, a body may be pressed harder than its own momentum tells, and may pass on
    # what it is given.
    for rows in tied:
        size[:, rows] = size[:, rows].sum(axis=1, keepdims=True)
        beside[:, rows] |= near[:, rows].any(axis=1, keepdims=True)
    most = fastest[:, None] * size
    given = np.where(near & ~beside, by_carrier, np.where(beside, most, 0.0))
    work[1:] = np.cumsum(np.where(motion.kinematic, 0.0, given), axis=0)
    return work


def _tied(evidence: Evidence) -> list[NDArray[np.intp]]:
    """The loose bodies of each mechanism in which ropes or joints pass something on."""
    world, unit, loose = evidence.world, evidence.motion.unit, ~evidence.motion.kinematic
    held = {end for joint in world.joints for end in (joint.parent, joint.child)}
    held |= {guide.body for rope in world.ropes for guide in rope.path}
    units = {int(unit[i]) for i, body in enumerate(world.bodies) if body.prim in held}
    return [np.flatnonzero((unit == each) & loose) for each in sorted(units)]


def _velocity(evidence: Evidence, shape: Placed, i: int) -> tuple[Floats, Floats]:
    """How a carrier's surface moves at the middle of body i in each interval, and by how much it may elsewhere on i."""
    motion = evidence.motion
    frame = np.broadcast_to(np.array([0.0, 0.0, 0.0, 1.0]), (len(motion.speed), 4))
    own = np.zeros((len(motion.speed), 3))
    turning = np.zeros(len(motion.speed))
    if shape.body >= 0:
        k = shape.body
        frame = evidence.body_q[:, k, 3:]
        own = motion.v[:, k] + np.cross(motion.w[:, k], motion.com[:, i] - motion.com[:, k])
        turning = np.linalg.norm(motion.w[:, k], axis=1)
    u = own + rotate(frame, belt(evidence, shape.shape))
    changes = 0.5 * np.linalg.norm(np.diff(u, axis=0), axis=1)
    spread: Floats = np.maximum(turning[1:], turning[:-1]) * motion.radius[i] + changes
    return 0.5 * (u[1:] + u[:-1]), spread
