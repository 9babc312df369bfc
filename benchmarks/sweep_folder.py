"""What a sweep's folder takes of many candidates: drawn, kept line by line, read again, ranked in a table, sent away.

    .venv/bin/python benchmarks/sweep_folder.py --count 100000
    .venv/bin/python benchmarks/sweep_folder.py --count 1000000

Outcomes are made up: three parameters, two objectives. Of each step the seconds, and the most memory so far.
"""

from __future__ import annotations

import argparse
import random
import resource
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from wsim.sweep import Axis, Outcome, Spec, SweepFolder
from wsim.sweep.candidate import Candidate
from wsim.sweep.store import Store
from wsim.sweep.table import write

AXES = ("edge=0.1:0.3", "density=200:900", "speed=0.1:2")
OBJECTIVES = ("box slides down ramp.", "box stays upright.")
Value = TypeVar("Value")


def outcome(candidate: Candidate, draw: random.Random) -> Outcome:
    """What might have come of it."""
    margins = {name: draw.uniform(-1.0, 1.0) for name in OBJECTIVES}
    good = min(margins.values()) > 0.0
    return Outcome(
        candidate=candidate,
        status="accepted" if good else "rejected",
        reason="Accepted: all 37 findings pass." if good else "Rejected: 1 of 37 findings fails.",
        slack=min(margins.values()),
        decided_by=min(margins, key=margins.__getitem__),
        margins=margins,
        values={name: draw.random() for name in OBJECTIVES},
        failures=[] if good else [OBJECTIVES[0]],
        seconds=round(draw.uniform(0.5, 1.5), 3),
    )


def timed(what: str, work: Callable[[], Value]) -> Value:
    """Say what a step took."""
    started = time.perf_counter()
    value = work()
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    print(f"{what:24} {time.perf_counter() - started:7.1f} s   {peak:5.2f} GiB")
    return value


def main() -> None:
    """Print a line for each step, and the sizes of what is left."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=100_000)
    count = parser.parse_args().count
    spec = Spec(axes=[Axis.parse(axis) for axis in AXES], samples=max(1, count - 1))
    draw = random.Random(0)
    with tempfile.TemporaryDirectory() as scratch:
        program = Path(scratch) / "program.py"
        program.write_text("def build(scene):\n    scene.ground()\n")
        folder = SweepFolder.create(scratch, "many", spec, [program])
        candidates = timed("drawn", spec.candidates)
        made = timed("made up", lambda: [outcome(candidate, draw) for candidate in candidates])
        timed("kept, line by line", lambda: [folder.add(each) for each in made])
        found = timed("read again", folder.outcomes)
        timed("ranked, in tables", lambda: write(list(found.values()), folder.path))
        timed("sent to a store", lambda: Store(f"{scratch}/store").rest(folder))
        for path in sorted(folder.path.iterdir()):
            size = path.stat().st_size
            print(f"{path.name:24} {size / 1e6:7.1f} MB  {size / len(candidates):5.0f} bytes a candidate")


if __name__ == "__main__":
    main()
