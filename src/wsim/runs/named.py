"""Runs by name: `latest`, or a part of a folder's name, wherever a run is named."""

from __future__ import annotations

from pathlib import Path

from wsim.errors import UserError

RUNS = Path("runs")  # where they go by default
MARKS = ("run.json", "sweep.json", "iterations")  # what a folder of a run or a sweep holds
LATEST = "latest"
SHOWN = 5


def is_run(path: Path) -> bool:
    """Whether a folder is that of a run or a sweep."""
    return any((path / mark).exists() for mark in MARKS)


def folders(base: Path = RUNS) -> list[Path]:
    """Folders of all runs and sweeps, the newest first: their names begin with the time."""
    found = [path for path in base.iterdir() if is_run(path)] if base.is_dir() else []
    return sorted(found, key=lambda path: path.name, reverse=True)


def named(target: Path, base: Path = RUNS) -> Path:
    """What a target means: itself if it is there, else the run whose name has these letters.

    Args:
        target: A path, `latest`, or a part of the name of one run in `base`.
        base: Folder of runs.

    Raises:
        UserError: If there is no such path or run, or more than one run.
    """
    text = str(target)
    if target.exists() or len(target.parts) != 1:
        return target
    known = folders(base)
    if text == LATEST:
        if not known:
            raise UserError(f"{base} holds no run yet; `wsim generate` or `wsim run` makes one")
        return known[0]
    found = [path for path in known if text.lower() in path.name.lower()]
    if len(found) > 1:
        names = ", ".join(path.name for path in found[:SHOWN])
        more = f" and {len(found) - SHOWN} more" if len(found) > SHOWN else ""
        raise UserError(f"{text} may be any of {names}{more}; give more of the name")
    return found[0] if found else target
