"""A narrow box heaves in waves: its response by linear potential flow, 1.056, near the long-wave limit of 1.

A box 0.12 m wide with a draft of 0.06 m, free to heave alone, in waves of 1.885 m (k d = 1) of a piston as in
`wave_maker.py`. What is small to the waves moves as the water would without it; this one moves by 5.6 % more, for its
own heave, with a period of about 0.66 s, is half as long as the waves' period (`heave_theory.py`, by matched
eigenfunctions).

The wave at the box is the mean of the levels of two columns beside it, one on each side: where eta'' = -k^2 eta,
however much of it the box or the end throws back, it is eta(x) cos(k a) times the mean of cos(k x) over a column.
What the box makes itself is small beside it: 0.2 of its heave relative to the water. Amplitudes and phases are of the
waves' frequency, by least squares over three periods once all is steady. The tank's last wave length takes the waves
in: velocities there decay, by up to 6 a second at its end.
"""

from __future__ import annotations

import math
import time

import newton
import numpy as np
import warp as wp

from benchmarks.sph_cases.bodies import make_rigid, outside_box
from benchmarks.sph_cases.case import Case, Measured, Value
from benchmarks.sph_cases.heave_theory import heave
from benchmarks.sph_cases.led import Led
from benchmarks.sph_cases.water import add_fluid, lattice, make_builder, simulate, steps_in
from benchmarks.sph_cases.wave_maker import DEPTH, HEIGHT, OMEGA, PERIOD, RHO, STROKE, G, K, piston
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

LENGTH, BEACH, DECAY = 5.7, 1.9, 6.0  # [m], [m], [1/s]
AT, WIDTH, DRAFT, TALL = 2.25, 0.12, 0.06, 0.15  # [m]
ASIDE, COLUMN = 0.3, 0.24  # [m]: middles of the columns off the box, and their width
SECONDS, FROM = 7.0 * PERIOD, 4.0 * PERIOD
SOUND = 10.0 * math.sqrt(G * DEPTH)
RESPONSE = heave(OMEGA, DEPTH, WIDTH, DRAFT, G).response


@wp.kernel
def _take_in(position: wp.array(dtype=wp.vec3), start: float, rate: float, velocity: wp.array(dtype=wp.vec3)):
    """Slow what is in the beach; `rate` is at one metre into it, times the step [1/m^2]."""
    i = wp.tid()
    into = wp.max(position[i][0] - start, 0.0)
    velocity[i] = velocity[i] * wp.exp(-rate * into * into)


def swing(t: np.ndarray, y: np.ndarray) -> complex:
    """Amplitude and phase of the waves' frequency in y, with its mean and twice the frequency beside it."""
    basis = [np.ones_like(t), *(f(n * OMEGA * t) for n in (1, 2) for f in (np.cos, np.sin))]
    found = np.linalg.lstsq(np.stack(basis, axis=1), y, rcond=None)[0]
    return complex(found[1], -found[2])


def _add_box(builder: newton.ModelBuilder) -> int:
    """The box, afloat: one metre of it weighs what it displaces."""
    at = wp.transform(wp.vec3(AT, 0.0, DEPTH - DRAFT + 0.5 * TALL), wp.quat_identity())
    mass = RHO * WIDTH * DRAFT
    box = builder.add_link(xform=at, mass=mass, inertia=wp.diag(wp.vec3(1.0, 1.0, 1.0)))
    builder.add_articulation([builder.add_joint_prismatic(-1, box, parent_xform=at, axis=newton.Axis.Z)])
    weightless = newton.ModelBuilder.ShapeConfig(density=0.0)
    builder.add_shape_box(box, hx=0.5 * WIDTH, hy=0.5, hz=0.5 * TALL, cfg=weightless)
    return box


def _make(device: str, spacing: float) -> tuple[SolverSPH, newton.State, int, int, float]:
    """The tank with its piston and the box: solver, state, both bodies, and the volume of a particle [m^3]."""
    builder = make_builder((0.0, 0.0, -G))
    cells = lattice((0.0, 0.0, 0.0), (LENGTH, 0.0, DEPTH), spacing, plane=True)
    volume = LENGTH * DEPTH / len(cells)
    cells = cells[outside_box(cells, (AT, 0.0, DEPTH), (0.5 * WIDTH, 1.0, DRAFT))]
    add_fluid(builder, cells, RHO * volume, RHO * G * (DEPTH - cells[:, 2]))
    thick, behind = 5.0 * spacing, 20.0 * spacing
    box = _add_box(builder)
    board = builder.add_body(xform=wp.transform(wp.vec3(-0.5 * thick, 0.0, 0.5 * HEIGHT), wp.quat_identity()))
    builder.add_shape_box(board, hx=0.5 * thick, hy=0.5, hz=0.5 * HEIGHT)
    model = builder.finalize(device=device)
    long = LENGTH + behind
    tank = OpenBox(center=(0.5 * long - behind, 0.0, 0.5 * HEIGHT), size=(long, 1.0, HEIGHT))
    solver = SolverSPH(model, SolverSPH.Config(spacing=spacing, speed_of_sound=SOUND, dimensions=2), (tank,))
    state = model.state()
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)
    return solver, state, box, board, volume


def run(device: str, spacing: float) -> Measured:
    """Let the waves pass the box."""
    started = time.perf_counter()
    solver, state, box, board, volume = _make(device, spacing)
    samples = 280
    steps, dt = steps_in(solver, SECONDS, samples)
    x, v = piston(np.arange(steps * samples) * dt)
    along = np.array([1.0, 0.0, 0.0])
    start = np.array([-2.5 * spacing, 0.0, 0.5 * HEIGHT])
    led = Led(state, board, start + x[:, None] * along, v[:, None] * along)
    rows: list[tuple[float, float, float]] = []

    def before() -> None:
        led.move()
        beach = [state.particle_q, LENGTH - BEACH, DECAY / BEACH**2 * dt]
        wp.launch(_take_in, dim=solver.fluid_count, inputs=beach, outputs=[state.particle_qd], device=device)

    def observe(t: float) -> None:
        off = np.abs(np.abs(state.particle_q.numpy()[:, 0].astype(float) - AT) - ASIDE)
        # Edges as wide as a particle: columns then change as particles pass, not by leaps.
        share = np.clip((0.5 * COLUMN - off) / spacing + 0.5, 0.0, 1.0)
        rows.append((t, float(state.body_q.numpy()[box, 2]), volume * float(share.sum()) / (2.0 * COLUMN)))

    simulate(solver, state, SECONDS, samples, observe, rigid=make_rigid(solver.model), before_step=before)
    t, height, level = np.array(rows).T
    late = t > FROM
    of_columns = math.cos(K * ASIDE) * math.sin(0.5 * K * COLUMN) / (0.5 * K * COLUMN)
    wave, answer = swing(t[late], level[late]) / of_columns, swing(t[late], height[late])
    response = Value.within(abs(answer / wave), RESPONSE, CASE.reach["response"], "of the wave's amplitude")
    return Measured(
        errors={"response": response.percent},
        figures={
            "phase after the wave [deg]": math.degrees(float(np.angle(wave / answer))),
            "height of the wave [mm]": 2e3 * abs(wave),
            "height of the wave by linear theory [mm]": 2e3 * 0.5 * STROKE * 0.9818,
            "height of the wave [spacings]": 2.0 * abs(wave) / spacing,
            "mean height of the box over its start [mm]": 1e3 * float(height[late].mean() - height[0]),
        },
        curves={
            f"box, dp = {1e3 * spacing:g} mm": (t, 1e3 * (height - height[late].mean())),
            f"wave, dp = {1e3 * spacing:g} mm": (t[late], 1e3 * (wave * np.exp(1j * OMEGA * t[late])).real),
        },
        values={"response": response},
        particles=solver.count,
        simulated_seconds=SECONDS,
        wall_seconds=time.perf_counter() - started,
    )


CASE = Case(
    name="heave_in_waves",
    title="A narrow box heaves in waves, B / L = 0.064",
    reference=f"linear potential flow: {RESPONSE:.3f}",
    reach={"response": 5.0},
    unit={"response": "%"},
    coarse=(0.03, 0.02),
    fine=(0.015, 0.0075),
    run=run,
    axes=("time [s]", "over the mean [mm]"),
)
