"""Floating blocks at several spacings on one device: speed, and how well the blocks float.

    python benchmarks/sph_scenes.py --device cuda:0 --spacing 0.03 0.0095 --seconds 4 --json sph_scenes.json

The scene is the demo's: three wooden blocks (density 600 kg/m^3) and a steel ball in a tank of 1.2 x 0.51 x 0.3 m of
water. The speed excludes compilation and pictures. The draft is the mean over the blocks and the last second, against
Archimedes (0.6 of the height), with the level from the conserved volume of the water.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

INNER = (1.2, 0.51, 0.45)
LEVEL = 0.3
BLOCK = (0.2, 0.2, 0.14)
BLOCK_DENSITY = 600.0
BALL_RADIUS = 0.06


def build(scene: Any, spacing: float) -> None:
    """The demo's world."""
    tank = scene.tank("tank", inner_size=INNER)
    water = scene.fluid("water", fills=tank, level=LEVEL, spacing=spacing)
    for i, x in enumerate((-0.404, -0.108, 0.404)):
        position = (x, 0.0, water.surface + 0.5 * BLOCK[2] + 0.005)
        scene.box(f"block_{i}", size=BLOCK, density=BLOCK_DENSITY, position=position)
    scene.sphere("ball", radius=BALL_RADIUS, density=7850.0, position=(0.148, 0.0, water.surface + 0.15 + BALL_RADIUS))


def measure(device: str, spacing: float, seconds: float) -> dict[str, Any]:
    """Run the scene at one spacing."""
    import warp as wp

    from wsim.scene import Scene
    from wsim.sim import Simulation

    with tempfile.TemporaryDirectory() as folder:
        scene = Scene()
        build(scene, spacing)
        scene.save(Path(folder) / "stage.usda")
        started = time.perf_counter()
        simulation = Simulation(Path(folder) / "stage.usda", device=device)
    compile_seconds = time.perf_counter() - started
    simulation.advance_frame()  # captures the graph
    wp.synchronize_device(simulation.device)
    frames = round(seconds * simulation.world.frame_rate)
    heights, running = [], 0.0
    for _ in range(frames - 1):
        started = time.perf_counter()
        simulation.advance_frame()
        wp.synchronize_device(simulation.device)
        running += time.perf_counter() - started
        heights.append(simulation.state.body_q.numpy()[simulation.built.bodies, 2])
    problems = simulation.problems()
    assert not problems, problems
    steps = (frames - 1) * simulation.substeps
    particles, walls = simulation.model.particle_count, simulation.fluid.boundary_count
    last = np.array(heights[-round(simulation.world.frame_rate) :])
    return {
        "device": simulation.device.name or device,
        "spacing": spacing,
        "particles": particles,
        "boundary": walls,
        "steps": steps,
        "dt_ms": 1e3 * simulation.dt,
        "seconds": running,
        "ms_per_step": 1e3 * running / steps,
        "mega_particle_steps_per_s": 1e-6 * steps * (particles + walls) / running,
        "compile_seconds": compile_seconds,
        "draft_error_percent_of_height": 100.0 * draft_error(simulation, last[:, :3].mean()),
        "ball_above_floor_mm": 1e3 * float(last[-1, 3] - BALL_RADIUS - simulation.world.containers[0].inner_center[2])
        + 1e3 * 0.5 * INNER[2],
    }


def draft_error(simulation: Any, center: float) -> float:
    """(Measured draft - Archimedes' draft) over the block's height."""
    floor = simulation.world.containers[0].inner_center[2] - 0.5 * INNER[2]
    water = float(simulation.model.particle_mass.numpy().sum()) / 1000.0
    expected = BLOCK_DENSITY / 1000.0 * BLOCK[2]
    displaced = 3.0 * BLOCK[0] * BLOCK[1] * expected + 4.0 / 3.0 * np.pi * BALL_RADIUS**3
    level = floor + (water + displaced) / (INNER[0] * INNER[1])
    return float((level - (center - 0.5 * BLOCK[2]) - expected) / BLOCK[2])


def main() -> None:
    """Print a row for each spacing."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device", default="auto")
    parser.add_argument("--spacing", type=float, nargs="+", default=[0.03])
    parser.add_argument("--seconds", type=float, default=4.0)
    parser.add_argument("--json", type=Path)
    args = parser.parse_args()
    rows = []
    print("spacing  particles  boundary   steps  ms/step  M particle-steps/s  draft error [% of height]", flush=True)
    for spacing in args.spacing:
        row = measure(args.device, spacing, args.seconds)
        rows.append(row)
        print(
            f"{spacing:7.4f}  {row['particles']:9d}  {row['boundary']:8d}  {row['steps']:6d}  {row['ms_per_step']:7.3f}"
            f"  {row['mega_particle_steps_per_s']:18.2f}  {row['draft_error_percent_of_height']:+8.2f}",
            flush=True,
        )
    print(f"device: {rows[0]['device']}")
    if args.json:
        args.json.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
