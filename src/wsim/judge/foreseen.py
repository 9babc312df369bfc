"""What is wrong with a world before anything happens in it: what the plan, the stage and the program tell alone."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.checks.plan_control import CheckPlanControl
from wsim.judge.evidence.evidence import Evidence
from wsim.recording.recording import Recording

if TYPE_CHECKING:
    from wsim.judge.verdict import Finding
    from wsim.plan.schema import Plan
    from wsim.scene.world import World


def foreseen(world: World, plan: Plan | None, controlled: bool) -> list[Finding]:
    """What the judge would find wrong with what steers a world, however it moves.

    Args:
        world: What the stage states.
        plan: What was asked for.
        controlled: Whether the program has a `control`.
    """
    start = Recording(
        path=Path(world.name),
        world=world,
        metadata={"controlled": controlled, "steered": controlled},
        time=np.zeros(1),
        body_q=np.array([[(*body.position, *body.rotation) for body in world.bodies]])
        .reshape(1, -1, 7)
        .astype(np.float32),
        body_qd=np.zeros((1, len(world.bodies), 6), dtype=np.float32),
        contact_force=np.zeros((1, len(world.bodies), 3), dtype=np.float32),
        fluids={},
        scalars={},
        log=[],
        images={},
    )
    return [finding for finding in CheckPlanControl().run(Evidence(start, plan)) if not finding.passed]
