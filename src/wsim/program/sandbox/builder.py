"""Run a program's `build` in a sandbox and bring out the stage."""

from __future__ import annotations

import contextlib
import math
import os
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

from wsim.errors import UserError
from wsim.program.sandbox.isolation import choose
from wsim.program.sandbox.limits import Limits
from wsim.program.sandbox.outcome import judge
from wsim.program.sandbox.process import SandboxProcess
from wsim.program.sandbox.result import BuildResult, Kind, ending, printable, read_report

_PROGRAM_BYTES = 1 << 20
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
    program = program_file(program)
    params = numbers(params or {})
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
                kind, message, line = judge(process, limits, program.name, "build(scene)")
                log = printable(process.log)
                problems: list[str] = []
                if kind == "ok":
                    kind, message, problems = _stage(target, checker, limits)
            if kind == "ok":
                deliver(target, 0, os.fstat(target).st_size, stage)
        finally:
            os.close(target)
    seconds = time.monotonic() - started
    return BuildResult(kind == "ok", kind, message, line, log, seconds, chosen, tuple(problems))


def program_file(program: Path) -> Path:
    """A program's file, absolute.

    Raises:
        UserError: If it is none, or too long.
    """
    path = Path(program).resolve()
    if not path.is_file():
        raise UserError(f"{program} is not a file; give the path of a program with a build(scene) function")
    if path.stat().st_size > _PROGRAM_BYTES:
        raise UserError(f"{program} has {path.stat().st_size} bytes; a program has at most {_PROGRAM_BYTES}")
    return path


def numbers(params: Mapping[str, float]) -> dict[str, float]:
    """Values of `scene.param`.

    Raises:
        UserError: If one is not a finite number.
    """
    for name, value in params.items():
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
            raise UserError(f"parameter {name} = {value!r} must be a finite number")
    return {str(name): float(value) for name, value in params.items()}


def _stage(target: int, checker: SandboxProcess, limits: Limits) -> tuple[Kind, str, list[str]]:
    """What is to be said of the stage that a program wrote, without having it read in this process."""
    kind, message = look(target, 0, os.fstat(target).st_size, limits)
    if kind != "ok":
        return kind, message, []
    checker.send(b"g")
    checker.wait(limits.check_seconds)
    return _checked(checker)


def look(target: int, at: int, size: int, limits: Limits) -> tuple[Kind, str]:
    """A first look at a stage in a file: its size, and that it is text."""
    if size == 0:
        return "output", "the program's process wrote no stage"
    if size > limits.file_bytes:
        return "output", f"the stage has {size} bytes, more than the {limits.file_bytes} that are allowed"
    if os.pread(target, min(size, len(_HEADER)), at) != _HEADER:
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


def deliver(source: int, at: int, size: int, stage: Path) -> None:
    """Copy to a side name in the target's folder, then rename: the target is whole or absent."""
    folder, name = os.path.split(stage)
    descriptor, side = tempfile.mkstemp(prefix=f".{name}.", dir=folder or os.curdir)
    try:
        try:
            while size and (sent := os.sendfile(descriptor, source, at, size)):
                at, size = at + sent, size - sent
            os.fchmod(descriptor, 0o644)
        finally:
            os.close(descriptor)
        os.replace(side, stage)  # noqa: PTH105 - of thousands of stages; so are the others
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(side)  # noqa: PTH108
        raise
