"""`wsim sweep`: candidates of a program, run and judged side by side, in one table."""

from __future__ import annotations

import os
from collections import Counter
from pathlib import Path
from typing import Annotated, get_args

import typer
from rich.table import Table
from rich.text import Text

from wsim import sim
from wsim.cli.options import Isolation, Runs, TimeStep
from wsim.cli.run import find_program
from wsim.cli.show import STATUS_STYLE, ConsoleProgress, console
from wsim.errors import UserError
from wsim.plan.store import load
from wsim.program.sandbox.isolation import choose
from wsim.report.sweep_page import write as write_page
from wsim.sweep.again import in_full
from wsim.sweep.axis import Axis
from wsim.sweep.candidate import Outcome
from wsim.sweep.declared import axes_of, check, check_draws, parameters_of
from wsim.sweep.device import pick_device
from wsim.sweep.draw import parse_all
from wsim.sweep.folder import SweepFolder
from wsim.sweep.picture import draw
from wsim.sweep.run import sweep as run_sweep
from wsim.sweep.sampling import Method, Point, read_points
from wsim.sweep.sensitivity import sensitivities
from wsim.sweep.spec import Spec
from wsim.sweep.store import Store
from wsim.sweep.table import parameters

SHOWN = 12  # rows


def sweep(
    targets: Annotated[
        list[Path] | None, typer.Argument(metavar="PROGRAM...", help="Programs, or the folder of a run.")
    ] = None,
    vary: Annotated[
        list[str] | None,
        typer.Option("--vary", metavar="NAME=LOW:HIGH", help="What differs; also NAME=log:LOW:HIGH and NAME=A,B,C."),
    ] = None,
    randomise: Annotated[
        list[str] | None,
        typer.Option(
            "--randomise",
            metavar="BODY.WHAT=LOW:HIGH",
            help="Drawn for each: .mass, .friction, .level (LOW:HIGHx: times its own), .pose=0.05,5deg.",
        ),
    ] = None,
    points: Annotated[
        Path | None, typer.Option("--points", metavar="FILE.csv", help="Values: a line of names, a line a candidate.")
    ] = None,
    method: Annotated[
        str, typer.Option("--method", help="How values are drawn: sobol, latin, random, grid, saltelli; cma searches.")
    ] = "sobol",
    samples: Annotated[int, typer.Option("--samples", "-n", min=1, max=1_000_000, help="How many are drawn.")] = 16,
    repeats: Annotated[
        int, typer.Option("--repeats", min=1, max=10_000, help="Worlds for each, set up a hair's breadth differently.")
    ] = 1,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Of the draw.")] = 0,
    plan: Annotated[Path | None, typer.Option("--plan", help="plan.json to judge by; a run's own by default.")] = None,
    device: Annotated[
        str,
        typer.Option("--device", help="auto (what is done sooner), cpu, cuda:0, …; cuda:0,cuda:1: a worker on each."),
    ] = "auto",
    time_step: TimeStep = None,
    worlds: Annotated[
        int, typer.Option("--worlds", min=0, help="Worlds simulated at once; 0: one on a CPU, 1024 on a GPU.")
    ] = 0,
    workers: Annotated[int, typer.Option("--workers", min=0, help="Processes; 0: one for each core.")] = 0,
    ray: Annotated[
        str, typer.Option("--ray", metavar="auto|ADDRESS", help="Workers of a Ray cluster; auto: this machine's own.")
    ] = "",
    patience: Annotated[
        float, typer.Option("--patience", min=1.0, help="Seconds after which a candidate is given up.")
    ] = 600.0,
    full: Annotated[
        bool, typer.Option("--full/--no-full", help="Run the best, the worst and those at the limit again, in full.")
    ] = True,
    resume: Annotated[
        str, typer.Option("--resume", metavar="FOLDER|URL", help="A sweep that was stopped: finish the rest.")
    ] = "",
    store: Annotated[
        str, typer.Option("--store", metavar="URL", help="A folder for a copy, as s3://bucket/sweeps (fsspec).")
    ] = "",
    runs: Runs = Path("runs"),
    isolation: Isolation = "auto",
) -> None:
    """Run many candidates of a program, judge each, and rank them: by verdict, then by the room to the limit.

    Without --vary and --randomise, every scene.param that states a range is varied. Ctrl-C keeps what is done.
    Exit code: 0 if a candidate is accepted, 1 if none is, 2 for a mistake in what was given.
    """
    if resume:
        if targets or vary or points or randomise:
            raise UserError(
                "--resume goes on with a sweep as it was asked for; "
                "leave programs, --vary, --randomise and --points out"
            )
        folder, kept = _opened(resume, store, runs)
    else:
        if method not in get_args(Method):
            raise UserError(f"--method {method}: expected sobol, latin, random, grid, saltelli or cma")
        choose(isolation)
        if not ray:
            _known(device)
        spec = Spec(
            method=method,
            samples=samples,
            repeats=repeats,
            seed=seed,
            device="cpu" if ray and device == "auto" else device,  # what a cluster has is not known here
            time_step=time_step,
            isolation=isolation,
            worlds=worlds,
            patience=patience,
            draws=parse_all(randomise or []),
            batch=max(1, (workers or len(os.sched_getaffinity(0))) // max(1, len(targets or []) * repeats)),
        )
        Store(store) if store else None  # what cannot be reached is said before there is a folder
        folder = _ask(spec, targets or [], vary or [], points, plan, runs)
        kept = Store(f"{store.rstrip('/')}/{folder.path.name}") if store else None
    if kept:
        kept.rest(folder)
    try:
        outcomes = _run(folder, workers, ray, kept, full)
    except KeyboardInterrupt:
        if kept:
            kept.rest(folder)
        console.print(f"stopped; what is done is kept: wsim sweep --resume {folder.path}", soft_wrap=True)
        raise typer.Exit(130) from None
    raise typer.Exit(0 if any(outcome.status == "accepted" for outcome in outcomes) else 1)


def _run(folder: SweepFolder, workers: int, ray: str, kept: Store | None, full: bool) -> list[Outcome]:
    """Run what is left, show how it came out, and write the page."""
    with ConsoleProgress() as progress:
        outcomes = run_sweep(folder, workers, progress, ray, kept)
        if full:
            outcomes = in_full(folder, outcomes, progress=progress)
    picture = draw(outcomes, folder.path)
    _show(outcomes)
    _show_sensitivity(folder.spec, outcomes)
    page = write_page(folder)
    for path in [folder.path / "table.parquet", *([picture] if picture else []), page]:
        console.print(f"{path.stem}: {path}", soft_wrap=True)
    if kept:
        kept.rest(folder)
        console.print(f"all of it: {kept.url}", soft_wrap=True)
    return outcomes


def _opened(resume: str, store: str, runs: Path) -> tuple[SweepFolder, Store | None]:
    """A sweep that was stopped, in a folder of this machine or in a store; and where its copy is kept."""
    if "://" in resume:
        kept = Store(resume)
        return kept.fetch(runs), kept
    folder = SweepFolder.open(resume)
    return folder, Store(f"{store.rstrip('/')}/{folder.path.name}") if store else None


def _known(device: str) -> None:
    """Refuse a device that this machine has not; several are GPUs."""
    names = device.split(",")
    if len(names) > 1 and not all(name.startswith("cuda:") for name in names):
        raise UserError(f"--device {device}: several devices are GPUs, as in cuda:0,cuda:1")
    for name in names:
        if name not in ("auto", "cpu"):
            sim.known_device(name)


def _ask(
    spec: Spec, targets: list[Path], vary: list[str], points: Path | None, plan: Path | None, runs: Path
) -> SweepFolder:
    """The folder of a new sweep, whose axes every program has."""
    if not targets:
        raise UserError("name a program.py or the folder of a run, or a sweep with --resume")
    found = [find_program(target, plan) for target in targets]
    programs, plans = [program for program, _ in found], {own for _, own in found if own is not None}
    if len(plans) > 1:
        raise UserError("the runs have different plans; give the one to judge by with --plan")
    if points and vary:
        raise UserError("--points gives the values; leave --vary out")
    given: list[Point] = read_points(points) if points else []
    axes = [Axis.parse(text) for text in vary]
    for program in programs:
        if given:
            known = {parameter.name: parameter for parameter in parameters_of(program, spec.isolation)}
            for name in given[0]:
                check(name, [point[name] for point in given], known, f"--points {points}")
        else:
            axes = axes_of(program, axes, spec.isolation) if axes or not spec.draws else axes
        if spec.draws:
            check_draws(program, spec.draws, spec.isolation)
    chosen = load(plans.pop()) if plans else None
    asked = spec.model_copy(update={"axes": axes, "points": given})
    _ = asked.count  # too few for the method is said before there is a folder
    if asked.device == "auto":
        device, why = pick_device(asked, programs[0], len(os.sched_getaffinity(0)))
        asked = asked.model_copy(update={"device": device})
        if why:
            console.print(why, soft_wrap=True)
    text = chosen.model_dump_json(indent=2) + "\n" if chosen else None
    return SweepFolder.create(runs, chosen.title if chosen else programs[0].stem, asked, programs, text)


def _show(outcomes: list[Outcome]) -> None:
    """The first rows of the table, and how many there are of each status."""
    names = parameters(outcomes)
    table = Table(show_edge=False, pad_edge=False)
    for column in ("rank", "candidate", *names, "status", "slack", "decided by", "s"):
        table.add_column(column, overflow="fold")
    for rank, outcome in enumerate(outcomes[:SHOWN], start=1):
        values = [outcome.candidate.values.get(name) for name in names]
        numbers = ["as it stands" if value is None else f"{value:.4g}" for value in values]
        slack = "" if outcome.slack is None else f"{outcome.slack:+.3f}"
        cells = [str(rank), str(outcome.candidate.number), *numbers]
        row = [*map(Text, cells), Text(outcome.status, style=STATUS_STYLE.get(outcome.status, "bold magenta"))]
        table.add_row(*row, Text(slack), Text(outcome.decided_by or outcome.reason), Text(f"{outcome.seconds:.1f}"))
    console.print(table)
    counts = {status: sum(o.status == status for o in outcomes) for status in {o.status: 0 for o in outcomes}}
    console.print(", ".join(f"{count} {status}" for status, count in counts.items()) + f" of {len(outcomes)}")
    accepted = [outcome for outcome in outcomes if outcome.status == "accepted"]
    if len(accepted) > 1 and all(outcome.slack is None for outcome in accepted):
        console.print("no objective ranks the accepted: they stand by their numbers; --plan gives what to rank by")
    for note, count in Counter(outcome.note for outcome in outcomes if outcome.note).most_common():
        console.print(f"{count} {note}", soft_wrap=True)
    if outcomes and outcomes[0].status == "accepted" and outcomes[0].together > 1:
        console.print("the best was judged in its batch alone, without contacts and ties; --full runs it by itself")


def _show_sensitivity(spec: Spec, outcomes: list[Outcome]) -> None:
    """Which parameter the room to the limit hangs on, where the points tell."""
    for each in sensitivities(spec, outcomes)[:1]:
        table = Table(show_edge=False, pad_edge=False)
        for column in (f"{each.result} hangs on", "by itself", "95 %", "with others", "95 %"):
            table.add_column(column, justify="left" if column.startswith(each.result) else "right")
        for index in each.indices:
            low, high = index.first_between
            own = [f"{index.first:.2f}", f"{low:.2f} … {high:.2f}"]
            low, high = index.total_between
            table.add_row(index.name, *own, f"{index.total:.2f}", f"{low:.2f} … {high:.2f}")
        console.print(table)
