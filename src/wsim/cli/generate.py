"""`wsim generate`: a sentence becomes a judged world."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wsim.cli.options import EXIT_CODES, Device, Isolation, Pictures, Runs, Set, TimeStep, parse_params

if TYPE_CHECKING:
    from wsim.plan.schema import Plan


def generate(
    prompt: Annotated[str, typer.Argument(help="What the world must be, in a sentence.")] = "",
    yes: Annotated[bool, typer.Option("--yes", "-y", help="Build the plan without asking.")] = False,
    plan: Annotated[Path | None, typer.Option("--plan", help="Use this plan.json in place of the planner.")] = None,
    device: Device = "auto",
    runs: Runs = Path("runs"),
    isolation: Isolation = "auto",
    pictures: Pictures = True,
    time_step: TimeStep = None,
    params: Set = None,
) -> None:
    """Plan a world from a sentence, build it, simulate it, and judge it.

    Exit code: 0 accepted, 1 rejected, 3 blocked, 2 for a mistake in what was given.
    """
    from wsim.cli.show import ConsoleProgress, console, show_plan, show_verdict
    from wsim.errors import UserError
    from wsim.generate import generate as generate_world
    from wsim.generate import make_plan
    from wsim.pipeline import Settings
    from wsim.plan.store import load

    if not prompt and plan is None:
        raise UserError(
            'give a sentence, such as wsim generate "A cork ball floats in a tank of water.", or --plan FILE'
        )
    settings = Settings(
        device=device, isolation=isolation, pictures=pictures, time_step=time_step, params=parse_params(params)
    )
    settings.check()
    chosen: Plan = load(plan) if plan else make_plan(prompt)
    show_plan(chosen)
    if not yes and not _agreed():
        console.print("nothing was built")
        raise typer.Exit(0)
    with ConsoleProgress() as progress:
        done = generate_world(prompt or chosen.prompt, runs, settings, plan=chosen, progress=progress)
    assert done.verdict is not None
    show_verdict(done.verdict, done.run.path, done.report)
    raise typer.Exit(EXIT_CODES[done.verdict.status])


def _agreed() -> bool:
    from wsim.errors import UserError

    try:
        return typer.confirm("Build this world?", default=True)
    except typer.Abort:
        raise UserError("nothing was built: there was no answer; --yes builds without asking") from None


def register(app: typer.Typer) -> None:
    """Add the verb."""
    app.command()(generate)
