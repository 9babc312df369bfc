"""Fluid at rest on a lattice, as particles of a Newton builder, and the loop that steps it."""

from __future__ import annotations

import math
from collections.abc import Callable

import newton
import numpy as np
import warp as wp

from wsim.geometry.filled import box_lattice
from wsim.solvers.solver_sph import SolverSPH


def make_builder(gravity: tuple[float, float, float]) -> newton.ModelBuilder:
    """A builder that knows the attributes of both solvers. `gravity` [m/s^2]."""
    builder = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=gravity)
    SolverSPH.register_custom_attributes(builder)
    newton.solvers.SolverMuJoCo.register_custom_attributes(builder)
    return builder


def add_fluid(
    builder: newton.ModelBuilder,
    position: np.ndarray,
    mass: np.ndarray | float,
    pressure: np.ndarray | float = 0.0,
    velocity: np.ndarray | None = None,
) -> None:
    """Add particles: `position` [m] (n, 3), `mass` [kg], `pressure` [Pa], `velocity` [m/s] (n, 3)."""
    n = len(position)
    builder.add_particles(
        pos=np.asarray(position, float).tolist(),
        vel=(np.zeros((n, 3)) if velocity is None else np.asarray(velocity, float)).tolist(),
        mass=np.broadcast_to(mass, n).astype(float).tolist(),
        custom_attributes={"sph:pressure": np.broadcast_to(pressure, n).astype(float).tolist()},
    )


def lattice(low: tuple[float, ...], high: tuple[float, ...], spacing: float, plane: bool = False) -> np.ndarray:
    """Cell centres of the box from `low` to `high` [m], shape (n, 3); in a plane y = 0 if `plane`."""
    low_, high_ = np.array(low, float), np.array(high, float)
    if plane:
        low_[1], high_[1] = -0.5 * spacing, 0.5 * spacing
    return box_lattice(high_ - low_, spacing).position + 0.5 * (low_ + high_)


def steps_in(solver: SolverSPH, seconds: float, samples: int, dt: float | None = None) -> tuple[int, float]:
    """How many steps `simulate` takes between two samples, and how long they are [s]."""
    dt = min(solver.config.max_time_step, seconds / samples, dt or math.inf)
    every = math.ceil(seconds / samples / dt)
    return every, seconds / samples / every


def simulate(
    solver: SolverSPH,
    state: newton.State,
    seconds: float,
    samples: int = 1,
    observe: Callable[[float], None] | None = None,
    rigid: object | None = None,
    dt: float | None = None,
    after_step: Callable[[], None] | None = None,
    before_step: Callable[[], None] | None = None,
) -> int:
    """Step for `seconds`, calling `observe(t)` at `samples` even times; on CUDA through a graph. Returns the steps.

    `before_step` and `after_step` are called in every step and captured with it: they may launch kernels, not read.
    """
    every, dt = steps_in(solver, seconds, samples, dt)
    control = solver.model.control()

    def interval() -> None:
        for _ in range(every):
            state.clear_forces()
            if before_step is not None:
                before_step()
            solver.step(state, state, control, None, dt)
            if rigid is not None:
                rigid.step(state, state, control, None, dt)
            if after_step is not None:
                after_step()

    graph = None
    for sample in range(samples):
        if solver.follow(state, every * dt):
            graph = None  # it was of fewer walls
        if graph is not None:
            wp.capture_launch(graph)
        else:
            interval()
        if graph is None and solver.model.device.is_cuda and sample < samples - 1:
            with wp.ScopedCapture(solver.model.device) as capture:
                interval()
            graph = capture.graph
        if observe is not None:
            observe((sample + 1) * every * dt)
    solver.check(state)
    return samples * every
