"""A sentence becomes a judged world: planned, written, tried, looked at, judged, and repaired until it is right."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsim.agents.ask import Desk
from wsim.agents.budget import Budget, BudgetError, Ledger
from wsim.agents.crew import Crew, verdict_of
from wsim.agents.failures import ModelError
from wsim.agents.models import BUILTIN, Models, reach
from wsim.agents.pictures import small_jpeg
from wsim.agents.transcript import Transcript
from wsim.judge.verdict import Verdict
from wsim.plan.drawing.picture import draw_picture
from wsim.program.compose import compose
from wsim.progress import Progress, silent
from wsim.report import write as write_report
from wsim.rules.planner import plan as make_plan
from wsim.runs.accept import accept
from wsim.runs.attempt import Reached, attempt, numerics
from wsim.runs.folder import RunFolder, write_whole
from wsim.runs.pipeline import Settings, conclude
from wsim.tools import Workspace
from wsim.tools.iterations import add

if TYPE_CHECKING:
    from wsim.agents.relay import Replay
    from wsim.plan.schema import Plan
    from wsim.runs.attempt import Attempt


REFERENCE = "reference.jpg"  # the small picture that the planner saw, in the run's folder


@dataclass
class Generated:
    """A finished run."""

    run: RunFolder
    plan: Plan | None  # None: the planner's model gave none
    verdict: Verdict | None  # None: the plan was not approved
    report: Path | None


@dataclass
class Options:
    """How a world is made.

    Attributes:
        settings: How its programs are run.
        models: Who fills which role.
        budget: What may be used.
        image: A picture of what it must look like, for a planner that sees.
        confirm: Run the accepted program once more, bare, and compare.
        replay: A recorded run that answers in place of the models.
    """

    settings: Settings = field(default_factory=Settings)
    models: Models = field(default_factory=Models)
    budget: Budget = field(default_factory=Budget)
    image: Path | None = None
    confirm: bool = True
    replay: Replay | None = None


def generate(
    prompt: str,
    runs: Path = Path("runs"),
    options: Options | None = None,
    approve: Callable[[Plan], bool] = lambda plan: True,
    plan: Plan | None = None,
    progress: Progress = silent,
) -> Generated:
    """Plan a world, write its program, try it, repair it until the judge accepts, and keep all of it in a run folder.

    Args:
        prompt: What the world must be.
        runs: Where run folders go.
        options: Models, budget, device, limits.
        approve: Shown the plan before anything is built.
        plan: A plan to use as it is, in place of the planner's.
        progress: Told how far it is.

    Raises:
        NotUnderstood: If the builtin planner cannot ground the prompt; nothing is left behind.
        UserError: If a model cannot be reached by its name, or the picture is none; nothing is left behind.
    """
    options = options or Options()
    if options.replay is None:
        reach(options.models)
    reference = _reference(options)
    if plan is None and options.models.planner == BUILTIN:
        plan = make_plan(prompt)  # refused before there is a folder
    run = RunFolder.create(runs, plan.title if plan else prompt)
    crew = _crew(run, options, progress)
    _note_inputs(run, prompt, options)
    try:
        plan = _plan(run, crew, prompt, plan, reference)
        if not approve(plan):
            run.record(status="not approved", **crew.facts())
            return Generated(run, plan, None, None)
        verdict = _loop(run, crew, plan, options)
    except (ModelError, BudgetError) as error:  # of the planner: there is nothing to keep but the transcript
        verdict = _blocked(run, str(error))
    except BaseException as error:
        why = "interrupted" if isinstance(error, KeyboardInterrupt) else f"{type(error).__name__}: {error}"
        run.record(status="stopped", summary=why, **crew.facts())
        raise
    run.record(status=verdict.status, summary=verdict.summary, **crew.facts())
    return Generated(run, plan, verdict, write_report(run.path))


def _loop(run: RunFolder, crew: Crew, plan: Plan, options: Options) -> Verdict:
    """Try, look, judge, repair the best, until one is accepted or the run must end."""
    programs = [_first_draft(run, plan)]
    best: Attempt | None = None
    undone: list[Attempt] = []
    try:
        while True:
            tried = max((_try(run, crew, plan, options, best, text) for text in programs), key=lambda one: one.rank)
            if best is None or tried.rank > best.rank:
                best, undone = tried, []
            else:
                undone = [*undone, tried]  # it is no better: the next patch starts from the best again
            _note_attempt(run, tried, best)
            if best.verdict.status == "accepted" or not crew.has("coder"):
                return best.verdict
            if tried.number >= options.budget.iterations:
                return _blocked(run, f"iteration limit: {tried.number} programs were tried", verdict_of, best)
            if tried is not best:
                crew.judge(best, plan, undone)  # what it asked for did not help
            programs = _candidates(crew, best, undone, plan)
    except (ModelError, BudgetError) as error:
        return _blocked(run, str(error), verdict_of, best)


def _candidates(crew: Crew, best: Attempt, undone: Sequence[Attempt], plan: Plan) -> list[str]:
    """Programs to try next. One; where several are tried, the best of them goes on."""
    return [crew.repair(best, undone, plan)]


def _try(run: RunFolder, crew: Crew, plan: Plan, options: Options, best: Attempt | None, text: str) -> Attempt:
    """One program through all passes, the review, the judge, and acceptance."""
    folder = add(run, text, best.program if best else None)
    settings = options.settings
    if best is not None and numerics(text) != numerics(_text(run.iteration(1))):
        settings = replace(
            settings, verify=True
        )  # a world that a finer computation made right must stand a still finer one
    tried = attempt(folder, plan, settings, crew.workspace.progress, cheap_first=crew.has("coder"))
    try:
        _assess(run, crew, plan, options, tried, best)
    except BudgetError as error:  # what was tried is kept, and what was found of it
        run.record(cause=str(error))
        if tried.verdict.status == "accepted":
            summary = f"{error}, before it was confirmed. {tried.verdict.summary}"
            tried.verdict = Verdict(status="blocked", summary=summary, findings=tried.verdict.findings)
    if tried.verdict.status != "accepted" and tried.reached == Reached.ALL:
        tried.reached = Reached.REVIEW
    conclude(folder, tried.verdict)
    return tried


def _text(folder: Path) -> str:
    return (folder / "program.py").read_text(encoding="utf-8")


def _assess(run: RunFolder, crew: Crew, plan: Plan, options: Options, tried: Attempt, best: Attempt | None) -> None:
    """The review, the judge, and acceptance of a program that was tried; one that is no better is not asked about."""
    if tried.verdict.status == "accepted":
        crew.look(tried, plan)
    if best is None or tried.rank > best.rank:
        crew.judge(tried, plan)
    if tried.verdict.status == "accepted" and options.confirm:
        tried.verdict = accept(run, tried.folder, plan, options.settings, crew.workspace.progress, tried.earlier)
    elif tried.verdict.status == "accepted":
        run.accept(tried.folder)


def _plan(run: RunFolder, crew: Crew, prompt: str, plan: Plan | None, reference: bytes | None) -> Plan:
    """The plan, kept in the run's folder with its drawing."""
    if plan is None:
        if reference is not None:
            (run.path / REFERENCE).write_bytes(reference)
        plan = crew.plan(prompt, [reference] if reference else [], REFERENCE if reference else "")
        run.record(title=plan.title)
    else:
        crew.desk.transcript.builtin("planner", prompt, plan.model_dump(mode="json"))
    write_whole(run.path / "plan.json", plan.model_dump_json(indent=2) + "\n")
    draw_picture(plan, run.path / "plan.png")
    return plan


def _first_draft(run: RunFolder, plan: Plan) -> str:
    """The program that the plan composes: what every later one is a patch of."""
    program = compose(plan)
    Transcript(run.path).builtin("coder", "plan.json", program)
    return program


def _crew(run: RunFolder, options: Options, progress: Progress) -> Crew:
    ledger = Ledger(options.budget)

    def watched(stage: str, done: float, total: float) -> None:
        ledger.check_time()  # a simulation that outlasts the run's time ends here
        progress(stage, done, total)

    desk = Desk(options.models, Transcript(run.path), ledger, options.replay)
    return Crew(desk, Workspace(run, options.settings, watched))


def _note_inputs(run: RunFolder, prompt: str, options: Options) -> None:
    """All that a replay needs besides the transcript."""
    run.record(
        prompt=prompt,
        models=options.models.facts(),
        settings=asdict(replace(options.settings)),
        budget=asdict(options.budget),
        confirm=options.confirm,
    )


def _note_attempt(run: RunFolder, tried: Attempt, best: Attempt) -> None:
    """A row of run.json's iterations: how far it came, what failed, and whether it was kept."""
    row: dict[str, Any] = {
        "number": tried.number,
        "reached": tried.reached.name.lower(),
        "status": tried.verdict.status,
        "summary": tried.verdict.summary,
        "failed": list(dict.fromkeys(finding.check for finding in tried.verdict.failures)),
        "kept": tried is best,
    }
    row |= {"repair": tried.repair} if tried.repair else {}
    run.record(iterations=[*run.facts().get("iterations", []), row], best=best.number)


def _blocked(
    run: RunFolder,
    cause: str,
    verdict_of: Callable[[Attempt, str], Verdict] | None = None,
    best: Attempt | None = None,
) -> Verdict:
    """The verdict on a run that could not go on: why, and the best so far."""
    run.record(cause=cause)
    if best is None or verdict_of is None:
        return Verdict(status="blocked", summary=cause)
    return verdict_of(best, cause)


def _reference(options: Options) -> bytes | None:
    """A reference picture as a small JPEG; the recorded one, byte for byte, in a replay."""
    if options.image is None:
        return None
    return small_jpeg(options.image) if options.replay is None else options.image.read_bytes()
