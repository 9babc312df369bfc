"""The worlds of a sweep, judged at once from arrays: each gets the verdict that it would get alone."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from wsim.forks import shared_out, uncollected
from wsim.judge.decide import judge_copies
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.language import Signals, evaluate
from wsim.progress import Progress, silent

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wsim.judge.language import Outcome
    from wsim.judge.verdict import Crash, Finding, Status, Verdict
    from wsim.plan.schema import Plan
    from wsim.plan.schema.formula import Formula
    from wsim.recording.trajectories import Trajectories

    # A world's status, its findings by key, and what crashed.
    Row = tuple[Status, dict[str, tuple[bool, float]], list[Crash]]

Value = TypeVar("Value")
Take = Callable[["Verdict", Any], Value]  # what is made of a world's verdict, and of what is given with it

CHUNK = 64  # worlds judged at once, between two reports of progress


@dataclass(frozen=True, eq=False)
class WorldVerdicts:
    """What was found in each of W worlds.

    Attributes:
        accepted: (W,).
        status: (W,), each accepted, rejected or blocked.
        passed: By finding, (W,): whether it passed; True where a world has no such finding.
        margin: By finding, (W,): distance to its limit in its unit, positive = satisfied; NaN where it has none.
            A finding's key is its objective's sentence or its check's name, numbered where there are several.
        crashes: Of each world what could not be evaluated.
    """

    accepted: NDArray[np.bool_]
    status: list[Status]
    passed: dict[str, NDArray[np.bool_]]
    margin: dict[str, NDArray[np.float64]]
    crashes: list[list[Crash]]

    def failures(self, k: int) -> list[str]:
        """The keys of what failed in world k."""
        return [key for key, passed in self.passed.items() if not passed[k]]


def judge_worlds(
    worlds: Trajectories, plan: Plan | None = None, processes: int | None = None, progress: Progress = silent
) -> WorldVerdicts:
    """Judge every world by the checks that always run, and by a plan's objectives, without a recording on disk.

    Worlds are independent: they are shared out to processes (`wsim.forks`), each of which works some out at once
    (`wsim.judge.decide.judge_copies`).

    Args:
        worlds: The copies.
        plan: What they are held against.
        processes: How many; by default one for each core that this process may use.
        progress: Told how many worlds are judged.
    """
    count = worlds.world_count
    rows: list[Row] = []
    for part in _judged(worlds, plan, _row, [None] * count, processes or len(os.sched_getaffinity(0))):
        rows += part
        progress("judging", len(rows), count)
    keys = list(dict.fromkeys(key for _, found, _ in rows for key in found))
    none = (True, np.nan)
    return WorldVerdicts(
        accepted=np.array([status == "accepted" for status, *_ in rows], dtype=bool),
        status=[status for status, *_ in rows],
        passed={key: np.array([found.get(key, none)[0] for _, found, _ in rows], dtype=bool) for key in keys},
        margin={key: np.array([found.get(key, none)[1] for _, found, _ in rows]) for key in keys},
        crashes=[crashes for *_, crashes in rows],
    )


def weigh(worlds: Trajectories, formula: Formula) -> Outcome:
    """One formula on all worlds in one go: what a sweep is ranked by. Raises as `wsim.judge.language.evaluate`."""
    arrays = (worlds.body_q, worlds.body_qd, worlds.contact_force)
    return evaluate(formula, Signals(worlds.world, worlds.time, *arrays, mass=worlds.mass))


@uncollected()
def verdicts_of(worlds: Trajectories, plan: Plan | None = None, processes: int = 1) -> list[Verdict]:
    """Each world's verdict in full.

    Args:
        worlds: The copies.
        plan: What they are held against.
        processes: To which they are shared out.
    """
    return take_verdicts(worlds, plan, _all, [None] * worlds.world_count, processes)


@uncollected()
def take_verdicts(
    worlds: Trajectories, plan: Plan | None, take: Take[Value], given: Sequence[Any], processes: int = 1
) -> list[Value]:
    """What is made of each world's verdict by the process that judges it: all of a verdict takes long to be sent.

    Args:
        worlds: The copies.
        plan: What they are held against.
        take: Called with a verdict and what is given of its world; a function of a module.
        given: (W,).
        processes: To which worlds are shared out.
    """
    return [taken for part in _judged(worlds, plan, take, given, processes) for taken in part]


def _judged(
    worlds: Trajectories, plan: Plan | None, take: Take[Value], given: Sequence[Any], processes: int
) -> Iterator[list[Value]]:
    """What is taken of the verdicts on all worlds in order, some at a time, by helpers if they wait (`wsim.helpers`).

    Particles are too many to be sent: forks, which have them already, judge those worlds. Neither needs a device.
    """
    count = worlds.world_count
    size = CHUNK if not worlds.worlds else max(1, min(CHUNK, -(-count // processes)))
    parts = [(worlds.part(k, k + size), given[k : k + size]) for k in range(0, count, size)]
    judged: Callable[[tuple[Trajectories, Sequence[Any]]], list[Value]] = partial(_taken, plan, take)
    yield from shared_out((lambda part: judged(part)) if worlds.fluids else judged, parts, processes)


def _taken(plan: Plan | None, take: Take[Value], part: tuple[Trajectories, Sequence[Any]]) -> list[Value]:
    worlds, given = part
    verdicts = judge_copies([Evidence(worlds.recording(k), plan) for k in range(worlds.world_count)])
    return list(map(take, verdicts, given))


def _all(verdict: Verdict, _: None) -> Verdict:
    return verdict


def _row(verdict: Verdict, _: None) -> Row:
    seen: Counter[str] = Counter()
    found: dict[str, tuple[bool, float]] = {}
    for finding in verdict.findings:
        name = _name(finding)
        seen[name] += 1
        key = name if seen[name] == 1 else f"{name} ({seen[name]})"
        found[key] = (finding.passed, np.nan if finding.margin is None else finding.margin)
    return verdict.status, found, verdict.crashes


def _name(finding: Finding) -> str:
    return finding.objective or finding.check
