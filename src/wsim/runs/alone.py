"""A program that is run by itself: the first and only iteration of a run."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING

from wsim.judge.verdict import Verdict
from wsim.progress import Progress, silent
from wsim.runs.folder import RunFolder
from wsim.runs.iteration import Iteration
from wsim.runs.settings import Settings

if TYPE_CHECKING:
    from wsim.plan.schema import Plan

RERUN_FACTS = ("variant", "seed", "time_step", "spacing_ratio", "status", "summary", "seconds")  # for run.json


def run_in_folder(
    run: RunFolder,
    program: Path,
    plan: Plan | None = None,
    settings: Settings | None = None,
    progress: Progress = silent,
) -> Verdict:
    """Program → stage → recording → verdict, in a run whose run.json says how it ended, however it did."""
    started = time.perf_counter()
    iteration = Iteration.of(program, run.iteration(1), plan, settings or Settings(), progress)
    try:
        verdict = iteration.run()
    except BaseException as error:
        why = "interrupted" if isinstance(error, KeyboardInterrupt) else f"{type(error).__name__}: {error}"
        run.record(status="stopped", summary=why, seconds=round(time.perf_counter() - started, 1))
        raise
    if verdict.status == "accepted":
        run.stamp(iteration.folder)
    run.record(status=verdict.status, summary=verdict.summary, seconds=round(time.perf_counter() - started, 1))
    if "verify" in iteration.checks:
        run.record(verify=[{key: copy[key] for key in RERUN_FACTS} for copy in iteration.checks["verify"]])
    return verdict
