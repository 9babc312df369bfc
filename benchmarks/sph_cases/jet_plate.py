"""A jet hits a plate at right angles: the force is the momentum that it brings, rho b v^2 a metre of depth.

A block of water 0.1 m thick and 1.2 m long flies at 1 m/s, without gravity, against a plate 1.2 m wide that stands
still. Potential flow of a free jet (Milne-Thomson, Theoretical Hydrodynamics, 11.4) turns it along the plate, where it
thins out to half its thickness on either side; where all of it has turned, the force is what it brought. Six
thicknesses to a side it is turned but for a thousandth.

The force is the mean from four to ten b / v after the jet's face is at the plate: the blow of the face, which is flat,
is over then, and the end of the block still 2 b away.
"""

from __future__ import annotations

import time

import numpy as np
import warp as wp

from benchmarks.sph_cases.case import Case, Measured, Value
from benchmarks.sph_cases.water import add_fluid, lattice, make_builder, simulate, steps_in
from wsim.solvers.solver_sph import SolverSPH

RHO, SPEED, THICK, LENGTH, PLATE = 1000.0, 1.0, 0.1, 1.2, 1.2
SOUND = 10.0 * SPEED
FORCE = RHO * THICK * SPEED**2  # [N/m]
FIRST, LAST = 4.0 * THICK / SPEED, 10.0 * THICK / SPEED  # [s]


def run(device: str, spacing: float) -> Measured:
    """Let the jet hit the plate."""
    started = time.perf_counter()
    builder = make_builder((0.0, 0.0, 0.0))
    cells = lattice((-LENGTH, 0.0, -0.5 * THICK), (0.0, 0.0, 0.5 * THICK), spacing, plane=True)
    velocity = np.tile([SPEED, 0.0, 0.0], (len(cells), 1))
    add_fluid(builder, cells, RHO * LENGTH * THICK / len(cells), 0.0, velocity)
    deep = 6.0 * spacing
    place = wp.transform(wp.vec3(0.5 * deep, 0.0, 0.0), wp.quat_identity())
    builder.add_shape_box(-1, xform=place, hx=0.5 * deep, hy=0.5, hz=0.5 * PLATE)
    model = builder.finalize(device=device)
    model.set_gravity((0.0, 0.0, 0.0))
    solver = SolverSPH(model, SolverSPH.Config(spacing=spacing, speed_of_sound=SOUND, dimensions=2))
    state = model.state()
    samples = 120
    steps, dt = steps_in(solver, LAST, samples)
    rows: list[tuple[float, float]] = []
    simulate(solver, state, LAST, samples, lambda t: rows.append((t, solver.take_wall_impulse()[0, 0] / (steps * dt))))
    t, force = np.array(rows).T
    steady = t > FIRST
    mean = Value.within(float(force[steady].mean()), FORCE, CASE.reach["force"], "N/m")
    mass, v = model.particle_mass.numpy(), state.particle_qd.numpy()
    turned = np.abs(state.particle_q.numpy()[:, 2]) > 3.0 * THICK
    speed = np.linalg.norm(v, axis=1)
    return Measured(
        errors={"force": mean.percent},
        figures={
            "force [% off]": 100.0 * (mean.measured / FORCE - 1.0),
            "unrest of the force [% of it]": 100.0 * float(force[steady].std()) / FORCE,
            "largest force of the blow [of it]": float(force.max()) / FORCE,
            # The force is more than the jet brings by as much as the turned water has back along the jet.
            "turned water's speed off the plate [% of the jet's]": -100.0 * float(v[turned, 0].mean()) / SPEED,
            "kinetic energy left [%]": 100.0 * float((mass * speed**2).sum() / (mass.sum() * SPEED**2)),
        },
        curves={
            "reference: rho b v^2": (t[[0, -1]], np.full(2, FORCE)),
            f"dp = {1e3 * spacing:g} mm": (t, force),
        },
        values={"force": mean},
        particles=solver.count,
        simulated_seconds=LAST,
        wall_seconds=time.perf_counter() - started,
    )


CASE = Case(
    name="jet_plate",
    title="A jet hits a plate",
    reference="momentum: F = rho b v^2",
    reach={"force": 3.0},
    unit={"force": "%"},
    coarse=(0.01, 0.005),
    fine=(0.0025, 0.00125),
    run=run,
    axes=("time [s]", "force [N/m]"),
)
