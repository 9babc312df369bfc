"""`wsim plan`: the plan of a sentence, without building it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from wsim.errors import UserError


def plan(
    prompt: Annotated[str, typer.Argument(help="What the world must be, in a sentence.")],
    output: Annotated[Path | None, typer.Option("--output", "-o", help="Write plan.json here.")] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the plan as JSON.")] = False,
) -> None:
    """Show the plan of a sentence: objects, places, what must happen, what was assumed."""
    from wsim.cli.show import console, show_plan
    from wsim.generate import make_plan
    from wsim.runs import write_whole

    made = make_plan(prompt)
    text = made.model_dump_json(indent=2)
    if json:
        print(text)
    else:
        show_plan(made)
    if output:
        try:
            write_whole(output, text + "\n")
        except OSError as error:
            raise UserError(f"cannot write the plan to {output}: {error.strerror}") from error
        console.print(f"plan: {output}")


def register(app: typer.Typer) -> None:
    """Add the verb."""
    app.command()(plan)
