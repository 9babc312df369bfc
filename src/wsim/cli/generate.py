"""`wsim generate`: a sentence becomes a judged world."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wsim.cli.options import (
    EXIT_CODES,
    Answers,
    Device,
    Image,
    Isolation,
    Pictures,
    Runs,
    Set,
    TimeStep,
    Verify,
    parse_params,
    refuse_image,
)

if TYPE_CHECKING:
    from wsim.plan.schema import Plan


def generate(
    prompt: Annotated[str, typer.Argument(help="What the world must be, in a sentence.")] = "",
    yes: Annotated[bool, typer.Option("--yes", "-y", help="Build the plan without asking.")] = False,
    plan: Annotated[Path | None, typer.Option("--plan", help="Use this plan.json in place of the planner.")] = None,
    answers: Answers = None,
    image: Image = None,
    device: Device = "auto",
    runs: Runs = Path("runs"),
    isolation: Isolation = "auto",
    pictures: Pictures = True,
    time_step: TimeStep = None,
    verify: Verify = False,
    params: Set = None,
) -> None:
    """Plan a world from a sentence, build it, simulate it, and judge it.

    Exit code: 0 accepted, 1 rejected, 3 blocked, 2 for a mistake in what was given.
    """
    from wsim.cli.show import ConsoleProgress, console, show_verdict
    from wsim.errors import UserError
    from wsim.generate import generate as generate_world
    from wsim.pipeline import Settings

    if not prompt and plan is None:
        raise UserError(
            'give a sentence, such as wsim generate "A cork ball floats in a tank of water.", or --plan FILE'
        )
    settings = Settings(
        device=device,
        isolation=isolation,
        pictures=pictures,
        time_step=time_step,
        verify=verify,
        params=parse_params(params),
    )
    settings.check()
    refuse_image(image)
    chosen = _agreed(prompt, plan, answers, yes)
    if chosen is None:
        console.print("nothing was built")
        raise typer.Exit(0)
    said = prompt if plan is not None and prompt else chosen.prompt  # with answers in it, the sentence is another
    with ConsoleProgress() as progress:
        done = generate_world(said, runs, settings, plan=chosen, progress=progress)
    assert done.verdict is not None
    show_verdict(done.verdict, done.run.path, done.report)
    raise typer.Exit(EXIT_CODES[done.verdict.status])


def _agreed(prompt: str, path: Path | None, answers: Path | None, yes: bool) -> Plan | None:
    """The plan to build: a file of answers is a yes, as --yes is; else a person is asked."""
    from wsim.cli.approve import approved, with_answers
    from wsim.cli.show import show_plan
    from wsim.generate import make_plan
    from wsim.plan.store import load

    planner = make_plan if path is None else None
    proposed = with_answers(make_plan(prompt) if path is None else load(path), planner, answers)
    if not (yes or answers):
        return approved(proposed, planner)
    show_plan(proposed)
    return proposed


def register(app: typer.Typer) -> None:
    """Add the verb."""
    app.command()(generate)
