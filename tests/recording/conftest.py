from __future__ import annotations

import numpy as np
import pytest

from wsim.recording import FluidFrame, Frame
from wsim.scene.world import Body, Camera, Container, Fluid, Shape, Static, World

INERTIA = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


def make_body(name: str, kind: str, size: tuple[float, ...], position: tuple[float, float, float], **shape) -> Body:
    prim = f"/World/{name}"
    geometry = Shape(prim=f"{prim}/geometry", kind=kind, size=size, color=(0.7, 0.3, 0.1), **shape)
    return Body(
        prim=prim,
        mass=2.0,
        volume=0.01,
        inertia=INERTIA,
        position=position,
        rotation=(0.0, 0.0, 0.0, 1.0),
        shapes=[geometry],
        line="program.py:12",
    )


def make_tank() -> Static:
    size, height, wall = (2.0, 1.0), 1.0, 0.02
    shapes = [Shape(prim="/World/tank/floor", kind="box", size=(*size, wall), position=(0, 0, wall / 2))]
    for side, axis, sign in (("minus_x", 0, -1), ("plus_x", 0, 1), ("minus_y", 1, -1), ("plus_y", 1, 1)):
        extent = [*size, height]
        extent[axis] = wall
        position = [0.0, 0.0, height / 2]
        position[axis] = sign * size[axis] / 2
        shapes.append(
            Shape(
                prim=f"/World/tank/wall_{side}",
                kind="box",
                size=tuple(extent),
                position=tuple(position),
                color=(0.6, 0.8, 0.9),
                opacity=0.25,
            )
        )
    return Static(prim="/World/tank", shapes=shapes)


@pytest.fixture
def world() -> World:
    tetrahedron = {
        "vertices": [(0.0, 0.0, 0.0), (0.3, 0.0, 0.0), (0.0, 0.3, 0.0), (0.0, 0.0, 0.3)],
        "triangles": [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)],
    }
    return World(
        name="tank with blocks",
        duration=1.0,
        bodies=[
            make_body("block", "box", (0.3, 0.3, 0.2), (-0.5, 0.0, 0.8)),
            make_body("ball", "sphere", (0.12,), (0.0, 0.0, 0.9)),
            make_body("can", "cylinder", (0.1, 0.25), (0.4, 0.0, 0.9)),
            make_body("pill", "capsule", (0.08, 0.2), (0.7, 0.2, 0.9)),
            make_body("wedge", "mesh", (0.3, 0.3, 0.3), (1.6, 0.0, 0.1), **tetrahedron),
        ],
        statics=[
            Static(
                prim="/World/ground",
                shapes=[Shape(prim="/World/ground/geometry", kind="plane", size=(), color=(0.4, 0.4, 0.4))],
            ),
            make_tank(),
        ],
        containers=[Container(prim="/World/tank", inner_size=(2.0, 1.0, 1.0), inner_center=(0.0, 0.0, 0.52))],
        fluids=[
            Fluid(
                prim="/World/water",
                density=1000.0,
                viscosity=0.001,
                spacing=0.1,
                size=(1.9, 0.9, 0.5),
                center=(0.0, 0.0, 0.27),
            )
        ],
        cameras=[Camera(prim="/World/side", eye=(1.5, -3.5, 2.0), target=(0.0, 0.0, 0.5), width=160, height=90)],
    )


@pytest.fixture
def make_frame(world: World):
    """Frames of arbitrary float32 bits, so that any loss on the way shows."""

    def make(seed: int, particles: int = 50) -> Frame:
        rng = np.random.default_rng(seed)

        def normal(*shape: int) -> np.ndarray:
            return rng.standard_normal(shape).astype(np.float32)

        count = len(world.bodies)
        fluid = FluidFrame(normal(particles, 3), normal(particles, 3), 1000 + normal(particles))
        return Frame(
            body_q=normal(count, 7),
            body_qd=normal(count, 6),
            contact_force=normal(count, 3),
            fluids={"/World/water": fluid},
            scalars={"energy/kinetic": float(rng.random()), "energy/potential": float(rng.random())},
        )

    return make
