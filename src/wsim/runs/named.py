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
    """What a target means: itself if it is there, else the run whose name has these letters, or what lies in it.

    Args:
        target: A path, `latest`, or a part of the name of one run in `base`; also a path that begins with either, such
            as `latest/candidates/0007`.
        base: Folder of runs.

    Raises:
        UserError: If there is no such path or run, or more than one run.
    """
    if target.exists() or not target.parts or target.is_absolute() or ".." in target.parts:
        return target
    text, rest = target.parts[0], target.parts[1:]
    if rest:  # of a name that many runs have one cannot be meant by a path: it may be a path that is not there
        inside = [found for found in _matching(text, base) if found.joinpath(*rest).exists()]
        return inside[0].joinpath(*rest) if len(inside) == 1 else target
    found = _matching(text, base)
    if text == LATEST and not found:
        raise UserError(f"{base} holds no run yet; `wsim generate` or `wsim run` makes one")
    if len(found) > 1:
        names = ", ".join(path.name for path in found[:SHOWN])
        more = f" and {len(found) - SHOWN} more" if len(found) > SHOWN else ""
        raise UserError(f"{text} may be any of {names}{more}; give more of the name")
    return found[0] if found else target


def _matching(text: str, base: Path) -> list[Path]:
    """The runs that a name may mean, the newest first; `latest` means one."""
    known = folders(base)
    return known[:1] if text == LATEST else [path for path in known if text.lower() in path.name.lower()]
