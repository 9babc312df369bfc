"""Options that several verbs share, and how their values are read."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import PIL.Image
import typer

from wsim.errors import UserError

EXIT_CODES = {"accepted": 0, "rejected": 1, "blocked": 3}

Device = Annotated[str, typer.Option("--device", help="auto (what is quicker for the world), cpu, cuda:0, …")]
Runs = Annotated[Path, typer.Option("--runs", help="Folder that the run's folder goes into.")]
Isolation = Annotated[
    str, typer.Option("--isolation", help="Sandbox of the program: auto, bubblewrap, landlock, or none (trust it).")
]
Pictures = Annotated[bool, typer.Option("--pictures/--no-pictures", help="Render camera frames and the video.")]
Caption = Annotated[
    bool, typer.Option("--caption", help="Write the time, and what is judged, below the video's pictures.")
]
TimeStep = Annotated[
    float | None,
    typer.Option("--time-step", min=1e-5, max=0.1, help="Upper bound of the time step [s]; default: chosen."),
]
Verify = Annotated[
    bool,
    typer.Option(
        "--verify",
        help="Run an accepted world again: at half the time step, with another seed, with a finer fluid. About 3 times "
        "the time, 6 with a fluid.",
    ),
]
Answers = Annotated[
    Path | None,
    typer.Option(
        "--answers", help="Answers to the planner's questions, TOML or JSON; generate then builds without asking."
    ),
]
Image = Annotated[Path | None, typer.Option("--image", help="A picture of what the world must look like.")]
Set = Annotated[list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="Set a parameter of the program.")]


Model = Annotated[
    str | None,
    typer.Option("--model", metavar="MODEL", help="Language model of every role: provider:model, or model@base-url."),
]
PlannerModel = Annotated[str | None, typer.Option("--planner-model", metavar="MODEL", help="Model that plans.")]
CoderModel = Annotated[str | None, typer.Option("--coder-model", metavar="MODEL", help="Model that repairs programs.")]
ReviewerModel = Annotated[str | None, typer.Option("--reviewer-model", metavar="MODEL", help="Model that looks.")]
JudgeModel = Annotated[str | None, typer.Option("--judge-model", metavar="MODEL", help="Model that judges.")]


def parse_params(pairs: list[str] | None) -> dict[str, float]:
    """`--set name=value` options as numbers.

    Raises:
        UserError: Naming the option that is not NAME=NUMBER.
    """
    params = {}
    for pair in pairs or []:
        name, equals, text = pair.partition("=")
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not equals or not name.isidentifier() or not math.isfinite(value):
            raise UserError(f"--set {pair}: expected NAME=NUMBER, such as --set wood_density=2500")
        params[name] = value
    return params


def refuse_image(path: Path | None) -> None:
    """No planner here sees pictures, and a picture that is left out must not go unsaid.

    Raises:
        UserError: A picture was given: it is not there, is no picture, or is one.
    """
    if path is None:
        return
    try:
        with PIL.Image.open(path) as picture:
            picture.verify()
    except (OSError, ValueError, SyntaxError, PIL.Image.DecompressionBombError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else "it is not a picture"
        raise UserError(f"--image {path}: {reason}; give a PNG or a JPEG") from error
    raise UserError(
        f"--image {path}: the builtin planner does not see pictures; name a model that does with --planner-model, or "
        "leave --image out and say it in the sentence"
    )
