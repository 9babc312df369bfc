"""The sweep: candidates are run and judged, ranked, and the telling ones run again in full."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from wsim.progress import Progress, silent
from wsim.sweep.candidate import Candidate, Outcome
from wsim.sweep.pool import Lost, Pool
from wsim.sweep.search import Search
from wsim.sweep.table import ranked, write
from wsim.sweep.work import Job, work

if TYPE_CHECKING:
    from wsim.sweep.folder import SweepFolder
    from wsim.sweep.spec import Spec


def sweep(folder: SweepFolder, workers: int = 0, progress: Progress = silent) -> list[Outcome]:
    """Run what is not done yet; the table is whole whenever this ends, also by Ctrl-C.

    Args:
        folder: With what is asked; outcomes go there as they come.
        workers: Processes; by default one for each core.
        progress: Told how many candidates are done.

    Returns:
        All outcomes, the best first.
    """
    done, spec = folder.outcomes(), folder.spec
    progress("candidates", len(done), spec.count)
    try:
        for batch in batches(spec, done):
            left = [candidate for candidate in batch if candidate.number not in done]
            for outcome in run(left, folder, workers):
                folder.add(outcome)
                done[outcome.candidate.number] = outcome
                progress("candidates", min(len(done), spec.count), spec.count)
    finally:
        if done:
            write(list(done.values()), folder.path)
    progress("candidates", spec.count, spec.count)
    best_first = ranked(list(done.values()))
    folder.finish(best_first)
    return best_first


def batches(spec: Spec, done: Mapping[int, Outcome]) -> Iterator[list[Candidate]]:
    """What is run side by side: all at once, or what a search asks for next.

    Args:
        spec: What is asked.
        done: By candidate; each batch is in it when the next one is taken. A search that goes on asks again for what
            is in it already, since the same answers make the same questions.
    """
    if spec.method != "cma" or spec.points or not spec.axes:
        yield spec.candidates()
        return
    search, first = Search(spec.axes, spec.seed, spec.batch), spec.each
    yield spec.of([{}], 0)
    while first < spec.count and not search.done:
        batch = spec.of(search.ask(), first)
        yield batch
        # Of the programs and seeds at a point the worst counts: it is to hold for all of them.
        came = [done[candidate.number] for candidate in batch]
        search.tell([max(came[k : k + spec.each], key=lambda o: o.rank) for k in range(0, len(came), spec.each)])
        first += len(batch)


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
