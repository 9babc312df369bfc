"""How long a step springs and dampers can take."""

from __future__ import annotations

import math

import numpy as np

from wsim.errors import UserError
from wsim.limits import MIN_TIME_STEP
from wsim.scene.world import Body, Guide, Spring, World

DRIVE_SHARE = 0.25  # of 1 / omega of a drive or a spring: its force is taken at the step's start


def spring_limits(world: World) -> dict[str, float]:
    """How long a step each spring can take: a share of its fastest oscillation, 1 / omega, or of its decay [s].

    With K = sum k u uᵀ, u each spring's row over the bodies divided by the roots of their masses, omega² is at most
    the largest sum over a body's springs of k |u there| (|u there| + |u at the other end|): Gershgorin's circles. So is
    the rate of decay with the damping in place of k. A damper's force is taken at the step's start, too: MuJoCo Warp
    3.17 leaves a tendon's damping out of the implicit step of a loose body.

    Raises:
        UserError: If a spring is so stiff that no step of `MIN_TIME_STEP` or more can follow it.
    """
    bodies = {body.prim: body for body in world.bodies}
    rows = {spring.prim: _rows(spring, bodies) for spring in world.springs}
    limits = {}
    for name, unit, power in (("stiffness", "N/m", 0.5), ("damping", "N s/m", 1.0)):
        circles: dict[str, float] = {}
        for spring in world.springs:
            ends = rows[spring.prim]
            for prim, size in ends.items():
                circles[prim] = circles.get(prim, 0.0) + getattr(spring, name) * size * sum(ends.values())
        for spring in world.springs:
            value = float(getattr(spring, name))
            rate = max((circles[prim] for prim in rows[spring.prim]), default=0.0) ** power
            if value <= 0.0 or rate <= 0.0:
                continue
            step = DRIVE_SHARE / rate
            if step < MIN_TIME_STEP:
                most = value * (step / MIN_TIME_STEP) ** (1.0 / power)
                raise UserError(
                    f"{spring.prim}: {name} = {value:.4g} {unit} on what it moves would need a time step of "
                    f"{step:.1e} s; give at most {most:.2g} {unit}, or more mass"
                )
            limits[f"the {name} of {spring.prim}"] = step
    return limits


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
