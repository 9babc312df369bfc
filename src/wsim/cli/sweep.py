"""`wsim sweep`: candidates of a program, run and judged side by side, in one table."""

from __future__ import annotations

import errno
import os
import shlex
from pathlib import Path
from typing import get_args

import typer

from wsim.cli.options import Isolation, Runs, TimeStep
from wsim.cli.show import ConsoleProgress, console
from wsim.cli.sweep_ask import Asked, known_device, make
from wsim.cli.sweep_options import (
    Devices,
    Drawn,
    Full,
    Patches,
    Patience,
    PlanFile,
    Points,
    Randomise,
    Ray,
    Repeats,
    Resume,
    Samples,
    Seed,
    StoreUrl,
    Targets,
    Vary,
    Workers,
    Worlds,
    Zipped,
)
from wsim.cli.sweep_show import show, show_sensitivity
from wsim.errors import UserError
from wsim.program.sandbox.isolation import choose
from wsim.report.sweep_page import write as write_page
from wsim.sweep.again import in_full
from wsim.sweep.candidate import Outcome
from wsim.sweep.draw import parse_all
from wsim.sweep.folder import SweepFolder
from wsim.sweep.picture import draw
from wsim.sweep.run import sweep as run_sweep
from wsim.sweep.sampling import Method
from wsim.sweep.spec import Spec
from wsim.sweep.store import Store

NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS)


def sweep(
    targets: Targets = None,
    patches: Patches = None,
    vary: Vary = None,
    zipped: Zipped = None,
    randomise: Randomise = None,
    points: Points = None,
    method: Drawn = "sobol",
    samples: Samples = 16,
    repeats: Repeats = 1,
    seed: Seed = 0,
    plan: PlanFile = None,
    device: Devices = "auto",
    time_step: TimeStep = None,
    worlds: Worlds = 0,
    workers: Workers = 0,
    ray: Ray = "",
    patience: Patience = 600.0,
    full: Full = True,
    resume: Resume = "",
    store: StoreUrl = "",
    runs: Runs = Path("runs"),
    isolation: Isolation = "auto",
) -> None:
    """Run many candidates of a program, judge each, and rank them: by verdict, then by the room to the limit.

    Without --vary and --randomise, every scene.param that states a range is varied. Ctrl-C keeps what is done.
    Exit code: 0 if a candidate is accepted, 1 if none is, 2 for a mistake in what was given.
    """
    if resume:
        if targets or patches or vary or zipped or points or randomise:
            raise UserError(
                "--resume goes on with a sweep as it was asked for; "
                "leave programs, --patch, --vary, --zip, --randomise and --points out"
            )
        folder, kept = _opened(resume, store, runs)
    else:
        if method not in get_args(Method):
            raise UserError(f"--method {method}: expected sobol, latin, random, grid, saltelli or cma")
        choose(isolation)
        if not ray:
            known_device(device)
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
            batch=workers or len(os.sched_getaffinity(0)),
        )
        Store(store) if store else None  # what cannot be reached is said before there is a folder
        folder = make(Asked(targets or [], patches or [], vary or [], zipped or [], points, plan), spec, runs)
        kept = Store(f"{store.rstrip('/')}/{folder.path.name}") if store else None
    _through(folder, workers, ray, kept, full)


def _through(folder: SweepFolder, workers: int, ray: str, kept: Store | None, full: bool) -> None:
    """Run what is left; Ctrl-C and a full disk keep what is done, and it is said how to go on."""
    go_on = f"wsim sweep --resume {shlex.quote(str(folder.path))}"
    with folder.taken():
        if kept:
            kept.rest(folder)
        try:
            outcomes = _run(folder, workers, ray, kept, full)
        except KeyboardInterrupt:
            console.print(f"stopped; what is done is kept: {go_on}", soft_wrap=True)
            if kept:
                kept.rest(folder)
            raise typer.Exit(130) from None
        except OSError as error:
            if error.errno not in NO_ROOM:
                raise
            raise UserError(f"{folder.path} takes no more: {error.strerror}; what it has is kept: {go_on}") from error
    raise typer.Exit(0 if any(outcome.status == "accepted" for outcome in outcomes) else 1)


def _run(folder: SweepFolder, workers: int, ray: str, kept: Store | None, full: bool) -> list[Outcome]:
    """Run what is left, show how it came out, and write the page."""
    with ConsoleProgress() as progress:
        outcomes = run_sweep(folder, workers, progress, ray, kept)
        if full:
            outcomes = in_full(folder, outcomes, progress=progress)
    picture = draw(outcomes, folder.path)
    show(outcomes)
    show_sensitivity(folder.spec, outcomes)
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
