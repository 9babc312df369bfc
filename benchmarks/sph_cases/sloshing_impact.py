"""A shallow tank rolls, and its water hits a wall each period: SPHERIC's test 10, lateral impact of water.

Souto-Iglesias, Botia-Vera, Martin & Perez-Arribas (2011), Ocean Engineering 38, 1823-1830: a tank 0.9 m long, 0.508 m
high and 0.062 m wide with 93 mm of water rolls by 4 degrees with a period of 1.6295 s, 0.85 of the first sloshing
period. A sensor in the wall is at the calm level; over 100 repeats its first four peaks are 37.1 +- 7.3, 48.2 +-
15.0, 46.9 +- 17.1 and 46.4 +- 13.2 mbar. Which way the tank turns first, how it starts and that it turns about the
middle of its floor are assumed here; the record of the roll was not at hand.

The flow is in the plane and in the tank's frame, where walls stand still and have sensors: gravity turns, and the
forces of a turning frame, of Euler, Coriolis and the centrifugal one, are added to the water's velocity in each step.
The roll is a sine that grows over the first half period. A peak is the largest pressure of a period, over 5 ms and a
spacing, as in `dam_break_impact.py`.
"""

from __future__ import annotations

import math
import time

import newton
import numpy as np
import warp as wp

from benchmarks.sph_cases.case import Case, Measured, Value
from benchmarks.sph_cases.dam_break_impact import running_mean
from benchmarks.sph_cases.sensors import WallSensors
from benchmarks.sph_cases.water import add_fluid, lattice, make_builder, simulate, steps_in
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

RHO, G, LENGTH, HEIGHT, LEVEL = 998.0, 9.81, 0.9, 0.508, 0.093
ROLL, PERIOD = math.radians(4.0), 1.6295
OMEGA = 2.0 * math.pi / PERIOD
PEAKS = {"first": (37.1, 7.3), "second": (48.2, 15.0), "third": (46.9, 17.1), "fourth": (46.4, 13.2)}  # [mbar]
FIRST = 1.2 * PERIOD  # [s], from where on peaks are counted, a period each
SECONDS = FIRST + len(PEAKS) * PERIOD
SOUND = 20.0 * math.sqrt(G * LEVEL)
RATE = 2000.0  # [1/s]


def roll(t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Angle [rad], its rate [rad/s] and its acceleration [rad/s^2] about y."""
    grown = np.clip(t / (0.5 * PERIOD), 0.0, 1.0)
    share, slope = grown**2 * (3.0 - 2.0 * grown), 6.0 * grown * (1.0 - grown) / (0.5 * PERIOD)
    bend = np.where(grown < 1.0, (6.0 - 12.0 * grown) / (0.5 * PERIOD) ** 2, 0.0)
    sine, cosine = np.sin(OMEGA * t), np.cos(OMEGA * t)
    rate = share * OMEGA * cosine + slope * sine
    return ROLL * share * sine, ROLL * rate, ROLL * (2.0 * slope * OMEGA * cosine + (bend - share * OMEGA**2) * sine)


@wp.kernel
def _turn(
    # Data in:
    motion: wp.array(dtype=wp.vec3),
    position: wp.array(dtype=wp.vec3),
    step: wp.array(dtype=int),
    dt: float,
    # Data in and out:
    gravity: wp.array(dtype=wp.vec3),
    velocity: wp.array(dtype=wp.vec3),
):
    """What a frame that turns about y adds to the velocities in a step; and gravity as the frame has it."""
    i = wp.tid()
    m = motion[wp.min(step[0], motion.shape[0] - 1)]
    x, v = position[i], velocity[i]
    aside = m[1] * m[1] * x[0] - m[2] * x[2] - 2.0 * m[1] * v[2]
    up = m[1] * m[1] * x[2] + m[2] * x[0] + 2.0 * m[1] * v[0]
    velocity[i] = v + dt * wp.vec3(aside, 0.0, up)
    if i == 0:
        gravity[0] = 9.81 * wp.vec3(wp.sin(m[0]), 0.0, -wp.cos(m[0]))


@wp.kernel
def _count(step: wp.array(dtype=int)):
    step[0] = step[0] + 1


def run(device: str, spacing: float, seconds: float = SECONDS) -> Measured:
    """Roll the tank."""
    started = time.perf_counter()
    builder = make_builder((0.0, 0.0, -G))
    cells = lattice((-0.5 * LENGTH, 0.0, 0.0), (0.5 * LENGTH, 0.0, LEVEL), spacing, plane=True)
    add_fluid(builder, cells, RHO * LENGTH * LEVEL / len(cells), RHO * G * (LEVEL - cells[:, 2]))
    model: newton.Model = builder.finalize(device=device)
    tank = OpenBox(center=(0.0, 0.0, 0.5 * HEIGHT), size=(LENGTH, 1.0, HEIGHT))
    config = SolverSPH.Config(spacing=spacing, rest_density=RHO, speed_of_sound=SOUND, dimensions=2)
    solver = SolverSPH(model, config, (tank,))
    state = model.state()
    corner = np.array([0.5 * LENGTH, 0.5, HEIGHT])
    points = np.array([(side * 0.5 * LENGTH, 0.0, LEVEL) for side in (-1.0, 1.0)])
    normals = np.array([(1.0, 0.0, 0.0), (-1.0, 0.0, 0.0)])
    sensors = WallSensors(solver, points, normals, corner * (-1, -1, 0), corner)
    samples = round(seconds * RATE)
    steps, dt = steps_in(solver, seconds, samples)
    motion = np.stack(roll(np.arange(steps * samples) * dt), axis=1)
    motions = wp.array(motion.astype(np.float32), dtype=wp.vec3, device=device)
    step = wp.zeros(1, dtype=int, device=device)
    rows: list[tuple[float, ...]] = []

    def before() -> None:
        inputs = [motions, state.particle_q, step, dt]
        wp.launch(_turn, solver.fluid_count, inputs=inputs, outputs=[model.gravity, state.particle_qd], device=device)
        wp.launch(_count, 1, inputs=[step], device=device)

    def observe(t: float) -> None:
        rows.append((t, *sensors.read(steps)))

    simulate(
        solver, state, seconds, samples, observe, before_step=before, after_step=lambda: sensors.feel(state.particle_q)
    )
    t, *pressures = np.array(rows).T
    smooth = [0.01 * running_mean(p, 5e-3) for p in pressures]  # [mbar]
    peaks = [
        [float(p[(t >= FIRST + k * PERIOD) & (t < FIRST + (k + 1) * PERIOD)].max(initial=0.0)) for k in range(4)]
        for p in smooth
    ]
    values = {
        f"{name} peak": Value(found, known, known - spread, known + spread, "mbar")
        for found, (name, (known, spread)) in zip(peaks[0], PEAKS.items(), strict=True)
    }
    return Measured(
        errors={name: value.spreads for name, value in values.items()},
        figures={f"{name} peak at the other wall [mbar]": p for name, p in zip(PEAKS, peaks[1], strict=True)}
        | {"mean of the four peaks [mbar]": float(np.mean(peaks[0]))},
        curves={
            "reference: mean of 100 repeats": (
                FIRST + PERIOD * (0.5 + np.arange(4)),
                np.array([known for known, _ in PEAKS.values()]),
            ),
            f"dp = {1e3 * spacing:.3g} mm": (t, smooth[0]),
        },
        values=values,
        particles=solver.count,
        simulated_seconds=seconds,
        wall_seconds=time.perf_counter() - started,
    )


CASE = Case(
    name="sloshing_impact",
    title="Water hits the wall of a tank that rolls",
    reference="Souto-Iglesias et al. (2011), SPHERIC test 10",
    reach={f"{name} peak": 1.0 for name in PEAKS},
    unit={f"{name} peak": "spreads" for name in PEAKS},
    coarse=(LEVEL / 7, LEVEL / 10),
    fine=(LEVEL / 30, LEVEL / 60),
    run=run,
    axes=("time [s]", "pressure at the calm level [mbar]"),
)
