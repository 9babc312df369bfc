"""The verbs. A new one is a file in this folder, with a function of its name, and a line here.

A verb's file is loaded when the verb is called, so that it can import what it needs at its top; the help of wsim as a
whole loads none of them.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup
from typer.exceptions import TyperException

from wsim.door import load_module

VERBS = {
    "generate": "Plan a world from a sentence, build it, simulate it, judge it, and repair it until it is right.",
    "plan": "Show the plan of a sentence: objects, places, what must happen, what was assumed, what it takes, two "
    "drawings.",
    "run": "Run a program: build its stage in the sandbox, simulate it, and judge it.",
    "sweep": "Run many candidates of a program, judge each, and rank them: by verdict, then by the room to the limit.",
    "judge": "Judge a recording: the checks that hold for any world, and the plan's objectives.",
    "tool": "Call one of the tools that agents work with, or list them; `wsim tool NAME` alone shows what one takes.",
    "assets": "List, find and show the assets that worlds are furnished with; add your own models, and remove them.",
    "runs": "List runs and sweeps, the newest first, with their verdicts.",
    "view": "Open a recording in Rerun's viewer; with no display, print the command to use elsewhere.",
    "mcp": "Serve wsim's tools to a coding agent, which starts this command and speaks over its stdin and stdout.",
    "warmup": "Compile the kernels that most worlds need, side by side, so that a first world need not wait for them.",
    "doctor": "List devices, versions, isolation and the models configured. Exit code 1 if wsim cannot run here.",
}


class Verb(TyperCommand):
    """Stands for a verb until it is called."""

    def make_context(self, info_name: str | None, args: list[str], *rest: Any, **given: Any) -> Any:
        """Load the verb; from here on it is the command."""
        assert self.name is not None
        return load(self.name).make_context(info_name, args, *rest, **given)


class Verbs(TyperGroup):
    """The command `wsim`."""

    def __init__(self, **given: Any) -> None:
        super().__init__(**given)
        self.commands = {
            **{name: Verb(name, callback=None, help=text) for name, text in VERBS.items()},
            **self.commands,
        }

    def main(
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        complete_var: str | None = None,
        standalone_mode: bool = True,
        windows_expand_args: bool = True,
        **extra: Any,
    ) -> Any:
        """Run it. A mistake in the words that it is given is one line, as any mistake of a user's is."""
        run = super().main
        if not standalone_mode:
            return run(args, prog_name, complete_var, False, windows_expand_args, **extra)
        try:
            sys.exit(run(args, prog_name, complete_var, False, windows_expand_args, **extra) or 0)
        except typer.Abort:
            print("wsim: stopped", file=sys.stderr)
            sys.exit(1)
        except TyperException as error:
            context = getattr(error, "ctx", None)
            if context is not None and type(error).__name__ == "NoArgsIsHelpError":  # nothing was asked
                context.get_help()  # which prints it
            else:
                said = " ".join(error.format_message().split()) if hasattr(error, "format_message") else str(error)
                command = context.command_path if context is not None else "wsim"
                print(f"wsim: {said.rstrip('.')}; {command} --help says more", file=sys.stderr)
            sys.exit(2)


def load(name: str) -> Any:
    """The command of a verb's file, or its group of commands."""
    verb = getattr(load_module(f"wsim.cli.{name}"), name)
    if isinstance(verb, typer.Typer):
        return typer.main.get_command(verb)
    only = typer.Typer(add_completion=False, pretty_exceptions_enable=False, rich_markup_mode="rich")
    only.command(name)(verb)
    return typer.main.get_command(only)
