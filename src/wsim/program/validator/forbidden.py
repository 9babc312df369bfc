"""What a program may not call: processes, changes of files, files outside the run's folder."""

from __future__ import annotations

from wsim.program.api.entry import Entry
from wsim.program.validator import imports
from wsim.program.validator.arguments import Arguments
from wsim.program.validator.state import State
from wsim.program.validator.values import UNKNOWN, Const

_WRITES = {"w", "a", "x", "+"}


def check(reader: State, entry: Entry, arguments: Arguments) -> None:
    """A problem if the sandbox does not let a program make this call; a person who runs it themselves may."""
    if reader.own:
        return
    why = imports.refused_call(entry.name)
    if why:
        reader.problems.add(arguments.call, "import", f"{entry.name}(): {why}")
    if entry.name == "builtins.open":
        _opens(reader, arguments)


def _opens(reader: State, arguments: Arguments) -> None:
    """`open(path, "w")` on a path outside the run's folder."""
    mode = arguments.values[1] if len(arguments.given) > 1 else arguments.named.get("mode", (UNKNOWN, None))[0]
    path = arguments.values[0] if arguments.given else arguments.named.get("file", (UNKNOWN, None))[0]
    if not (isinstance(mode, Const) and isinstance(path, Const) and isinstance(path.value, str)):
        return
    writes = isinstance(mode.value, str) and bool(_WRITES & set(mode.value))
    if writes and (path.value.startswith(("/", "~")) or ".." in path.value.split("/")):
        text = f'writes "{path.value}": a program writes no files outside its run folder'
        reader.problems.add(arguments.call, "import", text)
