"""`wsim doctor`: what this machine has."""

from __future__ import annotations

import os
import platform
from importlib.metadata import PackageNotFoundError, version

import typer
from rich.table import Table
from rich.text import Text

from wsim import __version__
from wsim.agents.models import BUILTIN, ROLES, choose
from wsim.cli.show import console
from wsim.errors import UserError
from wsim.program.sandbox import available
from wsim.recording.display import has_display

PACKAGES = ("newton", "warp-lang", "mujoco", "mujoco-warp", "usd-core", "rerun-sdk", "numpy", "av")


def doctor() -> None:
    """List devices, versions, isolation and the models configured. Exit code 1 if wsim cannot run here."""
    table = Table(show_header=False, show_edge=False)
    table.add_column(style="bold")
    table.add_column()
    for name, text in (*_versions(), *_devices(), *_isolation(), *_rest()):
        table.add_row(name, Text(text))
    console.print(table)
    if any(text == "missing" for _, text in _versions()):
        raise typer.Exit(1)


def _versions() -> list[tuple[str, str]]:
    rows = [("wsim", __version__), ("python", platform.python_version())]
    for package in PACKAGES:
        try:
            rows.append((package, version(package)))
        except PackageNotFoundError:
            rows.append((package, "missing"))
    return rows


def _devices() -> list[tuple[str, str]]:
    import warp as wp  # what is missing is to be told, not to stop this

    from wsim import sim

    sim.start_warp()
    rows = []
    for device in wp.get_devices():
        memory = f", {device.total_memory / 2**30:.0f} GiB" if device.is_cuda else ""
        cores = "" if device.is_cuda else f", {len(os.sched_getaffinity(0))} cores"
        rows.append((f"device {device.alias}", f"{device.name}{memory}{cores}"))
    rows.append(("kernel cache", str(wp.config.kernel_cache_dir)))
    return rows


def _isolation() -> list[tuple[str, str]]:
    modes = available()
    return [(f"isolation {mode}", "works" if not why else f"not here: {why}") for mode, why in modes.items()]


def _rest() -> list[tuple[str, str]]:
    return [
        ("display", "yes" if has_display() else "none: `wsim view --web` serves a browser"),
        ("models", _models()),
    ]


def _models() -> str:
    """Who fills which role, by the environment and wsim.toml."""
    try:
        models = choose()
    except UserError as error:
        return str(error)
    named = ", ".join(f"{role} {models[role]}" for role in ROLES if models[role] != BUILTIN)
    return named or "builtin for every role (no language model is needed)"
