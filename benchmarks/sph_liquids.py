"""What several liquids, and one that yields, cost: seconds of processor time a step of the SPH solver, in a full tank.

.venv/bin/python benchmarks/sph_liquids.py
"""

from __future__ import annotations

import time

import newton
import numpy as np
import warp as wp

from wsim.geometry.filled import box_lattice
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

SPACING, EDGE, STEPS, ROUNDS = 0.015, 0.24, 8, 6
KINDS: dict[str, dict[str, float]] = {
    "one liquid": {},
    "two liquids": {"liquid_density": 900.0, "liquid_viscosity": 0.05},
    "one of them yields": {"liquid_density": 900.0, "liquid_viscosity": 0.05, "yield_stress": 50.0},
}


def measure(told: dict[str, float]) -> tuple[SolverSPH, float]:
    """A solver whose upper half is of a liquid with these numbers, and the least time of a step [s]."""
    builder = newton.ModelBuilder(up_axis=newton.Axis.Z)
    SolverSPH.register_custom_attributes(builder, several_liquids=bool(told))
    cells = box_lattice(np.array([EDGE] * 3), SPACING)
    position = cells.position + np.array([0.0, 0.0, 0.5 * EDGE])
    upper, density = position[:, 2] > 0.5 * EDGE, told.get("liquid_density", 1000.0)
    builder.add_particles(
        pos=position.tolist(),
        vel=[(0.0, 0.0, 0.0)] * len(position),
        mass=(np.where(upper, density, 1000.0) * cells.volume).tolist(),
        custom_attributes={f"sph:{name}": np.where(upper, value, 0.0).tolist() for name, value in told.items()},
    )
    config = SolverSPH.Config(spacing=SPACING, speed_of_sound=15.0)
    solver = SolverSPH(builder.finalize(), config, (OpenBox((0.0, 0.0, 0.3), (EDGE, EDGE, 0.6)),))
    state, times = solver.model.state(), []
    for _ in range(ROUNDS + 1):
        wp.synchronize()
        start = time.process_time()
        for _ in range(STEPS):
            solver.step(state, state, None, None, 0.5 * config.max_time_step)
        wp.synchronize()
        times.append((time.process_time() - start) / STEPS)
    return solver, min(times[1:])


def main() -> None:
    """Print a line for each."""
    for name, told in KINDS.items():
        solver, seconds = measure(told)
        print(f"{name}: {solver.fluid_count} particles and {solver.wall_count} of walls, {1e3 * seconds:.2f} ms a step")


if __name__ == "__main__":
    main()
