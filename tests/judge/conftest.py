"""Recordings from theory: a block that bobs to its draft while a ball sinks, and a stack of boxes."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from wsim.plan.schema import Material, Plan
from wsim.recording.frames import LogLine
from wsim.recording.recording import FluidTrack, Recording
from wsim.rules.materials import GLASS_LOOK, GROUND_LOOK, material_named
from wsim.rules.planner import plan as make_plan
from wsim.scene.world import Body, Container, Fluid, Shape, Static, World

G = 9.81
RATE, DURATION = 30.0, 4.0
SPACING, LEVEL, WALL = 0.03, 0.3, 0.02
INNER = (0.66, 0.51, 0.45)
BLOCK, BALL = (0.2, 0.2, 0.14), 0.06
PROMPT = "A wooden block floats in a tank of water while a steel ball drops in and sinks"
BLOCK_PRIM, BALL_PRIM, TANK, WATER = "/World/wooden_block", "/World/steel_ball", "/World/tank", "/World/water"


@dataclass
class Case:
    """A recording and the plan that it is held against."""

    recording: Recording
    plan: Plan

    def changed(self, **fields: Any) -> "Case":
        return Case(replace(self.recording, **fields), self.plan)

    def world(self, **fields: Any) -> "Case":
        return self.changed(world=self.recording.world.model_copy(update=fields))

    def edit(self, field: str, where: Any, value: Any) -> "Case":
        array = np.array(getattr(self.recording, field))
        array[where] = value
        return self.changed(**{field: array})

    def water(self, **fields: Any) -> "Case":
        fluids = {WATER: replace(self.recording.fluids[WATER], **fields)}
        return self.changed(fluids=fluids)

    def body(self, prim: str, **fields: Any) -> "Case":
        bodies = [b.model_copy(update=fields) if b.prim == prim else b for b in self.recording.world.bodies]
        return self.world(bodies=bodies)

    def log(self, level: str, text: str) -> "Case":
        return self.changed(log=[*self.recording.log, LogLine(1.0, level, text)])


def body(prim: str, shape: Shape, volume: float, density: float, position: tuple[float, float, float]) -> Body:
    mass = density * volume
    if shape.kind == "sphere":
        moments = [0.4 * mass * shape.size[0] ** 2] * 3
    else:
        x, y, z = (mass * edge**2 / 12.0 for edge in shape.size)
        moments = [y + z, x + z, x + y]
    return Body(
        prim=prim,
        mass=mass,
        volume=volume,
        inertia=tuple(np.diag(moments).ravel().tolist()),
        position=position,
        rotation=(0.0, 0.0, 0.0, 1.0),
        shapes=[shape],
        line=f"program.py:{10 + len(prim)}",
    )


def look(material: str) -> dict[str, Any]:
    return surface(material_named(material))


def surface(named: Material) -> dict[str, Any]:
    return {"color": named.color, "friction": named.friction, "restitution": named.restitution}


def ground() -> Static:
    plane = Shape(prim="/World/ground/geometry", kind="plane", size=(), **surface(GROUND_LOOK))
    return Static(prim="/World/ground", shapes=[plane])


def tank() -> Static:
    lx, ly, lz = INNER
    boxes = {
        "floor": ((lx + 2 * WALL, ly + 2 * WALL, WALL), (0.0, 0.0, WALL / 2)),
        "wall_minus_x": ((WALL, ly, lz), (-(lx + WALL) / 2, 0.0, WALL + lz / 2)),
        "wall_plus_x": ((WALL, ly, lz), ((lx + WALL) / 2, 0.0, WALL + lz / 2)),
        "wall_minus_y": ((lx, WALL, lz), (0.0, -(ly + WALL) / 2, WALL + lz / 2)),
        "wall_plus_y": ((lx, WALL, lz), (0.0, (ly + WALL) / 2, WALL + lz / 2)),
    }
    glass = surface(GLASS_LOOK)
    shapes = [Shape(prim=f"{TANK}/{n}", kind="box", size=s, position=p, **glass) for n, (s, p) in boxes.items()]
    return Static(prim=TANK, shapes=shapes, line="program.py:6")


def still_water(level: float, times: np.ndarray) -> FluidTrack:
    """A lattice with LEVEL's number of layers, stretched to a level: what displaced water looks like from above."""
    counts = [round(length / SPACING) for length in (INNER[0], INNER[1], LEVEL)]
    axes = [(np.arange(n) + 0.5) * SPACING for n in counts]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    grid[:, 2] *= (level - SPACING / 2) / (grid[:, 2].max())
    grid += [-INNER[0] / 2, -INNER[1] / 2, WALL]
    position = np.broadcast_to(grid.astype(np.float32), (len(times), *grid.shape)).copy()
    density = np.full(position.shape[:2], 1002.0, dtype=np.float32)
    return FluidTrack(times, position, np.zeros_like(position), density)


def bobbing(times: np.ndarray, rest: float, amplitude: float, draft: float) -> tuple[np.ndarray, np.ndarray]:
    """Height and vertical speed of a damped heave about a rest height: omega^2 = g / draft of a straight-sided body."""
    omega, decay = math.sqrt(G / draft), 2.0
    envelope = amplitude * np.exp(-decay * times)
    z = rest + envelope * np.cos(omega * times)
    return z, -envelope * (decay * np.cos(omega * times) + omega * np.sin(omega * times))


def dropping(times: np.ndarray, start: float, surface: float, rest: float) -> tuple[np.ndarray, np.ndarray]:
    """Free fall to the surface, then at the speed of entry to the floor, where it stays."""
    entry = math.sqrt(2 * (start - surface) / G)
    speed = G * entry
    air = times < entry
    z = np.where(air, start - G * times**2 / 2, np.maximum(rest, surface - speed * (times - entry)))
    v = np.where(air, -G * times, np.where(z > rest, -speed, 0.0))
    return z, v


@pytest.fixture
def pool() -> Callable[..., Case]:
    """Make a recording of PROMPT's world; arguments plant what theory would not have."""

    def make(density: float = 600.0, lift: float = 0.0, settle: bool = True) -> Case:
        times = np.arange(round(DURATION * RATE) + 1) / RATE
        volume, ball_volume = math.prod(BLOCK), 4 / 3 * math.pi * BALL**3
        area = INNER[0] * INNER[1]
        floats = density < 1000.0
        displaced = volume * min(1.0, density / 1000.0) + ball_volume
        level = LEVEL + displaced / area
        surface = WALL + level
        draft = BLOCK[2] * min(1.0, density / 1000.0)
        rest = surface - draft + BLOCK[2] / 2 + lift
        if floats:
            z, v = bobbing(times, rest, 0.03 if settle else 0.2, draft)
            if not settle:
                z, v = rest + 0.012 * np.sin(9.0 * times), 0.108 * np.cos(9.0 * times)
        else:
            z, v = dropping(times, surface + 0.1, surface, WALL + BLOCK[2] / 2)
        ball_z, ball_v = dropping(times, surface + 0.2, surface, WALL + BALL)
        q = np.zeros((len(times), 2, 7), dtype=np.float32)
        q[:, :, 6] = 1.0
        q[:, 0, 0], q[:, 0, 2], q[:, 1, 0], q[:, 1, 2] = -0.12, z, 0.15, ball_z
        qd = np.zeros((len(times), 2, 6), dtype=np.float32)
        qd[:, 0, 2], qd[:, 1, 2] = v, ball_v
        force = np.zeros((len(times), 2, 3), dtype=np.float32)
        force[:, 1, 2] = np.where(ball_v == 0, (7850.0 - 1000.0) * ball_volume * G, 0.0)
        force[0] = 0.0
        box = Shape(prim=f"{BLOCK_PRIM}/geometry", kind="box", size=BLOCK, **look("wood"))
        sphere = Shape(prim=f"{BALL_PRIM}/geometry", kind="sphere", size=(BALL,), **look("steel"))
        world = World(
            duration=DURATION,
            frame_rate=RATE,
            bodies=[
                body(BLOCK_PRIM, box, volume, density, tuple(map(float, q[0, 0, :3]))),
                body(BALL_PRIM, sphere, ball_volume, 7850.0, tuple(map(float, q[0, 1, :3]))),
            ],
            statics=[ground(), tank()],
            containers=[Container(prim=TANK, inner_size=INNER, inner_center=(0.0, 0.0, WALL + INNER[2] / 2))],
            fluids=[
                Fluid(
                    prim=WATER,
                    density=1000.0,
                    viscosity=0.001,
                    spacing=SPACING,
                    size=(INNER[0], INNER[1], LEVEL),
                    center=(0.0, 0.0, WALL + LEVEL / 2),
                    container=TANK,
                    line="program.py:7",
                )
            ],
        )
        water = still_water(level, times)
        scalars = {"contact/penetration": np.full(len(times), 1e-4)}
        recording = Recording(Path("x.rrd"), world, {}, times, q, qd, force, {WATER: water}, scalars, [], {})
        return Case(recording, make_plan(PROMPT))

    return make


STACK = "A tower of three boxes stands on the ground"


@pytest.fixture
def stack() -> Callable[..., Case]:
    """Make a recording of three boxes on one another; `fallen` lays the uppermost on the ground beside them."""

    def make(fallen: bool = False, prompt: str = STACK) -> Case:
        times = np.arange(round(3 * RATE) + 1) / RATE
        q = np.zeros((len(times), 3, 7), dtype=np.float32)
        q[:, :, 6] = 1.0
        q[:, :, 2] = [0.1, 0.3, 0.5]
        qd = np.zeros((len(times), 3, 6), dtype=np.float32)
        if fallen:
            # Pushed off in a quarter of a second, then down and over in another: clear of the two below all the way.
            push = np.clip((times - 1.0) / 0.25, 0.0, 1.0)
            fall = np.clip((times - 1.25) / 0.25, 0.0, 1.0)
            turn = fall * math.pi / 2
            q[:, 2, 0] = 0.32 * push
            q[:, 2, 2] = 0.5 - 0.4 * fall
            q[:, 2, 4], q[:, 2, 6] = np.sin(turn / 2), np.cos(turn / 2)
            qd[(times > 1.0) & (times < 1.25), 2, 0] = 1.28
            qd[(times > 1.25) & (times < 1.5), 2, 2] = -1.6
        force = np.zeros((len(times), 3, 3), dtype=np.float32)
        force[:, :, 2] = 600.0 * 0.008 * G
        edge = (0.2, 0.2, 0.2)
        bodies = [
            body(
                f"/World/box_{i}",
                Shape(prim=f"/World/box_{i}/geometry", kind="box", size=edge, **look("wood")),
                0.008,
                600.0,
                (0, 0, z),
            )
            for i, z in ((1, 0.1), (2, 0.3), (3, 0.5))
        ]
        world = World(duration=3.0, frame_rate=RATE, bodies=bodies, statics=[ground()])
        recording = Recording(Path("x.rrd"), world, {}, times, q, qd, force, {}, {}, [], {})
        return Case(recording, make_plan(prompt))

    return make
