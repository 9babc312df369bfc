"""The worlds of a sweep, judged at once from arrays: each gets the verdict that it would get alone."""

from __future__ import annotations

import multiprocessing
import os
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wsim.judge.decide import judge, judge_copies
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.language import Signals, evaluate
from wsim.progress import Progress, silent

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.language import Outcome
    from wsim.judge.verdict import Finding, Status, Verdict
    from wsim.plan.schema import Plan
    from wsim.plan.schema.formula import Formula
    from wsim.recording.trajectories import Trajectories

    Row = tuple[Status, dict[str, tuple[bool, float]]]  # a world's status, and its findings by key

CHUNK = 64  # worlds judged at once, between two reports of progress
_shared: tuple[Trajectories, Plan | None]  # in a worker: what it was started with


@dataclass(frozen=True, eq=False)
class WorldVerdicts:
    """What was found in each of W worlds.

    Attributes:
        accepted: (W,).
        status: (W,), each accepted, rejected or blocked.
        passed: By finding, (W,): whether it passed; True where a world has no such finding.
        margin: By finding, (W,): distance to its limit in its unit, positive = satisfied; NaN where it has none.
            A finding's key is its objective's sentence or its check's name, numbered where there are several.
    """

    accepted: NDArray[np.bool_]
    status: list[Status]
    passed: dict[str, NDArray[np.bool_]]
    margin: dict[str, NDArray[np.float64]]

    def failures(self, k: int) -> list[str]:
        """The keys of what failed in world k."""
        return [key for key, passed in self.passed.items() if not passed[k]]


def judge_worlds(
    worlds: Trajectories, plan: Plan | None = None, processes: int | None = None, progress: Progress = silent
) -> WorldVerdicts:
    """Judge every world by the checks that always run, and by a plan's objectives, without a recording on disk.

    Worlds are independent: they are shared out to processes that see the arrays where they are, uncopied; each works
    some out at once (`wsim.judge.decide.judge_copies`). One process, or a system that cannot fork, takes them in turn.

    Args:
        worlds: The copies.
        plan: What they are held against.
        processes: How many; by default one for each core that this process may use.
        progress: Told how many worlds are judged.
    """
    count = worlds.world_count
    rows: list[Row] = []
    for part in _parts(worlds, plan, processes or len(os.sched_getaffinity(0))):
        rows += part
        progress("judging", len(rows), count)
    keys = list(dict.fromkeys(key for _, found in rows for key in found))
    none = (True, np.nan)
    return WorldVerdicts(
        accepted=np.array([status == "accepted" for status, _ in rows], dtype=bool),
        status=[status for status, _ in rows],
        passed={key: np.array([found.get(key, none)[0] for _, found in rows], dtype=bool) for key in keys},
        margin={key: np.array([found.get(key, none)[1] for _, found in rows]) for key in keys},
    )


def weigh(worlds: Trajectories, formula: Formula) -> Outcome:
    """One formula on all worlds in one go: what a sweep is ranked by. Raises as `wsim.judge.language.evaluate`."""
    arrays = (worlds.body_q, worlds.body_qd, worlds.contact_force)
    return evaluate(formula, Signals(worlds.world, worlds.time, *arrays, mass=worlds.mass))


def verdict_of(worlds: Trajectories, plan: Plan | None, k: int) -> Verdict:
    """World k's verdict in full."""
    return judge(worlds.recording(k), plan)


def _parts(worlds: Trajectories, plan: Plan | None, processes: int) -> Iterator[list[Row]]:
    """The rows of all worlds in order, some at a time."""
    chunks = [range(k, min(k + CHUNK, worlds.world_count)) for k in range(0, worlds.world_count, CHUNK)]
    if min(processes, len(chunks)) < 2 or "fork" not in multiprocessing.get_all_start_methods():
        yield from (_judged(worlds, plan, chunk) for chunk in chunks)
        return
    # A forked child has the arrays already. It does no more than NumPy and the judge: it never touches a device.
    fork = multiprocessing.get_context("fork")
    with ProcessPoolExecutor(processes, fork, initializer=_take, initargs=(worlds, plan)) as pool:
        yield from pool.map(_rows, chunks)


def _take(worlds: Trajectories, plan: Plan | None) -> None:
    global _shared
    _shared = (worlds, plan)


def _rows(chunk: range) -> list[Row]:
    return _judged(*_shared, chunk)


def _judged(worlds: Trajectories, plan: Plan | None, chunk: range) -> list[Row]:
    copies = [Evidence(worlds.recording(k), plan) for k in chunk]
    together = [[each] for each in copies] if worlds.worlds else [copies]  # each of its own shapes, or all of the same
    return [_row(verdict) for some in together for verdict in judge_copies(some)]


def _row(verdict: Verdict) -> Row:
    seen: Counter[str] = Counter()
    found: dict[str, tuple[bool, float]] = {}
    for finding in verdict.findings:
        name = _name(finding)
        seen[name] += 1
        key = name if seen[name] == 1 else f"{name} ({seen[name]})"
        found[key] = (finding.passed, np.nan if finding.margin is None else finding.margin)
    return verdict.status, found


def _name(finding: Finding) -> str:
    return finding.objective or finding.check
