"""Chains and cables that are struck, at random: what the judge says of them, and what their steps make of energy.

    python benchmarks/struck_mechanisms.py --worlds 60
    python benchmarks/struck_mechanisms.py --worlds 60 --keep build/struck     # recordings; again: judges those

A world is a chain of two to eight links on hinges or ball joints, hung up, adrift or falling on a floor or an edge, or
a cable with a load; one or two balls come at it; restitution from 0 to 1. All of them are sound: what is rejected is
rejected wrongly. The energy that a step of the simulator gives is of the solver's own numbers, and so are the momenta
of chains adrift.
"""

from __future__ import annotations

import argparse
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np

from wsim.geometry.rotations import rotate
from wsim.judge import judge
from wsim.judge.verdict import Finding
from wsim.recording import Recording, read
from wsim.scene import Scene
from wsim.sim import Simulation

SECONDS, WIDE = 0.4, 0.03  # [s], [m]
KINDS = ("hung", "adrift", "floor", "edge", "cable")
Array = np.ndarray


def build(scene: Scene, seed: int) -> str:
    """Fill a scene; its kind."""
    rng = np.random.default_rng(seed)
    kind = KINDS[seed % len(KINDS)]
    surface = {
        "friction": float(rng.choice([0.0, rng.uniform(0.1, 1.0)])),
        "restitution": float(rng.choice([0.0, 0.5, 1.0, rng.uniform(0.0, 1.0)])),
    }
    scene.simulation(
        duration=SECONDS, frame_rate=float(rng.choice([30.0, 60.0, 120.0])),
        gravity=(0.0, 0.0, 0.0 if kind == "adrift" else -9.81),
    )  # fmt: skip
    if kind == "cable":
        length = float(rng.uniform(0.5, 1.0))
        load = scene.sphere("load", radius=0.06, mass=float(10 ** rng.uniform(-0.5, 0.7)),
                            position=(0, 0, 2.0 - length - 0.06), **surface)  # fmt: skip
        scene.cable("cable", None, load, anchor_a=(0, 0, 2), anchor_b=(0, 0, 2.0 - length), length=length,
                    links=int(rng.integers(4, 10)), mass_per_length=float(10 ** rng.uniform(-1, 0)), radius=0.015,
                    friction=surface["friction"])  # fmt: skip
        aims = [np.array((0.0, 0.0, z)) for z in rng.uniform(2.0 - length, 1.9, 2)]
    else:
        aims = _chain(scene, rng, kind, surface)
    if kind in ("floor", "edge"):
        return kind
    for k, aim in enumerate(aims[: int(rng.integers(1, 3))]):
        angle = float(rng.uniform(-np.pi, np.pi))
        way, across = np.array((np.cos(angle), np.sin(angle), 0.0)), np.array((-np.sin(angle), np.cos(angle), 0.0))
        place = aim - (0.12 + 0.15 * k) * way + float(rng.uniform(-0.03, 0.03)) * across
        scene.sphere(f"ball_{k}", radius=0.05, mass=float(10 ** rng.uniform(-1, 0.5)), position=place.tolist(),
                     velocity=(float(rng.uniform(1, 8)) * way).tolist(), **surface)  # fmt: skip
    return kind


def _chain(scene: Scene, rng: np.random.Generator, kind: str, surface: dict[str, float]) -> list[Array]:
    """A chain, and where its links are that balls come at."""
    joint, links = str(rng.choice(["revolute", "spherical"])), int(rng.integers(2, 9))
    long, mass, level = float(rng.uniform(0.1, 0.25)), float(10 ** rng.uniform(-1, 0)), kind in ("floor", "edge")
    lean = float(rng.uniform(-0.5, 0.5)) if level else 0.0  # of a chain that falls, from the level
    along = np.array((np.cos(lean), 0.0, -np.sin(lean))) if level else np.array((0.0, 0.0, -1.0))
    begin = np.array((-0.5 * links * long, 0.0, 0.4 + 0.5 * links * long)) if level else np.array((0.0, 0.0, 2.0))
    if level:
        scene.ground(**surface)
        begin[2] = 0.1 + max(0.0, along[2] * -links * long) + 0.3 * (kind == "edge")
    if kind == "edge":
        scene.box("edge", size=(0.05, 0.4, 0.3), position=(0, 0, 0.15), static=True, **surface)
    fall = {"velocity": (0.0, 0.0, -float(rng.uniform(1, 4)))} if level else {}
    parent, middles = None, []
    for k in range(links):
        middle = begin + (k + 0.5) * long * along
        turn = (0.0, float(np.degrees(lean)), 0.0) if level else (0.0, 90.0, 0.0)
        link = scene.box(f"link_{k}", size=(0.9 * long, WIDE, WIDE), mass=mass, position=middle.tolist(),
                         rotation_deg=turn, **fall, **surface)  # fmt: skip
        if parent is not None or kind == "hung":
            extra = {"axis": "Y"} if joint == "revolute" else {}
            getattr(scene, f"joint_{joint}")(
                f"joint_{k}", parent, link, anchor=(begin + k * long * along).tolist(), **extra
            )
        parent = link
        middles.append(middle)
    return [middles[int(n)] for n in rng.integers(links, size=2)]


class Books:
    """Energy and momenta of all bodies of a simulation, from step to step."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation, built = simulation, simulation.built
        self._mass, self._inertia, self._com = (
            getattr(built.model, f"body_{part}").numpy()[built.bodies].astype(float)
            for part in ("mass", "inertia", "com")
        )
        self._gravity = np.array(simulation.world.gravity)
        self.energy: list[float] = []
        self.kinetic: list[float] = []
        self.momentum: list[Array] = []
        self.note()

    def note(self) -> None:
        """Take those of the present state."""
        state, rows = self._simulation.state, self._simulation.built.bodies
        pose, twist = (array.numpy()[rows].astype(float) for array in (state.body_q, state.body_qd))
        mass, v, w = self._mass[:, None], twist[:, :3], twist[:, 3:]
        center = pose[:, :3] + rotate(pose[:, 3:], self._com)
        own = rotate(pose[:, 3:] * (-1, -1, -1, 1), w)
        kinetic = 0.5 * (mass * v * v).sum() + 0.5 * np.einsum("ni,nij,nj->", own, self._inertia, own)
        self.kinetic.append(float(kinetic))
        self.energy.append(float(kinetic - (mass * center @ self._gravity).sum()))
        self.momentum.append((mass * v).sum(axis=0))

    @property
    def gain(self) -> float:
        """The most that one step adds, over the largest kinetic energy."""
        return float(np.diff(self.energy).max(initial=0.0) / max(self.kinetic))

    @property
    def drift(self) -> float:
        """What momentum is off the start by, over that of the fastest step."""
        off = np.abs(np.array(self.momentum) - self.momentum[0]).max()
        return float(off / np.sqrt(2.0 * max(self.kinetic) * self._mass.sum()))


def stage(folder: Path, seed: int) -> tuple[Path, str]:
    """Write a world's stage."""
    scene = Scene()
    kind = build(scene, seed)
    return scene.save(folder / f"{seed}.usda"), kind


def recorded(folder: Path, seed: int) -> Recording:
    """A world's recording, which is made where there is none."""
    path = folder / f"{seed}.rrd"
    if not path.exists():
        result = Simulation(stage(folder, seed)[0], device="cpu").run(path)
        if result.problems:
            raise RuntimeError(f"{path}: {'; '.join(result.problems)}")
    return read(path)


def wrong(recording: Recording) -> list[Finding]:
    """What the judge rejects of it."""
    return [finding for finding in judge(recording).findings if not finding.passed]


def main(arguments: list[str] | None = None) -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--worlds", type=int, default=60)
    parser.add_argument("--first", type=int, default=0, help="seed of the first")
    parser.add_argument("--keep", type=Path, help="folder of recordings")
    parser.add_argument("--steps", action="store_true", help="energy and momentum instead of the judge")
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as made:
        folder = options.keep or Path(made)
        folder.mkdir(parents=True, exist_ok=True)
        (_steps if options.steps else _judged)(folder, range(options.first, options.first + options.worlds))


def _judged(folder: Path, seeds: range) -> None:
    rejected: Counter[str] = Counter()
    checks: Counter[str] = Counter()
    for seed in seeds:
        kind = KINDS[seed % len(KINDS)]
        try:
            found = wrong(recorded(folder, seed))
        except RuntimeError as error:
            print(error)
            rejected[kind] += 1
            continue
        rejected[kind] += bool(found)
        for finding in found:
            checks[finding.check] += 1
            print(f"{seed:4d} {kind:6s} {finding.check} {finding.message}; most {finding.limit}")
    print(f"rejected: {rejected.total()} of {len(seeds)}; by kind {dict(rejected)}; by check {dict(checks)}")


def _steps(folder: Path, seeds: range) -> None:
    found: dict[str, list[tuple[float, float]]] = {}
    for seed in seeds:
        path, kind = stage(folder, seed)
        simulation = Simulation(path, device="cpu")
        books = Books(simulation)
        while simulation.time < SECONDS - 1e-9:
            simulation.step()
            books.note()
        found.setdefault(kind, []).append((books.gain, books.drift))
        e = max(shape.restitution or 0.0 for body in simulation.world.bodies for shape in body.shapes)
        print(f"{seed:4d} {kind:6s} e {e:.2f} gain {books.gain:.2e} drift {books.drift:.2e}", simulation.problems())
    for kind, each in found.items():
        gain, drift = np.array(each).max(axis=0)
        momentum = f", momentum to {drift:.1e}" if kind == "adrift" else ""
        print(f"{kind}: no step gives more than {gain:.1e} of the kinetic energy{momentum}")


if __name__ == "__main__":
    main()
