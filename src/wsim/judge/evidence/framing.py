"""What a camera's picture holds, and where it would have to stand to hold all of something."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from wsim.scene.following import as_at_start

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.evidence.recorded import Recorded
    from wsim.scene.world import Camera

    Floats = NDArray[np.float64]
    Bools = NDArray[np.bool_]

STEP, STEPS = 1.1, 60  # by which a camera steps back until it sees all, and how often: up to 300 times as far
RAISED = 0.2  # of its distance: how much higher than what it looks at it stands at least, so that no floor hides that
DIGITS = 3


def in_frame(camera: Camera, points: Floats) -> Bools:
    """Which points (..., 3) are in a camera's picture, (...)."""
    eye, up = np.array(camera.eye), np.array(camera.up)
    ahead = np.array(camera.target) - eye
    ahead /= max(float(np.linalg.norm(ahead)), 1e-12)
    right = np.cross(ahead, up)
    if float(np.linalg.norm(right)) < 1e-9:  # it looks along its own up: any side will do
        right = np.cross(ahead, np.eye(3)[int(np.argmin(np.abs(ahead)))])
    right /= float(np.linalg.norm(right))
    local = points - eye
    depth = local @ ahead
    half = math.tan(math.radians(camera.fov) / 2.0)
    tall = half * camera.height / camera.width
    inside: Bools = (depth > 0.0) & (np.abs(local @ right) <= half * depth)
    inside &= np.abs(local @ np.cross(right, ahead)) <= tall * depth
    return inside


def as_seen(evidence: Recorded, camera: Camera, frames: NDArray[np.intp], points: Floats) -> Floats:
    """Points (F, n, 3) [m] at frames (F,), where a camera that follows a body would have to see them at its start."""
    if camera.follows is None:
        return points
    row = [body.prim for body in evidence.world.bodies].index(camera.follows)
    return as_at_start(camera, evidence.world, evidence.recording.body_q[frames, row], points)


def framed(camera: Camera, points: Floats, radius: float) -> tuple[Floats, Floats] | None:
    """The eye and the target (3,) [m] from which a camera sees balls about points (n, 3); None if those are too far.

    It turns where it stands if that is enough; else it goes back, or comes nearer, on the side where it is.
    """
    low, high = points.min(axis=0) - radius, points.max(axis=0) + radius
    target, extent = np.round((low + high) / 2, DIGITS), float(np.linalg.norm(high - low))
    corners = np.array([[(low, high)[k >> axis & 1][axis] for axis in range(3)] for k in range(8)])
    eye = np.array(camera.eye)
    half = math.tan(math.radians(camera.fov) / 2.0) * camera.height / camera.width
    far = float(np.linalg.norm(eye - target))
    if far * half <= 3.0 * extent and _sees(camera, eye, target, corners):
        return eye, target
    way = eye - target
    level = float(np.hypot(way[0], way[1]))
    way[2] = max(way[2], RAISED * max(level, 1e-9))
    way /= float(np.linalg.norm(way))
    back = max(0.5 * extent, 1e-3)
    for _ in range(STEPS):
        eye = np.round(target + back * way, DIGITS)
        if _sees(camera, eye, target, corners):
            return eye, target
        back *= STEP
    return None


def _sees(camera: Camera, eye: Floats, target: Floats, points: Floats) -> bool:
    moved = camera.model_copy(update={"eye": tuple(map(float, eye)), "target": tuple(map(float, target))})
    return bool(in_frame(moved, points).all())
