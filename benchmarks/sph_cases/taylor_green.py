"""Decay of Taylor & Green's vortices in a periodic square (Taylor 1923; Taylor & Green 1937).

u = -U e cos(2 pi x / L) sin(2 pi z / L), w = U e sin(2 pi x / L) cos(2 pi z / L) with e = exp(-8 pi^2 nu t / L^2)
solves the Navier-Stokes equations exactly; the pressure is -rho U^2 e^2 / 4 (cos(4 pi x / L) + cos(4 pi z / L)).
L = 1 m, U = 1 m/s and nu = 0.01 m^2/s: Re = 100.

The rate is half that of a straight line through the logarithm of the kinetic energy of all particles, noise included,
from the start until the exact energy has fallen to a tenth (1.46 s).

The particles start up to a fifth of a spacing off a lattice, at random (a fixed seed). From the bare lattice they flow
in files that pile up at the stagnation points, until the lattice collapses; half of the energy is lost in that, and the
rate is 40 % too high: a property of the start, not of the flow (Colagrossi et al. 2012, Comput. Phys. Commun. 183).

The pressure falls rho U^2 / 2 below its mean, and fluid under tension clumps and leaves voids. BACKGROUND is what that
takes. The rate depends on it, as the noise of the background pressure on disordered particles stirs the fluid: at 20 mm
it is 1.6 % too high with rho U^2 / 2, 3.2 % with rho U^2. Artificial viscosity is off.
"""

from __future__ import annotations

import math
import time

import numpy as np
from scipy.spatial import cKDTree

from benchmarks.sph_cases.case import Case, Measured
from benchmarks.sph_cases.water import add_fluid, lattice, make_builder, simulate
from wsim.solvers.solver_sph import SolverSPH

RHO, NU, SPEED = 1000.0, 0.01, 1.0
WAVE = 2.0 * math.pi  # 2 pi / L, L = 1 m
RATE = 2.0 * WAVE**2 * NU
SECONDS = math.log(10.0) / (2.0 * RATE)
SOUND = 10.0 * SPEED
BACKGROUND = 0.5 * RHO * SPEED**2
SEED = 0


def vortices(position: np.ndarray) -> np.ndarray:
    """Velocity at the start [m/s], shape (n, 3)."""
    x, z = WAVE * position[:, 0], WAVE * position[:, 2]
    return SPEED * np.stack([-np.cos(x) * np.sin(z), np.zeros_like(x), np.sin(x) * np.cos(z)], axis=1)


def run(device: str, spacing: float, background: float = BACKGROUND) -> Measured:
    """Let the vortices decay."""
    started = time.perf_counter()
    builder = make_builder((0.0, 0.0, 0.0))
    position = lattice((0.0, 0.0, 0.0), (1.0, 0.0, 1.0), spacing, plane=True)
    position[:, [0, 2]] += np.random.default_rng(SEED).uniform(-0.2, 0.2, (len(position), 2)) * spacing
    x, z = 2.0 * WAVE * position[:, 0], 2.0 * WAVE * position[:, 2]
    pressure = -0.25 * RHO * SPEED**2 * (np.cos(x) + np.cos(z))
    add_fluid(builder, position, RHO / len(position), pressure, vortices(position))
    model = builder.finalize(device=device)
    model.set_gravity((0.0, 0.0, 0.0))
    config = SolverSPH.Config(
        spacing=spacing,
        rest_density=RHO,
        speed_of_sound=SOUND,
        viscosity=RHO * NU,
        artificial_viscosity=0.0,
        background_pressure=background,
        dimensions=2,
        periodic=((0.0, 1.0), None, (0.0, 1.0)),
    )
    solver = SolverSPH(model, config)
    state = model.state()
    rows = [(0.0, 0.25 * SPEED**2, 1.0)]

    def observe(t: float) -> None:
        v = state.particle_qd.numpy().astype(float)
        shape = vortices(state.particle_q.numpy().astype(float))
        rows.append((t, 0.5 * float(np.mean((v**2).sum(axis=1))), float((v * shape).sum() / (shape**2).sum())))

    simulate(solver, state, SECONDS, samples=50, observe=observe)
    t, energy, mode = np.array(rows).T
    rate = -0.5 * float(np.polyfit(t, np.log(energy), 1)[0])
    off = 100.0 * (rate / RATE - 1.0)
    q = state.particle_q.numpy()[:, [0, 2]].astype(float) % 1.0
    nearest = cKDTree(q, boxsize=1.0)
    holes = nearest.query(np.random.default_rng(SEED).random((20 * len(q), 2)))[0]
    return Measured(
        errors={"decay rate": abs(off)},
        figures={
            "decay rate [1/s]": rate,
            "decay rate [% off]": off,
            "decay rate of the mode alone [% off]": 100.0 * (-float(np.polyfit(t, np.log(mode), 1)[0]) / RATE - 1.0),
            "energy at the end [% off]": 100.0 * (energy[-1] / (energy[0] * math.exp(-2.0 * RATE * t[-1])) - 1.0),
            "closest pair at the end [spacings]": float(nearest.query(q, k=2)[0][:, 1].min()) / spacing,
            "farthest from any particle at the end [spacings]": float(holes.max()) / spacing,  # 0.71 on a lattice
        },
        curves={
            "reference: exact": (t, energy[0] * np.exp(-2.0 * RATE * t)),
            f"dp = {1e3 * spacing:.4g} mm": (t, energy),
        },
        particles=solver.count,
        simulated_seconds=SECONDS,
        wall_seconds=time.perf_counter() - started,
    )


CASE = Case(
    name="taylor_green",
    title="Taylor-Green vortices, Re = 100",
    reference="u ~ exp(-8 pi^2 nu t / L^2)",
    reach={"decay rate": 3.0},
    unit={"decay rate": "%"},
    coarse=(0.04, 0.02),
    fine=(0.005, 0.0025),
    run=run,
    axes=("time [s]", "kinetic energy / mass [J/kg]"),
)
