"""How fast `SolverSPH` steps, and what memory it takes.

    python benchmarks/sph_throughput.py --device cuda:0 --parts anchor curve batch memory --json throughput.json
    WSIM_THREADS=1 python benchmarks/sph_throughput.py --device cpu --parts core

- anchor: a closed tank of 3.22 x 1 x 1 m, a column of 1.228 x 1 x 0.55 m at one end, a box in its way; about 270
  neighbours (h/dp = 2). DualSPHysics 5.4 takes 3.00 s on an H100 80GB for 574 steps of 1,116,258 particles, 652,212 of
  them fluid, with two force evaluations a step: 427 M particle-evaluations/s, 250 M of fluid; 436 M at 4,360,716
  particles. An evaluation here is a whole step: continuity, walls, forces, and the sort.
- curve: the same tank with 74 neighbours (h/dp = 1.3), from 10^5 to 10^7 particles.
- fluid: a periodic block of fluid alone with 74 neighbours.
- batch: 1,024 worlds of 4,000 particles with a floating block each, rigid solver and fluid in one CUDA graph, against
  one pool with as many particles and one block.
- memory: bytes a particle, and 100 million particles.
- core: one core of a CPU at 74 neighbours.

Figures are of whole steps, by the wall clock around replays of a CUDA graph, after warming up: the first 575 steps of
the flow on a GPU, as the anchor's are, so that particles leave their lattice meanwhile (which makes steps 12 % dearer
at the end than at the start); 5 with 100 million particles, 30 on a CPU. Nothing is random. Neighbours are counted at
the start, not taken from the ratio.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT)] if str(ROOT) not in sys.path else []

import newton  # noqa: E402
import numpy as np  # noqa: E402
import warp as wp  # noqa: E402

from benchmarks.sph_cases.bodies import make_rigid  # noqa: E402
from benchmarks.sph_cases.bulk import set_particles  # noqa: E402
from benchmarks.sph_cases.water import make_builder  # noqa: E402
from wsim.geometry.filled import box_lattice  # noqa: E402
from wsim.solvers.shapes import OpenBox  # noqa: E402
from wsim.solvers.solver_sph import SolverSPH  # noqa: E402

G, RHO = 9.81, 1000.0
DUALSPHYSICS = {0.01: 213e6 * 2, 0.0063: 218e6 * 2}  # particle-evaluations/s on an H100 80GB
DUALSPHYSICS_FLUID = {0.01: 652_212 * 574 / 3.00 * 2}  # of fluid particles
STEPS = 575  # on a GPU
Row = dict[str, Any]


def tank(device: str, spacing: float, ratio: float) -> tuple[SolverSPH, Any]:
    """The anchor's closed tank with its column and its box."""
    size, column = (3.22, 1.0, 1.0), (1.228, 1.0, 0.55)
    builder = make_builder((0.0, 0.0, -G))
    builder.add_particle((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 1.0)
    place = wp.transform(wp.vec3(-0.9, 0.0, 0.08), wp.quat_identity())
    builder.add_shape_box(-1, xform=place, hx=0.08, hy=0.2, hz=0.08)
    model = builder.finalize(device=device)
    position = box_lattice(np.array(column), spacing).position
    position += np.array([0.5 * (size[0] - column[0]), 0.0, 0.5 * column[2]])
    state = set_particles(model, position, RHO * spacing**3, RHO * G * (column[2] - position[:, 2]))
    sound = 10.0 * math.sqrt(2.0 * G * column[2])
    config = SolverSPH.Config(spacing=spacing, smoothing_ratio=ratio, speed_of_sound=sound)
    return SolverSPH(model, config, (OpenBox((0.0, 0.0, 0.5), size, closed=True),)), state


def block(device: str, count: int) -> tuple[SolverSPH, Any]:
    """A periodic cube of fluid with about `count` particles, stirred."""
    side = max(9, round(count ** (1.0 / 3.0)))
    spacing = 1.0 / side
    builder = make_builder((0.0, 0.0, 0.0))
    builder.add_particle((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 1.0)
    model = builder.finalize(device=device)
    position = box_lattice(np.ones(3), spacing).position.astype(np.float32)
    state = set_particles(model, position, RHO * spacing**3)
    ends = ((-0.5, 0.5),) * 3
    return SolverSPH(model, SolverSPH.Config(spacing=spacing, speed_of_sound=10.0, periodic=ends), ()), state


def pools(device: str, worlds: int, count: int) -> tuple[SolverSPH, Any, Any]:
    """`worlds` pools of about `count` particles in all, with a floating block each."""
    each = count // worlds
    side = round((each / 0.75) ** (1.0 / 3.0))
    depth, spacing = round(each / side**2), 0.4 / side
    size = (0.4, 0.4, 0.4 + 4 * spacing)
    level = depth * spacing
    single = make_builder((0.0, 0.0, -G))
    body = single.add_body(xform=wp.transform(wp.vec3(0.0, 0.0, level), wp.quat_identity()))
    wood = newton.ModelBuilder.ShapeConfig(density=0.5 * RHO)
    single.add_shape_box(body, hx=0.08, hy=0.08, hz=0.05, cfg=wood)
    builder = make_builder((0.0, 0.0, -G))
    builder.replicate(single, worlds)
    builder.add_particle((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 1.0)
    model = builder.finalize(device=device)
    cells = box_lattice(np.array([0.4, 0.4, level]), spacing).position + np.array([0.0, 0.0, 0.5 * level])
    inside = (np.abs(cells - np.array([0.0, 0.0, level])) < np.array([0.08, 0.08, 0.05]) + 0.4 * spacing).all(axis=1)
    cells = cells[~inside]
    world = np.repeat(np.arange(worlds), len(cells))
    pressure = np.tile(RHO * G * (level - cells[:, 2]), worlds)
    state = set_particles(model, np.tile(cells, (worlds, 1)), RHO * spacing**3, pressure, world)
    sound = 10.0 * math.sqrt(G * level)
    config = SolverSPH.Config(spacing=spacing, speed_of_sound=sound)
    return SolverSPH(model, config, (OpenBox((0.0, 0.0, 0.5 * size[2]), size),)), state, make_rigid(model)


def seconds_a_step(solver: SolverSPH, step: Callable[[], None], steps: int) -> float:
    """Mean wall time of a step [s]; on CUDA of a graph of five steps, replayed."""
    device = solver.model.device
    step()
    step()
    if not device.is_cuda:
        started = time.perf_counter()
        for _ in range(steps):
            step()
        return (time.perf_counter() - started) / steps
    with wp.ScopedCapture(device) as capture:
        for _ in range(5):
            step()
    wp.capture_launch(capture.graph)
    wp.synchronize_device(device)
    started = time.perf_counter()
    for _ in range(steps // 5):
        wp.capture_launch(capture.graph)
    wp.synchronize_device(device)
    return (time.perf_counter() - started) / (steps // 5 * 5)


def neighbors(solver: SolverSPH, state: Any) -> float:
    """Mean number of neighbours of the fluid within the support, counted at a sample of particles on the host."""
    from scipy.spatial import cKDTree

    search = solver.search
    places = (state.particle_q, solver.wall_position, solver.bodies.position)
    kinds = (search.fluid, search.walls, search.bodies)
    position = np.concatenate([x.numpy()[kind.world.numpy() == 0] for x, kind in zip(places, kinds, strict=True)])
    fluid = int((search.fluid.world.numpy() == 0).sum())
    period = [ends[1] - ends[0] if ends else 0.0 for ends in solver.config.periodic]
    low = [ends[0] if ends else 0.0 for ends in solver.config.periodic]
    points = np.where(np.array(period) > 0.0, (position - low) % np.where(np.array(period) > 0, period, 1.0), position)
    tree = cKDTree(points, boxsize=period if all(period) else None)
    sample = points[: fluid : max(1, fluid // 2000)]
    return float(np.mean(tree.query_ball_point(sample, solver.config.support, return_length=True)) - 1.0)


def measure(name: str, solver: SolverSPH, state: Any, steps: int, rigid: Any = None) -> Row:
    """Time whole steps, and describe what was stepped."""
    dt = solver.config.max_time_step
    control = solver.model.control()

    def step() -> None:
        if rigid is not None:
            state.body_f.zero_()
        solver.step(state, state, None, None, dt)
        if rigid is not None:
            rigid.step(state, state, control, None, dt)

    around = neighbors(solver, state) if solver.count < 3e7 else math.nan
    per_step = seconds_a_step(solver, step, steps)
    solver.check(state)
    row = {
        "case": name,
        "device": solver.model.device.name or str(solver.model.device),
        "particles": solver.count,
        "fluid": solver.fluid_count,
        "neighbors": around,
        "ms_per_step": 1e3 * per_step,
        "mega_particle_steps_per_s": 1e-6 * solver.count / per_step,
    }
    print(
        f"{name:28s} {solver.count:11,d} {solver.fluid_count:11,d} {around:6.0f} {1e3 * per_step:10.3f} "
        f"{row['mega_particle_steps_per_s']:10.2f}",
        flush=True,
    )
    return row


def memory(device: str, count: int, steps: int) -> Row:
    """Device memory that the solver and the arrays of a simulation take, per particle."""
    before = wp.get_mempool_used_mem_current(device)
    solver, state = block(device, count)
    row = measure("memory", solver, state, steps)
    row["bytes_per_particle"] = (wp.get_mempool_used_mem_current(device) - before) / solver.count
    row["peak_bytes_per_particle"] = (wp.get_mempool_used_mem_high(device) - before) / solver.count
    print(f"{'':28s} {row['bytes_per_particle']:.0f} B a particle, {row['peak_bytes_per_particle']:.0f} at the peak")
    return row


def main() -> None:
    """Print a row for each measurement."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device", default="auto")
    parser.add_argument("--parts", nargs="+", default=[])
    parser.add_argument("--json", type=Path)
    args = parser.parse_args()
    device = args.device if args.device != "auto" else ("cuda:0" if wp.is_cuda_available() else "cpu")
    parts = args.parts or (["anchor", "curve", "fluid", "batch", "memory"] if "cuda" in device else ["core"])
    rows: list[Row] = []
    print(
        f"{'case':28s} {'particles':>11s} {'fluid':>11s} {'neigh.':>6s} {'ms/step':>10s} {'M part./s':>10s}", flush=True
    )
    if "anchor" in parts:
        for spacing, theirs in DUALSPHYSICS.items():
            row = measure(f"anchor dp = {spacing}", *tank(device, spacing, 2.0), STEPS)
            row["times_dualsphysics_on_h100"] = 1e6 * row["mega_particle_steps_per_s"] / theirs
            print(
                f"{'':28s} {row['times_dualsphysics_on_h100']:.2f} x DualSPHysics' {1e-6 * theirs:.0f} M evaluations/s"
            )
            if spacing in DUALSPHYSICS_FLUID:
                fluid = 1e3 * row["fluid"] / row["ms_per_step"] / DUALSPHYSICS_FLUID[spacing]
                row["times_dualsphysics_on_h100_fluid"] = fluid
                print(f"{'':28s} {fluid:.2f} x counting fluid alone")
            rows.append(row)
    if "curve" in parts:
        for spacing in (0.0225, 0.015, 0.01, 0.0067, 0.0043):
            rows.append(measure(f"tank dp = {spacing}", *tank(device, spacing, 1.3), STEPS))
    if "fluid" in parts:
        for count in (100_000, 1_000_000, 10_000_000):
            rows.append(measure("periodic fluid", *block(device, count), STEPS))
    if "batch" in parts:
        for worlds in (1, 1024):
            solver, state, rigid = pools(device, worlds, 1024 * 4000)
            rows.append(measure(f"{worlds} pools with blocks", solver, state, STEPS, rigid))
    if "memory" in parts:
        rows.append(memory(device, 100_000_000, steps=5))
    if "core" in parts:
        rows.append(measure("tank dp = 0.03", *tank(device, 0.03, 1.3), steps=30))
        rows.append(measure("periodic fluid", *block(device, 30_000), steps=30))
    if args.json:
        args.json.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
