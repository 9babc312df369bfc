"""What comes into the bodies of each world from outside: impulses and work of fluid, control and drives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import warp as wp

from wsim.kernels.work import accumulate_control, accumulate_drive, accumulate_push, shift_effort
from wsim.sim.ledger_notes import Steps
from wsim.solvers.packed import Packed


@dataclass(frozen=True)
class Entry:
    """The sums of W worlds since the last entry, each with its own axis first.

    `impulse` (W, bodies, 6) [N s, N m s about the centre of mass] and `work` (W, bodies) [J] are those of
    `State.body_f`, by the model's bodies; `control` and `scheduled` are what of the impulse is
    the controller's and schedules'. `drives` (W,) is the
    work of drives and joint forces on the bodies [J], and `unsure` (W,) how far it may be from that; `effort` (W, dofs)
    is what each degree of freedom's drive gives now [N m or N].
    """

    impulse: np.ndarray
    control: np.ndarray
    scheduled: np.ndarray
    work: np.ndarray
    drives: np.ndarray
    unsure: np.ndarray
    effort: np.ndarray


class Ledger:
    """Keeps the books of a model's bodies, step by step.

    Args:
        model: The Newton model.
        observables: The solver's, with `qfrc_actuator` at the end of a step, where the model has drives.
        first_order: Whether all steps are of first order.

    Attributes:
        control: What of the bodies' force a controller gives, where there is one.
        scheduled: What of it schedules give, likewise.
        last: What each degree of freedom's drive gave last, which the change in a step is from [N m or N].
    """

    def __init__(self, model: Any, observables: Any | None, first_order: bool = False) -> None:
        self.worlds = max(1, model.world_count)
        self.model, self.observables, self._packed = model, observables, Packed(model.device)
        self._first_order = first_order
        self.control: Any | None = None
        self.scheduled: Any | None = None
        self.bodies, self.dofs = model.body_count, model.joint_dof_count
        with wp.ScopedDevice(model.device):
            self._twist = wp.zeros(model.body_count, dtype=wp.spatial_vector)
            self._rate = wp.zeros(model.joint_dof_count, dtype=wp.float32)
            self._impulse: Any = wp.zeros(self.bodies, dtype=wp.spatial_vector)
            self._controlled: Any = wp.zeros(self.bodies, dtype=wp.spatial_vector)
            self._by_schedule: Any = wp.zeros(self.bodies, dtype=wp.spatial_vector)
            self._work = wp.zeros(self.bodies, dtype=wp.float32)
            self._drives = wp.zeros(self.dofs, dtype=wp.float32)
            self._unsure = wp.zeros(self.dofs, dtype=wp.float32)
            self.last = wp.zeros(self.dofs, dtype=wp.float32)
            self._none = wp.zeros(model.joint_dof_count, dtype=wp.float32)

    def before(self, state: Any) -> None:
        """Note the velocities that a step starts from."""
        wp.copy(self._twist, state.body_qd)
        if self.dofs:
            wp.copy(self._rate, state.joint_qd)

    def after(self, force: Any, state: Any, control: Any, dt: float) -> None:
        """Add a step of `dt` [s] that ended in `state`, under the bodies' `force`."""
        self._packed.launch(
            accumulate_push,
            dim=self.bodies,
            inputs=[force, self._twist, state.body_qd, dt],
            outputs=[self._impulse, self._work],
            changing=(force, state.body_qd, dt),
        )
        for part, sums in ((self.control, self._controlled), (self.scheduled, self._by_schedule)):
            if part is not None:
                self._packed.launch(
                    accumulate_control, dim=self.bodies, inputs=[part, dt], outputs=[sums], changing=(part, sums, dt)
                )
        if not self.dofs:
            return
        effort = self._none if self.observables is None else self.observables.qfrc_actuator
        self._packed.launch(
            accumulate_drive,
            dim=self.dofs,
            inputs=[
                effort,
                control.joint_f,
                self.model.joint_armature,
                self.model.joint_target_ke,
                self.model.joint_effort_limit,
                self._first_order and self.observables is not None,
                self._rate,
                state.joint_qd,
                dt,
            ],
            outputs=[self.last, self._drives, self._unsure],
            changing=(effort, control.joint_f, state.joint_qd, dt),
        )

    def add(self, steps: Steps, force: Any, control: Any, dt: float) -> None:
        """Add steps of `dt` [s] that a CPU took in one go, as `after` adds each; `force` and `control` were the same.

        They are summed in double precision; `after` rounds at each step.
        """
        count, push = len(steps.efforts), force.numpy()  # of a CPU's arrays these are the arrays
        self._impulse.numpy()[:] += count * dt * push
        if self.control is not None:
            self._controlled.numpy()[:] += count * dt * self.control.numpy()
        if steps.twists is not None:
            mean = 0.5 * (steps.twists[:-1] + steps.twists[1:])
            self._work.numpy()[:] += dt * np.einsum("sbi,bi->b", mean, push)
        dofs, last, effort = steps.dofs, self.last.numpy(), steps.efforts
        change = np.diff(effort, axis=0, prepend=last[None, dofs])
        mean, gain = 0.5 * (steps.rates[:-1] + steps.rates[1:]), np.diff(steps.rates, axis=0)
        given = effort - 0.5 * change + control.joint_f.numpy()[dofs]
        spun = self.model.joint_armature.numpy()[dofs] * gain
        self._drives.numpy()[dofs] += ((dt * given - spun) * mean).sum(axis=0)
        self._unsure.numpy()[dofs] += dt * np.abs(change * gain).sum(axis=0)
        last[dofs] = effort[-1]

    def retarget(self, dofs: np.ndarray, moved: np.ndarray) -> None:
        """Note that drives' targets jumped between two steps, and their efforts with them.

        Args:
            dofs: Degrees of freedom of the model.
            moved: By how much each target did [rad or m].
        """
        if not len(dofs) or not moved.any():
            return
        stiffness, strength = (
            array.numpy()[dofs] for array in (self.model.joint_target_ke, self.model.joint_effort_limit)
        )
        last = self.last.numpy()
        last[dofs] = np.clip(last[dofs] + stiffness * moved, -strength, strength)
        self.last.assign(last)

    def retarget_on_device(self, dofs: Any, moved: Any) -> None:
        """The same by a kernel, without a copy to the host; Warp's arrays (W, n)."""
        wp.launch(
            shift_effort,
            dim=dofs.shape,
            inputs=[dofs, moved, self.model.joint_target_ke, self.model.joint_effort_limit],
            outputs=[self.last],
            device=self.model.device,
        )

    def take(self) -> Entry:
        """The sums since the last call, which start anew."""
        effort = self._none if self.observables is None else self.observables.qfrc_actuator
        entry = Entry(
            self._by_world(self._impulse, 6),
            self._by_world(self._controlled, 6),
            self._by_world(self._by_schedule, 6),
            self._by_world(self._work),
            self._by_world(self._drives).sum(axis=1),
            self._by_world(self._unsure).sum(axis=1),
            self._by_world(effort),
        )
        self._empty()
        return entry

    def _by_world(self, array: Any, *each: int) -> np.ndarray:
        found: np.ndarray = array.numpy().astype(np.float64)
        return found.reshape(self.worlds, len(found) // self.worlds, *each)

    def clear(self) -> None:
        """Forget the sums, and the last effort: the run starts anew."""
        self._empty()
        self.last.zero_()

    def _empty(self) -> None:
        for array in (self._impulse, self._controlled, self._by_schedule, self._work, self._drives, self._unsure):
            array.zero_()
