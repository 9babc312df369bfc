"""Forty random stones pour into a crate-like bin. Reproducible through scene.random."""

import numpy as np

from wsim.scene import Scene

COUNT = 40


def build(scene: Scene) -> None:
    rng = scene.random
    scene.simulation(duration=4.0, frame_rate=30.0)
    scene.ground()

    for name, size, at in [
        ("wall_front", (0.04, 1.0, 0.5), (0.5, 0.0, 0.25)),
        ("wall_back", (0.04, 1.0, 0.5), (-0.5, 0.0, 0.25)),
        ("wall_left", (1.0, 0.04, 0.5), (0.0, 0.5, 0.25)),
        ("wall_right", (1.0, 0.04, 0.5), (0.0, -0.5, 0.25)),
    ]:
        scene.box(name, size=size, position=at, static=True, color=(0.4, 0.3, 0.2))

    stone = scene.material("stone", density=2600.0, friction=0.7, restitution=0.1)
    sizes = rng.uniform(0.06, 0.14, size=(COUNT, 3))
    places = np.column_stack((rng.uniform(-0.35, 0.35, COUNT), rng.uniform(-0.35, 0.35, COUNT), 0.6 + 0.16 * np.arange(COUNT)))
    turns = rng.normal(0.0, 40.0, (COUNT, 3)).clip(-180, 180)
    greys = rng.uniform(0.3, 0.6, COUNT)
    for i, (size, place, turn, grey) in enumerate(zip(sizes, places, turns, greys, strict=True)):
        scene.box(
            f"stone_{i:02d}", size=size, position=place.tolist(), rotation_deg=turn, material=stone, color=[grey] * 3
        )

    scene.camera("side", eye=(0.0, -3.2, 2.0), target=(0.0, 0.0, 0.6))
