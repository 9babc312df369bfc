"""The sweep: candidates are run and judged, ranked, and the telling ones run again in full."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from wsim.progress import Progress, silent
from wsim.sweep.candidate import Candidate, Outcome
from wsim.sweep.pool import Lost, Pool
from wsim.sweep.search import Search
from wsim.sweep.table import ranked, write
from wsim.sweep.work import Shard, work

if TYPE_CHECKING:
    from wsim.sweep.folder import SweepFolder
    from wsim.sweep.spec import Spec

A_SHARD = 16  # candidates that are built in one process: starting it takes as long as building them
SHARDS_A_WORKER = 4  # so that none waits long for the last


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
            for outcomes in run(left, folder, workers):
                for outcome in outcomes:
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


def run(candidates: Sequence[Candidate], folder: SweepFolder, workers: int = 0) -> Iterator[list[Outcome]]:
    """Every candidate's outcome, some at a time, in the order in which they are done.

    Who shares a shard with one that kills its worker, or holds it up, is run again by itself.
    """
    spec, workers = folder.spec, workers or _workers(folder.spec)
    shared = parts(candidates, spec.together, workers)
    cores = max(1, len(os.sched_getaffinity(0)) // max(1, min(workers, len(shared))))
    shards = [Shard(part, folder.path.resolve(), spec, cores) for part in shared]
    left: list[Shard] = []
    for shard, result in _on_pool(shards, workers):
        if not isinstance(result, Lost):
            yield result
        elif len(shard.candidates) > 1:
            left += [replace(shard, candidates=(candidate,)) for candidate in shard.candidates]
        else:
            yield [_lost(shard, result)]
    for shard, result in _on_pool(left, workers):
        yield [_lost(shard, result)] if isinstance(result, Lost) else result


def parts(candidates: Sequence[Candidate], together: int, workers: int) -> list[tuple[Candidate, ...]]:
    """Shards of candidates: as many as are simulated at once, or a few, of which each worker has several."""
    size = together if together > 1 else min(A_SHARD, max(1, len(candidates) // (SHARDS_A_WORKER * workers)))
    return [tuple(candidates[first : first + size]) for first in range(0, len(candidates), size)]


def _workers(spec: Spec) -> int:
    """One for each core; on a GPU one, which has it for itself."""
    return 1 if spec.device.startswith("cuda") else len(os.sched_getaffinity(0))


def _on_pool(shards: Sequence[Shard], workers: int) -> Iterator[tuple[Shard, list[Outcome] | Lost]]:
    pool: Pool[Shard, list[Outcome]] = Pool(work, workers, _patience)
    return pool.run(shards)


def _patience(shard: Shard) -> float:
    return shard.patience


def _lost(shard: Shard, lost: Lost) -> Outcome:
    return Outcome(candidate=shard.candidates[0], status="failed", reason=lost.reason)
