"""How long a step springs can take, and whether their dampers ask for implicit integration."""

from __future__ import annotations

import math

import numpy as np

from wsim.errors import UserError
from wsim.scene.world import Body, Guide, Spring, World

DRIVE_SHARE = 0.25  # of 1 / omega of a drive or a spring: its force is taken at the step's start
SMALLEST_DRIVE_STEP = 1e-5  # [s]


def spring_limits(world: World) -> dict[str, float]:
    """How long a step each spring can take: a share of its fastest oscillation, 1 / omega [s].

    With K = sum k u uᵀ, u each spring's row over the bodies divided by the roots of their masses, omega² is at most
    the largest sum over a body's springs of k |u there| (|u there| + |u at the other end|): Gershgorin's circles.

    Raises:
        UserError: If a spring is so stiff that no step of `SMALLEST_DRIVE_STEP` or more can follow it.
    """
    bodies = {body.prim: body for body in world.bodies}
    rows = {spring.prim: _rows(spring, bodies) for spring in world.springs}
    circles: dict[str, float] = {}
    for spring in world.springs:
        ends = rows[spring.prim]
        for prim, size in ends.items():
            circles[prim] = circles.get(prim, 0.0) + spring.stiffness * size * sum(ends.values())
    limits = {}
    for spring in world.springs:
        square = max((circles[prim] for prim in rows[spring.prim]), default=0.0)
        if spring.stiffness <= 0.0 or square <= 0.0:
            continue
        step = DRIVE_SHARE / math.sqrt(square)
        if step < SMALLEST_DRIVE_STEP:
            most = spring.stiffness * (step / SMALLEST_DRIVE_STEP) ** 2
            raise UserError(
                f"{spring.prim}: stiffness = {spring.stiffness:.4g} N/m on what it moves would need a time step of "
                f"{step:.1e} s; give at most {most:.2g} N/m, or more mass"
            )
        limits[f"the spring {spring.prim}"] = step
    return limits


def is_overdamped_spring(world: World, dt: float, share: float) -> bool:
    """Whether a spring's damper takes more than a share of a speed away in a step of `dt` [s]."""
    bodies = {body.prim: body for body in world.bodies}
    return any(
        spring.damping * dt * sum(size**2 for size in _rows(spring, bodies).values()) > share
        for spring in world.springs
    )


def _rows(spring: Spring, bodies: dict[str, Body]) -> dict[str, float]:
    """How fast each of a spring's ends gives way, as the root of what it yields to a push [1/sqrt(kg)]."""
    found = {}
    for guide in spring.path:
        body = bodies.get(guide.body or "")
        if body is not None and not body.kinematic:
            found[body.prim] = math.sqrt(_yields(body, guide))
    return found


def _yields(body: Body, guide: Guide) -> float:
    """The most that a body's point yields to a push, in any direction [1/kg]; on joints it yields less."""
    x, y, z = np.array(guide.position) - np.array(body.com)
    arm = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turning = np.linalg.inv(np.array(body.inertia).reshape(3, 3))
    return 1.0 / body.mass + float(np.linalg.eigvalsh(arm.T @ turning @ arm)[-1])
