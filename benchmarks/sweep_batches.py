"""How many candidates a second one device simulates and judges, over how many of them are worlds of one batch.

    .venv/bin/python benchmarks/sweep_batches.py --device cuda:0 --sizes 1 16 64 256 1024
    .venv/bin/python benchmarks/sweep_batches.py --device cpu --sizes 1

A block of wood, whose density is drawn, is let go in a tank of some 4,000 particles of water. Stages are built
beforehand. Of each size one batch is set up, simulated and judged, after one of a tenth of its time by which its
kernels are compiled. A size of 1 is one candidate after another, of which `--alone` are timed. What stands last in a
row is how many a second come out, set-up and judging among them, and how many times as many that are as in the first.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT)] if str(ROOT) not in sys.path else []

from benchmarks.sweep_setup import in_one_thread  # noqa: E402
from wsim.forks import shared_out  # noqa: E402
from wsim.judge.worlds import judge_worlds  # noqa: E402
from wsim.scene.describe import describe  # noqa: E402
from wsim.sim import Simulation  # noqa: E402
from wsim.sim.collect import follow  # noqa: E402
from wsim.sweep import Axis, Spec  # noqa: E402
from wsim.sweep.candidate import Candidate  # noqa: E402
from wsim.sweep.sampling import sample  # noqa: E402
from wsim.sweep.work import Shard, build  # noqa: E402

PROGRAM = """
def build(scene):
    scene.simulation(duration=SECONDS, frame_rate=20.0)
    scene.ground()
    tank = scene.tank("tank", inner_size=(0.4, 0.4, 0.4), wall=0.02)
    scene.fluid("water", fills=tank, level=0.16, spacing=0.0185)
    density = scene.param("density", 400.0, low=250.0, high=700.0)
    scene.box("block", size=(0.12, 0.12, 0.12), position=(0.0, 0.0, 0.26), density=density)
"""


@dataclass
class Row:
    """What a batch took [s]."""

    size: int
    count: int  # candidates that were timed
    particles: int
    steps: int
    set_up: float = 0.0
    simulated: float = 0.0
    judged: float = 0.0

    @property
    def rate(self) -> float:
        """Candidates a second."""
        return self.count / (self.set_up + self.simulated + self.judged)


def stages_of(count: int, seconds: float, cores: int, folder: Path) -> list[Path]:
    """The stages of so many candidates."""
    folder.mkdir()
    axes = [Axis.parse("density=250:700")]
    (folder / "program.py").write_text(f"SECONDS = {seconds}\n{PROGRAM}")
    some = tuple(Candidate(number=k, params=point) for k, point in enumerate(sample(axes, "sobol", count, 0)))
    made = build(Shard(some, folder, Spec(axes=axes), cores), folder, None)
    return [iteration.stage for iteration, _ in made]


def timed(stages: list[Path], size: int, device: str, cores: int) -> Row:
    """Set up, simulate and judge some stages, in batches of a size."""
    row = Row(size, len(stages), 0, 0)
    for first in range(0, len(stages), size):
        some, began = stages[first : first + size], time.perf_counter()
        worlds = list(shared_out(describe, some, cores))
        simulation = Simulation(some, device=device, worlds=worlds, processes=cores)
        ready = time.perf_counter()
        tracks = follow(simulation)
        found = tracks.read(list(range(tracks.count)))
        done = time.perf_counter()
        judge_worlds(found, None, cores)
        row.set_up += ready - began
        row.simulated += done - ready
        row.judged += time.perf_counter() - done
        row.particles = simulation.model.particle_count // len(some)
        row.steps = round(float(found.time[-1]) / simulation.dt)
    return row


def main() -> None:
    """Measure and print a row for each size."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--sizes", nargs="+", type=int, default=[1])
    parser.add_argument("--seconds", type=float, default=1.0, help="of a world")
    parser.add_argument("--alone", type=int, default=3, help="candidates that are timed one after another")
    parser.add_argument("--cores", type=int, default=len(os.sched_getaffinity(0)), help="that are kept busy")
    args = parser.parse_args()
    in_one_thread()
    print("worlds   particles   steps   set up [s]   simulated [s]   judged [s]   candidates a second   of the first")
    base = 0.0
    with tempfile.TemporaryDirectory(prefix="wsim-sweep-batches-") as name:
        for size in args.sizes:
            count = args.alone if size == 1 else size
            timed(stages_of(size, args.seconds / 10, args.cores, Path(name) / f"warm_{size}"), size, args.device, 1)
            stages = stages_of(count, args.seconds, args.cores, Path(name) / f"timed_{size}")
            row = timed(stages, size, args.device, args.cores)
            base = base or row.rate
            print(f"{size:6}   {row.particles:9}   {row.steps:5}   {row.set_up:10.2f}   {row.simulated:13.2f}   "
                  f"{row.judged:10.2f}   {row.rate:19.3f}   {row.rate / base:12.1f}", flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
