"""The sweep: candidates are run and judged, ranked, and the telling ones run again in full."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from wsim.progress import Progress, silent
from wsim.sweep.candidate import Candidate, Outcome
from wsim.sweep.pool import Lost, Pool
from wsim.sweep.table import ranked, write
from wsim.sweep.work import Job, work

if TYPE_CHECKING:
    from wsim.sweep.folder import SweepFolder


def sweep(folder: SweepFolder, workers: int = 0, progress: Progress = silent) -> list[Outcome]:
    """Run what is not done yet; the table is whole whenever this ends, also by Ctrl-C.

    Args:
        folder: With what is asked; outcomes go there as they come.
        workers: Processes; by default one for each core.
        progress: Told how many candidates are done.

    Returns:
        All outcomes, the best first.
    """
    done = folder.outcomes()
    candidates = folder.spec.candidates()
    left = [candidate for candidate in candidates if candidate.number not in done]
    progress("candidates", len(done), len(candidates))
    try:
        for outcome in run(left, folder, workers):
            folder.add(outcome)
            done[outcome.candidate.number] = outcome
            progress("candidates", len(done), len(candidates))
    finally:
        if done:
            write(list(done.values()), folder.path)
    return ranked(list(done.values()))


def run(candidates: Sequence[Candidate], folder: SweepFolder, workers: int = 0) -> Iterator[Outcome]:
    """Every candidate's outcome, in the order in which they are done."""
    spec = folder.spec
    jobs = [Job(candidate, folder.path.resolve(), spec) for candidate in candidates]
    pool: Pool[Job, Outcome] = Pool(work, workers or len(os.sched_getaffinity(0)), spec.patience)
    for job, result in pool.run(jobs):
        if isinstance(result, Lost):
            yield Outcome(candidate=job.candidate, status="failed", reason=result.reason)
        else:
            yield result
