"""Run a program's `build` for many sets of parameters: starting a sandbox takes longer than most builds."""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path

from wsim.program.sandbox.builder import build, deliver, look, numbers, program_file
from wsim.program.sandbox.isolation import choose
from wsim.program.sandbox.limits import Limits
from wsim.program.sandbox.process import SandboxProcess
from wsim.program.sandbox.result import BuildResult, read_report

A_PROCESS = 32  # builds


def build_many(
    program: Path,
    stages: Sequence[Path],
    params: Sequence[Mapping[str, float]],
    limits: Limits | None = None,
    isolation: str = "auto",
    *,
    readable: Sequence[Path] = (),
) -> Iterator[BuildResult]:
    """As `build` for each stage with its parameters, some dozens in one process; the program is loaded anew for each.

    A build that fails there is made again by itself, which says why: what one does to others (a library that it
    changes, all the memory) costs them time alone, unless it changes what they build and lets them seem sound.
    """
    limits = limits or Limits()
    for first in range(0, len(stages), A_PROCESS):
        some = slice(first, first + A_PROCESS)
        started = time.monotonic()
        made = _together(program_file(program), stages[some], params[some], limits, choose(isolation), readable)
        seconds = (time.monotonic() - started) / len(stages[some])
        for stage, values, ok in zip(stages[some], params[some], made, strict=True):
            if ok:
                yield BuildResult(True, "ok", "built", None, "", seconds, choose(isolation))
            else:
                yield build(program, stage, values, limits, isolation, readable=readable)


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
