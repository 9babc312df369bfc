"""A standing wave, one wave length long, in a tank 2 m long and 1 m deep.

Linear potential theory (Lamb 1932, Hydrodynamics, section 228): the surface eta = A sin(omega t) cos(k x) goes with
u = -A omega cosh(k z) / sinh(k h) cos(omega t) sin(k x) and w = A omega sinh(k z) / sinh(k h) cos(omega t) cos(k x),
z from the floor, and omega^2 = g k tanh(k h). With k = pi / m and h = 1 m the period is 1.1339 s.

The wave starts flat, at its largest velocity: the lattice then needs no bending, and the hydrostatic pressure is the
exact one. A = 2 cm makes k A = 0.06; the frequency's first correction by amplitude is of the order (k A)^2 / 8, 0.05 %.

The period comes from a least squares fit of a damped cosine, with an offset and a drift, to the moment
sum m z cos(k x) of all particles, which to first order is the amplitude of this one mode, over six periods.
"""

from __future__ import annotations

import math
import time

import numpy as np
from scipy.optimize import curve_fit

from benchmarks.sph_cases.case import Case, Measured
from benchmarks.sph_cases.water import add_fluid, lattice, make_builder, simulate
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

RHO, G = 1000.0, 9.81
LENGTH, DEPTH, AMPLITUDE = 2.0, 1.0, 0.02
K = math.pi
OMEGA = math.sqrt(G * K * math.tanh(K * DEPTH))
PERIOD = 2.0 * math.pi / OMEGA
PERIODS = 6
SOUND = 10.0 * math.sqrt(G * DEPTH)  # the water at the floor is 1 % denser than at the surface


def damped(
    t: np.ndarray, size: float, rate: float, omega: float, phase: float, offset: float, drift: float
) -> np.ndarray:
    """What is fitted: a damped cosine on a straight line."""
    return size * np.exp(-rate * t) * np.cos(omega * t + phase) + offset + drift * t


def fit_swing(t: np.ndarray, elevation: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Parameters of `damped` that fit an elevation [m] over time [s], and their covariance."""
    guess = (AMPLITUDE, 0.05, OMEGA, -0.5 * math.pi, 0.0, 0.0)
    return curve_fit(damped, t, elevation, guess)


def run(device: str, spacing: float, periods: float = PERIODS) -> Measured:
    """Let the wave swing."""
    started = time.perf_counter()
    builder = make_builder((0.0, 0.0, -G))
    position = lattice((0.0, 0.0, 0.0), (LENGTH, 0.0, DEPTH), spacing, plane=True)
    x, z = position[:, 0], position[:, 2]
    velocity = np.zeros_like(position)
    velocity[:, 0] = -AMPLITUDE * OMEGA * np.cosh(K * z) / math.sinh(K * DEPTH) * np.sin(K * x)
    velocity[:, 2] = AMPLITUDE * OMEGA * np.sinh(K * z) / math.sinh(K * DEPTH) * np.cos(K * x)
    add_fluid(builder, position, RHO * LENGTH * DEPTH / len(position), RHO * G * (DEPTH - z), velocity)
    model = builder.finalize(device=device)
    height = DEPTH + 4.0 * math.ceil(AMPLITUDE / spacing) * spacing
    tank = OpenBox(center=(0.5 * LENGTH, 0.0, 0.5 * height), size=(LENGTH, 1.0, height))
    config = SolverSPH.Config(
        spacing=spacing,
        rest_density=RHO,
        speed_of_sound=SOUND,
        dimensions=2,
    )
    solver = SolverSPH(model, config, (tank,))
    state = model.state()
    rows: list[tuple[float, float]] = []

    def observe(t: float) -> None:
        q = state.particle_q.numpy().astype(float)
        # sum m z cos(k x) over rho L / 2 is eta's amplitude: eta = A sin(omega t) cos(k x).
        rows.append((t, 2.0 * DEPTH * float(np.mean(q[:, 2] * np.cos(K * q[:, 0])))))

    simulate(solver, state, periods * PERIOD, samples=math.ceil(40 * periods), observe=observe)
    t, elevation = np.array(rows).T
    fit, covariance = fit_swing(t, elevation)
    size, rate, omega = fit[0], fit[1], fit[2]
    residual = elevation - damped(t, *fit)
    period = 2.0 * math.pi / omega
    off = 100.0 * (period / PERIOD - 1.0)
    return Measured(
        errors={"period": abs(off)},
        figures={
            "period [s]": period,
            "period [% off]": off,
            "uncertainty of the fit [%]": 100.0 * math.sqrt(covariance[2, 2]) / omega,
            "amplitude [% of theory]": 100.0 * size / AMPLITUDE,
            "damping rate [1/s]": rate,
            "residual rms [% of amplitude]": 100.0 * float(residual.std()) / AMPLITUDE,
        },
        curves={
            "reference: linear theory, no damping": (t, 1e3 * AMPLITUDE * np.sin(OMEGA * t)),
            f"dp = {1e3 * spacing:.4g} mm": (t, 1e3 * elevation),
        },
        particles=solver.count,
        simulated_seconds=periods * PERIOD,
        wall_seconds=time.perf_counter() - started,
    )


CASE = Case(
    name="standing_wave",
    title="Standing wave, 2 m long, 1 m deep",
    reference="linear theory: T = 1.1339 s",
    reach={"period": 1.0},
    unit={"period": "%"},
    coarse=(0.05, 0.025),
    fine=(0.01, 0.005),
    run=run,
    axes=("time [s]", "amplitude of the mode [mm]"),
)
