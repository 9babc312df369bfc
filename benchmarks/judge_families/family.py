"""A family of faults: one thing that is wrong, by any size."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from benchmarks.judge_families.drawn import Draw, Mechanism, Sound
from benchmarks.judge_families.record import Track
from wsim.plan.schema import Plan
from wsim.scene.world import World

SHARE = "of the quantity"
ENGINEER = {SHARE: 0.1, "of the weight": 0.1, "of the body's size": 0.1, "deg": 5.0, "m": 0.02}  # beyond it is wrong


@dataclass(frozen=True)
class Faulty:
    """A recording that holds a fault, and the world that it is said to be of."""

    track: Track
    world: World
    plan: Plan | None = None


Make = Callable[[Sound, float, Draw], Faulty]


@dataclass(frozen=True)
class Family:
    """Faults of one kind.

    Attributes:
        name: As tables and `--only` call it.
        sizes: Five or so, rising.
        unit: Theirs; `ENGINEER` says from where on it counts as wrong.
        on: What a mechanism must have, one of these at least.
        but: What it must not have.
        hand: Arrays were edited: there are no forces of contact with them.
        seen: The motion differs from the sound world's, or the fault is drawn anew; else what the world says does.
        wrong: Where that is not what `ENGINEER` has for the unit.
        make: The fault in one sound world.
    """

    name: str
    sizes: tuple[float, ...]
    unit: str
    on: tuple[str, ...]
    make: Make
    but: tuple[str, ...] = ()
    hand: bool = False
    seen: bool = True
    wrong: float = 0.0

    @property
    def limit(self) -> float:
        """The size that an engineer would call wrong, in the unit."""
        return self.wrong or ENGINEER[self.unit]

    def suits(self, mechanism: Mechanism) -> bool:
        """Whether the fault can be in a mechanism's worlds."""
        return bool(mechanism.has & set(self.on)) and not mechanism.has & set(self.but)


FAMILIES: dict[str, Family] = {}


def family(sizes: tuple[float, ...], unit: str, on: tuple[str, ...], **options: object) -> Callable[[Make], Make]:
    """Register a function as a family, by its name."""

    def register(make: Make) -> Make:
        name = make.__name__.strip("_").replace("_", " ")
        FAMILIES[name] = Family(name, sizes, unit, on, make, **options)  # type: ignore[arg-type]
        return make

    return register


def size_of(world: World, row: int) -> float:
    """A body's largest extent [m]."""
    shape = world.bodies[row].shapes[0]
    if shape.kind == "sphere":
        return 2.0 * shape.size[0]
    if shape.kind in ("cylinder", "capsule"):
        return max(2.0 * shape.size[0], shape.size[1])
    return max(shape.size)


def movers(world: World) -> list[int]:
    """Rows of the bodies that forces move."""
    return [k for k, body in enumerate(world.bodies) if not body.kinematic]


def effect(sound: Track, faulty: Faulty) -> float:
    """How far a faulty recording is from the sound one at most: in sizes of a body, or as a share of a force.

    A fault without effect is none: a wrong friction where nothing slides.
    """
    world, most = faulty.world, 0.0
    count = min(len(sound.time), len(faulty.track.time))
    q, qd, wrong_q, wrong_qd = (a[:count] for a in (sound.q, sound.qd, faulty.track.q, faulty.track.qd))
    for k in movers(world):
        size = size_of(world, k)
        apart = np.linalg.norm(wrong_q[:, k, :3] - q[:, k, :3], axis=1).max() / size
        cosine = np.abs((wrong_q[:, k, 3:] * q[:, k, 3:]).sum(axis=1)).min()
        speed = max(float(np.linalg.norm(qd[:, k, :3], axis=1).max()), 1e-9)
        faster = np.linalg.norm(wrong_qd[:, k, :3] - qd[:, k, :3], axis=1).max() / speed
        most = max(most, float(apart), 2.0 * float(np.arccos(min(cosine, 1.0))), float(faster) if speed > 0.01 else 0)
    return most
