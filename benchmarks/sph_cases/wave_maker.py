"""A piston makes waves: the height over the stroke, of linear theory (Dean & Dalrymple 1991, section 6.2).

H / S = 2 (cosh 2kd - 1) / (sinh 2kd + 2kd): in 0.3 m of water, at k d = 1, a period of 1.259 s, waves of 1.885 m and
0.9818 strokes. The stroke is 40 mm; H / d = 0.13. It grows over the first period.

The tank is 8 m long. The height is twice the amplitude of the one mode, 1 / L |sum V w exp(i k x)| over the water from
1 m to 1 m + 2 L off the piston, which the waves that die off with distance do not reach; w = 1 - cos(k x / 2) leaves
still water nothing and has no edges. It is averaged from 4 to 5.5 periods; what the end throws back comes later.
"""

from __future__ import annotations

import math
import time

import newton
import numpy as np
import warp as wp

from benchmarks.sph_cases.case import Case, Measured, Value
from benchmarks.sph_cases.led import Led
from benchmarks.sph_cases.water import add_fluid, lattice, make_builder, simulate, steps_in
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

RHO, G, DEPTH, STROKE, LENGTH, HEIGHT = 1000.0, 9.81, 0.3, 0.04, 8.0, 0.48
K = 1.0 / DEPTH
WAVE = 2.0 * math.pi / K
OMEGA = math.sqrt(G * K * math.tanh(K * DEPTH))
PERIOD = 2.0 * math.pi / OMEGA
RATIO = 2.0 * (math.cosh(2.0 * K * DEPTH) - 1.0) / (math.sinh(2.0 * K * DEPTH) + 2.0 * K * DEPTH)
SECONDS, FROM = 5.5 * PERIOD, 4.0 * PERIOD
FIRST = 1.0  # [m]
SOUND = 10.0 * math.sqrt(G * DEPTH)


def piston(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where the piston's face is [m] and how fast it moves [m/s]."""
    grown = np.clip(t / PERIOD, 0.0, 1.0)
    x = 0.5 * STROKE * grown * np.sin(OMEGA * t)
    v = 0.5 * STROKE * (grown * OMEGA * np.cos(OMEGA * t) + (t < PERIOD) / PERIOD * np.sin(OMEGA * t))
    return x, v


def run(device: str, spacing: float) -> Measured:
    """Make waves."""
    started = time.perf_counter()
    builder = make_builder((0.0, 0.0, -G))
    cells = lattice((0.0, 0.0, 0.0), (LENGTH, 0.0, DEPTH), spacing, plane=True)
    volume = LENGTH * DEPTH / len(cells)
    add_fluid(builder, cells, RHO * volume, RHO * G * (DEPTH - cells[:, 2]))
    thick, behind = 5.0 * spacing, 20.0 * spacing
    start = (-0.5 * thick, 0.0, 0.5 * HEIGHT)
    body = builder.add_body(xform=wp.transform(wp.vec3(*start), wp.quat_identity()))
    builder.add_shape_box(body, hx=0.5 * thick, hy=0.5, hz=0.5 * HEIGHT)
    model = builder.finalize(device=device)
    long = LENGTH + behind
    tank = OpenBox(center=(0.5 * long - behind, 0.0, 0.5 * HEIGHT), size=(long, 1.0, HEIGHT))
    solver = SolverSPH(model, SolverSPH.Config(spacing=spacing, speed_of_sound=SOUND, dimensions=2), (tank,))
    state: newton.State = model.state()
    samples = 220
    steps, dt = steps_in(solver, SECONDS, samples)
    x, v = piston(np.arange(steps * samples) * dt)
    along = np.array([1.0, 0.0, 0.0])
    led = Led(state, body, np.array(start) + x[:, None] * along, v[:, None] * along)
    rows: list[tuple[float, float]] = []

    def observe(t: float) -> None:
        at = state.particle_q.numpy()[:, 0].astype(float) - FIRST
        at = at[(at >= 0.0) & (at < 2.0 * WAVE)]
        mode = volume / WAVE * abs(((1.0 - np.cos(0.5 * K * at)) * np.exp(1j * K * at)).sum())
        rows.append((t, 2.0 * mode))

    simulate(solver, state, SECONDS, samples, observe, before_step=led.move)
    t, height = np.array(rows).T
    late = t > FROM
    value = Value.within(float(height[late].mean()) / STROKE, RATIO, CASE.reach["height"], "H/S")
    return Measured(
        errors={"height": value.percent},
        figures={
            "height [% off]": 100.0 * (value.measured / RATIO - 1.0),
            "unrest of the height [%]": 100.0 * float(height[late].std() / height[late].mean()),
        },
        curves={
            "reference: linear theory": (np.array([FROM, SECONDS]), np.full(2, RATIO)),
            f"dp = {1e3 * spacing:g} mm": (t, height / STROKE),
        },
        values={"height": value},
        particles=solver.count,
        simulated_seconds=SECONDS,
        wall_seconds=time.perf_counter() - started,
    )


CASE = Case(
    name="wave_maker",
    title="Waves of a piston, k d = 1",
    reference="linear theory: H / S = 0.982",
    reach={"height": 5.0},
    unit={"height": "%"},
    coarse=(0.03, 0.015),
    fine=(0.0075, 0.00375),
    run=run,
    axes=("time [s]", "height of the wave / stroke"),
)
