"""A square bucket that turns about its vertical axis: the water's surface is a paraboloid, z = z0 + w^2 r^2 / (2 g).

The bucket is a body of five slabs, led by its pose, 0.3 m wide inside; 0.12 m of water starts with its turn, level,
and has to find the paraboloid by itself: it swings at first. At 5 rad/s the corners are 57 mm above the middle. The
curvature is that of the least-squares fit of h0 + kappa r^2 to the heights over the floor, which the sums of V and
V r^2 give, the mean over the last half of three seconds; a particle is a cube of a spacing in it. `turn` is the water's
angular momentum against that of a solid turn of the same water: what the walls have failed to keep up.
"""

from __future__ import annotations

import math
import time

import newton
import numpy as np
import warp as wp

from benchmarks.sph_cases.case import Case, Measured, Value
from benchmarks.sph_cases.led import Led
from benchmarks.sph_cases.water import add_fluid, lattice, make_builder, simulate, steps_in
from wsim.solvers.solver_sph import SolverSPH

RHO, G, WIDTH, DEPTH, HEIGHT, SPIN, SECONDS = 1000.0, 9.81, 0.3, 0.12, 0.24, 5.0, 3.0
KAPPA = SPIN**2 / (2.0 * G)  # [1/m]
SOUND = 10.0 * math.sqrt(2.0 * G * 2.0 * DEPTH)


def _add_bucket(builder: newton.ModelBuilder, wall: float) -> int:
    """Five slabs; the body's origin is in the middle of the floor's upper face."""
    body = builder.add_body(xform=wp.transform(wp.vec3(0.0, 0.0, 0.0), wp.quat_identity()), is_kinematic=True)
    half, out, mid = 0.5 * WIDTH, 0.5 * WIDTH + wall, 0.5 * (WIDTH + wall)
    slabs = [((0.0, 0.0, -0.5 * wall), (out, out, 0.5 * wall))]
    for side in (-1.0, 1.0):
        slabs.append(((side * mid, 0.0, 0.5 * HEIGHT), (0.5 * wall, out, 0.5 * HEIGHT)))
        slabs.append(((0.0, side * mid, 0.5 * HEIGHT), (half, 0.5 * wall, 0.5 * HEIGHT)))
    for at, size in slabs:
        place = wp.transform(wp.vec3(*at), wp.quat_identity())
        builder.add_shape_box(body, xform=place, hx=size[0], hy=size[1], hz=size[2])
    return body


def curvature(position: np.ndarray, volume: float, spacing: float) -> float:
    """Kappa of the surface h0 + kappa r^2 that fits best over the bucket's floor [1/m]; positions in its frame [m].

    The fit is of heights h(x, y), so that it takes no more than the integrals of h and h r^2. Over a square of width W
    the mean of r^2 is W^2 / 6, and its variance W^4 / 90.
    """
    r2 = (position[:, :2] ** 2).sum(axis=1) + spacing**2 / 6.0
    return float(volume * (r2 - WIDTH**2 / 6.0).sum() / (WIDTH**2 * WIDTH**4 / 90.0))


def run(device: str, spacing: float, seconds: float = SECONDS) -> Measured:
    """Turn the bucket."""
    started = time.perf_counter()
    builder = make_builder((0.0, 0.0, -G))
    half = 0.5 * WIDTH
    cells = lattice((-half, -half, 0.0), (half, half, DEPTH), spacing)
    volume = WIDTH**2 * DEPTH / len(cells)
    velocity = np.stack([-SPIN * cells[:, 1], SPIN * cells[:, 0], np.zeros(len(cells))], axis=1)
    add_fluid(builder, cells, RHO * volume, RHO * G * (DEPTH - cells[:, 2]), velocity)
    body = _add_bucket(builder, 3.0 * spacing)
    model = builder.finalize(device=device)
    model.body_com.zero_()
    solver = SolverSPH(model, SolverSPH.Config(spacing=spacing, speed_of_sound=SOUND))
    state = model.state()
    samples = round(40 * seconds)
    steps, dt = steps_in(solver, seconds, samples)
    angle = SPIN * np.arange(steps * samples) * dt
    still = np.zeros((len(angle), 3))
    turned = np.stack([0.0 * angle, 0.0 * angle, np.sin(0.5 * angle), np.cos(0.5 * angle)], axis=1)
    led = Led(state, body, still, still, turned, np.tile([0.0, 0.0, SPIN], (len(angle), 1)))
    rows: list[tuple[float, float, float]] = []

    def observe(t: float) -> None:
        q, v = state.particle_q.numpy().astype(float), state.particle_qd.numpy().astype(float)
        cos, sin = math.cos(SPIN * t), math.sin(SPIN * t)
        own = np.stack([cos * q[:, 0] + sin * q[:, 1], cos * q[:, 1] - sin * q[:, 0]], axis=1)
        solid = SPIN * (q[:, 0] ** 2 + q[:, 1] ** 2).sum()
        turn = float((q[:, 0] * v[:, 1] - q[:, 1] * v[:, 0]).sum() / solid)
        rows.append((t, curvature(own, volume, spacing), turn))

    simulate(solver, state, seconds, samples, observe, before_step=led.move)
    t, kappa, turn = np.array(rows).T
    late = t > 0.5 * seconds
    bend = Value.within(float(kappa[late].mean()), KAPPA, CASE.reach["curvature"], "1/m")
    whole = Value.within(float(turn[late].mean()), 1.0, CASE.reach["turn"], "of a solid turn")
    inside = state.particle_q.numpy()[:, 2] > -0.5 * spacing
    return Measured(
        errors={"curvature": bend.percent, "turn": whole.percent},
        figures={
            "curvature [% off]": 100.0 * (bend.measured / KAPPA - 1.0),
            "unrest of the curvature [% of it]": 100.0 * float(kappa[late].std()) / KAPPA,
            "water below the floor [particles]": int((~inside).sum()),
        },
        curves={
            "reference: w^2 / 2 g": (t[[0, -1]], np.full(2, KAPPA)),
            f"dp = {1e3 * spacing:g} mm": (t, kappa),
        },
        values={"curvature": bend, "turn": whole},
        particles=solver.count,
        simulated_seconds=seconds,
        wall_seconds=time.perf_counter() - started,
    )


CASE = Case(
    name="rotating_bucket",
    title="A bucket turns: the paraboloid",
    reference="closed form: w^2 / 2 g",
    reach={"curvature": 5.0, "turn": 5.0},
    unit={"curvature": "%", "turn": "%"},
    coarse=(0.02, 0.015),
    fine=(0.01, 0.005),
    run=run,
    axes=("time [s]", "curvature of the surface [1/m]"),
)
