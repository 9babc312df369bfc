"""A hand-made tank world for the camera's tests: Newton model, World and fluid particles that agree."""

from __future__ import annotations

import newton
import numpy as np
import warp as wp
from scipy.spatial.transform import Rotation

from wsim.scene.world import Body, Camera, Container, Fluid, Shape, Static, World

GLASS = (0.75, 0.9, 0.92)


def _static(builder: newton.ModelBuilder, shape: Shape) -> None:
    xform = wp.transform(wp.vec3(*shape.position), wp.quat_identity())
    if shape.kind == "plane":
        builder.add_shape_plane(body=-1, xform=xform, width=0.0, length=0.0, label=shape.prim)
    else:
        half = [0.5 * s for s in shape.size]
        builder.add_shape_box(body=-1, xform=xform, hx=half[0], hy=half[1], hz=half[2], label=shape.prim)


def _body(builder: newton.ModelBuilder, body: Body) -> None:
    index = builder.add_body(xform=wp.transform(wp.vec3(*body.position), wp.quat(*body.rotation)), label=body.prim)
    shape = body.shapes[0]
    if shape.kind == "sphere":
        builder.add_shape_sphere(body=index, radius=shape.size[0], label=shape.prim)
    elif shape.kind == "cylinder":
        radius, height = shape.size
        builder.add_shape_cylinder(body=index, radius=radius, half_height=0.5 * height, label=shape.prim)
    else:
        half = [0.5 * s for s in shape.size]
        builder.add_shape_box(body=index, hx=half[0], hy=half[1], hz=half[2], label=shape.prim)


def model_of(world: World) -> newton.Model:
    return builder_of(world).finalize(device="cpu")


def builder_of(world: World) -> newton.ModelBuilder:
    builder = newton.ModelBuilder()
    for static in world.statics:
        for shape in static.shapes:
            _static(builder, shape)
    for body in world.bodies:
        _body(builder, body)
    return builder


def body(name: str, shape: Shape, position: tuple, rotation: tuple = (0.0, 0.0, 0.0, 1.0)) -> Body:
    return Body(
        prim=f"/World/{name}",
        mass=1.0,
        volume=1.0,
        inertia=(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
        position=position,
        rotation=rotation,
        shapes=[shape.model_copy(update={"prim": f"/World/{name}/geometry"})],
    )


def ground() -> Static:
    return Static(
        prim="/World/ground",
        shapes=[Shape(prim="/World/ground/geometry", kind="plane", size=(), color=(0.5, 0.5, 0.48))],
    )


def tank(inner: tuple, wall: float = 0.02, color: tuple = GLASS, opacity: float = 0.25) -> Static:
    x, y, z = inner
    full = (x + 2 * wall, y + 2 * wall)
    boxes = {
        "floor": ((full[0], full[1], wall), (0.0, 0.0, wall / 2)),
        "wall_minus_x": ((wall, full[1], z), (-(x + wall) / 2, 0.0, wall + z / 2)),
        "wall_plus_x": ((wall, full[1], z), ((x + wall) / 2, 0.0, wall + z / 2)),
        "wall_minus_y": ((x, wall, z), (0.0, -(y + wall) / 2, wall + z / 2)),
        "wall_plus_y": ((x, wall, z), (0.0, (y + wall) / 2, wall + z / 2)),
    }
    return Static(
        prim="/World/tank",
        shapes=[
            Shape(prim=f"/World/tank/{n}", kind="box", size=s, position=p, color=color, opacity=opacity)
            for n, (s, p) in boxes.items()
        ],
    )


def water_in_tank(inner: tuple, level: float, spacing: float, wall: float = 0.02) -> tuple[Container, Fluid]:
    container = Container(prim="/World/tank", inner_size=inner, inner_center=(0.0, 0.0, wall + inner[2] / 2))
    fluid = Fluid(
        prim="/World/water",
        density=1000.0,
        viscosity=1e-3,
        spacing=spacing,
        size=(inner[0], inner[1], level),
        center=(0.0, 0.0, wall + level / 2),
        container="/World/tank",
    )
    return container, fluid


def particles(fluid: Fluid, wave: float = 0.0, noise: float = 0.0) -> np.ndarray:
    """Particles of a box of fluid on a lattice; `wave` [m] raises and lowers its top."""
    h = fluid.spacing
    counts = [max(1, round(s / h)) for s in fluid.size]
    axes = [(np.arange(n) + 0.5) * h - 0.5 * n * h for n in counts]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    depth = (points[:, 2] + 0.5 * fluid.size[2]) / fluid.size[2]
    points[:, 2] += wave * depth * np.sin(2.2 * np.pi * points[:, 0] / fluid.size[0]) * np.cos(4.0 * points[:, 1])
    points += np.random.default_rng(0).normal(0.0, noise * h, points.shape)
    return (points + np.asarray(fluid.center)).astype(np.float32)


def aquarium(wave: float = 0.02) -> tuple[World, dict[str, np.ndarray]]:
    """A tank half full of water with floating blocks and a steel ball on its floor."""
    inner = (1.6, 0.9, 0.8)
    container, fluid = water_in_tank(inner, level=0.5, spacing=0.05)
    wood = Shape(prim="", kind="box", size=(0.26, 0.26, 0.18), color=(0.55, 0.30, 0.12))
    steel = Shape(prim="", kind="sphere", size=(0.1,), color=(0.45, 0.47, 0.5))
    world = World(
        statics=[ground(), tank(inner)],
        bodies=[
            body("block_0", wood, (-0.45, 0.05, 0.52), (0.0, 0.0, 0.1, 0.995)),
            body("block_1", wood, (0.1, -0.12, 0.53), (0.05, 0.0, -0.2, 0.978)),
            body("ball", steel, (0.48, -0.1, 0.12)),
        ],
        containers=[container],
        fluids=[fluid],
        cameras=[Camera(prim="/World/side", eye=(0.9, -2.6, 1.25), target=(0.0, 0.0, 0.4), fov=50.0)],
    )
    points = particles(fluid, wave=wave, noise=0.04)
    keep = np.ones(len(points), dtype=bool)
    for b in world.bodies:
        shape, skin = b.shapes[0], 0.5 * fluid.spacing
        local = Rotation.from_quat(b.rotation).inv().apply(points - np.asarray(b.position))
        if shape.kind == "sphere":
            keep &= np.linalg.norm(local, axis=1) > shape.size[0] + skin
        else:
            keep &= (np.abs(local) > 0.5 * np.asarray(shape.size) + skin).any(axis=1)
    return world, {fluid.prim: points[keep]}
