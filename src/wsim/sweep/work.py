"""A shard of candidates, built, run and judged in a worker's process."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import mujoco  # noqa: F401 - the judge searches for contacts with it: helpers have it if it is here before them

from wsim.assets import asset_folders
from wsim.errors import UserError
from wsim.forks import shared_out
from wsim.judge.verdict import Verdict, status_of, unjudged
from wsim.plan.store import load
from wsim.program import sandbox
from wsim.program.control import ControlError
from wsim.runs import draws
from wsim.runs.iteration import Iteration, no_world
from wsim.runs.settings import Settings
from wsim.scene.usd_threads import forks
from wsim.sweep.batch import Member, batches, run
from wsim.sweep.candidate import Candidate, Outcome
from wsim.sweep.pool import told
from wsim.sweep.spec import Spec

if TYPE_CHECKING:
    from wsim.plan.schema import Plan
    from wsim.program.sandbox import BuildResult

# What they hold against the plan is what a parameter is there to change.
VARIED = (
    "CheckPlanSizes",
    "CheckPlanPlaces",
    "CheckPlanLooks",
    "CheckPlanContacts",
    "CheckPlanJoints",
    "CheckPlanMotion",
    "CheckPlanVehicles",
    "CheckPlanTerrain",
    "CheckPlanScatter",
)
FAILURES = (ValueError, RuntimeError, LookupError, ArithmeticError, MemoryError, OSError, UserError, ControlError)


@dataclass(frozen=True)
class Shard:
    """Candidates that one worker takes at a time, and what they are run with.

    Attributes:
        candidates: They.
        folder: The sweep's, with its programs and perhaps plan.json.
        spec: The sweep's.
        cores: That the worker may keep busy.
    """

    candidates: tuple[Candidate, ...]
    folder: Path
    spec: Spec
    cores: int = 1


def settings(spec: Spec, candidate: Candidate, pictures: bool = False) -> Settings:
    """A candidate's, as `wsim run` takes them."""
    return Settings(
        device=spec.device.split(",")[0],
        params=candidate.params,
        draws=candidate.draws,
        isolation=spec.isolation,
        pictures=pictures,
        time_step=spec.time_step,
        seed=candidate.seed,
    )


def work(shard: Shard) -> Iterator[list[tuple[int, Outcome]]]:
    """Build, simulate, judge: outcomes as they are known, each with its place in the shard. Nothing stays on disk."""
    plan_file = shard.folder / "plan.json"
    plan = load(plan_file) if plan_file.is_file() else None
    places = {candidate.number: place for place, candidate in enumerate(shard.candidates)}
    with tempfile.TemporaryDirectory(prefix="wsim-candidates-") as scratch:
        left = {
            candidate.number: (candidate, *each)
            for candidate, each in zip(shard.candidates, build(shard, Path(scratch), plan), strict=True)
        }
        unfit = dict(_set_draws(list(left.values()), shard.cores))
        left = {number: made for number, made in left.items() if number not in unfit}
        if unfit:
            yield [(places[number], outcome) for number, outcome in unfit.items()]
        notes: dict[int, str] = {}
        if shard.spec.together > 1:
            runnable = [  # of a stage on which something was set what was told of it is no more so
                (candidate, iteration, b"" if candidate.draws else built.told)
                for candidate, iteration, built in left.values()
                if built.ok
            ]
            for batch in batches(runnable, shard.spec.together, shard.cores):
                try:
                    found = _together(batch, plan, shard.cores)
                except FAILURES as error:  # each is run by itself, which says whose it is; what it costs is not hidden
                    why = f"run by itself, as {len(batch)} worlds could not be at once: {told(error)}"
                    notes |= {member.candidate.number: why for member in batch}
                    continue
                left = {number: made for number, made in left.items() if number not in found}
                yield [(places[number], outcome) for number, outcome in found.items()]
        for number, (candidate, iteration, built) in left.items():
            alone = _alone(candidate, iteration, built)
            yield [(places[number], alone.model_copy(update={"note": notes.get(number, "")}))]


def as_varied(verdict: Verdict) -> Verdict:
    """A verdict without what differs from the plan that candidates are there to change; the first is held to it."""
    kept = [finding for finding in verdict.findings if finding.passed or finding.check not in VARIED]
    if len(kept) == len(verdict.findings):
        return verdict
    if any(not finding.passed for finding in kept):
        return verdict.model_copy(update={"findings": kept})
    said = f"Blocked: {unjudged(verdict.crashes)}" if verdict.crashes else f"Accepted: all {len(kept)} findings pass"
    summary = f"{said}; what differs from the plan was asked for."
    status = status_of(kept, verdict.crashes)
    return verdict.model_copy(update={"status": status, "summary": summary, "findings": kept})


def build(shard: Shard, scratch: Path, plan: Plan | None) -> list[tuple[Iteration, BuildResult]]:
    """Each candidate's folder and stage; those of one program are built some dozens to a process."""
    made: dict[int, tuple[Iteration, BuildResult]] = {}
    for name in dict.fromkeys(candidate.program for candidate in shard.candidates):
        program, own = shard.folder / name, [each for each in shard.candidates if each.program == name]
        iterations = []
        for candidate in own:
            folder = scratch / f"{candidate.number:06d}"
            folder.mkdir()
            iterations.append(Iteration(folder, plan, settings(shard.spec, candidate), source=program))
        built = sandbox.build_many(
            program,
            [iteration.stage for iteration in iterations],
            [candidate.params for candidate in own],
            iterations[0].settings.limits(),
            shard.spec.isolation,
            readable=asset_folders(),
            processes=shard.cores,
            tell=shard.spec.together > 1,
        )
        made |= {
            candidate.number: each for candidate, each in zip(own, zip(iterations, built, strict=True), strict=True)
        }
    return [made[candidate.number] for candidate in shard.candidates]


def _set_draws(
    made: Sequence[tuple[Candidate, Iteration, BuildResult]], processes: int
) -> Iterator[tuple[int, Outcome]]:
    """Set what is drawn on the stages; those on which it cannot be set have failed, and are told."""

    def put(each: tuple[Candidate, Iteration, BuildResult]) -> str:
        candidate, iteration, built = each
        try:
            if built.ok:
                draws.apply(iteration.stage, candidate.draws)
        except UserError as error:
            return str(error)
        return ""

    drawn = [each for each in made if each[0].draws]  # for none nobody is forked
    for (candidate, _, built), why in zip(drawn, shared_out(put, drawn, forks(processes)), strict=True):
        if why:
            failed = Outcome(candidate=candidate, status="failed", reason=why, seconds=round(built.seconds, 3))
            yield candidate.number, failed


def _alone(candidate: Candidate, iteration: Iteration, built: BuildResult) -> Outcome:
    started = time.perf_counter()
    try:
        found = outcome(iteration.happen() if built.ok else no_world(built), candidate)
    except Exception as error:  # noqa: BLE001 - one candidate's, and the others go on
        found = _failed(candidate, error)
    return _taking(found, built.seconds + time.perf_counter() - started)


def _together(batch: Sequence[Member], plan: Plan | None, cores: int) -> dict[int, Outcome]:
    """The outcomes of a batch, by candidate. Raises what `run` does where it cannot be simulated as one."""
    started = time.perf_counter()
    found = run(batch, plan, outcome, cores)
    seconds = (time.perf_counter() - started) / len(batch)
    return {
        own.candidate.number: _taking(own, seconds).model_copy(update={"together": len(batch), "note": note})
        for own, note in found
    }


def outcome(verdict: Verdict, candidate: Candidate) -> Outcome:
    """What a verdict says of a candidate, held to what it was drawn for; what it took is not known yet."""
    try:
        return Outcome.of(candidate, as_varied(verdict) if candidate.values else verdict)
    except Exception as error:  # noqa: BLE001 - one candidate's, and the others go on
        return _failed(candidate, error)


def _failed(candidate: Candidate, error: Exception) -> Outcome:
    return Outcome(candidate=candidate, status="failed", reason=told(error))


def _taking(found: Outcome, seconds: float) -> Outcome:
    return found.model_copy(update={"seconds": round(seconds, 3)})
