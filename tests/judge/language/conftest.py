"""Worlds of which theory knows everything, as arrays: W worlds of T frames."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from wsim.judge.language import Signals
from wsim.scene.world import Body, Container, Shape, Static, World

G = 9.81


def shape(kind: str, *size: float, **more: Any) -> Shape:
    return Shape(prim="/World/shape", kind=kind, size=size, **more)


def solid(name: str, form: Shape, mass: float = 1.0, **more: Any) -> Body:
    about = 0.4 * mass * form.size[0] ** 2
    fields = {
        "prim": f"/World/{name}", "mass": mass, "volume": 1.0, "position": (0.0, 0.0, 0.0),
        "rotation": (0.0, 0.0, 0.0, 1.0), "shapes": [form], "line": f"program.py:{len(name)}",
        "inertia": (about, 0.0, 0.0, 0.0, about, 0.0, 0.0, 0.0, about),
    }  # fmt: skip
    return Body(**{**fields, **more})


def still(name: str, form: Shape) -> Static:
    return Static(prim=f"/World/{name}", shapes=[form], line="program.py:1")


def times(duration: float, rate: float = 30.0) -> np.ndarray:
    return np.arange(round(duration * rate) + 1) / rate


def about_axis(axis: str, angle: np.ndarray) -> np.ndarray:
    """Quaternions (..., 4) of a turn about an axis [rad]."""
    q = np.zeros((*np.shape(angle), 4))
    q[..., "xyz".index(axis)], q[..., 3] = np.sin(np.asarray(angle) / 2), np.cos(np.asarray(angle) / 2)
    return q


def moving(world: World, time: np.ndarray, *paths: np.ndarray, **given: np.ndarray) -> Signals:
    """Signals of bodies on paths (T, 3) or (W, T, 3), with their differences as velocities, or what is given."""
    x = np.stack(np.broadcast_arrays(*[path if path.ndim == 3 else path[None] for path in paths]), axis=2)
    q = np.zeros((*x.shape[:3], 7))
    q[..., :3], q[..., 6] = x, 1.0
    if "q" in given:
        q[..., 3:] = given["q"]
    qd = np.zeros((*x.shape[:3], 6))
    qd[..., :3] = given["v"] if "v" in given else np.gradient(x, time, axis=1) if len(time) > 1 else 0.0
    qd[..., 3:] = given.get("w", 0.0)
    force = np.zeros(x.shape) + given.get("force", 0.0)
    return Signals(world, time, q, qd, force, mass=given.get("mass"))


@pytest.fixture
def two_balls() -> Callable[..., Signals]:
    """Signals in which `stays_within(a, (0, 0, 0), radius 1 m)` has the margins that are given, and so for b."""

    def make(a: Any, b: Any = None, rate: float = 1.0) -> Signals:
        margins = [np.atleast_2d(np.asarray(given, dtype=float)) for given in ((a, b) if b is not None else (a, a))]
        paths = [(1.0 - margin)[..., None] * np.array([1.0, 0.0, 0.0]) for margin in margins]
        world = World(bodies=[solid("a", shape("sphere", 0.1)), solid("b", shape("sphere", 0.1))])
        # At rest at each frame they go nowhere else in between.
        return moving(world, np.arange(margins[0].shape[1]) / rate, *paths, v=np.zeros(3))

    return make


@pytest.fixture
def tank_world() -> World:
    """A ball of 0.1 m, a box of 0.2 x 0.2 x 0.4 m, the ground, a wall at x = 1 m, and a tank of 1 x 1 x 0.5 m."""
    wall = shape("box", 0.1, 4.0, 2.0, position=(1.05, 0.0, 1.0))
    floor = shape("box", 1.2, 1.2, 0.1, position=(5.0, 0.0, 0.05))
    return World(
        bodies=[solid("ball", shape("sphere", 0.1)), solid("box", shape("box", 0.2, 0.2, 0.4), 2.0)],
        statics=[still("ground", Shape(prim="/g", kind="plane", size=())), still("wall", wall), still("tank", floor)],
        containers=[
            Container(
                prim="/World/tank", inner_size=(1.0, 1.0, 0.5), inner_center=(5.0, 0.0, 0.35),
                rotation=(0.0, 0.0, math.sin(math.pi / 8), math.cos(math.pi / 8)),
            )
        ],
    )  # fmt: skip
