"""The command line: one verb a file; parses, calls, prints."""

from __future__ import annotations

import atexit
import gc
import sys

import typer

from wsim import __version__
from wsim.cli.interrupts import ignore_interrupts, keep_interrupts
from wsim.cli.verbs import Verbs
from wsim.door import keep_what_loads
from wsim.errors import UserError
from wsim.threads import one_thread

one_thread()
app = typer.Typer(
    name="wsim",
    help="A sentence becomes a physical world: planned, built as OpenUSD, simulated on Newton, judged against physics.",
    cls=Verbs,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)
STOPPED = 130  # the exit code for Ctrl-C


@app.callback(invoke_without_command=True)
def _options(version: bool = typer.Option(False, "--version", help="Print the version and stop.")) -> None:
    if version:
        print(f"wsim {__version__}")
        raise typer.Exit


def main() -> None:
    """Run the command line; a user's mistake is one line and exit code 2."""
    keep_interrupts()
    keep_what_loads()
    atexit.register(gc.freeze)  # Python would look for garbage among all that Newton made, for seconds
    try:
        _run()
    except KeyboardInterrupt:  # pressed again while it was winding down
        sys.exit(STOPPED)
    finally:
        ignore_interrupts()


def _run() -> None:
    try:
        app(prog_name="wsim")
    except UserError as error:
        print(f"wsim: {error}", file=sys.stderr)
        sys.exit(2)
    except SystemExit as end:
        if end.code == STOPPED:
            print("wsim: stopped", file=sys.stderr)
        raise
