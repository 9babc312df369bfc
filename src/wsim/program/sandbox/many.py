"""Run a program's `build` for many sets of parameters: starting a sandbox takes longer than most builds."""

from __future__ import annotations

import json
import os
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path

from wsim.program.inside.builds_task import parts
from wsim.program.sandbox.builder import build, deliver, look, numbers, program_file
from wsim.program.sandbox.isolation import choose
from wsim.program.sandbox.limits import Limits
from wsim.program.sandbox.process import SandboxProcess
from wsim.program.sandbox.result import BuildResult, read_report

A_PROCESS = 512  # builds at most: starting one process and the one that checks takes as long as some fifty
A_LIMIT = 64  # builds for which a process has the time and the bytes of one
JOB_BYTES = 90_000  # of all parameters of a process: what it is to do comes by its command line, of 128 KiB


def build_many(
    program: Path,
    stages: Sequence[Path],
    params: Sequence[Mapping[str, float]],
    limits: Limits | None = None,
    isolation: str = "auto",
    *,
    readable: Sequence[Path] = (),
    processes: int = 1,
    tell: bool = False,
) -> Iterator[BuildResult]:
    """As `build` for each stage with its parameters, some hundred in one process; the program is loaded anew for each.

    A build that fails there is made again by itself, which says why, and what a process did not come to is made in
    another: what one does to others (a library that it changes, all the memory) costs them time alone, unless it
    changes what they build and lets them seem sound. So many processes are at it side by side; results come in order.

    With `tell` the process that checks a stage describes it, too, if it is one of many: `BuildResult.told`. It never
    had the program in it.
    """
    limits, isolation = limits or Limits(), choose(isolation)
    longest = max((len(json.dumps(numbers(values))) for values in params), default=0)
    size = max(1, min(A_PROCESS, -(-len(stages) // processes), JOB_BYTES // max(1, longest)))

    def some(first: int) -> list[BuildResult]:
        found: list[BuildResult] = []
        last = min(first + size, len(stages))
        while first < last:
            part, started = slice(first, last), time.monotonic()
            made = _together(program_file(program), stages[part], params[part], limits, isolation, readable, tell)
            seconds = (time.monotonic() - started) / len(made)
            found += [
                build(program, stage, values, limits, isolation, readable=readable)
                if told is None
                else BuildResult(True, "ok", "built", None, "", seconds, isolation, told=told)
                for stage, values, told in zip(stages[part], params[part], made, strict=False)
            ]
            first += len(made)
        return found

    with ThreadPoolExecutor(processes, thread_name_prefix="wsim-builds") as pool:  # they do no more than wait
        for results in pool.map(some, range(0, len(stages), size)):
            yield from results


def _together(
    program: Path,
    stages: Sequence[Path],
    params: Sequence[Mapping[str, float]],
    limits: Limits,
    isolation: str,
    readable: Sequence[Path],
    tell: bool,
) -> list[bytes | None]:
    """What is told of stages that one process made and another found sound; None of the others.

    Those alone that the first process came to, one at least.
    """
    roots = [Path(path).resolve() for path in readable]
    shared = _times(limits, -(-len(stages) // A_LIMIT))
    with tempfile.TemporaryDirectory(prefix="wsim-stage-") as folder, ExitStack() as stack:
        target, told = (_opened(Path(folder) / name, os.O_RDWR, stack) for name in ("stages", "told"))
        made = _opened(Path(folder) / "stages", os.O_RDONLY, stack)  # all that who checks them gets
        each = [numbers(values) for values in params]
        job = {"task": "builds", "program": str(program), "seed": 0, "each": each, "stages_fd": target}
        check = {"task": "checks", "count": len(stages), "most": limits.file_bytes, "stages_fd": made}
        check |= {"roots": [str(root) for root in roots]} | ({"told_fd": told} if tell else {})
        process = stack.enter_context(
            SandboxProcess(job, limits=shared, isolation=isolation, readable=[program, *roots], descriptors=[target])
        )
        checker = stack.enter_context(
            SandboxProcess(
                check, limits=shared, isolation=isolation, readable=roots, descriptors=[made, *([told] if tell else [])]
            )
        )
        process.send()
        process.wait(shared.wall_seconds)
        places = list(parts(made, len(stages)))
        written = [look(made, at, size, limits)[0] == "ok" for at, size in places]
        if len(written) < len(stages):
            written.append(False)  # at this one it ended
        if not any(written):
            return [None] * len(written)
        checker.send(b"g")
        checker.wait(shared.check_seconds)
        report = read_report(checker.report()) if checker.code == 0 and not checker.stopped else None
        sound = set(report.sound) if report else set()
        said = [os.pread(told, size, at) for at, size in parts(told, len(stages))] if tell else []
        found: list[bytes | None] = [None] * len(written)
        for k in sorted(sound.intersection(k for k, ok in enumerate(written) if ok)):
            deliver(made, *places[k], stages[k])
            found[k] = said[k] if k < len(said) else b""
        return found


def _opened(path: Path, how: int, stack: ExitStack) -> int:
    """A file that is open as long as the stack is; a new one where it is to be written."""
    new = os.O_CREAT | os.O_EXCL if how != os.O_RDONLY else 0
    target = os.open(path, how | new | os.O_NOFOLLOW, 0o600)
    stack.callback(os.close, target)
    return target


def _times(limits: Limits, count: int) -> Limits:
    """What a process may use that does what so many do."""
    cpu = None if limits.cpu_seconds is None else limits.cpu_seconds * count
    more = {name: getattr(limits, name) * count for name in ("wall_seconds", "check_seconds", "file_bytes")}
    return limits.model_copy(update={**more, "cpu_seconds": cpu})
