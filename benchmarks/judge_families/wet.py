"""Sound worlds with a fluid: still in a tank, or with something that floats or sinks in it."""

from __future__ import annotations

import math

from benchmarks.judge_families.drawn import Draw, mechanism
from wsim.scene import Scene
from wsim.scene.tanks import Tank


def _tank(scene: Scene, draw: Draw, seconds: float) -> tuple[Tank, float, float, float]:
    """A tank that is filled to a level; its width, the level and the fluid's density."""
    scene.simulation(gravity=(0, 0, -draw.between(3.0, 15.0)), duration=seconds, frame_rate=30.0)
    width, density = draw.log(0.3, 3.0), draw.between(800.0, 1300.0)
    tank = scene.tank("tank", inner_size=(width, 0.8 * width, 0.9 * width), wall=0.05 * width)
    level = width * draw.pick((0.4, 0.5))
    scene.fluid("water", fills=tank, level=level, spacing=width / 10, density=density)
    return tank, width, level, density


@mechanism("fluid", "still")
def still_tank(scene: Scene, draw: Draw) -> None:
    """A tank of fluid at rest."""
    _tank(scene, draw, 1.0)


@mechanism("fluid", "floats")
def floating(scene: Scene, draw: Draw) -> None:
    """A block floats, set down near its draft."""
    tank, width, level, density = _tank(scene, draw, 1.5)
    share, edge = draw.between(0.4, 0.7), 0.35 * width
    height = 0.3 * width
    surface = tank.floor + level + share * edge**2 * height / (0.8 * width**2)
    scene.box("block", size=(edge, edge, height), position=(0, 0, surface + height * (0.5 - share)),
              density=share * density)  # fmt: skip


@mechanism("fluid", "sinks")
def sinking(scene: Scene, draw: Draw) -> None:
    """A ball falls into the fluid and sinks to the floor."""
    tank, width, level, density = _tank(scene, draw, 1.5)
    radius = 0.13 * width
    scene.sphere("ball", radius=radius, position=(0, 0, tank.floor + level + 1.2 * radius),
                 density=density * math.exp(draw.between(0.7, 2.0)))  # fmt: skip
