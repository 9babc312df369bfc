"""All objectives, by their kind in a plan.

A module of objectives ends with `OBJECTIVES`, its classes by kind; a new module is named here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsim.judge.objectives import fluid, hinge, motion, solid

if TYPE_CHECKING:
    from wsim.judge.objectives.objective import Objectives

OBJECTIVES: Objectives = {**fluid.OBJECTIVES, **solid.OBJECTIVES, **hinge.OBJECTIVES, **motion.OBJECTIVES}
