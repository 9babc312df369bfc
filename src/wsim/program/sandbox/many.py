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

from wsim.program.inside.builds_task import SIZE
from wsim.program.sandbox.builder import build, deliver, look, numbers, program_file
from wsim.program.sandbox.isolation import choose
from wsim.program.sandbox.limits import Limits
from wsim.program.sandbox.process import SandboxProcess
from wsim.program.sandbox.result import BuildResult, read_report

A_PROCESS = 256  # builds at most: starting one process and the one that checks takes as long as some fifty
A_LIMIT = 64  # builds for which a process has the time and the bytes of one
JOB_BYTES = 64_000  # of all parameters of a process: what it is to do comes by its command line, of 128 KiB


def build_many(
    program: Path,
    stages: Sequence[Path],
    params: Sequence[Mapping[str, float]],
    limits: Limits | None = None,
    isolation: str = "auto",
    *,
    readable: Sequence[Path] = (),
    processes: int = 1,
) -> Iterator[BuildResult]:
    """As `build` for each stage with its parameters, some hundred in one process; the program is loaded anew for each.

    A build that fails there is made again by itself, which says why, and what a process did not come to is made in
    another: what one does to others (a library that it changes, all the memory) costs them time alone, unless it
    changes what they build and lets them seem sound. So many processes are at it side by side; results come in order.
    """
    limits, isolation = limits or Limits(), choose(isolation)
    longest = max((len(json.dumps(numbers(values))) for values in params), default=0)
    size = max(1, min(A_PROCESS, -(-len(stages) // processes), JOB_BYTES // max(1, longest)))

    def some(first: int) -> list[BuildResult]:
        found: list[BuildResult] = []
        last = min(first + size, len(stages))
        while first < last:
            part, started = slice(first, last), time.monotonic()
            made = _together(program_file(program), stages[part], params[part], limits, isolation, readable)
            seconds = (time.monotonic() - started) / len(made)
            found += [
                BuildResult(True, "ok", "built", None, "", seconds, isolation)
                if ok
                else build(program, stage, values, limits, isolation, readable=readable)
                for stage, values, ok in zip(stages[part], params[part], made, strict=False)
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
) -> list[bool]:
    """Which of the stages one process made and another found sound; those alone that it came to, one at least."""
    roots = [Path(path).resolve() for path in readable]
    shared = _times(limits, -(-len(stages) // A_LIMIT))
    with tempfile.TemporaryDirectory(prefix="wsim-stage-") as folder, ExitStack() as stack:
        made = [Path(folder) / f"stage_{k}.usda" for k in range(len(stages))]
        target = os.open(Path(folder) / "stages", os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o600)
        stack.callback(os.close, target)
        each = [numbers(values) for values in params]
        job = {"task": "builds", "program": str(program), "seed": 0, "each": each, "stages_fd": target}
        check = {"task": "checks", "stages": [str(path) for path in made], "roots": [str(root) for root in roots]}
        process = stack.enter_context(
            SandboxProcess(job, limits=shared, isolation=isolation, readable=[program, *roots], descriptors=[target])
        )
        checker = stack.enter_context(
            SandboxProcess(check, limits=shared, isolation=isolation, readable=[Path(folder), *roots])
        )
        process.send()
        process.wait(shared.wall_seconds)
        written = list(_parted(target, made, limits))
        if len(written) < len(made):
            written.append(False)  # at this one it ended
        if not any(written):
            return written
        checker.send(b"g")
        checker.wait(shared.check_seconds)
        report = read_report(checker.report()) if checker.code == 0 and not checker.stopped else None
        sound = set(report.sound) if report else set()
        found = [ok and k in sound for k, ok in enumerate(written)]
        for path, stage, ok in zip(made, stages, found, strict=False):
            if ok:
                deliver(path, stage)
        return found


def _times(limits: Limits, count: int) -> Limits:
    """What a process may use that does what so many do."""
    cpu = None if limits.cpu_seconds is None else limits.cpu_seconds * count
    more = {name: getattr(limits, name) * count for name in ("wall_seconds", "check_seconds", "file_bytes")}
    return limits.model_copy(update={**more, "cpu_seconds": cpu})


def _parted(target: int, made: Sequence[Path], limits: Limits) -> Iterator[bool]:
    """Write what a process appended, each stage to its file; whether it is one. It ends where what is there does."""
    total, at = os.fstat(target).st_size, 0
    for path in made:
        head = os.pread(target, SIZE, at)
        at += SIZE
        size = int(head) if len(head) == SIZE and head.isdigit() else total
        if at + size > total:
            return
        with path.open("x+b") as out:
            left = size if size <= limits.file_bytes else 0
            while left and (sent := os.sendfile(out.fileno(), target, at + size - left, left)):
                left -= sent
            yield look(out.fileno(), limits)[0] == "ok"
        at += size
