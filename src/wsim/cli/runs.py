"""`wsim runs`: what was run, and how it ended."""

from __future__ import annotations

import json as as_json
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table
from rich.text import Text

from wsim.cli.show import STATUS_STYLE, console
from wsim.errors import UserError
from wsim.runs.folder import RunFolder
from wsim.runs.named import folders
from wsim.sweep.folder import SweepFolder

SHORT = 72  # characters of a summary


def runs(
    base: Annotated[Path, typer.Argument(metavar="[FOLDER]", help="Folder of runs.")] = Path("runs"),
    count: Annotated[int, typer.Option("--count", "-n", min=1, help="How many, the newest first.")] = 20,
    json: Annotated[bool, typer.Option("--json", help="Print them as JSON.")] = False,
) -> None:
    """List runs and sweeps, the newest first, with their verdicts.

    Wherever a run is named, `latest` and any part of its name will do, also in `latest/candidates/0007`. A folder that
    cannot be read has a line that says why.
    """
    known = folders(base)
    rows = [_row(path) for path in known[:count]]
    if json:
        print(as_json.dumps(rows, indent=2, ensure_ascii=False))
        return
    if not rows:
        console.print(f"{base} holds no runs yet")
        return
    table = Table(show_edge=False, pad_edge=False)
    for column in ("run", "what", "tried", "status", "s", "summary"):
        table.add_column(column, overflow="fold")
    for row in rows:
        status = Text(row["status"], style=STATUS_STYLE.get(row["status"], "bold"))
        seconds = "" if row["seconds"] is None else f"{row['seconds']:.0f}"
        cells = [Text(row["run"]), Text(row["what"]), Text(str(row["tried"])), status, Text(seconds)]
        table.add_row(*cells, Text(row["summary"][:SHORT]))
    console.print(table)
    if len(known) > len(rows):
        console.print(f"and {len(known) - len(rows)} older ones")


def _row(path: Path) -> dict[str, Any]:
    """What is said of a folder; of one that cannot be read why, so that the others are listed nonetheless."""
    swept = (path / "sweep.json").is_file()
    try:
        return _sweep(path) if swept else _run(path)
    except (UserError, ValueError, OSError) as error:  # files are a user's to edit; json's errors are ValueErrors
        why = str(error).splitlines()[0]
        row = {"run": path.name, "what": "sweep" if swept else "run", "tried": 0, "status": "unreadable"}
        return row | {"seconds": None, "summary": why.replace(f"{path}/", "")}


def _run(path: Path) -> dict[str, Any]:
    run = RunFolder(path)
    facts = run.facts()
    if not isinstance(facts, dict):
        raise UserError("run.json: it holds no table of names and values")
    return {
        "run": path.name,
        "what": "generate" if "budget" in facts else "run",
        "tried": len(run.iterations()),
        "status": facts.get("status", "unfinished"),
        "seconds": facts.get("seconds"),
        "summary": facts.get("summary") or "",
    }


def _sweep(path: Path) -> dict[str, Any]:
    folder = SweepFolder(path)
    outcomes, asked = folder.outcomes().values(), folder.spec.count
    counts = {status: sum(o.status == status for o in outcomes) for status in {o.status: 0 for o in outcomes}}
    return {
        "run": path.name,
        "what": "sweep",
        "tried": len(outcomes),
        "status": ("accepted" if counts.get("accepted") else "rejected") if folder.finished else "unfinished",
        "seconds": round(sum(o.seconds for o in outcomes), 1),
        "summary": ", ".join(f"{n} {status}" for status, n in counts.items()) + f" of {asked}",
    }
