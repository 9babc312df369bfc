"""Heave decay of a sphere: Kramer et al. (2021), Energies 14:269, an experiment made to be a benchmark.

A sphere of 0.3 m and 7.056 kg, half submerged in 0.9 m of water of 998.2 kg/m^3 (g = 9.82 m/s^2), is lifted by 30 mm
and let go. Measured there: a period of 0.787 s, and a first trough 24.9 mm below the equilibrium. Linear potential flow
(`potential_flow.py`) gives 0.783 s and 26.0 mm, a first peak at 0.768 s; it is the black line of the plot.

The period is twice the time between the first two passes through the equilibrium, which is the still level with the
sphere afloat: its mass is that of half its volume of water. In a tank this narrow that is 0.6 mm to 1.5 mm above the
level with the sphere lifted, for it then takes the room of as much water. Equilibrium is where the error of a floating
body's draft shows: a tenth of a spacing is a twentieth of the drop at 15 mm, and an eighth at 37.5 mm. The figures give
it apart from the motion about it, by a fit of a decaying cosine.

On a GPU the tank is 1.8 m wide. The waves that the sphere makes are about 0.95 m long and carry their energy at
0.6 m/s; from the sphere to a wall and back are 1.5 m, 2.5 s, and 1.6 s are shown. On a CPU it is 1.2 m wide; they are
back after 0.9 m, 1.5 s, and 1.2 s are shown.

The sphere is held for a while before it is let go, as it hung from a line in the experiment, and the water's
velocities are damped meanwhile. A cubic lattice of particles in space is not stable under its own pressure: after
0.3 s to 1 s it slips into a disorder that stays, and stirs the tank with up to 3.7 J, ten times the 0.3 J that the
lifted sphere has over its equilibrium. Let go in the middle of that, the sphere's first peak was anything from 11 mm
to 18 mm. The lattice starts a tenth of a spacing off, at random, so that it slips early. The disorder takes up 0.6 %
less room, and the level falls by 5 mm; it is what the particles' mean height says, and the sphere follows it while it
is held, so that it always hangs DROP above its equilibrium. Held where it was, and moved when it is let go, it had 5 %
to 7 % too little lift, and its first trough was 18 % too deep at 10 mm. A body-centred lattice stays, but holds the
sphere as a soft solid would: 6 % too much lift at 30 mm.
"""

from __future__ import annotations

import math
import time

import newton
import numpy as np
import warp as wp

from benchmarks.sph_cases.bodies import make_rigid
from benchmarks.sph_cases.case import Case, Measured
from benchmarks.sph_cases.potential_flow import heave_decay
from benchmarks.sph_cases.water import add_fluid, lattice, make_builder, simulate
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

RHO, G = 998.2, 9.82
RADIUS, MASS, DEPTH, DROP = 0.15, 7.056, 0.9, 0.03
PERIOD, TROUGH = 0.787, -0.0249
SOUND = 10.0 * math.sqrt(G * DEPTH)
HELD, DAMPED, DAMPING = 1.2, 1.1, 10.0  # [s], [s], [1/s]


def _cap(height: float) -> float:
    """Volume of the sphere below a plane `height` over its lowest point [m^3]."""
    return math.pi * height**2 * (RADIUS - height / 3.0)


def _add_water(builder: newton.ModelBuilder, width: float, spacing: float) -> float:
    """Water to DEPTH with a hollow for the lifted sphere. Returns the height of the sphere's centre [m]."""
    cells = lattice((-0.5 * width, -0.5 * width, 0.0), (0.5 * width, 0.5 * width, DEPTH), spacing)
    cells += np.random.default_rng(0).uniform(-0.1, 0.1, cells.shape) * spacing
    volume = width * width * DEPTH / len(cells)
    center = DEPTH + DROP
    # As many particles as the sphere takes room, the nearest to its centre, so that the level stays what it is.
    taken = round(_cap(RADIUS - DROP) / volume)
    distance = np.linalg.norm(cells - np.array([0.0, 0.0, center]), axis=1)
    cells = cells[np.argsort(distance, kind="stable")[taken:]]
    add_fluid(builder, cells, RHO * volume, RHO * G * (DEPTH - cells[:, 2]))
    return center


def _hang(model: newton.Model, state: newton.State, height: float) -> None:
    """Put the sphere's centre at a height [m], at rest."""
    joint_q = model.joint_q.numpy()
    joint_q[2] = height
    state.joint_q.assign(joint_q)
    state.joint_qd.zero_()
    newton.eval_fk(model, state.joint_q, state.joint_qd, state)


def crossings(t: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Times at which z changes sign, linear between samples."""
    k = np.flatnonzero(z[:-1] * z[1:] < 0.0)
    return t[k] - z[k] * (t[k + 1] - t[k]) / (z[k + 1] - z[k])


def extremum(t: np.ndarray, z: np.ndarray, first: float, last: float, sign: float) -> tuple[float, float]:
    """Time and height of the highest (`sign` 1) or lowest (-1) point in a window, by a parabola through 5 samples."""
    window = np.flatnonzero((t >= first) & (t <= last))
    k = int(np.clip(window[np.argmax(sign * z[window])], 2, len(t) - 3))
    a, b, c = np.polyfit(t[k - 2 : k + 3] - t[k], z[k - 2 : k + 3], 2)
    at = float(np.clip(-0.5 * b / a, t[k - 2] - t[k], t[k + 2] - t[k])) if a * sign < 0.0 else 0.0
    return float(t[k] + at), float(a * at * at + b * at + c)


def fit_decay(t: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Middle [m], amplitude [m], decay [1/s], angular frequency [rad/s] and phase of a decaying cosine through z."""
    from scipy.optimize import curve_fit

    def wave(t: np.ndarray, middle: float, size: float, decay: float, omega: float, phase: float) -> np.ndarray:
        return middle + size * np.exp(-decay * t) * np.cos(omega * t + phase)

    return curve_fit(wave, t, z, [0.0, DROP, 0.7, 2.0 * math.pi / PERIOD, 0.0])[0]


def run(device: str, spacing: float, seconds: float | None = None, width: float | None = None) -> Measured:
    """Let the sphere go and follow it."""
    started = time.perf_counter()
    on_gpu = wp.get_device(device).is_cuda
    width, seconds = width or (1.8 if on_gpu else 1.2), seconds or (1.6 if on_gpu else 1.2)
    builder = make_builder((0.0, 0.0, -G))
    center = _add_water(builder, width, spacing)
    body = builder.add_body(xform=wp.transform(wp.vec3(0.0, 0.0, center), wp.quat_identity()))
    wood = newton.ModelBuilder.ShapeConfig(density=MASS / (4.0 / 3.0 * math.pi * RADIUS**3))
    builder.add_shape_sphere(body, radius=RADIUS, cfg=wood)
    model = builder.finalize(device=device)
    config = SolverSPH.Config(spacing=spacing, rest_density=RHO, speed_of_sound=SOUND)
    height = DEPTH + 4.0 * spacing
    tank = OpenBox(center=(0.0, 0.0, 0.5 * height), size=(width, width, height))
    solver, rigid = SolverSPH(model, config, (tank,)), make_rigid(model)
    state = model.state()
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)
    rows = [(0.0, DROP)]
    middle = float(model.particle_q.numpy()[:, 2].astype(float).mean())
    # From the level with the sphere lifted to that with half of it in the water.
    rise = (_cap(RADIUS) - _cap(RADIUS - DROP)) / width**2

    def find_equilibrium() -> float:
        return DEPTH + 2.0 * (float(state.particle_q.numpy()[:, 2].astype(float).mean()) - middle) + rise

    lifts: list[float] = []
    interval = HELD / 120

    def hold(t: float) -> None:
        if t < DAMPED:
            state.particle_qd.assign(state.particle_qd.numpy() * math.exp(-DAMPING * interval))
        else:
            lifts.append(float(solver.body_wrench.numpy()[0, 2]))
        _hang(model, state, find_equilibrium() + DROP)

    simulate(solver, state, HELD, 120, hold)
    lift, equilibrium = float(np.mean(lifts)), find_equilibrium()

    def observe(t: float) -> None:
        rows.append((t, float(state.body_q.numpy()[0, 2]) - equilibrium))

    simulate(solver, state, seconds, samples=round(100 * seconds), observe=observe, rigid=rigid)
    t, z = np.array(rows).T
    passes = crossings(t, z)
    period = 2.0 * float(passes[1] - passes[0]) if len(passes) > 1 else math.nan
    trough_at, trough = extremum(t, z, 0.2, 0.6, -1.0)
    peak_at, peak = extremum(t, z, 0.6, 0.95, 1.0)
    middle, _, decay, omega, _ = fit_decay(t, z)
    theory = heave_decay(RADIUS, RHO, G, DROP, seconds)
    in_theory = fit_decay(*theory)
    return Measured(
        errors={"period": 100.0 * abs(period / PERIOD - 1.0), "first trough": 100.0 * abs(trough / TROUGH - 1.0)},
        figures={
            "period [s]": period,
            "first trough [mm]": 1e3 * trough,
            "first trough at [s]": trough_at,
            "first peak [mm]": 1e3 * peak,
            "first peak at [s]": peak_at,
            "equilibrium off, of the fit [mm]": 1e3 * (middle - in_theory[0]),
            "period of the fit [% off linear theory]": 100.0 * (in_theory[3] / omega - 1.0),
            "decay of the fit [1/s]": decay,
            "decay of linear theory [1/s]": in_theory[2],
            "from linear theory, rms [mm]": 1e3 * float(np.sqrt(np.mean((np.interp(t, *theory) - z) ** 2))),
            # The force on the sphere that is held still, against the weight of the water that it displaces.
            "level, of the depth [% off]": 100.0 * ((equilibrium - rise) / DEPTH - 1.0),
            "lift while held [% off]": 100.0 * (lift / (RHO * G * _cap(RADIUS - DROP - rise)) - 1.0),
        },
        curves={f"dp = {1e3 * spacing:g} mm": (t, 1e3 * z), "reference: linear theory": (theory[0], 1e3 * theory[1])},
        particles=solver.count,
        simulated_seconds=HELD + seconds,
        wall_seconds=time.perf_counter() - started,
    )


CASE = Case(
    name="sphere_heave",
    title="Heave decay of a sphere",
    reference="Kramer et al. 2021, Energies 14:269",
    reach={"period": 3.0, "first trough": 10.0},
    unit={"period": "%", "first trough": "%"},
    coarse=(0.0375, 0.03),
    fine=(0.015, 0.01),
    run=run,
    axes=("time since release [s]", "height over equilibrium [mm]"),
)
