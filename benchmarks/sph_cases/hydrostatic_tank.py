"""A tank one metre deep, forty seconds at rest.

Closed form: in equilibrium the floor carries the water, p = m g / A = rho_0 g H whatever the method makes of the
density, dp/dz = -rho g, and nothing moves. SPH codes fall short of it by drifting density, by a pressure that is wrong
near walls, and by motion that never dies (Fourtakas et al. 2019, Computers & Fluids 190, section 4.1).

The flow is two-dimensional: a still tank has no third direction. It starts on a lattice at zero pressure, not at the
hydrostatic one, so that the water first falls into its own weight, rings, and has to find the answer itself.

- bottom pressure: a straight line through the pressures of all fluid particles over their heights, at z = 0, averaged
  over the last half; against m g / A.
- density drift: largest change of the mean density over the last three quarters, as the particles carry it (p / c^2),
  and as the height of the centre of mass tells it, whichever is larger: density that is advanced by the continuity
  equation can part from the room that the particles take.
- kinetic energy: its largest value over the last half, over m g H.
"""

from __future__ import annotations

import math
import time

import numpy as np

from benchmarks.sph_cases.case import Case, Measured
from benchmarks.sph_cases.water import add_fluid, lattice, make_builder, simulate
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

RHO, G = 1000.0, 9.81
DEPTH, WIDTH = 1.0, 0.4
SOUND = 10.0 * math.sqrt(G * DEPTH)  # the water at the floor is 1 % denser than at the surface
SECONDS = 40.0


def run(device: str, spacing: float, seconds: float = SECONDS) -> Measured:
    """Let a column of water come to rest."""
    started = time.perf_counter()
    config = SolverSPH.Config(spacing=spacing, rest_density=RHO, speed_of_sound=SOUND, dimensions=2)
    builder = make_builder((0.0, 0.0, -G))
    cells = lattice((-0.5 * WIDTH, 0.0, 0.0), (0.5 * WIDTH, 0.0, DEPTH), spacing, plane=True)
    add_fluid(builder, cells, RHO * DEPTH * WIDTH / len(cells))
    model = builder.finalize(device=device)
    height = DEPTH + 4.0 * spacing
    tank = OpenBox(center=(0.0, 0.0, 0.5 * height), size=(WIDTH, 1.0, height))
    solver = SolverSPH(model, config, (tank,))
    state = model.state()
    mass = model.particle_mass.numpy().astype(float)
    floor_pressure = mass.sum() * G / WIDTH
    rows: list[tuple[float, ...]] = []

    def observe(t: float) -> None:
        z = state.particle_q.numpy()[:, 2].astype(float)
        pressure = state.sph.pressure.numpy().astype(float)
        speed2 = (state.particle_qd.numpy().astype(float) ** 2).sum(axis=1)
        slope, bottom = np.polyfit(z, pressure, 1)
        rows.append((t, bottom, slope, pressure.mean() / SOUND**2, z.mean(), 0.5 * (mass * speed2).sum()))

    simulate(solver, state, seconds, samples=max(40, round(10 * seconds)), observe=observe)
    t, bottom, slope, density, center, kinetic = np.array(rows).T
    kinetic /= mass.sum() * G * DEPTH
    second_half, settled = t > 0.5 * seconds, t > 0.25 * seconds
    carried = 100.0 * np.ptp(density[settled]) / RHO
    packed = 100.0 * np.ptp(center[settled]) / center[settled][0]
    off = 100.0 * (bottom[second_half].mean() / floor_pressure - 1.0)
    return Measured(
        errors={
            "bottom pressure": abs(off),
            "density drift": max(carried, packed),
            "kinetic energy": float(kinetic[second_half].max()),
        },
        figures={
            "bottom pressure [% off]": off,
            "slope [% off]": 100.0 * (slope[second_half].mean() / (-RHO * G) - 1.0),
            "unrest of bottom pressure [%]": 100.0 * bottom[second_half].std() / floor_pressure,
            "density carried [% change]": carried,
            "centre of mass [% change]": packed,
            # Closed form of the mean compression, g H / (2 c^2) = 0.5 %.
            "mean compression [% of closed form]": 100.0
            * density[second_half].mean()
            / (RHO * G * DEPTH / SOUND**2 / 2),
            "kinetic energy, first second": float(kinetic[t <= 1.0].max()),
            "kinetic energy, last tenth": float(kinetic[t > 0.9 * seconds].max()),
        },
        curves={f"dp = {1e3 * spacing:g} mm": (t, kinetic)},
        particles=solver.count,
        simulated_seconds=seconds,
        wall_seconds=time.perf_counter() - started,
    )


CASE = Case(
    name="hydrostatic_tank",
    title="Tank 1 m deep, 40 s at rest",
    reference="hydrostatics: p = rho g z",
    reach={"bottom pressure": 1.0, "density drift": 0.5, "kinetic energy": 1e-4},
    unit={"bottom pressure": "%", "density drift": "%", "kinetic energy": "m g H"},
    coarse=(0.1, 0.05, 0.025),
    fine=(0.025, 0.0125),
    run=run,
    axes=("time [s]", "kinetic energy / m g H"),
)
