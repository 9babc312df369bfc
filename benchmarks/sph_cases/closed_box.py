"""A closed box of water adrift in space, with two cubes tumbling in it: momentum and angular momentum.

The box is itself a free body: six slabs, full of water, no gravity. Box, water and cubes push on each other alone, so
that the sums of their momenta and of their angular momenta about the origin must stay. The solver's pair forces are
central and opposite; what remains is the rounding of 32-bit numbers, and how the wrench reaches the bodies.

The bodies are a cube's shell and two cubes, whose inertia is the same about every axis. They tumble as the water
wills, but for such a body MuJoCo's semi-implicit Euler step keeps the angular momentum exactly, as the fluid's own step
does; for others, or with a higher order, it keeps it to the first order of the step, and the error that is measured
would be the rigid solver's. The cubes do not reach each other or a wall; the smallest distance is given.

The errors are the changes of the totals over the sum of the parts' magnitudes at that moment, the largest at any
sample. How much was exchanged (`given by the cubes`) shows that it is no still life.
"""

from __future__ import annotations

import math
import time

import newton
import numpy as np
import warp as wp

from benchmarks.sph_cases.bodies import make_rigid, outside_box
from benchmarks.sph_cases.case import Case, Measured
from benchmarks.sph_cases.water import add_fluid, lattice, make_builder, simulate
from wsim.geometry.rotations import rotate
from wsim.solvers.solver_sph import SolverSPH

RHO = 1000.0
INNER, WALL, CUBE = 0.24, 0.09, 0.06  # the cubes stand on the lattice of every spacing that divides 0.03
SPEED, SPIN = 0.2, 6.0
SOUND = 10.0 * (SPEED + 0.5 * math.sqrt(3.0) * CUBE * SPIN)
SECONDS = 0.5
STARTS = (((-0.06, 0.0, -0.03), (0.0, SPEED, 0.0)), ((0.06, 0.0, 0.03), (0.0, -0.5 * SPEED, 0.3 * SPEED)))


def _add_shell(builder: newton.ModelBuilder) -> None:
    """Six slabs around a cubic hollow, as one body."""
    wood = newton.ModelBuilder.ShapeConfig(density=0.5 * RHO)
    body = builder.add_body(label="box")
    out, mid = 0.5 * INNER + WALL, 0.5 * (INNER + WALL)
    for side in (-1.0, 1.0):
        for at, half in (
            ((side * mid, 0.0, 0.0), (0.5 * WALL, out, out)),
            ((0.0, side * mid, 0.0), (0.5 * INNER, 0.5 * WALL, out)),
            ((0.0, 0.0, side * mid), (0.5 * INNER, 0.5 * INNER, 0.5 * WALL)),
        ):
            place = wp.transform(wp.vec3(*at), wp.quat_identity())
            builder.add_shape_box(body, xform=place, hx=half[0], hy=half[1], hz=half[2], cfg=wood)


def _bodies(state: newton.State, model: newton.Model) -> tuple[np.ndarray, ...]:
    """Momenta, and angular momenta about the origin, each of shape (bodies, 3)."""
    pose, twist = state.body_q.numpy().astype(float), state.body_qd.numpy().astype(float)
    mass, inertia = model.body_mass.numpy().astype(float), model.body_inertia.numpy().astype(float)
    momentum, angular = mass[:, None] * twist[:, :3], np.zeros((len(pose), 3))
    for b, quaternion in enumerate(pose[:, 3:7]):
        axes = rotate(quaternion, np.eye(3)).T  # columns are the body's axes
        center = pose[b, :3] + axes @ model.body_com.numpy()[b]
        angular[b] = np.cross(center, momentum[b]) + axes @ inertia[b] @ axes.T @ twist[b, 3:]
    return momentum, angular


def _clearance(state: newton.State) -> float:
    """Smallest distance of a cube's corners from the walls, and of the cubes' circumscribed spheres [m]."""
    pose = state.body_q.numpy().astype(float)
    x, y, z, w = pose[0, 3:]
    corners = 0.5 * CUBE * np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
    inside = [rotate(np.array([-x, -y, -z, w]), rotate(p[3:], corners) + p[:3] - pose[0, :3]) for p in pose[1:]]
    apart = float(np.linalg.norm(pose[1, :3] - pose[2, :3])) - math.sqrt(3.0) * CUBE
    return min(apart, 0.5 * INNER - float(np.abs(inside).max()))


def run(device: str, spacing: float, seconds: float = SECONDS) -> Measured:
    """Let the cubes loose in the box and add up."""
    started = time.perf_counter()
    builder = make_builder((0.0, 0.0, 0.0))
    _add_shell(builder)
    half = 0.5 * INNER
    cells = lattice((-half,) * 3, (half,) * 3, spacing)
    for at, _ in STARTS:
        cells = cells[outside_box(cells, at, (0.5 * CUBE,) * 3)]
        body = builder.add_body(xform=wp.transform(wp.vec3(*at), wp.quat_identity()))
        cube = newton.ModelBuilder.ShapeConfig(density=2.0 * RHO)
        builder.add_shape_box(body, hx=0.5 * CUBE, hy=0.5 * CUBE, hz=0.5 * CUBE, cfg=cube)
    add_fluid(builder, cells, RHO * spacing**3)
    for body, (_, velocity) in enumerate(STARTS, start=1):
        spin = SPIN / math.sqrt(3.0)
        first = builder.joint_qd_start[body]
        builder.joint_qd[first : first + 6] = [*velocity, spin, -spin, spin]
    model = builder.finalize(device=device)
    background = 5e-3 * RHO * SOUND**2  # holds the water to the walls where it would be pulled off them
    config = SolverSPH.Config(
        spacing=spacing, rest_density=RHO, speed_of_sound=SOUND, viscosity=0.1, background_pressure=background
    )
    solver, rigid = SolverSPH(model, config), make_rigid(model)
    state = model.state()
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)
    mass = model.particle_mass.numpy().astype(float)[:, None]
    rows: list[list[float]] = []

    def observe(t: float) -> None:
        x, v = state.particle_q.numpy().astype(float), state.particle_qd.numpy().astype(float)
        momentum, angular = _bodies(state, model)
        fluid = np.cross(x, mass * v)
        size_p = np.linalg.norm(mass * v, axis=1).sum() + np.linalg.norm(momentum, axis=1).sum()
        size_l = np.linalg.norm(fluid, axis=1).sum() + np.linalg.norm(angular, axis=1).sum()
        total_p, total_l = (mass * v).sum(axis=0) + momentum.sum(axis=0), fluid.sum(axis=0) + angular.sum(axis=0)
        held = np.linalg.norm(momentum[1:], axis=1).sum()
        rows.append([t, *total_p, *total_l, size_p, size_l, _clearance(state), held])

    observe(0.0)
    simulate(solver, state, seconds, samples=round(50 * seconds), observe=observe, rigid=rigid)
    table = np.array(rows)
    linear = np.linalg.norm(table[:, 1:4] - table[0, 1:4], axis=1) / table[:, 7]
    angular = np.linalg.norm(table[:, 4:7] - table[0, 4:7], axis=1) / table[:, 8]
    return Measured(
        errors={"momentum": float(linear.max()), "angular momentum": float(angular.max())},
        figures={
            "given by the cubes [% of their momentum]": 100.0 * (1.0 - table[-1, 10] / table[0, 10]),
            "smallest distance of cubes and walls [mm]": 1e3 * float(table[:, 9].min()),
            "total momentum [kg m/s]": float(np.linalg.norm(table[0, 1:4])),
            "total angular momentum [kg m^2/s]": float(np.linalg.norm(table[0, 4:7])),
        },
        curves={
            f"momentum, dp = {1e3 * spacing:g} mm": (table[:, 0], linear),
            f"angular momentum, dp = {1e3 * spacing:g} mm": (table[:, 0], angular),
        },
        particles=solver.count,
        simulated_seconds=seconds,
        wall_seconds=time.perf_counter() - started,
    )


CASE = Case(
    name="closed_box",
    title="Bodies tumbling in a closed box",
    reference="conservation of momentum and angular momentum",
    reach={"momentum": 1e-5, "angular momentum": 1e-5},
    unit={"momentum": "of the sum of magnitudes", "angular momentum": "of the sum of magnitudes"},
    coarse=(0.03, 0.015),
    fine=(0.015, 0.0075),
    run=run,
    axes=("time [s]", "change of the total / sum of magnitudes"),
)
