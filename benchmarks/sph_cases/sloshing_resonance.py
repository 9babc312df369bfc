"""A tank sways at the first frequency of its water: sloshing grows with time, as linear modal theory has it.

Faltinsen & Timokha (2009), Sloshing, chapter 5: in a tank of length L that moves by x(t), the amplitude b of the mode
cos(pi x / L) of the surface, x from the left wall, obeys b'' + w^2 b = P x'', w^2 = g pi / L tanh(pi h / L) and P = 4
/ pi tanh(pi h / L). For x = A (1 - cos(w t)), from rest, it is b = P A w t sin(w t) / 2: each period adds pi P A.
Here L = 1 m, h = 0.4 m, A = 4 mm: 13.6 mm a period, 41 mm after three, a tenth of the depth.

The tank is a body of three slabs, led by its pose. b is 2 / L sum V cos(pi x / L) over the water, which deep water
does not enter into. Its growth is the factor of t sin(w t), by least squares, against P A w / 2; what it has of t
cos(w t) says by how much the water's own period is another.
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
from wsim.solvers.solver_sph import SolverSPH

RHO, G, LENGTH, DEPTH, HEIGHT, SWAY = 1000.0, 9.81, 1.0, 0.4, 0.6, 0.004
OMEGA = math.sqrt(G * math.pi / LENGTH * math.tanh(math.pi * DEPTH / LENGTH))
DRIVE = 4.0 / math.pi * math.tanh(math.pi * DEPTH / LENGTH)
GROWTH = 0.5 * DRIVE * SWAY * OMEGA  # [m/s]
PERIOD = 2.0 * math.pi / OMEGA
SECONDS = 3.0 * PERIOD
SOUND = 10.0 * math.sqrt(G * DEPTH)


def _add_tank(builder: newton.ModelBuilder, wall: float) -> int:
    """Three slabs; the body's origin is in the middle of the floor's upper face."""
    body = builder.add_body(xform=wp.transform(wp.vec3(0.0, 0.0, 0.0), wp.quat_identity()))
    slabs = [((0.0, -0.5 * wall), (0.5 * LENGTH + wall, 0.5 * wall))]
    slabs += [((side * 0.5 * (LENGTH + wall), 0.5 * HEIGHT), (0.5 * wall, 0.5 * HEIGHT)) for side in (-1.0, 1.0)]
    for (x, z), (hx, hz) in slabs:
        place = wp.transform(wp.vec3(x, 0.0, z), wp.quat_identity())
        builder.add_shape_box(body, xform=place, hx=hx, hy=0.5, hz=hz)
    return body


def run(device: str, spacing: float, seconds: float = SECONDS) -> Measured:
    """Sway the tank."""
    started = time.perf_counter()
    builder = make_builder((0.0, 0.0, -G))
    cells = lattice((-0.5 * LENGTH, 0.0, 0.0), (0.5 * LENGTH, 0.0, DEPTH), spacing, plane=True)
    volume = LENGTH * DEPTH / len(cells)
    add_fluid(builder, cells, RHO * volume, RHO * G * (DEPTH - cells[:, 2]))
    body = _add_tank(builder, 4.0 * spacing)
    model = builder.finalize(device=device)
    model.body_com.zero_()
    solver = SolverSPH(model, SolverSPH.Config(spacing=spacing, speed_of_sound=SOUND, dimensions=2))
    state = model.state()
    samples = round(60 * seconds)
    steps, dt = steps_in(solver, seconds, samples)
    at = np.arange(steps * samples)[:, None] * dt
    along = np.array([1.0, 0.0, 0.0])
    led = Led(state, body, SWAY * (1.0 - np.cos(OMEGA * at)) * along, SWAY * OMEGA * np.sin(OMEGA * at) * along)
    rows: list[tuple[float, float]] = []

    def observe(t: float) -> None:
        own = state.particle_q.numpy()[:, 0].astype(float) - SWAY * (1.0 - math.cos(OMEGA * t))
        mode = np.cos(math.pi * (own / LENGTH + 0.5)).sum()
        rows.append((t, 2.0 * volume / LENGTH * float(mode)))

    simulate(solver, state, seconds, samples, observe, before_step=led.move)
    t, mode = np.array(rows).T
    basis = np.stack([factor * f(OMEGA * t) for factor in (1.0, t) for f in (np.cos, np.sin)], axis=1)
    found = np.linalg.lstsq(basis, mode, rcond=None)[0]
    growth = Value.within(1e3 * float(found[3]), 1e3 * GROWTH, CASE.reach["growth"], "mm/s")
    theory = GROWTH * t * np.sin(OMEGA * t)
    return Measured(
        errors={"growth": growth.percent},
        figures={
            "growth [% off]": 100.0 * (growth.measured / growth.reference - 1.0),
            "growth out of phase [% of theory]": 100.0 * float(found[2]) / GROWTH,
            "largest amplitude [spacings]": float(np.abs(mode).max()) / spacing,
            "from theory, rms [% of the largest]": 100.0 * float(np.sqrt(((mode - theory) ** 2).mean()) / theory.max()),
        },
        curves={
            "reference: linear modal theory": (t, 1e3 * theory),
            f"dp = {1e3 * spacing:g} mm": (t, 1e3 * mode),
        },
        values={"growth": growth},
        particles=solver.count,
        simulated_seconds=seconds,
        wall_seconds=time.perf_counter() - started,
    )


CASE = Case(
    name="sloshing_resonance",
    title="Sloshing in a tank that sways at resonance",
    reference="linear modal theory (Faltinsen & Timokha 2009)",
    reach={"growth": 5.0},
    unit={"growth": "%"},
    coarse=(0.05, 0.025, 0.0125),
    fine=(0.01, 0.005),
    run=run,
    axes=("time [s]", "amplitude of the first mode [mm]"),
)
