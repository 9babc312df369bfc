"""A wedge of 30 degrees of deadrise goes into calm water at constant speed: Zhao & Faltinsen (1993).

J. Fluid Mech. 246, 593-612, table 1: the similarity solution of Dobrovol'skaya (1969, J. Fluid Mech. 36, 805-829),
without gravity, has a force of 14.139 rho V^3 t a metre of depth. (Wagner's theory of small angles gives
pi^3 / (4 tan^2 beta) = 23.3.)

The wedge is two turned boxes, sunk from where its tip touches the water to 0.15 m at 1 m/s; the wetted width at the end
is 0.74 m. The force is the slope of a line through the origin, force over time, fitted to the second half. The pool is
4.8 m wide and 1.6 m deep: in one half as wide and deep it was 16 % larger. Sound at 180 V crosses it in 9 ms; at 60 V,
ten times the speed of the jet, the pool swung as a whole and the force by 35 %.
"""

from __future__ import annotations

import math
import time

import newton
import numpy as np
import warp as wp

from benchmarks.sph_cases.case import Case, Measured, Value
from benchmarks.sph_cases.led import Led, add_wrench
from benchmarks.sph_cases.water import add_fluid, lattice, make_builder, simulate, steps_in
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

RHO, SPEED, DEADRISE = 1000.0, 1.0, math.radians(30.0)
FORCE = 14.139  # [rho V^3 t]
WIDTH, DEPTH, FACE, SECONDS = 4.8, 1.6, 0.7, 0.15
SOUND = 180.0 * SPEED


def _add_wedge(builder: newton.ModelBuilder, spacing: float) -> int:
    """Two slabs whose lower faces meet in the body's origin."""
    body = builder.add_body(xform=wp.transform(wp.vec3(0.0, 0.0, 0.0), wp.quat_identity()))
    half = 2.5 * spacing
    for side in (-1.0, 1.0):
        # About y a positive angle turns x down: the right face rises to the right.
        turn = wp.quat_from_axis_angle(wp.vec3(0.0, 1.0, 0.0), -side * DEADRISE)
        along = np.array([side * math.cos(DEADRISE), math.sin(DEADRISE)])
        out = np.array([-side * math.sin(DEADRISE), math.cos(DEADRISE)])
        x, z = 0.5 * FACE * along + half * out
        place = wp.transform(wp.vec3(float(x), 0.0, float(z)), turn)
        builder.add_shape_box(body, xform=place, hx=0.5 * FACE, hy=0.5, hz=half)
    return body


def run(device: str, spacing: float) -> Measured:
    """Sink the wedge."""
    started = time.perf_counter()
    builder = make_builder((0.0, 0.0, 0.0))
    cells = lattice((-0.5 * WIDTH, 0.0, -DEPTH), (0.5 * WIDTH, 0.0, 0.0), spacing, plane=True)
    add_fluid(builder, cells, RHO * WIDTH * DEPTH / len(cells))
    body = _add_wedge(builder, spacing)
    model = builder.finalize(device=device)
    model.set_gravity((0.0, 0.0, 0.0))
    model.body_com.zero_()
    pool = OpenBox(center=(0.0, 0.0, -0.5 * DEPTH + 0.4), size=(WIDTH, 1.0, DEPTH + 0.8))
    solver = SolverSPH(model, SolverSPH.Config(spacing=spacing, speed_of_sound=SOUND, dimensions=2), (pool,))
    state = model.state()
    samples = 150
    steps, dt = steps_in(solver, SECONDS, samples)
    at = np.arange(steps * samples) * dt
    down = np.array([0.0, 0.0, -SPEED])
    led = Led(state, body, at[:, None] * down, np.tile(down, (len(at), 1)))
    total = wp.zeros(1, dtype=wp.spatial_vector, device=model.device)
    rows: list[tuple[float, float]] = []

    def observe(t: float) -> None:
        rows.append((t, float(total.numpy()[0, 2]) / steps))
        total.zero_()

    simulate(
        solver,
        state,
        SECONDS,
        samples,
        observe,
        before_step=led.move,
        after_step=lambda: add_wrench(total, solver.body_wrench, body),
    )
    t, force = np.array(rows).T
    late = t > 0.5 * SECONDS
    slope = float((force * t)[late].sum() / (t * t)[late].sum()) / (RHO * SPEED**3)
    value = Value.within(slope, FORCE, CASE.reach["force"], "rho V^3 t")
    smooth = np.convolve(force, np.ones(9) / 9.0, "same")
    return Measured(
        errors={"force": value.percent},
        figures={
            "force [% off]": 100.0 * (slope / FORCE - 1.0),
            "unrest of the force in the second half [% of it]": 100.0
            * float((force - slope * RHO * SPEED**3 * t)[late].std())
            / float(force[late].mean()),
        },
        curves={
            "reference: similarity solution": (t[[0, -1]], FORCE * RHO * SPEED**3 * t[[0, -1]]),
            f"dp = {1e3 * spacing:g} mm": (t[4:-4], smooth[4:-4]),
        },
        values={"force": value},
        particles=solver.count,
        simulated_seconds=SECONDS,
        wall_seconds=time.perf_counter() - started,
    )


CASE = Case(
    name="wedge_entry",
    title="A wedge of 30 degrees enters water",
    reference="Zhao & Faltinsen (1993), similarity solution",
    reach={"force": 5.0},
    unit={"force": "%"},
    coarse=(0.02, 0.01),
    fine=(0.005, 0.0025),
    run=run,
    axes=("time [s]", "force [N/m]"),
)
