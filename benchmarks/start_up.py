"""How long what comes before a world moves takes: the command line's start, a small program's build, a `control` call.

    .venv/bin/python benchmarks/start_up.py
    .venv/bin/python benchmarks/start_up.py --runs 41

Each figure is the median of several runs, after one that is not counted. Half a second is promised for the first two;
the exit code is 1 where a promise is missed.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from wsim.program.control import ControlLayout, ControlProcess
from wsim.program.sandbox import available, build

START_LIMIT = 0.5  # [s]
CALLS = 300  # of `control`, in one run
PROGRAM = """\
def build(scene):
    scene.ground()
    scene.box("block", size=(0.2, 0.2, 0.2), position=(0.0, 0.0, 0.5), density=600.0)

def control(world, t):
    world.joint("hinge").target = t
"""


def start(*arguments: str) -> Callable[[], None]:
    """Start Python with these arguments, and wait for its end."""
    command = [sys.executable, *arguments]
    return lambda: subprocess.run(command, capture_output=True, check=True) and None


def built(program: Path, isolation: str) -> Callable[[], None]:
    """Build the program's stage."""

    def once() -> None:
        result = build(program, program.with_suffix(".usda"), isolation=isolation)
        assert result.ok, result.message

    return once


def seconds(action: Callable[[], object], runs: int) -> float:
    """The median of so many runs [s]."""
    times = []
    for _ in range(runs + 1):
        began = time.perf_counter()
        action()
        times.append(time.perf_counter() - began)
    return statistics.median(times[1:])


def rows(folder: Path, runs: int) -> Iterator[tuple[str, float, float | None]]:
    """What was measured, the time that it took [s], and the promise [s] if there is one."""
    yield "import wsim", seconds(start("-c", "import wsim"), runs), START_LIMIT
    yield "wsim --help", seconds(start("-m", "wsim.cli", "--help"), runs), START_LIMIT
    program = folder / "program.py"
    program.write_text(PROGRAM, encoding="utf-8")
    layout = ControlLayout(["/World/block"], ["/World/hinge"])
    state = {"joint_q": np.zeros((1, 1)), "joint_qd": np.zeros((1, 1))}
    for isolation in (name for name, problem in available().items() if not problem):
        yield f"a small program's build, {isolation}", seconds(built(program, isolation), runs), None
        with ControlProcess(program, layout, isolation=isolation) as process:
            yield f"a call of control, {isolation}", seconds(lambda p=process: p.step(0.0, state), CALLS), None


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=11, help="of each, besides the first")
    runs = parser.parse_args().runs
    missed = False
    with tempfile.TemporaryDirectory() as folder:
        for name, median, limit in rows(Path(folder), runs):
            missed |= limit is not None and median > limit
            promise = "" if limit is None else f"  promised {limit:g} s{', MISSED' if median > limit else ''}"
            print(f"{name:40} {1000.0 * median:9.2f} ms{promise}")
    return int(missed)


if __name__ == "__main__":
    sys.exit(main())
