"""The time step, chosen from what is in the stage."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wsim.errors import UserError
from wsim.geometry.rotations import rotate
from wsim.geometry.shapes import kind_of
from wsim.limits import MIN_TIME_STEP
from wsim.scene.usd_motion import curve_of
from wsim.scene.world import Body, Joint, World
from wsim.sim.cable_steps import cable_limits
from wsim.sim.spring_steps import DRIVE_SHARE, spring_limits

LARGEST_RIGID_STEP = 1.0 / 800.0  # [s]: contacts are as hard as the step allows
DAMPED_SHARE = 0.5  # of a speed, lost in a step
SHARE_OF_SIZE = 0.25  # a body may cross this share of the thinnest thing in a step
ON_TIME = 1e-3  # of an interval, by which it may be longer or shorter
DEARER = 2.0  # by which steps may be shorter for rates to be kept


@dataclass(frozen=True)
class TimeStep:
    """A step that divides the frame evenly."""

    dt: float  # [s]
    substeps: int  # steps a frame
    reason: str  # what limited it


def choose_time_step(world: World, fluid_limit: float | None, given: float | None = None) -> TimeStep:
    """Largest step within the limits of the fluid, the bodies and the drives, and the one that was asked for.

    Args:
        world: What is simulated.
        fluid_limit: The SPH solver's acoustic limit [s], if there is a fluid.
        given: A step from the caller or the stage [s]: one more upper bound.

    Raises:
        UserError: If a drive, a spring or a loaded chain needs a step of less than `MIN_TIME_STEP`, or one is given.
    """
    if given is not None and not MIN_TIME_STEP <= given < math.inf:
        raise UserError(f"time_step = {given!r} s: give {MIN_TIME_STEP:g} s or more, or leave it out")
    limits = {"rigid bodies": LARGEST_RIGID_STEP}
    crossing = _crossing_time(world)
    if crossing is not None:
        limits["the fastest body across the thinnest shape"] = SHARE_OF_SIZE * crossing
    if fluid_limit is not None:
        limits["sound in the fluid"] = fluid_limit
    limits |= _drive_limits(world)
    limits |= spring_limits(world) | cable_limits(world)
    if given is not None:
        limits["given"] = given
    reason = min(limits, key=limits.__getitem__)
    limit = limits[reason]
    frame = 1.0 / world.frame_rate
    least = max(1, math.ceil(frame / limit - 1e-9))
    rates = (*(policy.spec.rate for policy in world.policies), *(sensor.rate for sensor in world.sensors))
    substeps = _in_step(least, int(frame / MIN_TIME_STEP), [world.frame_rate / rate for rate in rates])
    return TimeStep(frame / substeps, substeps, reason)


def _in_step(least: int, most: int, intervals: Sequence[float]) -> int:
    """Steps a frame of which intervals are whole numbers, or nearly so if that would take too many.

    Args:
        least: That the limits ask for.
        most: That there may be.
        intervals: After which something takes its turn [frames].
    """
    if not intervals:
        return least
    counts = np.arange(least, max(least, min(most, int(DEARER * least))) + 1)
    steps = np.outer(intervals, counts)
    off = np.abs(np.maximum(np.rint(steps), 1.0) / steps - 1.0).max(axis=0)
    return int(counts[np.argmax(off <= max(off.min(), ON_TIME))])


def _drive_limits(world: World) -> dict[str, float]:
    """How long a step each drive with a stiffness can take: a share of its oscillation, 1 / omega [s]."""
    limits = {}
    for joint in world.joints:
        if joint.drive is None or joint.drive.stiffness <= 0.0:
            continue
        inertia = driven_inertia(world, joint)
        step = DRIVE_SHARE * math.sqrt(inertia / joint.drive.stiffness)
        if step < MIN_TIME_STEP:
            most = inertia * (DRIVE_SHARE / MIN_TIME_STEP) ** 2
            unit = "N/m" if joint.kind == "prismatic" else "N m/rad"
            raise UserError(
                f"{joint.prim}: drive.stiffness = {joint.drive.stiffness:.4g} {unit} on what it moves would need a "
                f"time step of {step:.1e} s; give at most {most:.2g} {unit}, or more mass"
            )
        limits[f"the drive of {joint.prim}"] = step
    return limits


def is_overdamped(world: World, dt: float) -> bool:
    """Whether a drive's damping takes a speed away in about a step, so that only implicit integration can follow it."""
    return any(
        joint.drive is not None and joint.drive.damping * dt > DAMPED_SHARE * driven_inertia(world, joint)
        for joint in world.joints
    )


def driven_inertia(world: World, joint: Joint) -> float:
    """What a joint's drive moves: inertia about its axis [kg m^2], or mass [kg], of its two ends together.

    What hangs on those ends adds to it, so a drive is at least as slow as that.
    """
    bodies = {body.prim: body for body in world.bodies}
    ends = ((joint.child, joint.child_anchor, joint.child_turn), (joint.parent, joint.parent_anchor, joint.parent_turn))
    yields = 0.0  # of both ends together: the sum of what each gives way
    for prim, anchor, turn in ends:
        body = bodies.get(prim or "")
        if body is None or body.kinematic:
            continue
        axis = rotate(np.array(turn), np.eye(3)["XYZ".index(joint.axis)])
        arm = np.array(anchor or body.com) - np.array(body.com)
        turned = float(axis @ np.array(body.inertia).reshape(3, 3) @ axis)
        turned += body.mass * float(arm @ arm - (arm @ axis) ** 2)
        yields += 1.0 / max(body.mass if joint.kind == "prismatic" else turned, 1e-12)
    return 1.0 / max(yields, 1e-12) + joint.armature


def _crossing_time(world: World) -> float | None:
    """Time that the fastest body takes to cross the thinnest shape [s], from its start and its fall.

    None where all bodies are led: they do not fall, and meet nothing that would be pushed.
    """
    extents = [thickness(body) for body in world.bodies]
    free = [body.position[2] for body in world.bodies if not body.kinematic]
    if not free:
        return None
    g = float(np.linalg.norm(world.gravity))
    fall = max(max(free) - min(0.0, *(body.position[2] for body in world.bodies)), 0.0)
    start = max(_fastest(body) for body in world.bodies)
    return min(extents) / max(math.sqrt(start**2 + 2.0 * g * fall), 1e-3)


def _fastest(body: Body) -> float:
    """Speed of a body at its start, or anywhere on its path [m/s]."""
    if body.path is not None:
        return float(curve_of(body.path).speeds()[0].max())
    return float(np.linalg.norm(body.velocity))


def thickness(body: Body) -> float:
    """Smallest extent of a body's smallest shape that collides [m]."""
    thinnest = [kind_of(shape).thinnest for shape in body.shapes if shape.collides and shape.kind != "plane"]
    return max(min(thinnest, default=0.1), 1e-3)
