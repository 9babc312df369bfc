"""`wsim tool`: one of the deterministic tools, as agents and MCP call it."""

from __future__ import annotations

import json
import sys
from contextlib import nullcontext
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from wsim import tools
from wsim.cli.options import Device, Isolation
from wsim.cli.show import ConsoleProgress
from wsim.errors import UserError
from wsim.progress import silent
from wsim.runs.folder import RunFolder
from wsim.runs.settings import Settings

if TYPE_CHECKING:
    from wsim.tools import Tool

FAILED = 1  # the exit code where a tool says no


def tool(
    name: Annotated[str, typer.Argument(help="The tool; without one, all are listed.")] = "",
    arguments: Annotated[
        list[str] | None,
        typer.Argument(metavar="[KEY=VALUE]...", help="Its arguments: JSON where they are that, else text."),
    ] = None,
    run: Annotated[
        Path | None, typer.Option("--run", help="The run's folder; made, if it is not there, by a tool that writes.")
    ] = None,
    device: Device = "auto",
    isolation: Isolation = "auto",
) -> None:
    """Call one of the tools that agents work with, or list them; `wsim tool NAME` alone shows what one takes.

    Exit code: 0 where the tool did what was asked, 1 where it says why not, 2 for a mistake in the command.
    """
    if not name:
        print("\n".join(_listed(list(tools.TOOLS.values()))))
        return
    if name not in tools.TOOLS:
        near = get_close_matches(name, tools.TOOLS, n=3)
        raise UserError(
            f"no tool {name!r}; " + (f"did you mean {' or '.join(near)}?" if near else "`wsim tool` lists them")
        )
    chosen = tools.TOOLS[name]
    given = _parsed(chosen, arguments or [])
    required = any(field.is_required() for field in chosen.arguments.model_fields.values())
    if not given and (required or (chosen.needs_run and run is None)):
        print("\n".join(_usage(chosen)))
        return
    with ConsoleProgress() if sys.stdout.isatty() else nullcontext(silent) as progress:
        workspace = tools.Workspace(_folder(chosen, run), Settings(device=device, isolation=isolation), progress)
        result = chosen(workspace, **given)
    print(result.text)
    if not result.ok:
        raise typer.Exit(FAILED)


def _folder(chosen: Tool, run: Path | None) -> RunFolder:
    """The run that a tool works on.

    Raises:
        UserError: If it needs one and there is none.
    """
    if not chosen.needs_run:
        return RunFolder(run or Path())
    if run is None:
        raise UserError(f"{chosen.name} works on a run: give its folder with --run; `wsim runs` lists them")
    run = run.resolve()  # answers name no folder of this machine, which a bare word would not be seen to be
    if chosen.writes and not run.exists():
        run.mkdir(parents=True)
        made = RunFolder(run)
        made.record(prompt=None)
        return made
    return RunFolder.open(run)


def _parsed(chosen: Tool, pairs: list[str]) -> dict[str, Any]:
    """KEY=VALUE arguments as the tool's fields take them.

    Raises:
        UserError: Naming the one that is not KEY=VALUE.
    """
    given: dict[str, Any] = {}
    for pair in pairs:
        key, equals, text = pair.partition("=")
        if not equals or not key.isidentifier():
            raise UserError(f"{pair[:60]}: expected KEY=VALUE; `wsim tool {chosen.name}` shows what it takes")
        if key in given:
            raise UserError(f"{key} is given twice; leave one out")
        given[key] = _value(chosen, key, text)
    return given


def _value(chosen: Tool, key: str, text: str) -> Any:
    field = chosen.arguments.model_fields.get(key)
    if field is not None and field.annotation in (str, str | None):
        return text  # what looks like a number may be a name
    try:
        return json.loads(text)
    except json.JSONDecodeError:
        return text


def _listed(known: list[Tool]) -> list[str]:
    width = max(len(each.name) for each in known)
    return [f"{each.name:<{width}}  {each.description}" for each in known]


def _usage(chosen: Tool) -> list[str]:
    lines = [f"{chosen.name}: {chosen.description}"]
    for name, field in chosen.arguments.model_fields.items():
        default = "" if field.is_required() else f" [{json.dumps(field.default)}]"
        lines.append(f"  {name}{default}: {field.description}")
    return lines
