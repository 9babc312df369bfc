"""What the dam-break cases share: a column of water let go in a tank, and where its front is.

The column is let go at once and everywhere. An experiment's gate takes time to leave, and its clock starts somewhere in
that time; the error of a case is against the experiment's own clock, and a figure beside it says which delay of the
experiment would fit best. A second error is against what an ideal column does, let go at once and without viscosity
(`dam_break_potential.py`): that front leads both experiments, by 12 % and 15 %, and a solver's should converge to it.
"""

from __future__ import annotations

import math
import time

import newton
import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from benchmarks.sph_cases import dam_break_potential
from benchmarks.sph_cases.case import Measured
from benchmarks.sph_cases.water import add_fluid, lattice, make_builder, simulate
from wsim.solvers.shapes import OpenBox
from wsim.solvers.solver_sph import SolverSPH

RHO, G = 1000.0, 9.81
LINK = 1.8  # spacings: reaches the diagonal neighbour of a lattice stretched by a quarter, not the next but one


def pressure_at_release(x: np.ndarray, z: np.ndarray, width: float, height: float) -> np.ndarray:
    """Pressure [Pa] in a column of water the moment that its gate at x = width is gone.

    The incompressible flow that starts from rest has a harmonic pressure: zero on the gate's side and on top, a floor
    that carries the weight, a wall at x = 0. Separation of variables gives the series. Started with the hydrostatic
    pressure of the column behind its gate, the water would spring off the gate as sound.
    """
    n = np.arange(1, 200, 2)[:, None]
    k = 0.5 * math.pi * n / height
    # cosh(k x) / cosh(k width), written so that it cannot overflow.
    across = (np.exp(k * (x - width)) + np.exp(-k * (x + width))) / (1.0 + np.exp(-2.0 * k * width))
    series = (8.0 * height / (math.pi * n) ** 2 * across * np.cos(k * z)).sum(axis=0)
    return RHO * G * np.maximum(height - z - series, 0.0)


def front_of(position: np.ndarray, spacing: float) -> float:
    """How far the bulk of the water reaches along x [m].

    Particles within LINK spacings of each other hang together; the bulk is the largest such group. Its front is half a
    spacing beyond its foremost particle. A drop that flew off does not count.
    """
    plane = position[:, [0, 2]]
    pairs = cKDTree(plane).query_pairs(LINK * spacing, output_type="ndarray")
    links = coo_matrix((np.ones(len(pairs), dtype=np.int8), (pairs[:, 0], pairs[:, 1])), shape=(len(plane), len(plane)))
    _, group = connected_components(links, directed=False)
    bulk = group == np.bincount(group).argmax()
    return float(plane[bulk, 0].max()) + 0.5 * spacing


def release(
    device: str,
    spacing: float,
    width: float,
    height: float,
    tank: tuple[float, float],
    times: np.ndarray,
    fronts: np.ndarray,
) -> Measured:
    """Let go a column and compare its front with an experiment's.

    Args:
        device: Warp's name of it.
        spacing: Between particles [m].
        width: Of the column [m].
        height: Of the column [m].
        tank: Its length and height [m].
        times: Of the experiment [s].
        fronts: Of the experiment [m].
    """
    started = time.perf_counter()
    builder = make_builder((0.0, 0.0, -G))
    position = lattice((0.0, 0.0, 0.0), (width, 0.0, height), spacing, plane=True)
    pressure = pressure_at_release(position[:, 0], position[:, 2], width, height)
    add_fluid(builder, position, RHO * width * height / len(position), pressure)
    model: newton.Model = builder.finalize(device=device)
    length = math.ceil(tank[0] / spacing) * spacing
    box = OpenBox(center=(0.5 * length, 0.0, 0.5 * tank[1]), size=(length, 1.0, tank[1]))
    # Ten times Ritter's (1892) speed of a frictionless front, 2 sqrt(g H), which is the largest there can be.
    sound = 20.0 * math.sqrt(G * height)
    config = SolverSPH.Config(
        spacing=spacing,
        rest_density=RHO,
        speed_of_sound=sound,
        dimensions=2,
    )
    solver = SolverSPH(model, config, (box,))
    state = model.state()
    rows = [(0.0, width)]

    def observe(t: float) -> None:
        rows.append((t, front_of(state.particle_q.numpy().astype(float), spacing)))

    simulate(solver, state, float(times[-1]), samples=100, observe=observe)
    t, front = np.array(rows).T

    def relative(delay: float) -> np.ndarray:
        """Error at each of the experiment's points, if the experiment's water had been let go so much later [s]."""
        return np.interp(times - delay, t, front) / fronts - 1.0

    off = relative(0.0)
    delays = np.linspace(0.0, 0.5 * times[len(times) // 2], 201)
    late = min(delays, key=lambda delay: float(np.abs(relative(delay)).mean()))
    q = state.particle_q.numpy()
    ideal = width * dam_break_potential.front(times * math.sqrt(G / width))
    behind = np.interp(times, t, front) / ideal - 1.0
    every = np.linspace(0.0, times[-1], 200)
    return Measured(
        errors={"front": 100.0 * float(np.abs(off).mean()), "ideal": 100.0 * float(np.abs(behind).mean())},
        figures={
            "mean of the signed error [%]": 100.0 * float(off.mean()),
            "largest error [%]": 100.0 * float(off[np.abs(off).argmax()]),
            # A gate takes time to leave, and where the experiment's clock starts is not known better than that.
            "delay of the experiment that fits best [s]": float(late),
            "mean error with that delay [%]": 100.0 * float(np.abs(relative(late)).mean()),
            "foremost drop, ahead of the front at the end [m]": float(q[:, 0].max()) + 0.5 * spacing - float(front[-1]),
        },
        curves={
            "reference: experiment": (times, fronts),
            "reference: potential flow": (every, width * dam_break_potential.front(every * math.sqrt(G / width))),
            f"dp = {1e3 * spacing:.4g} mm": (t, front),
        },
        particles=solver.count,
        simulated_seconds=float(times[-1]),
        wall_seconds=time.perf_counter() - started,
    )
