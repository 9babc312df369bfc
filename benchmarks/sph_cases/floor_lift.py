"""Eight shapes held on a tank's floor, or just over it: Archimedes' lift.

Water gets under what lies on a floor, and lifts it by the weight of the water that it displaces. A shape 0.12 m across
is held in a tank of 0.32 m, in 0.24 m of water with a hollow for it; the lift is the mean of the later half of 0.8 s,
over rho g V. Particles that make room are as many as the shape's volume takes, the deepest in it. A mesh is a prism.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import newton
import numpy as np
import warp as wp

from benchmarks.sph_cases.case import Case, Measured, Value
from benchmarks.sph_cases.led import add_wrench
from benchmarks.sph_cases.water import add_fluid, lattice, make_builder, simulate
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

RHO, G, WIDTH, DEPTH, EDGE, SECONDS = 1000.0, 9.81, 0.32, 0.24, 0.06, 0.8
SOUND = 10.0 * math.sqrt(G * DEPTH)
LYING = wp.quat_from_axis_angle(wp.vec3(0.0, 1.0, 0.0), 0.5 * math.pi)
ALONG = 0.09  # half of the length of what lies [m]
PRISM = np.array([(x, y, z) for x in (-EDGE, EDGE) for y, z in ((-EDGE, -EDGE), (EDGE, -EDGE), (0.0, EDGE))])
PRISM_FACES = np.array([0, 2, 1, 3, 4, 5, 0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4, 2, 0, 3, 2, 3, 5])


@dataclass(frozen=True)
class Shape:
    """What is held: how it is added to a body, its volume [m^3], how deep points are below its surface [m]."""

    add: Callable[[newton.ModelBuilder, int], object]
    volume: float
    depth: Callable[[np.ndarray], np.ndarray]
    over: float = 0.0
    """Over the floor [spacings]."""


def _in_box(p: np.ndarray) -> np.ndarray:
    return EDGE - np.abs(p).max(axis=1)


def _in_cylinder(p: np.ndarray) -> np.ndarray:
    return np.minimum(EDGE - np.hypot(p[:, 0], p[:, 1]), EDGE - np.abs(p[:, 2]))


def _in_lying(p: np.ndarray) -> np.ndarray:
    return np.minimum(EDGE - np.hypot(p[:, 1], p[:, 2]), ALONG - np.abs(p[:, 0]))


def _in_capsule(p: np.ndarray) -> np.ndarray:
    beyond = np.maximum(np.abs(p[:, 0]) - (ALONG - EDGE), 0.0)
    return EDGE - np.sqrt(beyond**2 + p[:, 1] ** 2 + p[:, 2] ** 2)


def _in_prism(p: np.ndarray) -> np.ndarray:
    side = (2.0 * (EDGE - np.abs(p[:, 1])) - (p[:, 2] + EDGE)) / math.sqrt(5.0)
    return np.minimum.reduce([EDGE - np.abs(p[:, 0]), p[:, 2] + EDGE, side])


def _box(over: float) -> Shape:
    return Shape(lambda b, k: b.add_shape_box(k, hx=EDGE, hy=EDGE, hz=EDGE), (2.0 * EDGE) ** 3, _in_box, over)


SHAPES = {
    "ball": Shape(
        lambda b, k: b.add_shape_sphere(k, radius=EDGE),
        4.0 / 3.0 * math.pi * EDGE**3,
        lambda p: EDGE - np.linalg.norm(p, axis=1),
    ),
    "box": _box(0.0),
    "box 1/4 over": _box(0.25),
    "box 1 over": _box(1.0),
    "cylinder": Shape(
        lambda b, k: b.add_shape_cylinder(k, radius=EDGE, half_height=EDGE), 2.0 * math.pi * EDGE**3, _in_cylinder
    ),
    "lying cylinder": Shape(
        lambda b, k: b.add_shape_cylinder(
            k, xform=wp.transform(wp.vec3(0.0, 0.0, 0.0), LYING), radius=EDGE, half_height=ALONG
        ),
        2.0 * math.pi * EDGE**2 * ALONG,
        _in_lying,
    ),
    "lying capsule": Shape(
        lambda b, k: b.add_shape_capsule(
            k, xform=wp.transform(wp.vec3(0.0, 0.0, 0.0), LYING), radius=EDGE, half_height=ALONG - EDGE
        ),
        4.0 / 3.0 * math.pi * EDGE**3 + 2.0 * math.pi * EDGE**2 * (ALONG - EDGE),
        _in_capsule,
    ),
    "prism": Shape(lambda b, k: b.add_shape_mesh(k, mesh=newton.Mesh(PRISM, PRISM_FACES)), 4.0 * EDGE**3, _in_prism),
}


def lift(device: str, spacing: float, shape: Shape, seconds: float) -> tuple[float, int]:
    """Mean lift [N] of a shape that is held, and how many particles there are."""
    builder = make_builder((0.0, 0.0, -G))
    center = np.array([0.0, 0.0, EDGE + shape.over * spacing])
    cells = lattice((-0.5 * WIDTH, -0.5 * WIDTH, 0.0), (0.5 * WIDTH, 0.5 * WIDTH, DEPTH), spacing)
    volume = WIDTH**2 * DEPTH / len(cells)
    cells = cells[np.argsort(-shape.depth(cells - center), kind="stable")[round(shape.volume / volume) :]]
    add_fluid(builder, cells, RHO * volume, RHO * G * (DEPTH - cells[:, 2]))
    body = builder.add_body(xform=wp.transform(wp.vec3(*center), wp.quat_identity()))
    shape.add(builder, body)
    model = builder.finalize(device=device)
    tank = OpenBox(center=(0.0, 0.0, DEPTH), size=(WIDTH, WIDTH, 2.0 * DEPTH))
    solver = SolverSPH(model, SolverSPH.Config(spacing=spacing, speed_of_sound=SOUND), (tank,))
    state = model.state()
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)
    total = wp.zeros(1, dtype=wp.spatial_vector, device=model.device)
    simulate(solver, state, 0.5 * seconds)
    steps = simulate(
        solver, state, 0.5 * seconds, samples=10, after_step=lambda: add_wrench(total, solver.body_wrench, body)
    )
    return float(total.numpy()[0, 2]) / steps, solver.count


def run(device: str, spacing: float, seconds: float = SECONDS, names: tuple[str, ...] = tuple(SHAPES)) -> Measured:
    """Hold each shape."""
    started = time.perf_counter()
    values, particles = {}, 0
    for name in names:
        found, count = lift(device, spacing, SHAPES[name], seconds)
        values[name] = Value.within(found, RHO * G * SHAPES[name].volume, CASE.reach[name], "N")
        particles += count
    at = np.arange(len(values)) + 1.0
    ratio = np.array([value.measured / value.reference for value in values.values()])
    return Measured(
        errors={name: value.percent for name, value in values.items()},
        curves={
            "reference: Archimedes": (at, np.ones(len(at))),
            f"dp = {1e3 * spacing:g} mm": (at, ratio),
        },
        values=values,
        particles=particles,
        simulated_seconds=seconds,
        wall_seconds=time.perf_counter() - started,
    )


CASE = Case(
    name="floor_lift",
    title="Lift of what lies on the floor",
    reference="Archimedes",
    reach=dict.fromkeys(SHAPES, 5.0),
    unit=dict.fromkeys(SHAPES, "%"),
    coarse=(0.02, 0.015),
    fine=(0.01, 0.006),
    run=run,
    axes=("shape, in the table's order", "lift / rho g V"),
)
