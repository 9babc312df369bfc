"""Candidates of one topology, simulated as one batch of worlds and judged from its arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from wsim.judge.worlds import verdict_of
from wsim.runs.simulation import is_controlled
from wsim.scene.describe import describe
from wsim.sim import Simulation
from wsim.sim.alike import alike
from wsim.sim.collect import collect

if TYPE_CHECKING:
    from wsim.judge.verdict import Verdict
    from wsim.plan.schema import Plan
    from wsim.runs.iteration import Iteration
    from wsim.sweep.candidate import Candidate

    Member = tuple[Candidate, Iteration]  # whose stage is built

NO_ROOM = ("out of memory", "failed to allocate", "memory allocation")


def batches(members: Sequence[Member], most: int) -> list[list[Member]]:
    """Those that can be simulated together, at most so many at a time; who must go alone is in none.

    A program with a `control` is asked world by world, and worlds with fluid are not batched.
    """
    free = [member for member in members if not is_controlled(member[1].program)]
    worlds = [describe(iteration.stage) for _, iteration in free]
    dry = [k for k, world in enumerate(worlds) if not world.fluids and world.bodies]
    found = []
    for group in alike([worlds[k] for k in dry]):
        own = [free[dry[k]] for k in group]
        found += [own[first : first + most] for first in range(0, len(own), most)]
    return [batch for batch in found if len(batch) > 1]


def verdicts(batch: Sequence[Member], plan: Plan | None) -> list[Verdict]:
    """Each member's verdict. A batch that does not fit into memory is simulated in halves.

    Raises:
        UserError, ValueError, RuntimeError: If a member cannot be simulated with the others.
    """
    settings = batch[0][1].settings
    try:
        simulation = Simulation(
            [iteration.stage for _, iteration in batch],
            device=settings.device,
            time_step=settings.time_step,
            seeds=[candidate.seed for candidate, _ in batch],
        )
        worlds = collect(simulation)
    except (MemoryError, RuntimeError) as error:
        if len(batch) < 2 or not _is_no_room(error):
            raise
        half = len(batch) // 2
        return verdicts(batch[:half], plan) + verdicts(batch[half:], plan)
    return [verdict_of(worlds, plan, k) for k in range(len(batch))]


def _is_no_room(error: Exception) -> bool:
    return isinstance(error, MemoryError) or any(text in str(error).lower() for text in NO_ROOM)
