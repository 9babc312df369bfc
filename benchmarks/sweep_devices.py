"""How many candidates a second a sweep runs on one device, and on several: one after another, on this machine.

    .venv/bin/python benchmarks/sweep_devices.py --devices cuda:0 cuda:0,cuda:1 --count 16384
    .venv/bin/python benchmarks/sweep_devices.py --devices cpu --workers 1 2 --count 64
    .venv/bin/python benchmarks/sweep_devices.py --devices cuda:0 cuda:0,cuda:1 --count 256 \\
        --program examples/wood_afloat.py --plan examples/plans/wood_afloat.json \\
        --vary density=250:1000 level=0.04:0.12 spacing=0.0125

By default five boxes and a ball on the ground, whose sizes, masses, friction and speeds are drawn. Each sweep starts
its workers anew; a small one before them compiles the kernels.
"""

from __future__ import annotations

import argparse
import itertools
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import Any

from wsim.sweep import Axis, Spec, SweepFolder, sweep

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT)] if str(ROOT) not in sys.path else []

from benchmarks.sweep_setup import AXES, PROGRAM  # noqa: E402 - found from wherever this is called


def seconds(scratch: Path, program: Path, plan: str | None, spec: Spec, workers: int, ray: str) -> float:
    """What a sweep takes [s]; how its candidates came out is printed."""
    folder = SweepFolder.create(scratch / "runs", "devices", spec, [program], plan)
    started = time.perf_counter()
    found = sweep(folder, workers, ray=ray)
    took = time.perf_counter() - started
    print("  ", dict(Counter(outcome.status for outcome in found)), Counter(o.note for o in found if o.note) or "")
    return took


def main() -> None:
    """Print candidates a second for each."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, help="with scene.param; by default five boxes and a ball")
    parser.add_argument("--vary", nargs="+", default=list(AXES), help="as of wsim sweep; needed with --program")
    parser.add_argument("--plan", type=Path, help="what the worlds are held to besides")
    parser.add_argument("--devices", nargs="+", default=["cpu"], help="each as `wsim sweep --device` takes it")
    parser.add_argument("--workers", nargs="+", type=int, default=[0])
    parser.add_argument("--count", type=int, default=64)
    parser.add_argument("--seconds", type=float, default=2.0, help="of a world")
    parser.add_argument("--worlds", type=int, default=0, help="at once, as `wsim sweep --worlds` takes it")
    parser.add_argument("--ray", default="", help="a cluster, as `wsim sweep --ray` takes it")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        scratch = Path(folder)
        program = given.program or scratch / "program.py"
        if given.program is None:
            program.write_text(PROGRAM.replace("SECONDS", f"{given.seconds:g}"), encoding="utf-8")
        plan = given.plan and given.plan.read_text(encoding="utf-8")
        axes, first = [Axis.parse(axis) for axis in given.vary], None
        spec = Spec(axes=axes, samples=given.count - 1, worlds=given.worlds)

        def takes(workers: int, **changes: Any) -> float:
            return seconds(scratch, program, plan, spec.model_copy(update=changes), workers, given.ray)

        for device in given.devices:
            takes(0, samples=3, device=device)
        for device, workers in itertools.product(given.devices, given.workers):
            took = takes(workers, device=device)
            first = first or took
            print(
                f"{device}, {workers or 'all'} workers: {given.count / took:.2f} candidates/s, {first / took:.2f} times"
            )


if __name__ == "__main__":
    main()
