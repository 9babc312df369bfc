"""A candidate run again in full: recording, pictures and report, as `wsim run` leaves them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from wsim.plan.store import load
from wsim.progress import Progress, silent
from wsim.runs.alone import run_in_folder
from wsim.sweep.work import settings

if TYPE_CHECKING:
    from wsim.runs.folder import RunFolder
    from wsim.sweep.candidate import Outcome
    from wsim.sweep.folder import SweepFolder


def telling(outcomes: Sequence[Outcome]) -> list[Outcome]:
    """The best, and the two on either side of where acceptance ends; fewer where they are the same.

    Args:
        outcomes: The best first.
    """
    judged = [outcome for outcome in outcomes if outcome.status != "failed"]
    accepted = [outcome for outcome in judged if outcome.status == "accepted"]
    others = [outcome for outcome in judged if outcome.status != "accepted"]
    chosen = [*judged[:1], *accepted[-1:], *others[:1], *judged[-1:]]
    return list({outcome.candidate.number: outcome for outcome in chosen}.values())


def run_again(folder: SweepFolder, outcome: Outcome, pictures: bool = True, progress: Progress = silent) -> RunFolder:
    """Run a candidate alone, with its parameters and seed, into candidates/NNNN.

    Its run.json says whether the verdict is the one that it had in the sweep.
    """
    candidate, spec = outcome.candidate, folder.spec
    run = folder.run_of(candidate.number)
    plan_file = folder.path / "plan.json"
    plan = load(plan_file) if plan_file.is_file() else None
    if plan is not None:
        (run.path / "plan.json").write_text(plan_file.read_text(encoding="utf-8"), encoding="utf-8")
    run.record(prompt=plan.prompt if plan else None, program=candidate.program, params=candidate.params)
    program = folder.path / candidate.program
    verdict = run_in_folder(run, program, plan, settings(spec, candidate, pictures), progress)
    run.record(seed=candidate.seed, in_sweep=outcome.status, same=verdict.status == outcome.status)
    return run
