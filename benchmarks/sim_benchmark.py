"""SimBenchmark's four tests of loose bodies, with its measures: wsim beside the engines that its authors ran.

    python benchmarks/sim_benchmark.py --device cpu --write
    python benchmarks/sim_benchmark.py --device cpu --tests rolling bouncing

The tests are those of D. Kang and J. Hwangbo, SimBenchmark, 2018 (github.com/leggedrobotics/SimBenchmark): the worlds
are built anew from its parameters. The others' figures are its own, from `data/*/*.csv` of commit 3fd1764: the rows
with a time step of 1 ms, no error reduction, and in the rolling test the push askew to the axes and default solver
settings. `--write` puts the table into docs/rigid.md.
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from wsim.scene import Scene
from wsim.sim import Simulation
from wsim.sim.devices import known_device

Array = np.ndarray
G, STEP = 9.81, 1e-3
DOCUMENT = Path(__file__).resolve().parents[1] / "docs/rigid.md"
MARKS = re.compile(r"(?<=<!-- simbenchmark:begin -->\n).*?(?=<!-- simbenchmark:end -->)", re.DOTALL)
UNITS = {"rolling": "m²/s²", "bouncing": "J²", "666": "m²", "elastic666": "J²"}
PUBLISHED = {  # mean squared error: rolling, bouncing, 666, elastic 666; None where the authors give none
    "RaiSim": (4.14e-7, 0.0186, 1.35e-4, 8.37),
    "Bullet (multibody)": (5.71e-9, 7.52e4, 0.382, 4.15e4),
    "ODE (quick)": (3.14, 185.0, 1.57e-4, 112.0),
    "DART (Dantzig)": (3.14, 7.23e4, 2.82e-4, 3.47e5),
    "MuJoCo 1.5 (Newton, Euler)": (6.93e-3, None, 0.0950, None),
}


def steps(build: Callable[[Scene], None], device: str, seconds: float, force: Array | None = None) -> Iterator[
    tuple[float, Array, Array]
]:  # fmt: skip
    """The time, positions and velocities of all bodies, from the start on, step by step of 1 ms.

    Args:
        build: Fills a scene.
        device: Where it runs.
        seconds: To simulate.
        force: On the first body [N].

    Raises:
        RuntimeError: If the run has problems.
    """
    scene = Scene()
    scene.simulation(frame_rate=1.0 / STEP, time_step=STEP)
    build(scene)

    def push(_: float, simulation: Simulation) -> None:
        wrench = simulation.control_force.numpy()
        wrench[simulation.built.bodies[0], :3] = force
        simulation.control_force.assign(wrench)

    with tempfile.TemporaryDirectory() as folder:
        stage = scene.save(Path(folder) / "stage.usda")
        simulation = Simulation(stage, device, controller=push if force is not None else None)
    bodies = simulation.built.bodies
    for k in range(round(seconds / STEP)):
        poses, twists = (a.numpy()[bodies].astype(float) for a in (simulation.state.body_q, simulation.state.body_qd))
        yield k * STEP, poses[:, :3], twists[:, :3]
        simulation.advance_frame()
    if problems := simulation.problems():
        raise RuntimeError("; ".join(problems))


def rolling(device: str) -> float:
    """A box with 25 balls on it is pushed for 4 s: squared errors of the speeds of the box and of a ball [m²/s²]."""
    push, ball, box, count = 150.0, 1.0, 10.0, 25
    rubs = 0.4 * (box + count * ball) * G
    between = (push - rubs) / box / (3.5 / ball + count / box)  # on each ball; it rolls on the box
    along = np.array([0.5, np.sqrt(0.75), 0.0])

    def build(scene: Scene) -> None:
        scene.ground(friction=0.4)
        scene.box("box", size=(20, 20, 1), mass=box, position=(0, 0, 0.5), friction=0.8)
        for k in range(count):
            place = (k // 5 * 2.0 - 4.0, k % 5 * 2.0 - 4.0, 1.5)
            scene.sphere(f"ball_{k}", radius=0.5, mass=ball, position=place, friction=0.8)

    speeds = np.array([(push - rubs - count * between) / box, between / ball])
    errors = [
        float(((velocity[:2] - speeds[:, None] * t * along) ** 2).sum())
        for t, _, velocity in steps(build, device, 4.0, push * along)
    ]
    return float(np.mean(errors))


def _energy(place: Array, velocity: Array) -> float:
    """Of balls of 10 kg that do not turn [J]."""
    return float(10.0 * (G * place[:, 2] + 0.5 * (velocity**2).sum(axis=1)).sum())


def bouncing(device: str) -> float:
    """49 elastic balls fall from 5 m and bounce for 20 s: squared change of their energy [J²]."""

    def build(scene: Scene) -> None:
        scene.ground(friction=0.0)
        for k in range(49):
            place = (k // 7 * 2.0, k % 7 * 2.0, 5.0)
            scene.sphere(f"ball_{k}", radius=0.1, mass=10.0, position=place, friction=0.0, restitution=1.0)

    start = 49 * 10.0 * G * 5.0
    return float(np.mean([(_energy(place, velocity) - start) ** 2 for _, place, velocity in steps(build, device, 20)]))


def _cube(height: float, restitution: float) -> Callable[[Scene], None]:
    """6 x 6 x 6 balls, a little off their lattice; the authors' random numbers are others."""

    def build(scene: Scene) -> None:
        scene.ground(friction=0.0)
        off = np.random.default_rng(42).uniform(0.0, 1e-3, (216, 3))
        for k, (cell, away) in enumerate(zip(np.ndindex(6, 6, 6), off, strict=True)):
            x, y, z = (float(value) for value in 0.21 * np.array(cell) + away)
            scene.sphere(f"ball_{k}", radius=0.1, mass=10.0, position=(x, y, z + height), friction=0.0,
                         restitution=restitution)  # fmt: skip

    return build


def _overlap(place: Array) -> float:
    """Squared depths of all pairs and of the ground, added up [m²]."""
    apart = np.linalg.norm(place[:, None] - place[None], axis=2)[np.triu_indices(len(place), 1)]
    return float((np.maximum(0.2 - apart, 0.0) ** 2).sum() + (np.maximum(0.1 - place[:, 2], 0.0) ** 2).sum())


def six_six_six(device: str) -> float:
    """216 balls of no restitution collapse in 10 s: squared depths of what overlaps, added up [m²]."""
    return float(np.mean([_overlap(place) for _, place, _ in steps(_cube(0.101, 0.0), device, 10.0)]))


def elastic_six_six_six(device: str) -> float:
    """216 elastic balls fall by 1 m and fly apart in 10 s: squared change of their energy [J²]."""
    energies = [_energy(place, velocity) for _, place, velocity in steps(_cube(1.101, 1.0), device, 10.0)]
    return float(np.mean((np.array(energies) - energies[0]) ** 2))


TESTS = {"rolling": rolling, "bouncing": bouncing, "666": six_six_six, "elastic666": elastic_six_six_six}


def table(measured: dict[str, float], device: str) -> str:
    """The document's table: a row for each engine, wsim's first."""
    rows = [("engine", *(f"{name} [{unit}]" for name, unit in UNITS.items())), ("---",) * 5]
    rows.append((f"wsim ({device})", *(f"{measured[name]:.3g}" if name in measured else "–" for name in UNITS)))
    for engine, errors in PUBLISHED.items():
        rows.append((engine, *("–" if error is None else f"{error:.3g}" for error in errors)))
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)


def main(arguments: list[str] | None = None) -> int:
    """Run the tests and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device", default="auto", help="cpu, cuda:0, … or auto: CUDA if there is one")
    parser.add_argument("--tests", nargs="+", choices=list(TESTS), default=list(TESTS))
    parser.add_argument("--write", action="store_true", help="put the table into docs/rigid.md; needs all tests")
    args = parser.parse_args(arguments)
    if args.write and len(args.tests) < len(TESTS):
        parser.error("--write: the table is of all tests; leave out --tests")
    device, measured = known_device(args.device), {}
    for name in args.tests:
        started = time.perf_counter()
        measured[name] = TESTS[name](device)
        print(f"{name:12} {measured[name]:.4g} {UNITS[name]:6} {time.perf_counter() - started:6.0f} s", flush=True)
    text = table(measured, device)
    print(text)
    if args.write:
        side = DOCUMENT.with_name(DOCUMENT.name + ".part")
        side.write_text(MARKS.sub(lambda _: text, DOCUMENT.read_text(encoding="utf-8")), encoding="utf-8")
        side.replace(DOCUMENT)
    return 0


if __name__ == "__main__":
    sys.exit(main())
