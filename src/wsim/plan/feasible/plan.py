"""Everything that keeps a plan from coming true, in one list."""

from __future__ import annotations

from pathlib import Path

from wsim.errors import UserError
from wsim.plan.feasible.fluids import fluid_faults
from wsim.plan.feasible.freedom import freedom_faults
from wsim.plan.feasible.joints import joint_faults
from wsim.plan.feasible.kinds import kind_faults
from wsim.plan.feasible.motions import motion_faults
from wsim.plan.feasible.objectives import objective_faults
from wsim.plan.feasible.starts import start_faults
from wsim.plan.schema import Plan

SHOWN = 8  # faults in a message


def faults(plan: Plan) -> list[str]:
    """What no run of a laid-out plan can show, a line each with its path and the way out."""
    every = (fluid_faults, joint_faults, freedom_faults, kind_faults, motion_faults, objective_faults, start_faults)
    return [fault for each in every for fault in each(plan)]


def refuse_impossible(plan: Plan, where: str | Path = "plan") -> None:
    """Refuse a plan that cannot come true.

    Raises:
        UserError: What it says that no run can show.
    """
    found = faults(plan)
    if found:
        raise UserError(f"{where}: it cannot come true: {'; '.join(found[:SHOWN])}")
