"""Load a generated program as a module, and say where in it an error arose."""

from __future__ import annotations

import functools
import sys
import traceback
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

_TEXT = 4000  # characters of a message that are reported


class ProgramError(Exception):
    """The program ran, and is not what it must be."""


def load(program: str) -> ModuleType:
    """Run a program's top level as a module named `program`, so that its `__main__` part does not run."""
    module = ModuleType("program")
    module.__file__ = program
    sys.modules["program"] = module
    exec(_compiled(Path(program).read_bytes(), program), module.__dict__)
    return module


@functools.lru_cache(maxsize=1)
def _compiled(text: bytes, program: str) -> CodeType:
    return compile(text, program, "exec")


def function(module: ModuleType, name: str, arguments: str) -> Any:
    """The program's function of that name.

    Raises:
        ProgramError: If it has none.
    """
    found = getattr(module, name, None)
    if not callable(found):
        raise ProgramError(f"the program has no function {name}({arguments}); define it at the top level")
    return found


def explain(error: BaseException, program: str) -> dict[str, Any]:
    """An exception as a report: type, message and the program's line, with the traceback printed to stderr."""
    line = _line(error, program)
    name = type(error).__name__
    try:
        message = str(error)[:_TEXT]
    except BaseException:  # noqa: BLE001 - the program may have defined this exception
        message = "(its message cannot be shown)"
    if isinstance(error, SyntaxError):
        message = str(error.msg)[:_TEXT]
    if isinstance(error, SystemExit):
        message = f"the program called exit({message})"
    trace = error.__traceback__
    while trace is not None and trace.tb_frame.f_code.co_filename != program:
        trace = trace.tb_next
    try:
        traceback.print_exception(error.with_traceback(trace or error.__traceback__))
    except BaseException:  # noqa: BLE001
        sys.stderr.write(f"{name}: {message}\n")
    return {
        "outcome": "exception",
        "type": "" if isinstance(error, ProgramError) else name[:_TEXT],
        "message": message,
        "line": line,
        "errno": error.errno if isinstance(error, OSError) else None,
        "no_memory": isinstance(error, MemoryError),
    }


def _line(error: BaseException, program: str) -> int | None:
    if isinstance(error, SyntaxError) and error.filename == program:
        return error.lineno
    lines = [number for frame, number in traceback.walk_tb(error.__traceback__) if frame.f_code.co_filename == program]
    return lines[-1] if lines else None
