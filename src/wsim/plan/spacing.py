"""How far apart a fluid's particles are."""

from __future__ import annotations

import math
from collections.abc import Sequence

from wsim.plan.schema import Plan, PlanObject

PARTICLES = 8000  # of a fluid whose spacing the plan leaves open
ACROSS = 4  # of them at least, on its least edge


def spacing_of(plan: Plan, fluid: PlanObject, edges: Sequence[float]) -> float:
    """The fluid's own spacing, or that of the plan, or one that gives some thousand particles [m].

    Args:
        plan: Whose fluid it is.
        fluid: The object.
        edges: Of the box that it fills at the start [m].
    """
    return fluid.registration.spacing or plan.simulation.spacing or _left_open(edges)


def _left_open(edges: Sequence[float]) -> float:
    return float(f"{min((math.prod(edges) / PARTICLES) ** (1 / 3), min(edges) / ACROSS):.2g}")
