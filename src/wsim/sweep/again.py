"""A candidate run again in full: recording, pictures and report, as `wsim run` leaves them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from wsim.plan.store import load
from wsim.progress import Progress, silent
from wsim.runs.alone import run_in_folder
from wsim.runs.folder import RunFolder
from wsim.sweep.candidate import Outcome
from wsim.sweep.table import ranked, write
from wsim.sweep.work import as_varied, settings

if TYPE_CHECKING:
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


def in_full(
    folder: SweepFolder, outcomes: Sequence[Outcome], pictures: bool = True, progress: Progress = silent
) -> list[Outcome]:
    """Run the telling ones again, each by itself; what that run's verdict says is what counts, and ranks them.

    One whose own run is there already, of a time before this was stopped, is not run once more.

    Args:
        folder: The sweep's, whose table is written anew.
        outcomes: All of them.
        pictures: Whether pictures are taken.
        progress: Told how each run goes.

    Returns:
        All outcomes, the best first: what is best now has been run by itself.
    """
    best_first = ranked(outcomes)
    done = {outcome.candidate.number for outcome in best_first if _was_run(folder, outcome)}
    while left := [outcome for outcome in telling(best_first) if outcome.candidate.number not in done]:
        _, own = run_again(folder, left[0], pictures, progress)
        done.add(own.candidate.number)
        best_first = ranked([own if each.candidate == own.candidate else each for each in best_first])
    write(best_first, folder.path)
    folder.finish(best_first)
    return best_first


def run_again(
    folder: SweepFolder, outcome: Outcome, pictures: bool = True, progress: Progress = silent
) -> tuple[RunFolder, Outcome]:
    """Run a candidate alone, with its parameters, draws and seed, into candidates/NNNN.

    What was simulated with others is run on the CPU, where contacts and what joints, springs and ropes give are
    recorded. Its run.json says whether the verdict is the one that it had in the sweep; its outcome is kept.

    Returns:
        The run, and what came of the candidate by it.
    """
    candidate, spec = outcome.candidate, folder.spec
    run = folder.run_of(candidate.number)
    plan_file = folder.path / "plan.json"
    plan = load(plan_file) if plan_file.is_file() else None
    if plan is not None:
        (run.path / "plan.json").write_text(plan_file.read_text(encoding="utf-8"), encoding="utf-8")
    run.record(prompt=plan.prompt if plan else None, program=candidate.program, params=candidate.params)
    if candidate.draws:
        run.record(draws=candidate.draws)
    program = folder.path / candidate.program
    own = settings(spec, candidate, pictures)
    if outcome.together > 1:
        own = replace(own, device="cpu")
    verdict = run_in_folder(run, program, plan, own, progress)
    said = as_varied(verdict) if candidate.values else verdict
    same = said.status == outcome.status
    of = f" with {outcome.together - 1} others" if outcome.together > 1 else ""
    note = outcome.note if same else f"{outcome.status} when it was simulated{of}"
    found = Outcome.of(candidate, said, outcome.seconds).model_copy(update={"note": note})
    folder.add(found)
    run.record(seed=candidate.seed, in_sweep=outcome.status, same=same)  # last: where this stands, all of it is there
    return run, found


def _was_run(folder: SweepFolder, outcome: Outcome) -> bool:
    """Whether a candidate's own run was finished, and its outcome is what that said."""
    run = RunFolder(folder.candidate(outcome.candidate.number))
    return outcome.together == 1 and run.path.is_dir() and "same" in run.facts()
