"""`wsim plan`: the plan of a sentence, or of a file, without building it."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wsim import loop
from wsim.agents.models import BUILTIN, choose
from wsim.agents.shorthand import load_given
from wsim.cli.approve import draw, with_answers
from wsim.cli.options import Answers, Image, Model, PlannerModel, Runs, refuse_image
from wsim.cli.show import ConsoleProgress, console, show_plan, show_usage
from wsim.errors import UserError
from wsim.loop.options import Options
from wsim.plan.schema import Plan
from wsim.program.drafted import refuse_unbuildable
from wsim.rules.planner import plan as make_plan
from wsim.rules.questions import questions
from wsim.rules.words import known_words
from wsim.runs.folder import write_whole

if TYPE_CHECKING:
    from wsim.agents.models import Models


def plan(
    prompt: Annotated[str, typer.Argument(help="What the world must be, in a sentence.")] = "",
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Write plan.json here, its picture beside.")
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the plan as JSON.")] = False,
    file: Annotated[Path | None, typer.Option("--plan", help="Check and show this plan.json.")] = None,
    schema: Annotated[bool, typer.Option("--schema", help="Print the JSON Schema of a plan, and stop.")] = False,
    words: Annotated[bool, typer.Option("--words", help="Print what the builtin planner knows, and stop.")] = False,
    answers: Answers = None,
    image: Image = None,
    model: Model = None,
    planner_model: PlannerModel = None,
    runs: Runs = Path("runs"),
) -> None:
    """Show the plan of a sentence: objects, places, what must happen, what was assumed, what it takes, two drawings."""
    if schema:
        print(_schema())
        return
    if words:
        print(known_words())
        return
    models = choose(model, planner=planner_model)
    if models.planner == BUILTIN or file is not None:
        refuse_image(image)
        made = _plan(prompt, file, answers)
    else:
        made = _plan_with(models, prompt, image, runs)
    text = made.model_dump_json(indent=2)
    if output:
        try:
            write_whole(output, text + "\n")
        except OSError as error:
            raise UserError(f"cannot write the plan to {output}: {error.strerror}") from error
    if json:
        print(text)
    else:
        _show(made, output, planned=file is None and models.planner == BUILTIN)


def _schema() -> str:
    return json.dumps(Plan.model_json_schema(), indent=2)


def _plan(prompt: str, file: Path | None, answers: Path | None) -> Plan:
    if bool(prompt) == (file is not None):
        raise UserError(
            'give a sentence, such as wsim plan "A cork ball floats in a tank of water.", or --plan FILE; not both'
        )
    if file is not None:
        made = with_answers(load_given(file), None, answers)
        refuse_unbuildable(made, file)
        return made
    return with_answers(make_plan(prompt), make_plan, answers)


def _plan_with(models: Models, prompt: str, image: Path | None, runs: Path) -> Plan:
    """A model's plan; its run's folder keeps what was asked and answered."""
    if not prompt:
        raise UserError('give a sentence, such as wsim plan "A crank drives a piston." --planner-model MODEL')
    with ConsoleProgress() as progress:
        done = loop.generate_world(
            prompt, runs, Options(models=models, image=image), lambda plan: False, progress=progress
        )
    if done.plan is None:
        raise UserError(f"no plan: {done.run.facts().get('summary', '')}; {done.run.path} has what was asked")
    console.print(f"run:    {done.run.path}", soft_wrap=True)
    show_usage(done.run.facts())
    return done.plan


def _show(made: Plan, output: Path | None, planned: bool) -> None:
    path = output.with_suffix(".png") if output else Path(tempfile.mkdtemp(prefix="wsim-plan-")) / "plan.png"
    show_plan(made, questions(made) if planned else (), draw(made, path))
    if output:
        console.print(f"plan: {output}", soft_wrap=True, markup=False)
