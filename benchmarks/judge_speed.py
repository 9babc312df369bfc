"""How long judging takes: one long recording of many bodies, and the many worlds of a sweep.

    .venv/bin/python benchmarks/judge_speed.py --json build/judge_speed.json
    .venv/bin/python benchmarks/judge_speed.py --simulate      # the sweep's worlds from the simulator, on its device

The recording is 30 s of 200 bodies that stand, stand on one another, slide to rest and fall, by closed-form mechanics;
it is written, read back and judged by a plan of 20 objectives besides the checks that always run. The pile is 100 boxes
and balls that fall into a heap, from the simulator: all of them are one problem of contacts. The sweep is 1,024 worlds
of 5 such bodies over 5 s, judged from arrays.
"""

from __future__ import annotations

import argparse
import cProfile
import json
import os
import platform
import pstats
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from wsim.judge import judge
from wsim.judge.worlds import judge_worlds, weigh
from wsim.plan.schema import Plan
from wsim.recording import Frame, RecordingWriter, read
from wsim.recording.trajectories import Trajectories
from wsim.scene.world import Body, Shape, Static, World

G, FRICTION, EDGE, RATE = 9.81, 0.5, 0.2, 30.0
BODIES, SECONDS, OBJECTIVES, LIMIT = 200, 30.0, 20, 2.0
WORLDS, WORLD_BODIES, WORLD_SECONDS, WORLDS_LIMIT = 1024, 5, 5.0, 5.0
PILE_BODIES, PILE_SECONDS, PILE_LIMIT = 100, 6.0, 10.0
KINDS = ("stands", "stands_on", "slides", "falls")


def body(index: int, place: np.ndarray) -> Body:
    """Body `index` at its start: a box, or a ball if it falls."""
    falls = KINDS[index % 4] == "falls"
    volume = np.pi * EDGE**3 / 6 if falls else EDGE**3
    share = 0.1 if falls else 1 / 6
    mass = 500.0 * volume
    name = f"/World/{KINDS[index % 4]}_{index}"
    shape = {"kind": "sphere", "size": (EDGE / 2,)} if falls else {"kind": "box", "size": (EDGE,) * 3}
    return Body(
        prim=name,
        mass=mass,
        volume=volume,
        inertia=tuple((np.eye(3) * share * mass * EDGE**2).reshape(-1).tolist()),
        position=tuple(place.tolist()),
        rotation=(0.0, 0.0, 0.0, 1.0),
        shapes=[Shape.model_validate({"prim": f"{name}/geometry", "friction": FRICTION, **shape})],
    )


def theory(count: int, seconds: float, seed: int = 0) -> Trajectories:
    """One world of `count` bodies, four of a kind in a row of their own."""
    random = np.random.default_rng(seed)
    t = np.arange(round(seconds * RATE) + 1) / RATE
    q, qd, force = (np.zeros((1, len(t), count, width), np.float32) for width in (7, 6, 3))
    q[..., 6] = 1.0
    bodies = []
    for i in range(count):
        x, y, z = np.full_like(t, 4.0 * (i // 4 % 8)), np.full_like(t, 1.5 * (i // 32)), np.full_like(t, EDGE / 2)
        carried = np.ones_like(t)
        kind = KINDS[i % 4]
        if kind == "stands_on":
            z += EDGE
        elif kind == "slides":
            speed = random.uniform(0.5, 1.0)
            moving = np.minimum(t, speed / (FRICTION * G))
            x += 1.0 + speed * moving - FRICTION * G * moving**2 / 2
            qd[0, :, i, 0] = speed - FRICTION * G * moving
            force[0, :, i, 0] = np.where(qd[0, :, i, 0] > 1e-6, -FRICTION, 0.0) * 500.0 * EDGE**3 * G
        elif kind == "falls":
            x += 3.0
            height = random.uniform(0.5, 2.0)
            z += np.maximum(height - G * t**2 / 2, 0.0)
            qd[0, :, i, 2] = np.where(z > EDGE / 2, -G * t, 0.0)
            carried = (z <= EDGE / 2).astype(float)
        q[0, :, i, :3] = np.stack([x, y, z], axis=1)
        bodies.append(body(i, q[0, 0, i, :3].astype(float)))
        force[0, :, i, 2] = bodies[-1].mass * G * carried
        bodies[-1] = bodies[-1].model_copy(update={"velocity": tuple(qd[0, 0, i, :3].astype(float).tolist())})
    ground = Static(prim="/World/ground", shapes=[Shape(prim="/World/ground/geometry", kind="plane", size=())])
    world = World(duration=seconds, frame_rate=RATE, bodies=bodies, statics=[ground])
    return Trajectories(world, t, q, qd, force, metadata={"time_step": 1.0 / 800.0})


def plan_of(world: World, objectives: int) -> Plan:
    """A plan of the world's objects, with so many objectives."""
    wood = {"name": "wood", "density": 500.0, "friction": FRICTION}
    names = [(b.prim.rsplit("/", 1)[-1], b.shapes[0], b.velocity) for b in world.bodies]
    things: list[dict[str, Any]] = [
        {
            "name": name,
            "role": "rigid_body",
            "state": "dynamic",
            "material": wood,
            "velocity": list(velocity),
            "construction": {"kind": "proxy", "primitive": shape.kind, "size": list(shape.size)},
        }
        for name, shape, velocity in names
    ]
    ground: dict[str, Any] = {"name": "ground", "role": "terrain", "state": "static"}
    ground["construction"] = {"kind": "proxy", "primitive": "ground"}
    standing = [name for name, _, _ in names if not name.startswith("stands_on")]
    asked = [
        {"kind": kind, "object": name, **({"ref": "ground"} if kind == "rests_on" else {})}
        for name in standing
        for kind in ("rests_on", "settles")
    ]
    return Plan.model_validate(
        {
            "title": "speed",
            "prompt": "Many bodies stand, slide and fall.",
            "objects": [ground, *things],
            "objectives": asked[:objectives],
            "simulation": {"duration": world.duration, "frame_rate": world.frame_rate},
        }
    )


def one_recording(profile: bool) -> dict[str, Any]:
    """Write, read and judge the long recording."""
    made = theory(BODIES, SECONDS)
    plan = plan_of(made.world, OBJECTIVES)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "recording.rrd"
        with RecordingWriter(path, made.world, made.metadata) as writer:
            for k, t in enumerate(made.time):
                writer.frame(float(t), Frame(made.body_q[0, k], made.body_qd[0, k], made.contact_force[0, k]))
        began = time.perf_counter()
        recording = read(path)
        reading = time.perf_counter() - began
    judge(theory(2, 1.0).recording(0))  # imports
    profiler = cProfile.Profile()
    began, busy = time.perf_counter(), time.process_time()
    if profile:
        profiler.enable()
    verdict = judge(recording, plan)
    profiler.disable()
    row = {
        "case": f"{SECONDS:g} s of {BODIES} bodies",
        "seconds": time.perf_counter() - began,
        "processor_seconds": time.process_time() - busy,
        "reading_seconds": reading,
        "limit": LIMIT,
        "checks": len({(f.check, f.objective) for f in verdict.findings}),
        "findings": len(verdict.findings),
        "status": verdict.status,
        "failures": [f.message for f in verdict.failures],
    }
    if profile:
        pstats.Stats(profiler).sort_stats("tottime").print_stats(25)
    return row


def pile() -> dict[str, Any]:
    """Judge a heap of bodies that fell on each other, by the checks that always run."""
    from wsim.scene import Scene
    from wsim.sim import Simulation
    from wsim.sim.collect import collect

    random, scene = np.random.default_rng(0), Scene()
    scene.simulation(duration=PILE_SECONDS, frame_rate=RATE)
    scene.ground(friction=FRICTION)
    for i in range(PILE_BODIES):
        x, y = (1.25 * EDGE * (i % 16 // n % 4) + random.uniform(-0.02, 0.02) for n in (1, 4))
        options = {"density": 500.0, "friction": FRICTION, "position": (x, y, 0.15 + 1.25 * EDGE * (i // 16))}
        if i % 4 == 3:
            scene.sphere(f"ball_{i}", radius=EDGE / 2, **options)
        else:
            scene.box(f"box_{i}", size=(EDGE,) * 3, **options)
    with tempfile.TemporaryDirectory() as folder:
        heap = collect(Simulation(scene.save(Path(folder) / "stage.usda"), device="cpu")).recording(0)
    began, busy = time.perf_counter(), time.process_time()
    verdict = judge(heap)
    return {
        "case": f"a pile of {PILE_BODIES} bodies over {PILE_SECONDS:g} s",
        "seconds": time.perf_counter() - began,
        "processor_seconds": time.process_time() - busy,
        "limit": PILE_LIMIT,
        "frames": len(heap.time),
        "status": verdict.status,
        "failures": [f.message for f in verdict.failures],
    }


def many_worlds(count: int, processes: int | None, simulate: bool, device: str) -> list[dict[str, Any]]:
    """Judge the worlds of a sweep in full, and weigh them by one formula."""
    from wsim.judge.language import parse

    worlds, seconds = simulated(count, device) if simulate else (copies(count), None)
    plan = plan_of(worlds.world, 3)
    judge(worlds.recording(0), plan)  # imports
    began, busy = time.perf_counter(), _processor_seconds()
    found = judge_worlds(worlds, plan, processes)
    judging, busy = time.perf_counter() - began, _processor_seconds() - busy
    formula = parse("finally (rests_on(stands_0, ground)) and eventually (speed_between(falls_3, 1 m/s, 10 m/s))")
    began = time.perf_counter()
    outcome = weigh(worlds, formula)
    weighing = time.perf_counter() - began
    name = f"{count} worlds of {WORLD_BODIES} bodies over {WORLD_SECONDS:g} s"
    return [
        {
            "case": f"{name}, in full",
            "seconds": judging,
            "processor_seconds": busy,
            "simulating_seconds": seconds,
            "processes": processes or len(os.sched_getaffinity(0)),
            "limit": WORLDS_LIMIT,
            "accepted": int(found.accepted.sum()),
            "findings": len(found.margin),
        },
        {
            "case": f"{name}, one formula",
            "seconds": weighing,
            "limit": WORLDS_LIMIT,
            "accepted": int(outcome.satisfied.sum()),
        },
    ]


def _processor_seconds() -> float:
    """Of this process, and of its children that have ended."""
    used = os.times()
    return used.user + used.system + used.children_user + used.children_system


def copies(count: int) -> Trajectories:
    """The worlds of different seeds, by theory."""
    alike = [theory(WORLD_BODIES, WORLD_SECONDS, seed) for seed in range(count)]
    arrays = [np.concatenate([getattr(w, name) for w in alike]) for name in ("body_q", "body_qd", "contact_force")]
    return Trajectories(alike[0].world, alike[0].time, *arrays, metadata=alike[0].metadata)


def simulated(count: int, device: str) -> tuple[Trajectories, float]:
    """The same bodies in the simulator, each world set up by another hand; and how long they took."""
    from wsim.scene import Scene
    from wsim.sim import Simulation
    from wsim.sim.collect import collect

    scene = Scene()
    scene.simulation(duration=WORLD_SECONDS, frame_rate=RATE)
    scene.ground(friction=FRICTION)
    for made in theory(WORLD_BODIES, WORLD_SECONDS).world.bodies:
        options = {
            "mass": made.mass,
            "position": made.position,
            "velocity": made.velocity,
            "friction": FRICTION,
            "color": made.shapes[0].color,
        }
        name = made.prim.rsplit("/", 1)[-1]
        if made.shapes[0].kind == "box":
            scene.box(name, size=made.shapes[0].size, **options)
        else:
            scene.sphere(name, radius=made.shapes[0].size[0], **options)
    with tempfile.TemporaryDirectory() as folder:
        stage = scene.save(Path(folder) / "stage.usda")
        simulation = Simulation(stage, device=device, world_count=count, seeds=range(count))
        began = time.perf_counter()
        return collect(simulation), time.perf_counter() - began


def machine() -> str:
    """The processor's name and how many cores this process may use."""
    names = [line.split(":")[1].strip() for line in _cpuinfo() if line.startswith("model name")]
    return f"{names[0] if names else platform.machine()}, {len(os.sched_getaffinity(0))} cores"


def _cpuinfo() -> list[str]:
    path = Path("/proc/cpuinfo")
    return path.read_text().splitlines() if path.is_file() else []


def main() -> None:
    """Measure, print a table and write JSON."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="where the figures go")
    parser.add_argument("--worlds", type=int, default=WORLDS)
    parser.add_argument("--processes", type=int, help="for the sweep; one for each core by default")
    parser.add_argument("--simulate", action="store_true", help="simulate the sweep's worlds first")
    parser.add_argument("--device", default="auto")
    parser.add_argument("--profile", action="store_true", help="print where the time of the long recording goes")
    given = parser.parse_args()
    rows = [
        one_recording(given.profile),
        pile(),
        *many_worlds(given.worlds, given.processes, given.simulate, given.device),
    ]
    print(f"machine: {machine()}; Python {platform.python_version()}, NumPy {np.__version__}\n")
    print(f"{'case':58} {'time':>9} {'limit':>7}")
    for row in rows:
        missed = "" if row["seconds"] <= row["limit"] else "MISSED"
        print(f"{row['case']:58} {row['seconds']:7.2f} s {row['limit']:5g} s  {missed}")
        print("    " + ", ".join(f"{k} {_shown(v)}" for k, v in row.items() if k not in ("case", "seconds", "limit")))
    if given.json:
        given.json.parent.mkdir(parents=True, exist_ok=True)
        given.json.write_text(json.dumps({"machine": machine(), "rows": rows}, indent=2) + "\n", encoding="utf-8")


def _shown(value: Any) -> str:
    return f"{value:.3g}" if isinstance(value, float) else str(value)


if __name__ == "__main__":
    main()
