"""All objectives, by their kind in a plan.

A module of objectives ends with `OBJECTIVES`, its classes by kind; a new module is named here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.judge.language.objective import ObjectiveFormula
from wsim.judge.objectives import fluid, hinge, motion, solid

if TYPE_CHECKING:
    from wsim.judge.objectives.objective import ObjectiveCheck, Objectives
    from wsim.plan.schema import Objective

OBJECTIVES: Objectives = {**fluid.OBJECTIVES, **solid.OBJECTIVES, **hinge.OBJECTIVES, **motion.OBJECTIVES}


def check_of(objective: Objective) -> ObjectiveCheck:
    """What puts an objective of a plan to the evidence."""
    return (OBJECTIVES[objective.kind] if objective.formula is None else ObjectiveFormula)(objective)
