"""What a simulation takes in: stages that were checked, by whoever built them or here."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from wsim.errors import UserError
from wsim.scene.check import check_stage
from wsim.scene.describe import describe
from wsim.scene.world import World


def entered(stages: Sequence[Path], worlds: Sequence[World]) -> Sequence[World]:
    """What the stages state: `worlds`, if whoever checked them read them already; else each is checked and read once.

    Where its files lie is the caller's own choice: what must keep to some folders is checked before it comes here.

    Raises:
        UserError: A stage is not one that can be simulated; one line with the first problem and how many there are.
    """
    if worlds:
        return worlds
    for stage in dict.fromkeys(stages):
        problems = check_stage(stage, [stage.resolve().anchor])
        if problems:
            more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
            raise UserError(f"{stage}: {problems[0]}{more}")
    return [describe(stage) for stage in stages]
