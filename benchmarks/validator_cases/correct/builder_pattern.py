"""Crates on pallets, written with an abstract builder, a protocol, generators and a decorator."""
from __future__ import annotations

import contextlib
import functools
import operator
from abc import ABC, abstractmethod
from typing import Callable, ClassVar, Generator, Protocol, TypeVar

from wsim.scene import Handle, Scene

T = TypeVar("T")


class Named(Protocol):
    name: str
    path: str


def logged(function: Callable[..., T]) -> Callable[..., T]:
    @functools.wraps(function)
    def wrapper(*args, **kwargs) -> T:
        result = function(*args, **kwargs)
        print(function.__name__, "->", result)
        return result

    return wrapper


class Builder(ABC):
    count: ClassVar[int] = 0

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.made: list[Named] = []

    @abstractmethod
    def build(self) -> None: ...

    def name(self, prefix: str) -> str:
        type(self).count += 1
        return f"{prefix}_{self.count}"


class PalletBuilder(Builder):
    CRATE = 0.4
    SURFACE = 0.144

    @logged
    def crate(self, x: float, y: float, level: int) -> Handle:
        z = self.SURFACE + level * (self.CRATE + 1e-3) + 1e-3
        handle = self.scene.asset(self.name("crate"), "crate", position=(x, y, z))
        self.made.append(handle)
        return handle

    def spots(self) -> Generator[tuple[float, float], None, None]:
        yield from ((sx * 0.25, 0.0) for sx in (-1, 1))

    def build(self) -> None:
        self.scene.asset("pallet", "pallet", static=True)
        for level in range(2):
            for x, y in self.spots():
                self.crate(x, y, level)


@contextlib.contextmanager
def timed_setup(scene: Scene, duration: float):
    scene.simulation(duration=duration)
    yield scene.ground(friction=0.7)
    scene.camera("corner", eye=(2.5, -2.5, 1.8), target=(0.0, 0.0, 0.5))


def build(scene: Scene) -> None:
    with timed_setup(scene, 3.0) as ground:
        builder = PalletBuilder(scene)
        builder.build()
        paths = list(map(operator.attrgetter("path"), builder.made))
        print(ground.name, len(paths), max(paths, key=len), sep=" | ")
    hit = scene.sphere("ball", radius=0.15, position=(-2.5, 0, 0.6), velocity=(6, 0, 1), mass=10)
    setattr(builder, "last", hit)
    assert getattr(builder, "last", None) is hit and hasattr(hit, "kind")
