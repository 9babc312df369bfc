"""Run a program's `build` in a sandbox and bring out the stage."""

from __future__ import annotations

import contextlib
import errno
import math
import os
import shutil
import signal
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

from wsim.errors import UserError
from wsim.program.sandbox.isolation import choose
from wsim.program.sandbox.limits import Limits
from wsim.program.sandbox.process import SandboxProcess
from wsim.program.sandbox.result import BuildResult, Kind, Report, ending, printable, read_report

_PROGRAM_BYTES = 1 << 20
_MESSAGE = 800  # characters
_NO_ROOM = (errno.ENOSPC, errno.EFBIG, errno.EDQUOT, errno.EMFILE)
_HEADER = b"#usda 1.0"


def build(
    program: Path,
    stage: Path,
    params: Mapping[str, float] | None = None,
    limits: Limits | None = None,
    isolation: str = "auto",
    *,
    seed: int = 0,
    readable: Sequence[Path] = (),
) -> BuildResult:
    """Run `build(scene)` of a program in its own process and write the stage that it authors.

    Args:
        program: The program's file.
        stage: Where the stage goes; written only if all went well, by renaming a whole file.
        params: Values of `scene.param`, by name; the others keep their defaults.
        limits: What the process may use.
        isolation: "auto" takes bubblewrap, else Landlock, else refuses; "none" keeps the limits only.
        seed: Of the scene.
        readable: Folders that the program may read besides, such as assets; references of the stage must lie in them.

    Returns:
        What came of it. A program that fails is a result, not an exception.

    Raises:
        UserError: If the program cannot be read, a parameter is not a number, or no isolation works here.
    """
    started = time.monotonic()
    limits = limits or Limits()
    program = _program(program)
    params = _numbers(params or {})
    roots = [Path(path).resolve() for path in readable]
    chosen = choose(isolation)
    with tempfile.TemporaryDirectory(prefix="wsim-stage-") as folder:
        made = Path(folder) / "stage.usda"
        target = os.open(made, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o600)
        job = {"task": "build", "program": str(program), "params": params, "seed": seed, "stage_fd": target}
        check = {"task": "check", "stage": str(made), "roots": [str(root) for root in roots]}
        try:
            with (
                SandboxProcess(
                    job, limits=limits, isolation=chosen, readable=[program, *roots], descriptors=[target]
                ) as process,
                SandboxProcess(check, limits=limits, isolation=chosen, readable=[Path(folder), *roots]) as checker,
            ):
                process.send()  # nobody answers a program that asks
                process.wait(limits.wall_seconds)
                kind, message, line = _judge(process, limits, program.name)
                log = printable(process.log)
                problems: list[str] = []
                if kind == "ok":
                    kind, message = _look(target, limits)
                if kind == "ok":
                    checker.send(b"g")
                    checker.wait(limits.check_seconds)
                    kind, message, problems = _checked(checker)
        finally:
            os.close(target)
        if kind == "ok":
            _deliver(made, stage)
    seconds = time.monotonic() - started
    return BuildResult(kind == "ok", kind, message, line, log, seconds, chosen, tuple(problems))


def _program(program: Path) -> Path:
    path = Path(program).resolve()
    if not path.is_file():
        raise UserError(f"{program} is not a file; give the path of a program with a build(scene) function")
    if path.stat().st_size > _PROGRAM_BYTES:
        raise UserError(f"{program} has {path.stat().st_size} bytes; a program has at most {_PROGRAM_BYTES}")
    return path


def _numbers(params: Mapping[str, float]) -> dict[str, float]:
    for name, value in params.items():
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
            raise UserError(f"parameter {name} = {value!r} must be a finite number")
    return {str(name): float(value) for name, value in params.items()}


def _judge(process: SandboxProcess, limits: Limits, name: str) -> tuple[Kind, str, str | None]:
    """Kind, message and line of what became of the process."""
    stopped = _stopped(process, limits)
    if stopped is not None:
        return (*stopped, None)
    report = read_report(process.report()) if process.code == 0 else None
    if report is None:
        return (*_died(process), None)
    line = f"{name}:{report.line}" if report.line else None
    if report.outcome == "ok":
        return "ok", "built", None
    kind: Kind = "exception"
    if report.no_memory or report.type == "MemoryError":
        return "memory", f"the program ran out of its {limits.memory_bytes >> 20} MiB of memory", line
    if report.errno in _NO_ROOM:
        kind = "output"
    return kind, _told(report), line


def _told(report: Report) -> str:
    text = ": ".join(part for part in (report.type, report.message) if part)
    # One line: USD's errors are pages long, and the log has them whole.
    line = " ".join(printable(text).split())
    return line if len(line) <= _MESSAGE else line[:_MESSAGE] + " ..."


def _stopped(process: SandboxProcess, limits: Limits) -> tuple[Kind, str] | None:
    if process.stopped == "timeout":
        return "timeout", f"build(scene) did not end within {limits.wall_seconds:g} s and was stopped"
    if process.code in (-signal.SIGXCPU, 128 + signal.SIGXCPU):
        return "timeout", f"build(scene) used more than {limits.cpu_seconds:g} s of CPU time and was stopped"
    if process.stopped == "log":
        return "output", f"the program printed more than {limits.log_bytes} bytes and was stopped"
    if process.stopped == "scratch":
        return "output", f"the program wrote more than {limits.scratch_bytes} bytes of files and was stopped"
    if process.stopped == "threads":
        return "crash", f"the program started more than {limits.threads} threads and was stopped"
    return None


def _died(process: SandboxProcess) -> tuple[Kind, str]:
    """A process that ended without a report."""
    assert process.code is not None
    log = process.log
    if "std::bad_alloc" in log[-4000:] or "MemoryError" in log[-400:]:
        return "memory", "the program ran out of memory"
    if process.code == 0:
        return "crash", "the program ended its process before build(scene) returned"
    return "crash", f"the program {ending(process.code)} before build(scene) returned"


def _look(target: int, limits: Limits) -> tuple[Kind, str]:
    """A first look at what is in the stage's file: its size, and that it is text."""
    size = os.fstat(target).st_size
    if size == 0:
        return "output", "the program's process wrote no stage"
    if size > limits.file_bytes:
        return "output", f"the stage has {size} bytes, more than the {limits.file_bytes} that are allowed"
    if os.pread(target, len(_HEADER), 0) != _HEADER:
        return "stage", "the stage is not a USD text file (usda)"
    return "ok", "built"


def _checked(checker: SandboxProcess) -> tuple[Kind, str, list[str]]:
    report = read_report(checker.report()) if checker.code == 0 and not checker.stopped else None
    if checker.stopped == "timeout":
        return "stage", "the stage's check did not end in time; the stage is too large or made to hang its reader", []
    if report is None or report.outcome != "ok":
        return "stage", f"the stage cannot be read: its check {ending(checker.code or 0)}", []
    problems = [printable(problem) for problem in report.problems]
    if problems:
        more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
        return "stage", f"{problems[0]}{more}", problems
    return "ok", "built", []


def _deliver(made: Path, stage: Path) -> None:
    """Copy to a side name in the target's folder, then rename: the target is whole or absent."""
    stage = Path(stage)
    descriptor, side = tempfile.mkstemp(prefix=f".{stage.name}.", dir=stage.parent)
    try:
        with os.fdopen(descriptor, "wb") as out, made.open("rb") as source:
            shutil.copyfileobj(source, out)
        Path(side).chmod(0o644)
        Path(side).replace(stage)
    except BaseException:
        with contextlib.suppress(OSError):
            Path(side).unlink()
        raise
