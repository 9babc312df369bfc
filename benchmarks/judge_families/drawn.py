"""Sound worlds that are drawn at random: a kind of mechanism is a function that fills a scene from a draw."""

from __future__ import annotations

import hashlib
import math
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from wsim.plan.schema import Plan
from wsim.program.compose import compose
from wsim.scene import Scene

Item = TypeVar("Item")
Vector = tuple[float, float, float]
FRAME_RATE = 60.0  # [1/s]
CROSSED = 300.0  # thicknesses a second that a body moves at most [1/s]: beyond, a run takes many steps
LEAST, MOST = 0.01, 10.0  # size of a body [m]
HEAVIEST = 5e4  # [kg]


def seed_of(*what: object) -> list[int]:
    """A seed that follows from words and numbers alone."""
    digest = hashlib.sha256(repr(what).encode()).digest()
    return [int.from_bytes(digest[k : k + 4], "big") for k in range(0, 16, 4)]


class Draw:
    """Random numbers as a world's parts need them."""

    def __init__(self, *what: object) -> None:
        self.random = np.random.default_rng(seed_of(*what))

    def between(self, low: float, high: float) -> float:
        """Evenly from low to high."""
        return float(self.random.uniform(low, high))

    def log(self, low: float, high: float) -> float:
        """Evenly in its logarithm."""
        return math.exp(self.between(math.log(low), math.log(high)))

    def pick(self, items: Sequence[Item]) -> Item:
        """One of them."""
        return items[int(self.random.integers(len(items)))]

    def whole(self, low: int, high: int) -> int:
        """A whole number from low to high, both possible."""
        return int(self.random.integers(low, high + 1))

    def sign(self) -> float:
        """Plus or minus one."""
        return self.pick((-1.0, 1.0))

    def heading(self) -> tuple[float, float]:
        """A level direction."""
        turn = self.between(0.0, 2.0 * math.pi)
        return math.cos(turn), math.sin(turn)

    def direction(self) -> Vector:
        """A direction in space."""
        x, y, z = (way := self.random.normal(size=3)) / np.linalg.norm(way)
        return float(x), float(y), float(z)

    def size(self) -> float:
        """Of a body [m]."""
        return self.log(LEAST, MOST)

    def density(self, size: float) -> float:
        """From cork to steel [kg/m^3]; of what is large, hollow: the simulator takes no more than 100 t."""
        return min(self.log(150.0, 8000.0), HEAVIEST / size**3)

    def gravity(self, scene: Scene, duration: float, low: float = 1.0) -> float:
        """Gravity up to 20 m/s^2, straight down, and how long the scene runs [s]."""
        g = self.between(low, 20.0)
        scene.simulation(gravity=(0.0, 0.0, -g), duration=duration, frame_rate=FRAME_RATE)
        return g

    def speed(self, wanted: float, thickness: float) -> float:
        """As wanted [m/s], as far as what is so thin can be followed in a fair number of steps."""
        return min(wanted, CROSSED * thickness)


Fill = Callable[[Scene, Draw], None]


@dataclass(frozen=True)
class Mechanism:
    """A kind of sound world.

    Attributes:
        name: As tables call it.
        has: What a fault can act on: friction, bounce, mass, inertia, air, rest, roll, drive, …
        fill: Fills a scene.
        plan: What asked for it, where something did.
    """

    name: str
    has: frozenset[str]
    fill: Fill
    plan: Callable[[Draw], Plan] | None = None


@dataclass(frozen=True)
class Sound:
    """One sound world: the k-th draw of a mechanism."""

    mechanism: Mechanism
    k: int

    @property
    def name(self) -> str:
        """As `--only` finds it."""
        return f"{self.mechanism.name} {self.k}"

    def scene(self) -> Scene:
        """The scene, the same each time."""
        scene = Scene()
        self.mechanism.fill(scene, Draw("sound", self.mechanism.name, self.k))
        return scene

    @property
    def plan(self) -> Plan | None:
        """What asked for it."""
        return self.mechanism.plan(Draw("sound", self.mechanism.name, self.k)) if self.mechanism.plan else None

    @cached_property
    def stage(self) -> str:
        """The stage as text."""
        with tempfile.TemporaryDirectory() as folder:
            return self.scene().save(Path(folder) / "sound.usda").read_text(encoding="utf-8")


MECHANISMS: dict[str, Mechanism] = {}


def mechanism(*has: str) -> Callable[[Fill], Fill]:
    """Register a function as a kind of sound world, by its name."""

    def register(fill: Fill) -> Fill:
        name = fill.__name__.strip("_").replace("_", " ")
        MECHANISMS[name] = Mechanism(name, frozenset(has), fill)
        return fill

    return register


def planned_mechanism(*has: str) -> Callable[[Callable[[Draw], Plan]], Callable[[Draw], Plan]]:
    """Register a function that draws a plan, whose program fills the scene, as a kind of sound world."""

    def register(plan: Callable[[Draw], Plan]) -> Callable[[Draw], Plan]:
        name = plan.__name__.replace("_", " ")

        def fill(scene: Scene, draw: Draw) -> None:
            made: dict[str, Any] = {}
            exec(compile(compose(plan(draw)), "program.py", "exec"), made)
            made["build"](scene)

        MECHANISMS[name] = Mechanism(name, frozenset(has), fill, plan)
        return plan

    return register
