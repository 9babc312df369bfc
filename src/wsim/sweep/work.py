"""One candidate, run and judged in a worker's process."""

from __future__ import annotations

import shutil
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from wsim.errors import UserError
from wsim.judge.verdict import Verdict
from wsim.plan.store import load
from wsim.runs.iteration import Iteration
from wsim.runs.settings import Settings
from wsim.sweep.candidate import Candidate, Outcome
from wsim.sweep.spec import Spec

# What they hold against the plan is what a parameter is there to change.
VARIED = (
    "CheckPlanSizes",
    "CheckPlanPlaces",
    "CheckPlanLooks",
    "CheckPlanContacts",
    "CheckPlanJoints",
    "CheckPlanMotion",
)


@dataclass(frozen=True)
class Job:
    """A candidate, and what it is run with.

    Attributes:
        candidate: It.
        folder: The sweep's, with its programs and perhaps plan.json.
        spec: The sweep's.
    """

    candidate: Candidate
    folder: Path
    spec: Spec

    def settings(self, pictures: bool = False) -> Settings:
        """As `wsim run` takes them."""
        spec, candidate = self.spec, self.candidate
        return Settings(
            device=spec.device,
            params=candidate.params,
            isolation=spec.isolation,
            pictures=pictures,
            time_step=spec.time_step,
            seed=candidate.seed,
        )


def work(job: Job) -> Outcome:
    """Build, simulate, judge; nothing stays on disk."""
    started = time.perf_counter()
    plan_file = job.folder / "plan.json"
    scratch = Path(tempfile.mkdtemp(prefix="wsim-candidate-"))
    try:
        plan = load(plan_file) if plan_file.is_file() else None
        iteration = Iteration.of(job.folder / job.candidate.program, scratch, plan, job.settings())
        verdict = iteration.run()
        if job.candidate.params:
            verdict = as_varied(verdict)
        return Outcome.of(job.candidate, verdict, time.perf_counter() - started)
    except (ValueError, RuntimeError, LookupError, ArithmeticError, MemoryError, OSError, UserError) as error:
        text = " ".join(str(error).split())[:400]
        reason = f"{type(error).__name__}: {text}"
        seconds = round(time.perf_counter() - started, 3)
        return Outcome(candidate=job.candidate, status="failed", reason=reason, seconds=seconds)
    finally:
        shutil.rmtree(scratch, ignore_errors=True)


def as_varied(verdict: Verdict) -> Verdict:
    """A verdict without what differs from the plan because a parameter was set; candidate 0 is held to all of it."""
    kept = [finding for finding in verdict.findings if finding.passed or finding.check not in VARIED]
    if len(kept) == len(verdict.findings):
        return verdict
    if any(not finding.passed for finding in kept):
        return verdict.model_copy(update={"findings": kept})
    summary = f"Accepted: all {len(kept)} findings pass; what differs from the plan was asked for."
    return verdict.model_copy(update={"status": "accepted", "summary": summary, "findings": kept})
