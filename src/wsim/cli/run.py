"""`wsim run`: a program, or a run's program again, built in the sandbox, simulated and judged."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import Annotated

import typer

from wsim import recording, report
from wsim import runs as passes
from wsim.cli.options import EXIT_CODES, Caption, Device, Isolation, Pictures, Runs, Set, TimeStep, Verify, parse_params
from wsim.cli.show import ConsoleProgress, show_verdict
from wsim.errors import UserError
from wsim.plan.store import load
from wsim.runs.folder import RunFolder, write_whole
from wsim.runs.named import named
from wsim.runs.settings import Settings
from wsim.sweep.declared import Known, check, declared_by


def run(
    target: Annotated[Path, typer.Argument(help="A program.py, or the folder of a run.")],
    plan: Annotated[Path | None, typer.Option("--plan", help="plan.json to judge by; a run's own by default.")] = None,
    params: Set = None,
    device: Device = "auto",
    runs: Runs = Path("runs"),
    isolation: Isolation = "auto",
    pictures: Pictures = True,
    caption: Caption = False,
    time_step: TimeStep = None,
    verify: Verify = False,
    timeout: Annotated[
        float, typer.Option("--timeout", min=0.5, max=3600.0, help="Seconds that build may take.")
    ] = 30.0,
    memory: Annotated[
        float, typer.Option("--memory", min=2.0, max=1024.0, help="Memory that build may use [GiB].")
    ] = 4.0,
) -> None:
    """Run a program: build its stage in the sandbox, simulate it, and judge it.

    Without a plan the judge makes the checks that hold for any world.
    Exit code: 0 accepted, 1 rejected, 3 blocked, 2 for a mistake in what was given.
    """
    program, plan = find_program(target, plan)
    chosen = load(plan) if plan else None
    settings = Settings(
        device=device,
        isolation=isolation,
        pictures=pictures,
        caption=caption,
        time_step=time_step,
        verify=verify,
        params=parse_params(params),
        build_timeout=timeout,
        build_memory=int(memory * 2**30),
    )
    settings.check()
    known: Known = {}
    if settings.params:
        with contextlib.suppress(UserError):  # it may build with these values alone; if not, its verdict says why
            known = declared_by([program], isolation)
    if known:
        for name, value in settings.params.items():
            check(name, [], known, f"--set {name}={value:g}")  # a range bounds a search, and no user
    folder = RunFolder.create(runs, chosen.title if chosen and target.is_dir() else program.stem)
    folder.record(prompt=chosen.prompt if chosen else None, program=str(program), params=settings.params)
    if chosen:
        write_whole(folder.path / "plan.json", chosen.model_dump_json(indent=2) + "\n")
    with recording.keeping():
        with ConsoleProgress() as progress:
            verdict = passes.run_in_folder(folder, program, chosen, settings, progress)
        written = report.write(folder.path)
    show_verdict(verdict, folder.path, written)
    raise typer.Exit(EXIT_CODES[verdict.status])


def find_program(target: Path, plan: Path | None) -> tuple[Path, Path | None]:
    """The program that a target means, and the plan that goes with it.

    Raises:
        UserError: If there is no program.
    """
    target = named(target)
    if target.is_dir():
        run = RunFolder.open(target)
        own = run.path / "plan.json"
        places = [target, run.path / "accepted"]
        program = next((place / "program.py" for place in places if (place / "program.py").is_file()), None)
        program = program or run.last_iteration() / "program.py"
        if not program.is_file():
            raise UserError(f"{program} does not exist: the run ended before its program was written")
        return program, plan or (own if own.is_file() else None)
    if not target.is_file():
        raise UserError(f"{target} does not exist; give a program.py or the folder of a run")
    if target.suffix != ".py":
        raise UserError(f"{target} is not a Python program; give a .py file or the folder of a run")
    return target, plan
