"""`wsim mcp`: the tools, skills and prompts for any coding agent, over the Model Context Protocol."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from wsim import mcp as protocol
from wsim.cli.options import Device, Isolation, Runs
from wsim.errors import UserError
from wsim.runs.settings import Settings


def mcp(
    http: Annotated[bool, typer.Option("--http", help="Serve over HTTP, to this machine alone.")] = False,
    port: Annotated[
        int | None, typer.Option("--port", min=0, max=65535, help="Port of --http; default: any that is free.")
    ] = None,
    runs: Runs = Path("runs"),
    device: Device = "auto",
    isolation: Isolation = "auto",
) -> None:
    """Serve wsim's tools to a coding agent, which starts this command and speaks over its stdin and stdout."""
    if port is not None and not http:
        raise UserError(f"--port {port}: only --http has a port; add it, or leave --port out")
    wire = None if http else protocol.take_stdout()
    settings = Settings(device=device, isolation=isolation)
    settings.check()
    server = protocol.make_server(protocol.Desk(runs, settings))
    if wire is None:
        protocol.serve_http(server, port or 0, lambda address: _say(f"{address} (Ctrl-C ends it)"))
        return
    if sys.stdin.isatty():
        _say("a coding agent starts this, and speaks over stdin and stdout; docs/mcp.md says how to add it to one")
    protocol.serve_stdio(server, wire)


def _say(text: str) -> None:
    print(f"wsim: {text}", file=sys.stderr, flush=True)
