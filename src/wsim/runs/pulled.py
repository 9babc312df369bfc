"""Robots that a program names and that are not here are pulled before it runs: its own process has no network."""

from __future__ import annotations

from wsim.assets.robots import missing
from wsim.assets.sources import source
from wsim.progress import Progress, silent


def pull_missing(program: str, progress: Progress = silent) -> list[str]:
    """Pull what a program's text names, and say so.

    Returns:
        The ids of what was pulled.

    Raises:
        UserError: If it cannot be fetched, with the way out.
    """
    wanted = missing(program)
    for id in wanted:
        from wsim.intake.pull import complete  # with MuJoCo and readers of meshes: few programs need it

        told = f"pulling {id} ({source(id).wheel}, {source(id).license})"
        progress(told, 0, 1)
        complete(id)
        progress(told, 1, 1)
    return wanted
