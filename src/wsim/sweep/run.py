"""The sweep: candidates are run and judged, ranked, and the telling ones run again in full."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from wsim.progress import Progress, silent
from wsim.sweep import shards
from wsim.sweep.candidate import Candidate, Outcome
from wsim.sweep.cluster import RayWorkers, connect
from wsim.sweep.pool import Pool
from wsim.sweep.search import Search
from wsim.sweep.shards import Dealer, Lost
from wsim.sweep.table import ranked, write
from wsim.sweep.turns import SHARING, sharing
from wsim.sweep.work import Shard, work

if TYPE_CHECKING:
    from wsim.sweep.folder import SweepFolder
    from wsim.sweep.spec import Spec
    from wsim.sweep.store import Store

A_SHARD = 16  # candidates that are built in one process: starting it takes as long as building them
SHORTEST = 8  # times fewer in the last shards
SHORTEST_SHARED = 2  # where workers share a GPU: what a batch takes beside its worlds is not shortened with it


def sweep(
    folder: SweepFolder, workers: int = 0, progress: Progress = silent, ray: str = "", store: Store | None = None
) -> list[Outcome]:
    """Run what is not done yet; the table is whole whenever this ends, also by Ctrl-C.

    Args:
        folder: With what is asked; outcomes go there as they come.
        workers: Processes; by default one for each core, on GPUs one or two for each.
        progress: Told how many candidates are done.
        ray: A Ray cluster whose workers do it, as `wsim.sweep.cluster.connect` takes it; "": processes of this machine.
        store: Where outcomes are sent as they come; the table is not.

    Returns:
        All outcomes, the best first.
    """
    done, spec = folder.outcomes(), folder.spec
    count = spec.count  # drawn anew each time that it is asked for
    progress("candidates", len(done), count)
    try:
        for batch in batches(spec, done):
            left = [candidate for candidate in batch if candidate.number not in done]
            for outcomes in run(left, folder, workers, ray):
                for outcome in outcomes:
                    folder.add(outcome)
                    done[outcome.candidate.number] = outcome
                if store:
                    store.part(folder)
                progress("candidates", min(len(done), count), count)
    finally:
        if done:
            write(list(done.values()), folder.path)
    progress("candidates", count, count)
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
    search, first, count = Search(spec.axes, spec.seed, spec.batch), spec.each, spec.count
    yield spec.of([{}], 0)
    while first < count and not search.done:
        batch = spec.of(search.ask(), first)
        yield batch
        # Of the programs and seeds at a point the worst counts: it is to hold for all of them.
        came = [done[candidate.number] for candidate in batch]
        search.tell([max(came[k : k + spec.each], key=lambda o: o.rank) for k in range(0, len(came), spec.each)])
        first += len(batch)


def run(
    candidates: Sequence[Candidate], folder: SweepFolder, workers: int = 0, ray: str = ""
) -> Iterator[list[Outcome]]:
    """Every candidate's outcome, some at a time, as they come.

    Who shares a shard with one that kills its worker, or holds it up, is run again without it.

    Args:
        candidates: They.
        folder: Of the sweep that they belong to.
        workers: How many; by default one for each core, on GPUs one for each, or two that take turns at it
            (`wsim.sweep.turns`) where there is more than a batch for each.
        ray: A Ray cluster whose workers do it; "": processes of this machine.
    """
    if not candidates:
        return
    spec, asked = folder.spec, min(workers, len(candidates))
    with tempfile.TemporaryDirectory(prefix="wsim-turns-") as turns:
        doing = _on_cluster(folder, asked, ray) if ray else _here(spec, asked, len(candidates), Path(turns))
        alone = spec.device.startswith("cuda") and bool(ray or "," in spec.device)
        pack = packed(folder.path.resolve(), spec, max(1, doing.cores), alone)
        shared = isinstance(doing, Pool) and doing.shared
        for found in shards.run(dealer(spec, len(candidates), shared), candidates, pack, doing):
            yield [_lost(candidate, came) if isinstance(came, Lost) else came for candidate, came in found]


def _on_cluster(folder: SweepFolder, count: int, ray: str) -> RayWorkers:
    spec = folder.spec
    files = {name: folder.path / name for name in [*spec.programs, "plan.json"]}
    contents = {name: path.read_bytes() for name, path in files.items() if path.is_file()}
    return RayWorkers(connect(ray), contents, spec.device.startswith("cuda"), count)


def _here(spec: Spec, asked: int, candidates: int, turns: Path) -> Pool:
    """Processes of this machine, as many as are asked for, or 0.

    Those that share a GPU have the same cores: one steps on it while the other needs them.
    """
    cores, devices = len(os.sched_getaffinity(0)), spec.device.split(",")
    if not spec.device.startswith("cuda"):
        count = asked or cores
        return Pool(work, count, cores=max(1, cores // count))
    count = asked or len(devices) * (SHARING if candidates > len(devices) * spec.together else 1)
    seen = [_seeing(device) if len(devices) > 1 else {} for device in devices]
    environments = [{**sees, **sharing(turns, device)} for sees, device in zip(seen, devices, strict=True)]
    return Pool(work, count, environments, max(1, cores // min(count, len(devices))))


def dealer(spec: Spec, count: int, shared: bool = False) -> Dealer:
    """Of so many candidates: shards of as many as are simulated at once, or of a few.

    Args:
        spec: The sweep's.
        count: Candidates.
        shared: Whether workers share a device.
    """
    most = spec.together if spec.together > 1 else A_SHARD
    return Dealer(count, most, spec.patience, max(1, most // (SHORTEST_SHARED if shared else SHORTEST)))


def packed(folder: Path, spec: Spec, cores: int, alone: bool) -> Callable[[tuple[Candidate, ...]], Shard]:
    """What a worker is sent of some candidates; of several GPUs each worker sees its own alone."""
    device = "cuda:0" if alone else spec.device
    small = spec.model_copy(update={"device": device, "points": []})  # a million points are not sent with each shard
    return lambda candidates: Shard(candidates, folder, small, cores)


def _seeing(device: str) -> dict[str, str]:
    """Variables with which a process sees one GPU alone; which of those that this one sees is in the device's name."""
    index = int(device.removeprefix("cuda:"))
    seen = os.environ.get("CUDA_VISIBLE_DEVICES", "")
    return {"CUDA_VISIBLE_DEVICES": seen.split(",")[index] if seen else str(index)}


def _lost(candidate: Candidate, lost: Lost) -> Outcome:
    return Outcome(candidate=candidate, status="failed", reason=lost.reason)
