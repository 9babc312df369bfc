"""All checks, in the order of their findings.

A module of checks ends with `CHECKS`, its classes; a new module is named here, in one of the two lists.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.judge.checks import (
    buoyancy,
    camera,
    catches,
    contact,
    continuity,
    cord,
    energy,
    fluid,
    fluid_books,
    fluid_height,
    fluid_push,
    forces,
    impacts,
    joint,
    lift,
    mass,
    motion,
    openings,
    physics,
    plan,
    plan_closed,
    plan_contacts,
    plan_cords,
    plan_joints,
    plan_land,
    plan_motion,
    plan_openings,
    plan_vehicles,
    recorded,
    recorded_state,
    recorded_ties,
    rest,
    rolling,
    run,
    scheduled,
    settled,
    stated,
    water,
)

if TYPE_CHECKING:
    from wsim.judge.checks.check import Check

RUN = (run,)
PHYSICS = (
    physics, settled, stated, scheduled, continuity, motion, forces, recorded, recorded_state, recorded_ties, impacts,
    rolling, catches, energy, contact, rest, joint, cord, mass, plan, plan_closed, plan_joints, plan_cords,
    plan_contacts, plan_motion, plan_openings, plan_vehicles, plan_land,
    fluid, openings, fluid_books, fluid_push, lift, buoyancy, fluid_height, water, camera,
)  # fmt: skip


def run_checks() -> list[Check]:
    """The checks that need no finite numbers."""
    return [check() for module in RUN for check in module.CHECKS]


def physics_checks() -> list[Check]:
    """The checks of what the numbers say."""
    return [check() for module in PHYSICS for check in module.CHECKS]
