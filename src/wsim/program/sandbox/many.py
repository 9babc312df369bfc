"""Run a program's `build` for many sets of parameters: starting a sandbox takes longer than most builds."""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path

from wsim.program.sandbox.builder import build, deliver, look, numbers, program_file
from wsim.program.sandbox.isolation import choose
from wsim.program.sandbox.limits import Limits
from wsim.program.sandbox.process import SandboxProcess
from wsim.program.sandbox.result import BuildResult, read_report

A_PROCESS = 64  # builds at most: starting one process and the one that checks takes as long as some fifty


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
    """As `build` for each stage with its parameters, some dozens in one process; the program is loaded anew for each.

    A build that fails there is made again by itself, which says why: what one does to others (a library that it
    changes, all the memory) costs them time alone, unless it changes what they build and lets them seem sound.
    So many processes are at it side by side; results come in order.
    """
    limits, isolation = limits or Limits(), choose(isolation)
    size = max(1, min(A_PROCESS, -(-len(stages) // processes)))

    def some(first: int) -> list[BuildResult]:
        part, started = slice(first, first + size), time.monotonic()
        made = _together(program_file(program), stages[part], params[part], limits, isolation, readable)
        seconds = (time.monotonic() - started) / len(made)
        return [
            BuildResult(True, "ok", "built", None, "", seconds, isolation)
            if ok
            else build(program, stage, values, limits, isolation, readable=readable)
            for stage, values, ok in zip(stages[part], params[part], made, strict=True)
        ]

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
    """Which of the stages one process made and another found sound."""
    roots = [Path(path).resolve() for path in readable]
    with tempfile.TemporaryDirectory(prefix="wsim-stage-") as folder, ExitStack() as stack:
        made = [Path(folder) / f"stage_{k}.usda" for k in range(len(stages))]
        targets = []
        for path in made:
            targets.append(os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o600))
            stack.callback(os.close, targets[-1])
        each = [{"params": numbers(values), "stage_fd": target} for values, target in zip(params, targets, strict=True)]
        job = {"task": "builds", "program": str(program), "seed": 0, "each": each}
        check = {"task": "checks", "stages": [str(path) for path in made], "roots": [str(root) for root in roots]}
        process = stack.enter_context(
            SandboxProcess(job, limits=limits, isolation=isolation, readable=[program, *roots], descriptors=targets)
        )
        checker = stack.enter_context(
            SandboxProcess(check, limits=limits, isolation=isolation, readable=[Path(folder), *roots])
        )
        process.send()
        process.wait(limits.wall_seconds)
        written = [look(target, limits)[0] == "ok" for target in targets]
        if not any(written):
            return written
        checker.send(b"g")
        checker.wait(limits.check_seconds)
        report = read_report(checker.report()) if checker.code == 0 and not checker.stopped else None
        sound = set(report.sound) if report else set()
        found = [ok and k in sound for k, ok in enumerate(written)]
        for path, stage, ok in zip(made, stages, found, strict=True):
            if ok:
                deliver(path, stage)
        return found
