"""Several patches of a program, each tried in a process of its own as far as the physics go."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace

from wsim.judge.verdict import Verdict
from wsim.progress import Progress, silent
from wsim.runs.attempt import Attempt, Reached, attempt
from wsim.runs.iteration import Iteration
from wsim.sweep.pool import each
from wsim.sweep.shards import Lost


def side_by_side(iterations: Sequence[Iteration], seconds: float, progress: Progress = silent) -> list[Attempt]:
    """Each iteration's attempt without pictures, in the iterations' order; what they find is in their folders.

    A patch that kills its process, or is not done when the time is over, is blocked, and the others go on.

    Args:
        iterations: Folders with a program each.
        seconds: That are left for all of them [s].
        progress: Told how many are done.
    """
    found: dict[str, Attempt] = {}
    tasks = [replace(iteration, progress=silent) for iteration in iterations]
    progress("patches side by side", 0, len(tasks))
    for task, result in each(physics_of, tasks, len(os.sched_getaffinity(0)), seconds):
        found[task.folder.name] = _lost(task, result) if isinstance(result, Lost) else result
        progress("patches side by side", len(found), len(tasks))
    return [found[iteration.folder.name] for iteration in iterations]


def physics_of(iteration: Iteration) -> Attempt:
    """The passes up to the physics: an attempt that reaches them all is still to be recorded with pictures."""
    quick = replace(iteration.settings, pictures=False, verify=False)
    tried = attempt(replace(iteration, settings=quick))
    tried.reached = min(tried.reached, Reached.PHYSICS)
    return tried


def _lost(iteration: Iteration, lost: Lost) -> Attempt:
    verdict = iteration.conclude(Verdict(status="blocked", summary=f"The patch was given up: {lost.reason}."))
    return Attempt(iteration.folder, iteration.text, Reached.BUILD, verdict)
