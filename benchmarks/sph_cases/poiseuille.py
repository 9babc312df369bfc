"""Flow between two plates, driven by a body force, from rest to its parabola.

Poiseuille's steady profile (Batchelor 1967, section 4.2) is u = F z (H - z) / (2 nu), at most F H^2 / (8 nu).
H = 0.2 m, nu = 1e-3 m^2/s and F = 0.05 m/s^2 make 0.25 m/s, a Reynolds number of 50. From rest the parabola is
approached as exp(-pi^2 nu t / H^2) (Morris, Fox & Zhu 1997, J. Comput. Phys. 136): after 30 s it lacks 0.06 %.

What is compared is the velocity of every particle where it stands at 30 s with the steady parabola there: the root mean
square of the difference over the largest speed of the parabola. There is no free surface, and a background pressure
of rho u_max^2 keeps the particles in their rows; without it the rows break up after some 10 s, and the stirring adds to
the viscosity. Artificial viscosity is off.
"""

from __future__ import annotations

import math
import time

import numpy as np

from benchmarks.sph_cases.case import Case, Measured
from benchmarks.sph_cases.water import add_fluid, lattice, make_builder, simulate
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

RHO, NU, FORCE = 1000.0, 1e-3, 0.05
GAP, LENGTH = 0.2, 0.2
FASTEST = FORCE * GAP**2 / (8.0 * NU)
SOUND = 10.0 * FASTEST
SECONDS = 30.0


def parabola(z: np.ndarray) -> np.ndarray:
    """Steady velocity [m/s] at a height z [m] above the lower plate."""
    return FORCE / (2.0 * NU) * z * (GAP - z)


def run(device: str, spacing: float, seconds: float = SECONDS) -> Measured:
    """Drive the fluid from rest."""
    started = time.perf_counter()
    builder = make_builder((FORCE, 0.0, 0.0))
    position = lattice((0.0, 0.0, 0.0), (LENGTH, 0.0, GAP), spacing, plane=True)
    add_fluid(builder, position, RHO * LENGTH * GAP / len(position))
    model = builder.finalize(device=device)
    plates = OpenBox(center=(0.5 * LENGTH, 0.0, 0.5 * GAP), size=(LENGTH, 1.0, GAP), closed=True)
    config = SolverSPH.Config(
        spacing=spacing,
        rest_density=RHO,
        speed_of_sound=SOUND,
        viscosity=RHO * NU,
        artificial_viscosity=0.0,
        background_pressure=RHO * FASTEST**2,
        dimensions=2,
        periodic=((0.0, LENGTH), None, None),
    )
    solver = SolverSPH(model, config, (plates,))
    state = model.state()
    mean: list[float] = []

    def observe(_: float) -> None:
        mean.append(float(state.particle_qd.numpy()[:, 0].mean()))

    simulate(solver, state, seconds, samples=30, observe=observe)
    z = state.particle_q.numpy()[:, 2].astype(float)
    u = state.particle_qd.numpy().astype(float)
    difference = u[:, 0] - parabola(z)
    rms = math.sqrt(float(np.mean(difference**2)))
    order = np.argsort(z, kind="stable")
    line = np.linspace(0.0, GAP, 101)
    return Measured(
        errors={"velocity rms": 100.0 * rms / FASTEST},
        figures={
            "mean velocity [% off]": 100.0 * (u[:, 0].mean() / (FASTEST * 2.0 / 3.0) - 1.0),
            "largest difference [% of fastest]": 100.0 * float(np.abs(difference).max()) / FASTEST,
            "velocity across, rms [% of fastest]": 100.0 * math.sqrt(float(np.mean(u[:, 2] ** 2))) / FASTEST,
            "change of the mean in the last second [%]": 100.0 * (mean[-1] / mean[-2] - 1.0),
        },
        curves={
            "reference: parabola": (parabola(line), line),
            f"dp = {1e3 * spacing:.4g} mm": (u[order, 0], z[order]),
        },
        particles=solver.count,
        simulated_seconds=seconds,
        wall_seconds=time.perf_counter() - started,
    )


CASE = Case(
    name="poiseuille",
    title="Poiseuille flow from rest, Re = 50",
    reference="u = F z (H - z) / (2 nu)",
    reach={"velocity rms": 0.5},
    unit={"velocity rms": "% of u_max"},
    coarse=(0.01, 0.005),
    fine=(0.0025, 0.00125),
    run=run,
    axes=("velocity [m/s]", "height [m]"),
)
