"""A cylinder enters calm water on its side at constant speed: Campbell & Weynberg (1980).

The fit to their measurements that DNV-RP-C205 (section 8.6) recommends is F = 1/2 rho C D V^2 a metre, C = 5.15 (D /
(D + 19 s) + 0.107 s / D), s the depth of the lowest point below the calm level. (Wagner's theory has 2 pi at s = 0,
von Karman's pi.) What is compared is the impulse from s = 0.02 D to 0.25 D: a peak is over before s is a particle.
Records of slamming scatter by more than a tenth; reach is 15 %.

A disc of 0.4 m sinks at 2 m/s, from where it touches the water; its walls are as far off as eight diameters are wide.
Gravity is left out, as V^2 / g D is large in what was measured, and so is what lifts the disc: rho g A is another
force.
"""

from __future__ import annotations

import math
import time

import numpy as np
import warp as wp

from benchmarks.sph_cases.case import Case, Measured, Value
from benchmarks.sph_cases.led import Led, add_wrench
from benchmarks.sph_cases.water import add_fluid, lattice, make_builder, simulate, steps_in
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

RHO, SPEED, DIAMETER = 1000.0, 2.0, 0.4
WIDTH, DEPTH = 8.0 * DIAMETER, 3.0 * DIAMETER
FIRST, LAST = 0.02, 0.25  # [diameters]
SECONDS = LAST * DIAMETER / SPEED
SOUND = 180.0 * SPEED


def coefficient(depth: np.ndarray) -> np.ndarray:
    """Campbell & Weynberg's, by the depth in diameters."""
    return 5.15 * (1.0 / (1.0 + 19.0 * depth) + 0.107 * depth)


def run(device: str, spacing: float) -> Measured:
    """Sink the disc."""
    started = time.perf_counter()
    builder = make_builder((0.0, 0.0, 0.0))
    cells = lattice((-0.5 * WIDTH, 0.0, -DEPTH), (0.5 * WIDTH, 0.0, 0.0), spacing, plane=True)
    add_fluid(builder, cells, RHO * WIDTH * DEPTH / len(cells))
    start = np.array([0.0, 0.0, 0.5 * DIAMETER])
    body = builder.add_body(xform=wp.transform(wp.vec3(*start), wp.quat_identity()))
    across = wp.transform(wp.vec3(), wp.quat_from_axis_angle(wp.vec3(1.0, 0.0, 0.0), 0.5 * math.pi))
    builder.add_shape_cylinder(body, xform=across, radius=0.5 * DIAMETER, half_height=0.5)
    model = builder.finalize(device=device)
    model.set_gravity((0.0, 0.0, 0.0))
    pool = OpenBox(center=(0.0, 0.0, 0.5 * (DIAMETER - DEPTH)), size=(WIDTH, 1.0, DEPTH + DIAMETER))
    solver = SolverSPH(model, SolverSPH.Config(spacing=spacing, speed_of_sound=SOUND, dimensions=2), (pool,))
    state = model.state()
    samples = 200
    steps, dt = steps_in(solver, SECONDS, samples)
    at, down = np.arange(steps * samples) * dt, np.array([0.0, 0.0, -SPEED])
    led = Led(state, body, start + at[:, None] * down, np.tile(down, (len(at), 1)))
    total = wp.zeros(1, dtype=wp.spatial_vector, device=model.device)
    rows: list[tuple[float, float]] = []

    def observe(t: float) -> None:
        rows.append((t - 0.5 * steps * dt, float(total.numpy()[0, 2]) / steps))
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
    deep, measured = SPEED * t / DIAMETER, force / (0.5 * RHO * DIAMETER * SPEED**2)
    counts = deep > FIRST
    mean = Value.within(
        float(measured[counts].mean()), float(coefficient(deep[counts]).mean()), CASE.reach["impulse"], "in the mean"
    )
    smooth = np.convolve(measured, np.ones(5) / 5.0, "same")
    return Measured(
        errors={"impulse": mean.percent},
        figures={
            "impulse [% off]": 100.0 * (mean.measured / mean.reference - 1.0),
            "largest C, over a fortieth of the time": float(smooth[2:-2].max()),
            "largest C at a depth of [diameters]": float(deep[2:-2][smooth[2:-2].argmax()]),
            "C at the end": float(measured[-20:].mean()),
            "C at the end, measured by Campbell & Weynberg": float(coefficient(deep[-20:]).mean()),
        },
        curves={
            "reference: Campbell & Weynberg": (deep, coefficient(deep)),
            f"dp = {1e3 * spacing:g} mm": (deep[2:-2], smooth[2:-2]),
        },
        values={"impulse": mean},
        particles=solver.count,
        simulated_seconds=SECONDS,
        wall_seconds=time.perf_counter() - started,
    )


CASE = Case(
    name="cylinder_entry",
    title="A cylinder enters water on its side",
    reference="Campbell & Weynberg (1980)",
    reach={"impulse": 15.0},
    unit={"impulse": "%"},
    coarse=(0.04, 0.02, DIAMETER / 30),
    fine=(0.005, 0.0025),
    run=run,
    axes=("depth of the lowest point / diameter", "C = F / (rho D V^2 / 2)"),
)
