"""What a step of batched worlds costs in each of which a Go2 walks by its policy, and what the policy does of it.

    .venv/bin/wsim assets pull go2
    .venv/bin/python benchmarks/robot_batches.py --device cuda:0 --worlds 1 64 1024 4096
    .venv/bin/python benchmarks/robot_batches.py --device cpu --worlds 1 8 --warm 0.1 --seconds 0.1

Of each number of worlds the Go2s walk for `--warm` seconds that are not counted, then for `--seconds` that are, with
the policy, and after that without it, by the targets that it set last. What stands last is what one turn of the policy
takes by NumPy on the host and by kernels on the device, in the mean of 20.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import warp as wp

from wsim.scene import Scene
from wsim.sim import Simulation
from wsim.sim.layers import layers_of
from wsim.sim.policies import PolicyController, PolicyOnDevice
from wsim.sim.turns import Turns
from wsim.sim.walked import walked

TURNS = 20


def walk(scene: Scene) -> None:
    """A Go2 that walks ahead."""
    scene.simulation(duration=10.0, frame_rate=50.0)
    scene.ground()
    scene.policy("walk", scene.robot("go2"), "go2_walk", command=(0.5, 0.0, 0.0))


def timed(work: Callable[[], object], count: int) -> float:
    """Wall time of each of some rounds of work [s]."""
    wp.synchronize()
    began = time.perf_counter()
    for _ in range(count):
        work()
    wp.synchronize()
    return (time.perf_counter() - began) / count


def row(stage: Path, device: str, worlds: int, warm: float, seconds: float) -> str:
    """What so many worlds take."""
    began = time.perf_counter()
    simulation = Simulation(stage, device, worlds)
    set_up = time.perf_counter() - began
    frame = simulation.dt * simulation.substeps
    for _ in range(round(warm / frame)):
        simulation.advance_frame()
    rates = []
    for turns in (simulation._turns, Turns(simulation.dt)):
        simulation._turns = turns
        cost = timed(simulation.advance_frame, round(seconds / frame))
        rates.append(worlds * simulation.substeps / cost)
    robot = walked(simulation.model, simulation.built.worlds, simulation.built.bodies, 0)
    layers = layers_of(robot.network, robot.spec.size)
    assert layers is not None
    turn = []
    for policy in (PolicyController(robot), PolicyOnDevice(robot, layers, simulation.device)):
        policy(0.0, simulation)  # compiles, and captures its graph
        turn.append(timed(lambda policy=policy: policy(0.0, simulation), TURNS))  # type: ignore[misc]
    return (
        f"{worlds:6}   {set_up:10.1f}   {rates[0]:19,.0f}   {rates[1]:14,.0f}   {rates[0] * simulation.dt:16.1f}   "
        f"{1e3 * turn[0]:9.3f}   {1e3 * turn[1]:12.3f}   {simulation.problems()}"
    )


def main() -> None:
    """Print a line for each number of worlds."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--worlds", type=int, nargs="+", default=[1, 64, 1024])
    parser.add_argument("--warm", type=float, default=0.5, help="of each world that are not timed")
    parser.add_argument("--seconds", type=float, default=1.0, help="of each world that are timed")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="wsim-robot-batches-") as folder:
        scene = Scene()
        walk(scene)
        stage = scene.save(Path(folder) / "stage.usda")
        print(
            "worlds   set up [s]   world-steps a second   without policy   s a second, all   host [ms]   kernels [ms]"
        )
        for worlds in args.worlds:
            print(row(stage, args.device, worlds, args.warm, args.seconds), flush=True)


if __name__ == "__main__":
    main()
