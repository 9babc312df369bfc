"""`wsim judge`: judge a recording again, or a trajectory that another simulator made."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

import typer

from wsim import importers, runs
from wsim.cli.options import EXIT_CODES
from wsim.cli.show import ConsoleProgress, show_verdict
from wsim.errors import UserError
from wsim.plan.store import load
from wsim.runs.folder import RunFolder
from wsim.runs.named import named


def judge(
    target: Annotated[Path, typer.Argument(help="The folder of a run, a recording.rrd, or a trajectory.npz.")],
    plan: Annotated[Path | None, typer.Option("--plan", help="plan.json to judge by; a run's own by default.")] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the verdict as JSON.")] = False,
    model: Annotated[
        Path | None,
        typer.Option("--model", help="What a trajectory is of: MJCF or URDF (.xml, .urdf), a USD stage, a World.json."),
    ] = None,
    save: Annotated[
        Path | None, typer.Option("--save", metavar="FILE.rrd", help="Write the trajectory as a recording, to view it.")
    ] = None,
) -> None:
    """Judge a recording: the checks that hold for any world, and the plan's objectives.

    A trajectory is a NumPy file of MuJoCo's states (time, qpos, qvel), or of bodies: time and body_names with xpos and
    xquat, or with Newton's body_q; body_qd and contact_force may be there.
    The run's own verdict.json is not touched. Exit code: 0 accepted, 1 rejected, 3 blocked.
    """
    if (model or save) and target.suffix != ".npz":
        raise UserError(f"{target} is no trajectory; --model and --save go with a .npz file")
    recording, own = find_recording(target)
    path = plan or own
    chosen = load(path) if path else None
    if json:
        verdict = runs.judge_recording(recording, chosen, model=model)
        print(verdict.model_dump_json(indent=2))
    else:
        with ConsoleProgress() as progress:
            verdict = runs.judge_recording(recording, chosen, progress, model)
        show_verdict(verdict, recording.parent)
    if save:
        importers.save(importers.read_npz(recording, model), save)
    raise typer.Exit(EXIT_CODES[verdict.status])


def find_recording(target: Path) -> tuple[Path, Path | None]:
    """The recording that a target means, and the plan of its run.

    Raises:
        UserError: If there is no recording.
    """
    target = named(target)
    if target.suffix in (".rrd", ".npz"):
        if not target.is_file():
            raise UserError(f"{target} does not exist")
        try:
            plan = RunFolder.open(target).path / "plan.json"
        except UserError:
            return target, None
        return target, plan if plan.is_file() else None
    run = RunFolder.open(target)
    iteration = target if (target / "recording.rrd").is_file() else run.last_iteration()
    recording, plan = iteration / "recording.rrd", run.path / "plan.json"
    if not recording.is_file():
        raise UserError(f"{iteration} has no recording: {_why_not(iteration)}")
    return recording, plan if plan.is_file() else None


def _why_not(iteration: Path) -> str:
    """What became of an iteration that has no recording: a verdict is written at its end, a stage before it runs."""
    program = shlex.quote(str(iteration / "program.py"))
    again = f"`wsim run {program}` runs it again"
    if (iteration / "recording.rrd.partial").is_file():
        return f"the run was stopped while it simulated, and left recording.rrd.partial; {again}"
    if (iteration / "verdict.json").is_file():
        return f"its program made no world; see {iteration / 'verdict.json'}"
    if (iteration / "stage.usda").is_file():
        return f"the run was stopped before it simulated; {again}"
    return f"the run was stopped before its program was built; {again}"
