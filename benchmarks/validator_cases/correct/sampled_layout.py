"""Poisson-like placement of cylinders by rejection sampling."""
import itertools
import random as rnd

from wsim.scene import Scene

MIN_GAP = 0.25


def far_enough(p, others, gap=MIN_GAP):
    return all((p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 >= gap**2 for q in others)


def sample(n: int, seed: int = 3, *, low=-1.0, high=1.0):
    rng = rnd.Random(seed)
    chosen = []
    for _ in itertools.count():
        candidate = (rng.uniform(low, high), rng.uniform(low, high))
        if far_enough(candidate, chosen):
            chosen.append(candidate)
        if len(chosen) == n:
            return chosen


def build(scene: Scene) -> None:
    scene.ground()
    palette = itertools.cycle([(0.8, 0.3, 0.1), (0.1, 0.5, 0.3), (0.2, 0.2, 0.7)])
    for index, ((x, y), color) in enumerate(zip(sample(12), palette)):
        tall = index % 3 == 0
        height = 0.6 if tall else 0.3
        scene.cylinder(f"pin_{index}", radius=0.06, height=height, position=(x, y, height / 2), density=400, color=color)
    if (count := sum(1 for _ in range(12))) > 10:
        scene.sphere("wrecker", radius=0.2, position=(-3, 0, 0.2), velocity=(5, 0, 0), mass=count * 1.0)
    scene.camera("above", eye=(0, -3.5, 3), target=(0, 0, 0.2))
