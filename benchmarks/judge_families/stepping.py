"""wsim's simulation, frame by frame, with wrenches that its world does not have."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from wsim.solvers import flight

Array = np.ndarray
# Time, body_q (B, 7) and body_qd (B, 6) → wrenches (B, 6) about the centres of mass [N, N m] that nothing exerts.
Push = Callable[[float, Array, Array], Array]


@dataclass(frozen=True)
class MeanSteps:
    """A share of the steps goes the way of the mean of both velocities, whether bodies accelerate evenly or not."""

    share: float

    def spoil(self, simulation: Any) -> None:
        """Have a simulation step so."""
        solver_flight, count = simulation.rigid.solver._law_c.flight, 0
        fly = solver_flight.fly

        def wrong(h: float) -> None:
            nonlocal count
            count += 1
            if int(count * self.share) == int((count - 1) * self.share):
                fly(h)
                return
            patience, flight.PATIENCE = flight.PATIENCE, 0.0
            fly(h)
            flight.PATIENCE = patience

        solver_flight.fly = wrong


class Told:
    """A push that the simulator takes for the fluid's or the control's: its books have it."""


class Stepper:
    """Advances a simulation on the CPU.

    Where all that acts is in MuJoCo's own model, its steps follow each other there, and Newton's state is told of a
    frame's last alone: three times as fast, and the same to rounding. Pushes then see the bodies as they were at the
    frame's start.
    """

    def __init__(self, simulation: Any, push: Push | None = None) -> None:
        self.simulation, self.push = simulation, push
        self.solver, self.rows = getattr(simulation.rigid, "solver", None), simulation.built.bodies
        world = simulation.world
        fluids, moved = bool(world.fluids), any(body.kinematic for body in world.bodies)
        self.direct = simulation.rigid is not None and simulation.rigid.ledger is None and not fluids and not moved
        self.direct = self.direct and self.solver._law_c.touching is None  # each step looks for those contacts
        if push is not None and not self.direct:
            self._wrap()

    def frame(self) -> None:
        """Advance by one recorded frame."""
        if not self.direct:
            self.simulation.advance_frame()
            return
        simulation, solver, state = self.simulation, self.solver, self.simulation.state
        q, qd = state.body_q.numpy()[self.rows].copy(), state.body_qd.numpy()[self.rows].copy()
        state.clear_forces()
        solver._update_mjc_data(solver.mj_data, solver.model, state)
        for n in range(simulation.substeps):
            if self.push is not None:
                force = np.zeros((*state.body_f.shape, 6), dtype=np.float32)
                force[self.rows] = self.push(simulation.time, q, qd)
                state.body_f.assign(force)
            if n == 0 or self.push is not None:
                solver._apply_mjc_control(solver.model, state, simulation.control, solver.mj_data)
            solver.mj_model.opt.timestep = simulation.dt
            solver._law_c.step(solver.mj_data)
            simulation.step_count += 1
            simulation.time = simulation.step_count * simulation.dt
        solver._update_newton_state(solver.model, state, solver.mj_data, state_prev=state)
        solver._step += simulation.substeps

    def _wrap(self) -> None:
        """Have the push act in each of the solver's steps."""
        step, simulation = self.solver.step, self.simulation

        def pushed(state_in: Any, *rest: Any, **options: Any) -> None:
            force = state_in.body_f.numpy()
            known = force.copy()
            q, qd = state_in.body_q.numpy()[self.rows], state_in.body_qd.numpy()[self.rows]
            force[self.rows] += self.push(simulation.time, q, qd)  # type: ignore[misc]
            state_in.body_f.assign(force)
            step(state_in, *rest, **options)
            if not isinstance(self.push, Told):
                state_in.body_f.assign(known)

        self.solver.step = pushed
