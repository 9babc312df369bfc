"""How many candidates a second a sweep runs on one device, and on several: one after another, on this machine.

    .venv/bin/python benchmarks/sweep_devices.py --devices cuda:0 cuda:0,cuda:1 --count 16384
    .venv/bin/python benchmarks/sweep_devices.py --devices cpu --workers 1 2 --count 64

Five boxes and a ball on the ground, whose sizes, masses, friction and speeds are drawn. Each sweep starts its workers
anew; a small one before them compiles the kernels.
"""

from __future__ import annotations

import argparse
import itertools
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from wsim.sweep import Axis, Spec, SweepFolder, sweep

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT)] if str(ROOT) not in sys.path else []

from benchmarks.sweep_setup import AXES, PROGRAM  # noqa: E402 - found from wherever this is called


def seconds(program: Path, spec: Spec, workers: int, ray: str) -> float:
    """What a sweep takes [s]; how its candidates came out is printed."""
    folder = SweepFolder.create(program.parent / "runs", "devices", spec, [program])
    started = time.perf_counter()
    found = sweep(folder, workers, ray=ray)
    took = time.perf_counter() - started
    print("  ", dict(Counter(outcome.status for outcome in found)), Counter(o.note for o in found if o.note) or "")
    return took


def main() -> None:
    """Print candidates a second for each."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--devices", nargs="+", default=["cpu"], help="each as `wsim sweep --device` takes it")
    parser.add_argument("--workers", nargs="+", type=int, default=[0])
    parser.add_argument("--count", type=int, default=64)
    parser.add_argument("--seconds", type=float, default=2.0, help="of a world")
    parser.add_argument("--worlds", type=int, default=0, help="at once, as `wsim sweep --worlds` takes it")
    parser.add_argument("--ray", default="", help="a cluster, as `wsim sweep --ray` takes it")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        program = Path(scratch) / "program.py"
        program.write_text(PROGRAM.replace("SECONDS", f"{given.seconds:g}"), encoding="utf-8")
        axes, first = [Axis.parse(axis) for axis in AXES], None
        spec = Spec(axes=axes, samples=given.count - 1, worlds=given.worlds)
        for device in given.devices:
            seconds(program, spec.model_copy(update={"samples": 3, "device": device}), 0, given.ray)
        for device, workers in itertools.product(given.devices, given.workers):
            took = seconds(program, spec.model_copy(update={"device": device}), workers, given.ray)
            first = first or took
            print(
                f"{device}, {workers or 'all'} workers: {given.count / took:.2f} candidates/s, {first / took:.2f} times"
            )


if __name__ == "__main__":
    main()
