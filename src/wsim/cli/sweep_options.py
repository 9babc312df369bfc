"""The options of `wsim sweep`: what each is called, and what its help says."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

Targets = Annotated[list[Path] | None, typer.Argument(metavar="PROGRAM...", help="Programs, or the folders of runs.")]
Patches = Annotated[
    list[Path] | None,
    typer.Option(
        "--patch",
        metavar="FILE",
        help="Each program with these edits too: search/replace blocks, or a unified diff. Again for another.",
    ),
]
Vary = Annotated[
    list[str] | None,
    typer.Option("--vary", metavar="NAME=LOW:HIGH", help="What differs; also NAME=log:LOW:HIGH and NAME=A,B,C."),
]
Zipped = Annotated[
    list[str] | None,
    typer.Option("--zip", metavar="NAME,NAME", help="Parameters that are walked together, not each with each."),
]
Randomise = Annotated[
    list[str] | None,
    typer.Option(
        "--randomise",
        metavar="BODY.WHAT=LOW:HIGH",
        help="Drawn for each: .mass, .friction, .level (LOW:HIGHx: times its own), .pose=0.05,5deg.",
    ),
]
Points = Annotated[
    Path | None, typer.Option("--points", metavar="FILE.csv", help="Values: a line of names, a line a candidate.")
]
Drawn = Annotated[
    str, typer.Option("--method", help="How values are drawn: sobol, latin, random, grid, saltelli; cma searches.")
]
Samples = Annotated[
    int,
    typer.Option("--samples", "-n", min=0, max=1_000_000, help="How many are drawn; 0: the programs as they stand."),
]
Repeats = Annotated[
    int, typer.Option("--repeats", min=1, max=10_000, help="Worlds for each, set up a hair's breadth differently.")
]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Of the draw.")]
PlanFile = Annotated[Path | None, typer.Option("--plan", help="plan.json to judge by; a run's own by default.")]
Devices = Annotated[
    str, typer.Option("--device", help="auto (what is done sooner), cpu, cuda:0, …; cuda:0,cuda:1: a worker on each.")
]
Worlds = Annotated[
    int, typer.Option("--worlds", min=0, help="Worlds simulated at once; 0: one on a CPU, 1024 on a GPU.")
]
Workers = Annotated[int, typer.Option("--workers", min=0, help="Processes; 0: one for each core.")]
Ray = Annotated[
    str, typer.Option("--ray", metavar="auto|ADDRESS", help="Workers of a Ray cluster; auto: this machine's own.")
]
Patience = Annotated[float, typer.Option("--patience", min=1.0, help="Seconds after which a candidate is given up.")]
Full = Annotated[
    bool, typer.Option("--full/--no-full", help="Run the best, the worst and those at the limit again, in full.")
]
Resume = Annotated[
    str, typer.Option("--resume", metavar="FOLDER|URL", help="A sweep that was stopped: finish the rest.")
]
StoreUrl = Annotated[
    str, typer.Option("--store", metavar="URL", help="A folder for a copy, as s3://bucket/sweeps (fsspec).")
]
