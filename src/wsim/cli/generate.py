"""`wsim generate`: a sentence becomes a judged world."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wsim import loop, recording
from wsim.agents.budget import Budget
from wsim.agents.models import BUILTIN, choose
from wsim.agents.shorthand import load_given
from wsim.cli.approve import approved, with_answers
from wsim.cli.options import (
    EXIT_CODES,
    Answers,
    Caption,
    CoderModel,
    Device,
    Image,
    Isolation,
    JudgeModel,
    Model,
    Pictures,
    PlannerModel,
    ReviewerModel,
    Runs,
    Set,
    TimeStep,
    Verify,
    parse_params,
    refuse_image,
)
from wsim.cli.show import ConsoleProgress, console, show_plan, show_usage, show_verdict
from wsim.door import load_beside
from wsim.errors import UserError
from wsim.loop.options import Options
from wsim.phases import since_start
from wsim.program.drafted import refuse_unbuildable
from wsim.rules.planner import plan as make_plan
from wsim.runs.folder import check_base
from wsim.runs.settings import Settings
from wsim.runs.standby import Standby

if TYPE_CHECKING:
    from wsim.plan.schema import Plan

Iterations = Annotated[int, typer.Option("--max-iterations", min=1, max=99, help="Programs that are tried.")]
Tokens = Annotated[int, typer.Option("--max-tokens", min=0, help="Tokens that all models together may use.")]
Seconds = Annotated[float, typer.Option("--max-seconds", min=1.0, help="Time of the whole run [s].")]
ModelSeconds = Annotated[
    float, typer.Option("--model-timeout", min=0.1, help="Time of one request to a model [s]; it is sent three times.")
]
Candidates = Annotated[
    int,
    typer.Option("--candidates", min=1, max=64, help="Patches that are tried side by side; the best of them goes on."),
]
Fresh = Annotated[bool, typer.Option("--fresh", help="Ask models anew; take no replies that are kept from before.")]
Nearest = Annotated[
    bool,
    typer.Option("--nearest", help="With --yes: build the nearest world too, where what is asked cannot be simulated."),
]
Confirm = Annotated[
    bool, typer.Option("--confirm/--no-confirm", help="Run an accepted program once more, bare, and compare.")
]


def generate(
    prompt: Annotated[str, typer.Argument(help="What the world must be, in a sentence.")] = "",
    yes: Annotated[bool, typer.Option("--yes", "-y", help="Build the plan without asking.")] = False,
    plan: Annotated[Path | None, typer.Option("--plan", help="Use this plan.json in place of the planner.")] = None,
    answers: Answers = None,
    image: Image = None,
    model: Model = None,
    planner_model: PlannerModel = None,
    coder_model: CoderModel = None,
    reviewer_model: ReviewerModel = None,
    judge_model: JudgeModel = None,
    candidates: Candidates = 1,
    max_iterations: Iterations = 8,
    max_tokens: Tokens = 200_000,
    max_seconds: Seconds = 3600.0,
    model_timeout: ModelSeconds = 180.0,
    confirm: Confirm = True,
    fresh: Fresh = False,
    nearest: Nearest = False,
    replay: Annotated[
        Path | None, typer.Option("--replay", metavar="RUN", help="Make a recorded run again, offline.")
    ] = None,
    device: Device = "auto",
    runs: Runs = Path("runs"),
    isolation: Isolation = "auto",
    pictures: Pictures = True,
    caption: Caption = False,
    time_step: TimeStep = None,
    verify: Verify = False,
    params: Set = None,
) -> None:
    """Plan a world from a sentence, build it, simulate it, judge it, and repair it until it is right.

    Repairs are the judge's own suggestions, or a model's.

    Exit code: 0 accepted, 1 rejected, 3 blocked, 2 for a mistake in what was given.
    """
    if replay is not None:
        _replay(replay, runs, device)
    if not prompt and plan is None:
        raise UserError(
            'give a sentence, such as wsim generate "A cork ball floats in a tank of water.", or --plan FILE'
        )
    options = Options(
        settings=Settings(
            device=device,
            isolation=isolation,
            pictures=pictures,
            caption=caption,
            time_step=time_step,
            verify=verify,
            params=parse_params(params),
        ),
        models=choose(model, planner=planner_model, coder=coder_model, reviewer=reviewer_model, judge=judge_model),
        budget=Budget(max_iterations, max_tokens, max_seconds, model_timeout),
        image=image,
        candidates=candidates,
        confirm=confirm,
        fresh=fresh,
        nearest=nearest,
        start_up=since_start() or 0.0,
    )
    options.settings.check()
    _generate(prompt, options, runs, plan, answers, yes)


def _generate(prompt: str, options: Options, runs: Path, path: Path | None, answers: Path | None, yes: bool) -> None:
    builtin = options.models.planner == BUILTIN or path is not None
    if builtin:
        refuse_image(options.image)
    chosen = _agreed(prompt, path, answers, yes, options.settings.isolation) if builtin else None
    if builtin and chosen is None:
        console.print("nothing was built")
        raise typer.Exit(0)
    said = prompt if chosen is None or (path is not None and prompt) else chosen.prompt  # answers are in the sentence
    progress = ConsoleProgress()

    agreed = [builtin]  # whether this plan was shown already

    def approve(plan: Plan) -> bool:
        if agreed.pop() if agreed else False:
            return True
        with progress.aside():
            show_plan(plan)
            if yes and plan.stands_in_for and not options.nearest:
                console.print("what is asked cannot be simulated; --nearest builds this world in its place")
                return False
            return yes or typer.confirm("build it?")

    check_base(runs)
    with progress, _standby(options):
        began = time.perf_counter()
        generate_world = loop.generate_world
        load_beside("wsim.sim.simulation")  # while the stage is built in its sandbox
        options.start_up += time.perf_counter() - began
        with recording.keeping():
            done = generate_world(said, runs, options, approve, chosen, progress)
    if done.verdict is None:
        console.print("nothing was built")
        raise typer.Exit(0)
    show_verdict(done.verdict, done.run.path, done.report)
    show_usage(done.run.facts())
    raise typer.Exit(EXIT_CODES[done.verdict.status])


@contextmanager
def _standby(options: Options) -> Iterator[None]:
    """Let the process that will confirm a first draft load beside this one; a draft that a model sees has none."""
    if not options.confirm or options.models.coder != BUILTIN:
        yield
        return
    with Standby() as options.standby:
        yield


def _replay(recorded: Path, runs: Path, device: str) -> None:
    with ConsoleProgress() as progress:
        again = loop.replay_run(recorded, runs, progress, None if device == "auto" else device)
    done = again.generated
    assert done.verdict is not None
    show_verdict(done.verdict, done.run.path, done.report)
    for line in (*again.divergences, *again.differing):
        console.print(f"otherwise: {line}", markup=False)
    console.print(f"replayed: {again.same} files are byte for byte as recorded, {len(again.differing)} are not")
    raise typer.Exit(EXIT_CODES[done.verdict.status] if not again.differing else 1)


def _agreed(prompt: str, path: Path | None, answers: Path | None, yes: bool, isolation: str) -> Plan | None:
    """The plan to build: a file of answers is a yes, as --yes is; else a person is asked."""
    planner = make_plan if path is None else None
    proposed = with_answers(make_plan(prompt) if path is None else load_given(path), planner, answers)
    if path is not None:
        refuse_unbuildable(proposed, path, isolation)
    if not (yes or answers):
        return approved(proposed, planner)
    show_plan(proposed)
    return proposed
