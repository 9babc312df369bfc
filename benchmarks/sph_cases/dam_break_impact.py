"""What the cases of a dam break that hits a wall share: Lobovsky et al. (2014), J. Fluids Struct. 48, 407-434.

A tank 1.61 m long and 0.15 m wide, a column of water 0.6 m long behind a gate, sensors of 4.2 mm in the far wall. The
experiment was run 100 times; peaks have a median and 2.5 % and 97.5 % quantiles. On a CPU the flow is in the plane, on
a GPU in space.

A sensor here is the mean over a spacing and over 5 ms: a particle is several sensors' faces wide, and one that hits the
wall is a blow of its own. Where a record of the experiment is at hand, it is taken through the same 5 ms. The rise time
is the experiment's, twice the time from half of the peak to the peak. Impulses are integrals over a fixed time: between
the halves of the peak, as the experiment has them, they follow how sharp the peak is more than what the water gave; of
one record of the experiment they are 420 Pa s raw and 513 Pa s after the 5 ms.

The column is let go at once; the experiment's gate takes 69 ms at 0.3 m to clear it, and its clock starts as it moves.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

import newton
import numpy as np
import warp as wp

from benchmarks.sph_cases.dam_break import front_of, pressure_at_release
from benchmarks.sph_cases.sensors import WallSensors
from benchmarks.sph_cases.water import add_fluid, lattice, make_builder, simulate, steps_in
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

RHO, G = 997.0, 9.81
COLUMN, LENGTH, BREADTH = 0.6, 1.61, 0.15
RATE = 2000.0  # [1/s]
WINDOW = 5e-3  # [s]
# Height over the floor and place across [m]. 2L stands a quarter of the breadth off the middle.
SENSORS = {"P1": (0.003, 0.0), "P2": (0.015, 0.0), "P2L": (0.015, 0.0375), "P3": (0.030, 0.0), "P4": (0.080, 0.0)}


@dataclass(frozen=True)
class Impact:
    """Of one sensor's pressure."""

    peak: float
    """[Pa]"""
    at: float
    """[s]"""
    rise: float
    """[s]"""


@dataclass(frozen=True)
class Run:
    """Pressures [Pa] at the sensors and the front [m] over time [s]."""

    t: np.ndarray
    raw: dict[str, np.ndarray]
    smooth: dict[str, np.ndarray]
    front_t: np.ndarray
    front: np.ndarray
    particles: int
    wall_seconds: float

    @property
    def arrival(self) -> float:
        """When the front of the bulk is at the wall, but for a spacing [s]; not a number if it never is."""
        there = self.front >= LENGTH - 0.01
        return float(self.front_t[there.argmax()]) if there.any() else math.nan


def running_mean(p: np.ndarray, seconds: float, rate: float = RATE) -> np.ndarray:
    """Mean over so many seconds around each sample."""
    n = max(1, round(seconds * rate))
    return np.convolve(p, np.ones(n) / n, "same")


def impact_of(t: np.ndarray, p: np.ndarray, until: float = math.inf) -> Impact:
    """The largest impact before `until` [s]."""
    k = int(np.where(t <= until, p, -math.inf).argmax())
    half = 0.5 * p[k]
    before = np.flatnonzero(p[:k] < half)
    first = t[before[-1]] if len(before) else t[0]
    return Impact(float(p[k]), float(t[k]), 2.0 * float(t[k] - first))


def impulse_of(t: np.ndarray, p: np.ndarray, until: float) -> float:
    """Integral of a pressure over time up to `until` [Pa s]."""
    return float(np.trapezoid(p[t <= until], t[t <= until]))


def _water(height: float, spacing: float, plane: bool) -> newton.ModelBuilder:
    """The column, at the moment that its gate is gone."""
    builder = make_builder((0.0, 0.0, -G))
    half = 0.5 * BREADTH
    position = lattice((0.0, -half, 0.0), (COLUMN, half, height), spacing, plane)
    pressure = pressure_at_release(position[:, 0], position[:, 2], COLUMN, height)
    volume = COLUMN * height * (1.0 if plane else BREADTH) / len(position)
    add_fluid(builder, position, RHO * volume, pressure)
    return builder


def release(device: str, spacing: float, height: float, seconds: float) -> Run:
    """Let go a column of `height` [m] and read the sensors for so many seconds."""
    started = time.perf_counter()
    plane = not wp.get_device(device).is_cuda
    model = _water(height, spacing, plane).finalize(device=device)
    breadth, top = (1.0 if plane else BREADTH), 2.0 * height if height < 0.5 else 1.4 * height
    tank = OpenBox(center=(0.5 * LENGTH, 0.0, 0.5 * top), size=(LENGTH, breadth, top))
    # Ten times Ritter's (1892) speed of a frictionless front, 2 sqrt(g H), as in the other dam breaks.
    sound = 20.0 * math.sqrt(G * height)
    config = SolverSPH.Config(spacing=spacing, rest_density=RHO, speed_of_sound=sound, dimensions=2 if plane else 3)
    solver = SolverSPH(model, config, (tank,))
    state = model.state()
    names = [name for name, (_, across) in SENSORS.items() if not (plane and across)]
    points = np.array([(LENGTH, SENSORS[name][1], SENSORS[name][0]) for name in names])
    corner = np.array([LENGTH, 0.5 * breadth, top])
    sensors = WallSensors(solver, points, np.tile([-1.0, 0.0, 0.0], (len(names), 1)), corner * (0, -1, 0), corner)
    samples = round(seconds * RATE)
    steps, _ = steps_in(solver, seconds, samples)
    rows: list[tuple[float, ...]] = []
    fronts = [(0.0, COLUMN)]

    def observe(t: float) -> None:
        rows.append((t, *sensors.read(steps)))
        if len(rows) % 10 == 0 and fronts[-1][1] < LENGTH - 0.01:
            fronts.append((t, front_of(state.particle_q.numpy().astype(float), spacing)))

    simulate(solver, state, seconds, samples, observe, after_step=lambda: sensors.feel(state.particle_q))
    t, *pressures = np.array(rows).T
    front_t, front = np.array(fronts).T
    raw = dict(zip(names, pressures, strict=True))
    smooth = {name: running_mean(p, WINDOW) for name, p in raw.items()}
    return Run(t, raw, smooth, front_t, front, solver.count, time.perf_counter() - started)


def figures(run: Run, until: float) -> dict[str, float]:
    """Of each sensor what is not an error: peak, rise and time of the impact, and impulse, before `until` [s]."""
    found = {}
    for name, p in run.smooth.items():
        impact = impact_of(run.t, p, until)
        found[f"{name} raw peak [Pa]"] = float(run.raw[name].max())
        found[f"{name} peak [Pa]"] = impact.peak
        found[f"{name} at [s]"] = impact.at
        found[f"{name} rise [ms]"] = 1e3 * impact.rise
        found[f"{name} impulse [Pa s]"] = impulse_of(run.t, run.raw[name], until)
    return found


def front_error(run: Run, height: float, points: np.ndarray) -> float:
    """Mean error of the front [%] at an experiment's points: t sqrt(g / H) and x / H from the gate, shape (n, 2)."""
    t, x = points.T
    expected = COLUMN + height * x
    return 100.0 * float(np.abs(np.interp(t / math.sqrt(G / height), run.front_t, run.front) / expected - 1.0).mean())
