"""What a sweep of many candidates costs beside its simulation, by phase: built, grouped, set up, simulated, judged.

    .venv/bin/python benchmarks/sweep_setup.py --count 64
    .venv/bin/python benchmarks/sweep_setup.py --count 1024 --device cuda:0 --json build/sweep_setup.json
    .venv/bin/python benchmarks/sweep_setup.py --program my_program.py --vary edge=0.1:0.3 --count 256

By default five boxes and a ball on the ground, whose sizes, masses, friction and speeds are drawn. A small batch of
the same program is set up first, so that kernels are warm: what is measured is what each further batch takes. Beside
the time that passes stands that of the CPU on all cores (what runs in sandboxes is not seen), which other jobs on
the machine change less, and what share of simulating it is. The digests are of all
trajectories and of all verdicts; two versions of wsim that do the same print the same. `--checks` tells which part of
judging takes how long, of one process's CPU.
"""

from __future__ import annotations

import argparse
import cProfile
import hashlib
import json
import os
import platform
import pstats
import sys
import tempfile
import time
from collections import Counter, defaultdict
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from wsim import helpers
from wsim.judge.checks.registry import physics_checks, run_checks
from wsim.judge.decide import work_out
from wsim.judge.evidence.evidence import Evidence
from wsim.judge.language.objective import ObjectiveCheck
from wsim.judge.worlds import CHUNK, take_verdicts, verdicts_of
from wsim.plan.schema import Plan
from wsim.plan.store import load
from wsim.recording.trajectories import Trajectories
from wsim.scene.usd_threads import ONE_THREAD
from wsim.sim import Simulation
from wsim.sim.collect import follow
from wsim.sweep import Axis, Spec
from wsim.sweep.batch import batches
from wsim.sweep.candidate import Candidate
from wsim.sweep.sampling import sample
from wsim.sweep.screen import rejected
from wsim.sweep.work import Shard, build, outcome

PROGRAM = """
def build(scene):
    scene.simulation(duration=SECONDS)
    scene.ground(friction=scene.param("ground", 0.5, low=0.0, high=1.0))
    edge = scene.param("edge", 0.2, low=0.1, high=0.3)
    density = scene.param("density", 600.0, low=100.0, high=2000.0)
    speed = scene.param("speed", 1.0, low=0.1, high=3.0)
    for k in range(3):
        scene.box(f"stacked_{k}", size=(edge, edge, edge), position=(0, 0, edge * (k + 0.5)), density=density)
    for k in range(2):
        scene.box(f"sliding_{k}", size=(edge, edge, 0.1), position=(2 + k, 0, 0.05), density=density,
                  velocity=(0, speed, 0), friction=0.4)
    scene.sphere("ball", radius=0.1, position=(-2, 0, scene.param("height", 1.0, low=0.2, high=3.0)),
                 density=density, restitution=scene.param("bounce", 0.3, low=0.0, high=0.8))
"""
AXES = ("ground=0.2:0.9", "edge=0.1:0.3", "density=200:1500", "speed=0.2:2", "height=0.3:2", "bounce=0:0.6")
# What is asked with --ask: about half of the candidates slide that far.
THINGS = {**{f"stacked_{k}": "box" for k in range(3)}, **{f"sliding_{k}": "box" for k in range(2)}, "ball": "sphere"}
ASKED = {"op": "gone_between", "object": "sliding_0", "axis": "y", "low": 0.0, "high": 0.1}
PLAN: dict[str, Any] = {
    "title": "slides",
    "prompt": "A box slides beside a stack and a ball.",
    "objects": [
        {"name": "ground", "role": "terrain", "state": "static",
         "construction": {"kind": "proxy", "primitive": "ground"}},
        *(
            {"name": name, "role": "rigid_body", "state": "dynamic", "material": {"name": "wood", "density": 600.0},
             "construction": {"kind": "proxy", "primitive": kind, "size": [0.2] * (3 if kind == "box" else 1)}}
            for name, kind in THINGS.items()
        ),
    ],
    "objectives": [{"kind": "formula", "object": "sliding_0", "formula": ASKED}],
    "simulation": {"duration": 1.0, "frame_rate": 60.0},
}  # fmt: skip
WARM = 2  # candidates of the batch that compiles the kernels
CLOCKS = ("time,", "CPU,")
SHOWN = 16  # checks that take longest
Value = TypeVar("Value")


def cpu_seconds() -> float:
    """Of this process and of all its children [s]."""
    alive = Path(f"/proc/self/task/{os.getpid()}/children").read_text(encoding="ascii").split()
    stats = [Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rsplit(")", 1)[1].split() for pid in alive]
    return sum(os.times()[:4]) + sum(int(stat[k]) for stat in stats for k in (11, 12)) / os.sysconf("SC_CLK_TCK")


def measured(args: argparse.Namespace, folder: Path) -> dict[str, Any]:
    """Every phase in seconds, that passed and of the CPU; and the digests."""
    plan = load(args.plan) if args.plan else Plan.model_validate(PLAN) if args.ask else None
    axes = [Axis.parse(text) for text in args.vary]
    points = sample(axes, "sobol", args.count, 0)
    candidates = tuple(Candidate(number=k, params=point) for k, point in enumerate(points))
    text = args.program.read_text() if args.program else f"SECONDS = {args.seconds}\n{PROGRAM}"
    (folder / "program.py").write_text(text)
    spec = Spec(axes=axes, device=args.device, worlds=max(2, args.together))
    seconds: dict[str, list[float]] = {}
    kept: list[int] = []
    counts: Counter[str] = Counter()
    by_check: defaultdict[str, float] = defaultdict(float)

    def timed(name: str, call: Callable[..., Value], *given: Any, **named: Any) -> Value:
        wall, busy = time.perf_counter(), cpu_seconds()
        value = call(*given, **named)
        taken = seconds.setdefault(name, [0.0, 0.0])
        taken[0] += time.perf_counter() - wall
        taken[1] += cpu_seconds() - busy
        return value

    def run(some: tuple[Candidate, ...], scratch: Path) -> tuple[str, str]:
        scratch.mkdir()
        made = timed("built", build, Shard(some, folder, spec, args.cores), scratch, plan)
        members = [
            (each, iteration, built.told) for each, (iteration, built) in zip(some, made, strict=True) if built.ok
        ]
        moved, said = hashlib.sha256(), hashlib.sha256()
        for batch in timed("grouped", batches, members, spec.together, args.cores):
            worlds = [member.world for member in batch]
            stages = [member.iteration.stage for member in batch]
            texts = [member.skeleton for member in batch]
            simulation = timed(
                "set up", Simulation, stages, device=args.device, worlds=worlds, skeletons=texts, processes=args.cores
            )
            tracks = timed("simulated", follow, simulation)
            early = timed("screened", rejected, tracks, plan)
            left = [w for w in range(tracks.count) if w not in early]
            counts["rejected by the screen"] += len(early)
            found = timed("read", tracks.read, left)
            assert found.penetration is not None  # what is collected has it
            arrays = (found.body_q, found.body_qd, found.contact_force, found.penetration)
            kept.append(sum(int(array.nbytes) for array in arrays))
            for array in arrays:
                moved.update(array.tobytes())
            own = [batch[w].candidate for w in left]
            outcomes = timed("judged", take_verdicts, found, plan, outcome, own, args.cores) if left else []
            verdicts = verdicts_of(found, plan, args.cores) if left else []
            if [outcome(*each) for each in zip(verdicts, own, strict=True)] != outcomes:
                raise SystemExit("the outcomes are not those of the verdicts")
            for w, verdict in [*early.items(), *zip(left, verdicts, strict=True)]:
                said.update(verdict.model_dump_json().encode())
                counts[outcome(verdict, batch[w].candidate).status] += 1
            if args.checks and left and len(some) > WARM:
                for name, busy in checks_of(found, plan).items():
                    by_check[name] += busy
        return moved.hexdigest()[:16], said.hexdigest()[:16]

    run(candidates[:WARM], folder / "warm")
    seconds.clear()
    kept.clear()
    counts.clear()
    profile = cProfile.Profile()
    if args.profile:
        profile.enable()
    digests = run(candidates, folder / "measured")
    if args.profile:
        profile.disable()
        profile.dump_stats(args.profile)
        pstats.Stats(profile).sort_stats("cumulative").print_stats(60)
    said: dict[str, Any] = {
        "trajectories": digests[0],
        "verdicts": digests[1],
        "bytes": sum(kept),
        "checks": dict(by_check),
    }
    said["counts"] = dict(counts)
    return {"seconds": seconds, **said}


def checks_of(worlds: Trajectories, plan: Plan | None) -> dict[str, float]:
    """How long each check takes for all worlds, and what is worked out at once for all [s of CPU]."""
    taken: defaultdict[str, float] = defaultdict(float)
    for first in range(0, worlds.world_count, CHUNK):
        began = time.process_time()
        copies = [Evidence(worlds.recording(k), plan) for k in range(first, min(first + CHUNK, worlds.world_count))]
        work_out(copies)
        taken["worked out at once"] += time.process_time() - began
        asked = [ObjectiveCheck(each) for each in (plan.objectives if plan else [])]
        for check in (*run_checks(), *physics_checks(), *asked):
            began = time.process_time()
            for evidence in copies:
                check.run(evidence)
            taken[check.name] += time.process_time() - began
    return taken


def show(found: dict[str, Any]) -> None:
    """Print the table."""
    # A GPU simulates while the CPU waits; on a CPU other jobs change the time that passes more than its own.
    clock, count = (0 if found["device"].startswith("cuda") else 1), found["count"]
    print(f"phase          seconds   ms a candidate   CPU ms a candidate   {CLOCKS[clock]} of simulating")
    simulating = found["seconds"]["simulated"][clock]
    for name, (wall, busy) in found["seconds"].items():
        each, own, share = 1e3 * wall / count, 1e3 * busy / count, (wall, busy)[clock] / simulating
        print(f"{name:12}  {wall:8.2f}  {each:15.2f}  {own:19.2f}  {share:18.1%}")
    print(f"arrays of bodies that were read: {found['bytes'] / count / 1e3:.1f} kB a candidate")
    for name, busy in sorted(found["checks"].items(), key=lambda each: -each[1])[:SHOWN]:
        print(f"  {name:24}  {1e3 * busy / count:8.3f} CPU ms a candidate")
    print(", ".join(f"{name} {number}" for name, number in found["counts"].items()))
    print(f"trajectories {found['trajectories']}, verdicts {found['verdicts']}")


def in_one_thread() -> None:
    """Begin anew with USD in one thread, as a sweep's worker begins: it reads how many when it is loaded."""
    if any(os.environ.get(name) != value for name, value in ONE_THREAD.items()):
        os.execve(sys.executable, [sys.executable, *sys.argv], {**os.environ, **ONE_THREAD})


def main() -> None:
    """Measure, print the table, write it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, help="with scene.param; by default five boxes and a ball")
    parser.add_argument("--vary", action="append", help="as of wsim sweep; needed with --program")
    parser.add_argument("--plan", type=Path, help="what the worlds are held to besides")
    parser.add_argument("--count", type=int, default=32, help="candidates")
    parser.add_argument("--seconds", type=float, default=1.0, help="simulated, of the default program [s]")
    parser.add_argument("--together", type=int, default=1024, help="worlds of a batch")
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--cores", type=int, default=len(os.sched_getaffinity(0)), help="that are kept busy")
    parser.add_argument("--profile", help="write a profile of the parent process here, and print its head")
    parser.add_argument("--ask", action="store_true", help="hold the default program to an objective")
    parser.add_argument("--checks", action="store_true", help="print what judging takes, check by check")
    parser.add_argument("--json", type=Path)
    args = parser.parse_args()
    args.vary = args.vary or list(AXES)
    in_one_thread()
    helpers.start(args.cores)  # as a sweep's worker does
    with tempfile.TemporaryDirectory(prefix="wsim-sweep-setup-") as folder:
        found = measured(args, Path(folder))
    found |= {"count": args.count, "device": args.device, "cores": args.cores}
    print(
        f"{args.count} candidates, {args.device}, {found['cores']} cores, {platform.processor() or platform.machine()}"
    )
    show(found)
    if args.json:
        args.json.parent.mkdir(parents=True, exist_ok=True)
        args.json.write_text(json.dumps(found, indent=2) + "\n")


if __name__ == "__main__":
    main()
