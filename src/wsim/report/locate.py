"""Where a prim is in a camera's picture."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from wsim.geometry.shapes import kind_of
from wsim.scene.following import camera_at

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsim.recording import Recording
    from wsim.scene.world import Camera

    Ball = tuple[tuple[float, float, float], float]  # centre and radius [m]

NEAR = 1e-3  # [m]: nothing nearer than this to a camera is in its picture
MARGIN = 1.15  # of a ring's radius


def where_is(recording: Recording, prim: str | None, time: float) -> Ball | None:
    """A ball about a body, or a joint's child, at a time [s]; None for what is neither, or is nowhere."""
    # A joint is where its child is.
    prim = next((joint.child for joint in recording.world.joints if joint.prim == prim), prim)
    for i, body in enumerate(recording.world.bodies):
        if body.prim == prim and body.shapes:
            position = recording.body_q[recording.frame_index(time), i, :3]
            reach = max(
                math.dist((0.0, 0.0, 0.0), shape.position) + kind_of(shape).radius_about for shape in body.shapes
            )
            if np.isfinite(position).all() and math.isfinite(reach):
                x, y, z = (float(value) for value in position)
                return (x, y, z), reach
    return None


def camera_then(recording: Recording, camera: Camera, time: float) -> Camera:
    """A camera where it was at a time [s]: that of the body that it follows, if it follows one."""
    if camera.follows is None:
        return camera
    row = [body.prim for body in recording.world.bodies].index(camera.follows)
    return camera_at(camera, recording.world, recording.body_q[recording.frame_index(time), row])


def ring_of(camera: Camera, center: Sequence[float], reach: float) -> tuple[float, float, float] | None:
    """A ball in a pinhole camera's picture as (x, y, radius) in widths of the picture; None where it is out of view.

    Args:
        camera: That looks from its eye to its target.
        center: Of the ball, (3,) [m].
        reach: Its radius [m].
    """
    forward = np.subtract(camera.target, camera.eye)
    forward = forward / np.linalg.norm(forward)
    right = np.cross(forward, camera.up)
    right = right / max(float(np.linalg.norm(right)), 1e-12)
    offset = np.subtract(center, camera.eye)
    depth = float(offset @ forward)
    if depth < NEAR:
        return None
    focal = 0.5 / math.tan(0.5 * math.radians(camera.fov))  # in widths, as `fov` is across
    x = 0.5 + focal * float(offset @ right) / depth
    y = 0.5 * camera.height / camera.width - focal * float(offset @ np.cross(right, forward)) / depth
    if not (0.0 <= x <= 1.0 and 0.0 <= y <= camera.height / camera.width):
        return None
    return x, y, MARGIN * focal * reach / depth
