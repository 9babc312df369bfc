"""Contacts as hard as the time step allows, that bounce as their materials say."""

from __future__ import annotations

import math
from typing import Any

HARD_STEPS = 2.5  # 1 / (natural frequency x time step); MuJoCo keeps a contact's time constant above two steps
BOUNCY_STEPS = 6.0  # a body that is found x deep after its first step in contact gains x^2 of the spring's energy
RAW_SOLREF = 1  # Newton's mode for a time constant and a damping ratio that are taken as they are
SMALLEST_DAMPING = 0.02  # a restitution of 0.94; below, the contact's spring rings for longer than it should


def rebound(ratio: float) -> float:
    """Share of its speed with which a body leaves a spring and damper of a damping ratio in 0..1.

    It leaves when the force vanishes, not when the spring is relaxed: with sin(phi) = zeta,
    e = exp(-tan(phi) (pi - 2 phi)), which is exp(-2) at critical damping.
    """
    phi = math.asin(min(ratio, 1.0 - 1e-9))
    return math.exp(-math.tan(phi) * (math.pi - 2.0 * phi))


def damping_ratio(restitution: float) -> float:
    """Damping ratio whose rebound is `restitution`; critical damping where that is below exp(-2)."""
    low, high = SMALLEST_DAMPING, 1.0
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if rebound(middle) > restitution else (low, middle)
    return 0.5 * (low + high)


def harden_contacts(builder: Any, dt: float) -> None:
    """Set MuJoCo's contact spring of every shape from the time step and the shape's restitution.

    MuJoCo's default time constant of 20 ms lets a steel ball that lands at 2 m/s sink 13 mm into a tank's floor. The
    natural frequency here is 1 / (2.5 dt), or 1 / (6 dt) for shapes that bounce. Two shapes in contact share the mean
    of their time constants and damping ratios, so a restitution holds between shapes of the same one,
    to about 0.04: the time step falls anywhere into the contact.

    Args:
        builder: The `newton.ModelBuilder`, with MuJoCo's custom attributes registered.
        dt: Time step [s].
    """
    solref, mode = {}, {}
    for shape, restitution in enumerate(builder.shape_material_restitution):
        ratio = damping_ratio(float(restitution))
        steps = HARD_STEPS if ratio > 0.999 else BOUNCY_STEPS
        solref[shape] = (steps * dt / ratio, ratio)
        mode[shape] = RAW_SOLREF
    builder.custom_attributes["mujoco:solref"].values = solref
    builder.custom_attributes["mujoco:solref_mode"].values = mode
