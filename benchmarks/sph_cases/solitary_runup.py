"""A solitary wave runs up a slope of 20 degrees: Synolakis (1987), J. Fluid Mech. 185, 523-545.

A wave of height H on water of depth d that does not break has a run-up of R / d = 2.831 sqrt(cot beta) (H / d)^(5/4),
for which H / d must be below 0.82 cot(beta)^(-10/9) = 0.267; it is 0.2 here, on 0.2 m of water: R = 0.126 m. The tongue
ends within a spacing, which is 8 % and 4 % of that on a CPU; reach is 10 %.

It starts with Boussinesq's (1872) profile, eta = H sech^2(sqrt(3 H / 4 d^3) (x - x0)), and speed, c^2 = g (d + H),
u = c eta / (d + eta) over the whole depth, w such that nothing is compressed. The run-up is the height over the calm
level of the highest particle within two spacings of the slope, and half a spacing. Beside it the speed is measured: of
the crest, from two to seven depths past where it started.
"""

from __future__ import annotations

import math
import time

import numpy as np
import warp as wp

from benchmarks.sph_cases.case import Case, Measured, Value
from benchmarks.sph_cases.water import add_fluid, lattice, make_builder, simulate
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

RHO, G, DEPTH, HEIGHT = 1000.0, 9.81, 0.2, 0.04
SLOPE = math.radians(20.0)
RUN_UP = DEPTH * 2.831 * math.sqrt(1.0 / math.tan(SLOPE)) * (HEIGHT / DEPTH) ** 1.25
DECAY = math.sqrt(0.75 * HEIGHT / DEPTH**3)
SPEED = math.sqrt(G * (DEPTH + HEIGHT))
START, TOE, LENGTH = 7.0 * DEPTH, 15.0 * DEPTH, 19.5 * DEPTH
SECONDS = (TOE - START) / SPEED + 1.4
SOUND = 10.0 * math.sqrt(2.0 * G * (DEPTH + HEIGHT))  # of water that runs down again from twice the height


def elevation(x: np.ndarray) -> np.ndarray:
    """Over the calm level at the start [m]."""
    return HEIGHT / np.cosh(DECAY * (x - START)) ** 2


def _water(spacing: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions, velocities and pressures of the wave, above the slope."""
    cells = lattice((0.0, 0.0, 0.0), (LENGTH, 0.0, math.ceil(0.3 / spacing) * spacing), spacing, plane=True)
    x, z = cells[:, 0], cells[:, 2]
    over = (z * math.cos(SLOPE) - (x - TOE) * math.sin(SLOPE)) > 0.45 * spacing
    cells = cells[(z < DEPTH + elevation(x)) & ((x < TOE) | over)]
    x, z = cells[:, 0], cells[:, 2]
    eta = elevation(x)
    velocity = np.zeros_like(cells)
    velocity[:, 0] = SPEED * eta / (DEPTH + eta)
    # du / dx = c d eta' / (d + eta)^2, and w = -z du / dx.
    slope = -2.0 * DECAY * eta * np.tanh(DECAY * (x - START))
    velocity[:, 2] = -z * SPEED * DEPTH * slope / (DEPTH + eta) ** 2
    return cells, velocity, RHO * G * (DEPTH + eta - z)


def run(device: str, spacing: float) -> Measured:
    """Let the wave run up."""
    started = time.perf_counter()
    builder = make_builder((0.0, 0.0, -G))
    cells, velocity, pressure = _water(spacing)
    add_fluid(builder, cells, RHO * spacing**2, pressure, velocity)
    half, thick = 0.65, 3.0 * spacing
    turn = wp.quat_from_axis_angle(wp.vec3(0.0, 1.0, 0.0), -SLOPE)
    # The middle of the slab whose upper face starts at the toe.
    x = TOE + half * math.cos(SLOPE) + thick * math.sin(SLOPE)
    z = half * math.sin(SLOPE) - thick * math.cos(SLOPE)
    builder.add_shape_box(-1, xform=wp.transform(wp.vec3(x, 0.0, z), turn), hx=half, hy=0.5, hz=thick)
    model = builder.finalize(device=device)
    long = TOE + 2.0 * half
    tank = OpenBox(center=(0.5 * long, 0.0, 0.25), size=(long, 1.0, 0.5))
    solver = SolverSPH(model, SolverSPH.Config(spacing=spacing, speed_of_sound=SOUND, dimensions=2), (tank,))
    state = model.state()
    rows: list[tuple[float, float, float]] = []
    bins = np.arange(0.0, TOE, 0.1 * DEPTH)

    def observe(t: float) -> None:
        q = state.particle_q.numpy().astype(float)
        out = q[:, 2] * math.cos(SLOPE) - (q[:, 0] - TOE) * math.sin(SLOPE)
        on_slope = (q[:, 0] > TOE) & (out < 2.0 * spacing)
        highest = float(q[on_slope, 2].max()) + 0.5 * spacing - DEPTH if on_slope.any() else 0.0
        column, _ = np.histogram(q[:, 0], bins)
        smooth = np.convolve(column, np.hanning(17), "same")
        k = int(np.clip(smooth.argmax(), 1, len(smooth) - 2))
        a, b, _ = np.polyfit([-1.0, 0.0, 1.0], smooth[k - 1 : k + 2], 2)
        rows.append((t, highest, bins[k] + 0.05 * DEPTH - 0.05 * DEPTH * b / a))

    simulate(solver, state, SECONDS, samples=round(100 * SECONDS), observe=observe)
    t, highest, crest = np.array(rows).T
    run_up = Value.within(1e3 * float(highest.max()), 1e3 * RUN_UP, CASE.reach["run-up"], "mm")
    runs = (crest > START + 2.0 * DEPTH) & (crest < START + 7.0 * DEPTH) & (t < 8.0 * DEPTH / SPEED)
    speed = Value.within(float(np.polyfit(t[runs], crest[runs], 1)[0]), SPEED, CASE.reach["speed"], "m/s")
    return Measured(
        errors={"run-up": run_up.percent, "speed": speed.percent},
        figures={
            "run-up [% off]": 100.0 * (run_up.measured / run_up.reference - 1.0),
            "run-up at [s]": float(t[highest.argmax()]),
            "spacing [% of the run-up]": 100.0 * spacing / RUN_UP,
        },
        curves={
            "reference: Synolakis's law": (t[[0, -1]], np.full(2, 1e3 * RUN_UP)),
            f"dp = {1e3 * spacing:g} mm": (t, 1e3 * highest),
        },
        values={"run-up": run_up, "speed": speed},
        particles=solver.count,
        simulated_seconds=SECONDS,
        wall_seconds=time.perf_counter() - started,
    )


CASE = Case(
    name="solitary_runup",
    title="A solitary wave on a slope of 20 degrees, H / d = 0.2",
    reference="Synolakis (1987)",
    reach={"run-up": 10.0, "speed": 3.0},
    unit={"run-up": "%", "speed": "%"},
    coarse=(0.01, 0.005),
    fine=(0.0025, 0.00125),
    run=run,
    axes=("time [s]", "run-up over the calm level [mm]"),
)
