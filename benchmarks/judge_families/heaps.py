"""Sound worlds of heaps that are struck: stacks, piles and rows that a ball runs into.

What stands on several points does not bounce: where many points bounce at once the simulator's own energy rises, and
the judge is right to reject that.
"""

from __future__ import annotations

import math

from benchmarks.judge_families.drawn import Draw, mechanism
from wsim.scene import Scene

RATES = (24.0, 30.0, 60.0, 120.0)  # frames a second
LEAST, MOST = 0.02, 2.0  # size of a body [m]
WAIT = (0.02, 0.3)  # [s] until the ball is there


def _begin(scene: Scene, draw: Draw) -> tuple[float, float]:
    """The Earth's gravity, ground, and a frame rate; the bodies' size, and the ball's speed by their size.

    With sqrt(g L) for a speed what is light flies off, and what is heavy rocks.
    """
    scene.simulation(duration=1.0, frame_rate=draw.pick(RATES))
    scene.ground(friction=draw.between(0.1, 0.9))
    size = draw.log(LEAST, MOST)
    return size, draw.log(0.5, 5.0) * math.sqrt(9.81 * size)


def _surface(draw: Draw, bounce: float = 0.0) -> dict[str, float]:
    return {"friction": draw.between(0.1, 0.9), "restitution": bounce}


def _ball(scene: Scene, draw: Draw, size: float, speed: float, height: float, bounce: float = 0.0) -> None:
    """A ball that flies level at what begins at the origin, at a height, a little beside the middle."""
    radius = size * draw.between(0.2, 0.5)
    gap = draw.between(*WAIT) * speed
    at = (-gap - radius, draw.between(-0.3, 0.3) * size, max(height, radius))
    scene.sphere("ball", radius=radius, position=at, velocity=(speed, 0.0, 0.0), density=draw.density(size),
                 **_surface(draw, bounce))  # fmt: skip


@mechanism("heap")
def struck_stack(scene: Scene, draw: Draw) -> None:
    """A ball hits a stack of three to eight boxes."""
    size, speed = _begin(scene, draw)
    top = 0.0
    for k in range(draw.whole(3, 8)):
        height = size * draw.between(0.3, 1.0)
        scene.box(f"box_{k}", size=(size, size, height), position=(0.5 * size, 0.0, top + 0.5 * height),
                  density=draw.density(size), **_surface(draw))  # fmt: skip
        top += height
    _ball(scene, draw, size, speed, top * draw.between(0.0, 1.0))


@mechanism("heap")
def struck_pile(scene: Scene, draw: Draw) -> None:
    """A ball hits boxes, balls, rollers and capsules that stand beside and on each other."""
    size, speed = _begin(scene, draw)
    left, highest = draw.whole(3, 11), 0.0
    count, at = left, 0.5 * size
    while left:
        top = 0.0
        for _ in range(min(left, draw.whole(1, 3))):
            name, kind = f"body_{count - left}", draw.pick(("box", "sphere", "cylinder", "capsule"))
            wide, height = size * draw.between(0.5, 1.0), size * draw.between(0.4, 1.0)
            options = {"density": draw.density(size), **_surface(draw)}
            if kind == "box":
                scene.box(name, size=(wide, wide, height), position=(at, 0, top + 0.5 * height), **options)
            elif kind == "sphere":
                height = wide
                scene.sphere(name, radius=0.5 * wide, position=(at, 0, top + 0.5 * height), **options)
            else:
                lies, make = draw.pick((True, False)), scene.cylinder if kind == "cylinder" else scene.capsule
                radius, length = (0.25 if lies else 0.4) * wide, 0.5 * wide if lies else height
                height = 2.0 * radius if lies else length + (2.0 * radius if kind == "capsule" else 0.0)
                make(name, radius=radius, height=length, axis="Y" if lies else "Z",
                     position=(at, 0, top + 0.5 * height), **options)  # fmt: skip
            top += height
            left -= 1
        highest, at = max(highest, top), at + size * draw.between(1.0, 1.2)
    _ball(scene, draw, size, speed, highest * draw.between(0.0, 1.0) - 0.5 * size)


@mechanism("heap")
def struck_row(scene: Scene, draw: Draw) -> None:
    """A ball hits the first of a row: cards that knock each other over, balls, or blocks."""
    size, speed = _begin(scene, draw)
    bounce, kind = draw.pick((0.0, draw.between(0.1, 0.8))), draw.pick(("card", "ball", "block"))
    thick = {"card": draw.between(0.1, 0.25), "ball": 1.0, "block": draw.between(0.5, 1.0)}[kind] * size
    gap = draw.pick((0.0, draw.between(0.05, 0.5))) * size
    for k in range(draw.whole(3, 9)):
        options = {"density": draw.density(size), **_surface(draw, bounce)}
        middle = 0.5 * thick + k * (thick + gap)
        if kind == "ball":
            scene.sphere(f"row_{k}", radius=0.5 * size, position=(middle, 0.0, 0.5 * size), **options)
        else:
            scene.box(f"row_{k}", size=(thick, 0.6 * size, size), position=(middle, 0.0, 0.5 * size), **options)
    _ball(scene, draw, size, speed, size * draw.between(0.2, 0.8), bounce)
