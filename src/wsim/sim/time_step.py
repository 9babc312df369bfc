"""The time step, chosen from what is in the stage."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from wsim.geometry.shapes import kind_of
from wsim.scene.world import Body, World

LARGEST_RIGID_STEP = 1.0 / 800.0  # [s]: contacts are as hard as the step allows
SHARE_OF_SIZE = 0.25  # a body may cross this share of the thinnest thing in a step


@dataclass(frozen=True)
class TimeStep:
    """A step that divides the frame evenly."""

    dt: float  # [s]
    substeps: int  # steps a frame
    reason: str  # what limited it


def choose_time_step(world: World, fluid_limit: float | None, given: float | None = None) -> TimeStep:
    """Largest step within the limits of the fluid and of the bodies, or the one that was asked for.

    Args:
        world: What is simulated.
        fluid_limit: The SPH solver's acoustic limit [s], if there is a fluid.
        given: A step from the caller or the stage [s]; taken as an upper bound, so that frames stay regular.
    """
    limits = {"rigid bodies": LARGEST_RIGID_STEP}
    crossing = _crossing_time(world)
    if crossing is not None:
        limits["the fastest body across the thinnest shape"] = SHARE_OF_SIZE * crossing
    if fluid_limit is not None:
        limits["sound in the fluid"] = fluid_limit
    reason = min(limits, key=limits.__getitem__)
    limit = limits[reason]
    if given:
        limit, reason = given, "given"
    frame = 1.0 / world.frame_rate
    substeps = max(1, math.ceil(frame / limit - 1e-9))
    return TimeStep(frame / substeps, substeps, reason)


def _crossing_time(world: World) -> float | None:
    """Time that the fastest body takes to cross the thinnest shape [s], from its start and its fall."""
    extents = [thickness(body) for body in world.bodies]
    if not extents:
        return None
    g = float(np.linalg.norm(world.gravity))
    fall = max(max(body.position[2] for body in world.bodies) - min(0.0, *(b.position[2] for b in world.bodies)), 0.0)
    start = max(float(np.linalg.norm(body.velocity)) for body in world.bodies)
    return min(extents) / max(math.sqrt(start**2 + 2.0 * g * fall), 1e-3)


def thickness(body: Body) -> float:
    """Smallest extent of a body's smallest shape that collides [m]."""
    thinnest = [kind_of(shape).thinnest for shape in body.shapes if shape.collides and shape.kind != "plane"]
    return max(min(thinnest, default=0.1), 1e-3)
