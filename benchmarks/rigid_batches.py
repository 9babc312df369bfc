"""What a step of batched worlds costs: five boxes in a stack, at rest or struck by balls of 2 to 6 m/s.

.venv/bin/python benchmarks/rigid_batches.py --device cuda:0 [--struck] [--worlds 1 64 1024 8192]
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

import newton
import numpy as np
import warp as wp

from wsim.scene import Scene
from wsim.sim import Simulation

SECONDS = 0.4
SPEED = 3.0  # [m/s], as stated; each world's own is drawn


def stack(scene: Scene, struck: bool) -> None:
    """Five boxes, and a ball that flies at the middle one."""
    scene.simulation(duration=1.0)
    scene.ground()
    for k in range(5):
        scene.box(f"box{k}", size=(0.2, 0.2, 0.2), density=600, position=(0, 0, 0.1 + 0.2 * k))
    if struck:
        scene.sphere(
            "ball", radius=0.1, density=2000, position=(-0.5, 0.03, 0.55), velocity=(SPEED, 0, 0), restitution=0.3
        )


def start(simulation: Simulation, places: np.ndarray, speeds: np.ndarray) -> None:
    """Go back to the start, each world's ball at a speed of its own."""
    state, own = simulation.state, speeds.copy().reshape(simulation.model.world_count, -1)
    moving = np.flatnonzero(own[0] == SPEED)
    own[:, moving] = np.random.default_rng(1).uniform(2.0, 6.0, (len(own), len(moving)))
    state.joint_q.assign(places)
    state.joint_qd.assign(own.ravel())
    newton.eval_fk(simulation.model, state.joint_q, state.joint_qd, state)
    simulation.rigid.reset(state)
    wp.synchronize()


def milliseconds(simulation: Simulation) -> float:
    """Wall time of a step, over `SECONDS` of frames after a first that is not counted."""
    places, speeds = simulation.state.joint_q.numpy().copy(), simulation.state.joint_qd.numpy().copy()
    start(simulation, places, speeds)
    simulation.advance_frame()
    start(simulation, places, speeds)
    frames = round(SECONDS / (simulation.dt * simulation.substeps))
    began = time.perf_counter()
    for _ in range(frames):
        simulation.advance_frame()
    wp.synchronize()
    return 1e3 * (time.perf_counter() - began) / (frames * simulation.substeps)


def main() -> None:
    """Print a line for each number of worlds."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--struck", action="store_true")
    parser.add_argument("--worlds", type=int, nargs="+", default=[1, 64, 1024, 8192])
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        scene = Scene()
        stack(scene, args.struck)
        stage = scene.save(Path(folder) / "stage.usda")
        for worlds in args.worlds:
            simulation = Simulation(stage, args.device, worlds)
            cost = milliseconds(simulation)
            print(f"{worlds} worlds: {cost:.3f} ms a step, {worlds / cost:.0f} worlds a ms; {simulation.problems()}")


if __name__ == "__main__":
    main()
