"""Blocks that land in shallow water: does any of it leave the tank, or get into the block?

    .venv/bin/python benchmarks/sph_landing.py                 twelve drops, two minutes on one core

A block half as wide as the tank falls flat on the floor through water two to four spacings deep, and presses the film
out from under itself at half of the speed of sound: the hardest that a wall is tried by here. Below each drop's
settings stand the particles that are more than half a spacing outside after one second and after two, those inside the
block by a quarter of one, the largest speed of those in the tank over c, and the largest compression.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np

from wsim.scene import Scene
from wsim.sim import Simulation

SPACING = 0.02
INNER, WALL = 0.4, 0.02  # of the tank [m]
BLOCK = np.array([0.2, 0.2, 0.16])
SECONDS = 2


def scene_of(layers: int, drop: float, density: float) -> Scene:
    """Water of some layers of particles, and a block whose face is `drop` [m] above it."""
    scene, level = Scene(), layers * SPACING
    scene.simulation(duration=float(SECONDS), frame_rate=50.0)
    tank = scene.tank("tank", inner_size=(INNER, INNER, INNER), wall=WALL)
    scene.fluid("water", fills=tank, level=level, spacing=SPACING)
    height = WALL + level + drop + BLOCK[2] / 2
    scene.box("block", size=tuple(BLOCK), density=density, position=(0.0, 0.0, height))
    return scene


def lands(layers: int, drop: float, density: float, folder: Path) -> int:
    """Let it fall, print what came of it; returns how many particles are outside at the end."""
    simulation = Simulation(scene_of(layers, drop, density).save(folder / "drop.usda"), "cpu")
    settings = simulation.built.sph
    assert settings is not None
    fastest = compressed = 0.0
    out = []
    for _ in range(SECONDS):
        for _ in range(50):
            simulation.advance_frame()
            place, speed = simulation.state.particle_q.numpy(), simulation.state.particle_qd.numpy()
            beyond = np.maximum(np.abs(place[:, :2]).max(axis=1) - INNER / 2, WALL - place[:, 2])
            fastest = max(fastest, float(np.linalg.norm(speed[beyond < 0.0], axis=1).max()))
            compressed = max(compressed, float(simulation.state.sph.pressure.numpy().max()))
        out.append(int((beyond > 0.5 * SPACING).sum()))
    local = place - simulation.state.body_q.numpy()[0, :3]  # it lands flat: its axes stay the world's
    inside = int((np.abs(local) < BLOCK / 2 - 0.25 * SPACING).all(axis=1).sum())
    sound = settings.speed_of_sound
    print(
        f"{layers} layers, dropped {1e3 * drop:3.0f} mm, c = {sound:4.1f} m/s: outside {out[0]:2d} and {out[1]:2d} of "
        f"{len(place)}, in the block {inside}, fastest {fastest / sound:.2f} c, "
        f"compressed {100.0 * compressed / (settings.rest_density * sound**2):.0f} %",
        flush=True,
    )
    return out[-1]


def main(arguments: list[str] | None = None) -> int:
    """Run them all; 1 if any particle has left."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--density", type=float, default=800.0, help="of the block [kg/m^3]")
    given = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as folder:
        drops = [(layers, drop) for layers in (2, 3, 4) for drop in (0.0, 0.025, 0.05, 0.1)]
        lost = sum(lands(*drop, given.density, Path(folder)) for drop in drops)
    print(f"outside in all: {lost}")
    return int(lost > 0)


if __name__ == "__main__":
    sys.exit(main())
