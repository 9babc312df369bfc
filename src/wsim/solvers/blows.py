"""The blows of a step: impulses at the pose of its start, before anything moves.

What is hit passes the blow on at once: each round is a solution for the velocities after the blows of an instant, and
what they send against something else is hit in the next one. A row of balls that touch thus hands a blow through in one
step, and none moves into its neighbour meanwhile. The last round ends all other approaches, and starts what overlaps
on its way out, without a bounce: no contact is jolted in the step itself, so that all bodies may go by the mean of
their first and last velocities, and what touches stays together. Forces that are finite, gravity, springs, drives and
dry friction in joints, give nothing in no time. The step then goes on from the velocities after its last blow.

A joint that comes to its stop within the step is hit as well, and goes on with the speed that takes it there by the
step's end: what else the stop gives is finite, and may be held over a step of a higher order.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from wsim.solvers.contact_config import ContactConfig
from wsim.solvers.contact_rows import ContactRows
from wsim.solvers.slips import seek_slip
from wsim.solvers.targets import after_blows, stopped

Array = np.ndarray


@dataclass(frozen=True)
class Contacts:
    """The contacts of a pose that have rows."""

    chosen: Array  # (contacts,), their numbers
    bodies: Array  # (contacts, 2)
    friction: Array  # (contacts, 5): two of sliding, one of spinning [m], two of rolling [m]
    restitution: Array  # (contacts,)
    distance: Array  # [m]
    bow: Array  # speed that the gap loses in a step to curvature [m/s]


class BlowsC:
    """Rounds of blows in MuJoCo in C.

    Args:
        mujoco: The module.
        model: MuJoCo's model.
        config: How the law is applied.
        aim_others: Asks what is no contact for the speeds that it should have.
        ends_of_stops: By how much joints approach their stops too fast [m/s or rad/s], (rows,).

    Attributes:
        struck: Whether something was in this step.
        jump: Change of the velocities by its blows [m/s or rad/s], (nv,).
    """

    def __init__(
        self,
        mujoco: Any,
        model: Any,
        config: ContactConfig,
        aim_others: Callable[[Any], None],
        ends_of_stops: Callable[[Any], Array],
    ) -> None:
        self._mujoco, self._model, self._config, self._aim_others = mujoco, model, config, aim_others
        self._ends_of_stops = ends_of_stops
        self.begin()

    def begin(self) -> None:
        """A step begins, in which nothing is struck yet."""
        self.struck, self.jump = False, np.zeros(self._model.nv)

    def strike(
        self,
        data: Any,
        contacts: Contacts,
        rows: ContactRows,
        smooth: Callable[[Array, Array], Array],
        whole: bool = False,
    ) -> bool:
        """Give `data` the velocities after this step's blows; whether there are any.

        Args:
            data: MuJoCo's, whose accelerations without constraints are known.
            contacts: Of its pose.
            rows: Of these.
            smooth: Whether bodies fly by a higher order, from normal speeds and accelerations without constraints.
            whole: Whether no blow is shared with the next step (`wsim.solvers.targets.at_once`).
        """
        config, h = self._config, self._model.opt.timestep
        self._forces, rounds, ended = np.zeros(data.nefc), 0, False
        start, free = data.qvel.copy(), rows.pull()
        is_smooth = smooth(data.efc_vel[rows.normal], free)
        while rounds < config.most_blows:
            speed = data.efc_vel[rows.normal] + contacts.bow
            goal, blow = after_blows(contacts.distance, speed, free, contacts.restitution, h, config, is_smooth, whole)
            bounces = bool(blow.any())
            jolts = (goal - speed).max(initial=0.0) >= config.steady * h or self.meets_stops(data)
            if not bounces and (ended or not jolts):
                break
            if rounds == 0:
                self._without_finite_forces(data)
            self._aim_others(data)
            rows.aim(goal + contacts.bow, blow)
            hits = bounces or stopped(goal, speed, h, config).any()
            slip = rows.left_without_friction() if hits else rows.slip
            seek_slip(rows.left, slip, contacts.bodies, bounces, config, (config.tolerance, config.rough))
            self._advance(data)
            rounds, rows, ended = rounds + 1, self.rows(data, contacts), not bounces
        self.struck = rounds > 0
        if self.struck:
            self.jump = data.qvel - start
            self._with_finite_forces(data)
        return self.struck

    def meets_stops(self, data: Any) -> bool:
        """Whether a joint comes to its stop in this step."""
        return bool(self._ends_of_stops(data).max(initial=0.0) >= self._config.steady * self._model.opt.timestep)

    def undo(self, data: Any) -> None:
        """Go back to the velocities before the blows of this step."""
        if self.struck:
            data.qvel[:] -= self.jump

    def add_to(self, data: Any) -> None:
        """Add what the blows gave to the forces and accelerations of the step, which are recorded together."""
        if self.struck:
            self._smooth = data.qacc.copy()
            data.efc_force[:] += self._forces
            data.qacc[:] += self.jump / self._model.opt.timestep

    def forces_after(self, data: Any) -> Array:
        """Of the constraints in the step after the blows, which `data` have together with those, (rows,)."""
        return np.asarray(data.efc_force - self._forces if self.struck else data.efc_force)

    def loads(self, data: Any) -> Array:
        """What constraints bear by the forces after the blows, and by the blows as long as these last, (rows,)."""
        if not self.struck:
            return np.asarray(data.efc_force)
        share = self._model.opt.timestep / self._config.blow_time
        return np.asarray(data.efc_force + (share - 1.0) * self._forces)

    def take_from(self, data: Any) -> None:
        """Leave `data` the accelerations after the blows."""
        if self.struck:
            data.qacc[:] = self._smooth

    def rows(self, data: Any, contacts: Contacts) -> ContactRows:
        """The rows of some contacts, at the present velocities."""
        return ContactRows(self._mujoco, self._model, data, contacts.chosen, contacts.friction, self._config)

    def _advance(self, data: Any) -> None:
        """Take the velocities of a round, and what they make of the rows."""
        h = self._model.opt.timestep
        self._forces += data.efc_force
        data.qvel[:] += h * data.qacc
        self._mujoco.mj_fwdVelocity(self._model, data)

    def _without_finite_forces(self, data: Any) -> None:
        self._warm, self._loss = data.qacc_warmstart.copy(), data.efc_frictionloss.copy()
        data.qfrc_smooth[:], data.qacc_smooth[:] = 0.0, 0.0
        self._lose(data, np.zeros(data.nefc))

    def _with_finite_forces(self, data: Any) -> None:
        data.qacc_warmstart[:] = self._warm
        self._lose(data, self._loss)

    @staticmethod
    def _lose(data: Any, loss: Array) -> None:
        data.efc_frictionloss[:] = loss
        if data.nisland:  # MuJoCo solves copies, sorted by what hangs together
            data.iefc_frictionloss[:] = loss[data.map_iefc2efc]
