"""The rows of a step's contacts in MuJoCo's data, and what slip a solution of them leaves."""

from __future__ import annotations

from typing import Any

import numpy as np

from wsim.geometry.rotations import lengths
from wsim.solvers.contact_config import ContactConfig
from wsim.solvers.targets import friction_pays

Array = np.ndarray
STILL = 1e-2  # acceleration that a slip is none of, if it is reached in a step [m/s^2]
ENDED = 1e-2  # of a slip, left by a step that ends it


class ContactRows:
    """What MuJoCo is asked for at the contacts of a step, and what it finds.

    Args:
        mujoco: The module.
        model: MuJoCo's model.
        data: MuJoCo's data.
        chosen: The contacts that have rows, (contacts,).
        friction: Their coefficients, (contacts, 5): two of sliding, one of spinning [m], two of rolling [m].
        config: How the law is applied.
    """

    def __init__(
        self, mujoco: Any, model: Any, data: Any, chosen: Array, friction: Array, config: ContactConfig
    ) -> None:
        self._mujoco, self._model, self._data, self._config = mujoco, model, data, config
        self._chosen, self._friction = chosen, friction
        contact = data.contact
        self.normal = contact.efc_address[chosen]
        # Rows of friction: as many a contact as it has dimensions, but the normal one.
        offset = np.arange(1, 6)
        self._held = offset < contact.dim[chosen][:, None]
        self._rows = np.where(self._held, self.normal[:, None] + offset, self.normal[:, None])
        self._weight = np.where(self._held, friction, 0.0)
        self._velocity = data.efc_vel[self._rows]
        data.efc_aref[self._rows[self._held]] = -self._velocity[self._held] / model.opt.timestep
        self._image = np.zeros(data.nefc)
        self._rub(friction)

    def _rub(self, friction: Array | float) -> None:
        contact = self._data.contact
        contact.friction[self._chosen] = friction
        contact.mu[self._chosen] = contact.friction[self._chosen, 0]

    def pull(self) -> Array:
        """Normal accelerations without constraints [m/s^2], (contacts,)."""
        self._mujoco.mj_mulJacVec(self._model, self._data, self._image, self._data.qacc_smooth)
        return np.asarray(self._image[self.normal])

    @property
    def push(self) -> Array:
        """Of the last solution [N], (contacts,)."""
        return np.asarray(self._data.efc_force[self.normal])

    @property
    def slip(self) -> Array:
        """Times friction, at the step's start [m/s], (contacts,)."""
        return lengths(self._weight * self._velocity)

    def aim(self, goal: Array, blow: Array) -> None:
        """Ask for normal speeds [m/s] at the step's end, of which some are blows, (contacts,)."""
        self._goal, self._blow = goal, blow
        self._given = np.zeros(len(goal))  # by the regularisation under a blow [m/s^2]

    def left(self, slip: Array) -> Array:
        """Solve with guessed slips, times friction [m/s], (contacts,); those that the solution leaves."""
        data, blow, h = self._data, self._blow, self._model.opt.timestep
        data.efc_aref[self.normal] = (self._goal - slip - data.efc_vel[self.normal]) / h + self._given
        self._mujoco.mj_fwdConstraint(self._model, data)
        self._mujoco.mj_mulJacVec(self._model, data, self._image, data.qacc)
        data.qacc_warmstart[:] = data.qacc
        end = self._velocity + h * self._image[self._rows]
        left = lengths(self._weight * end)
        if blow.any():
            rub = np.where(self._held, data.efc_force[self._rows], 0.0)
            left += friction_pays(blow, self._goal, self.push, rub, self._velocity, end)
            self._given = np.where(blow, data.efc_R[self.normal] * self.push, 0.0)
        return np.asarray(left)

    def stops(self) -> Array:
        """Whether a slip ends in the step, or turns round, (contacts,), by the last solution."""
        start = self._velocity[:, :2]
        end = start + self._model.opt.timestep * self._image[self._rows[:, :2]]
        slips = lengths(self._weight[:, :2] * start)
        least = STILL * lengths(self._weight[:, :2]) * self._model.opt.timestep
        goes_on = np.einsum("nr,nr->n", start, end) > ENDED * np.einsum("nr,nr->n", start, start)
        return np.asarray((self.push > 0.0) & (slips > least) & ~goes_on)

    def left_without_friction(self) -> Array:
        """Slips, times the friction that there is [m/s], (contacts,), of a solution in which nothing rubs."""
        self._rub(self._config.smallest_friction)
        left = self.left(np.zeros(len(self.normal)))
        self._rub(self._friction)
        return left


def weigh_rows(data: Any, normal: Array, dim: Array, friction: Array) -> None:
    """Weights of the rows of spinning and rolling by their coefficients, as MuJoCo's cone has them."""
    wide = dim > 3
    first, share = normal[wide, None] + 1, (friction[wide, 2:] / friction[wide, :1]) ** 2
    row, weight = first + np.arange(2, 5), data.efc_D[first] * share
    data.efc_D[row], data.efc_R[row] = weight, 1.0 / weight
    if data.nisland:  # MuJoCo solves copies, sorted by what hangs together
        row = data.map_efc2iefc[row]
        data.iefc_D[row], data.iefc_R[row] = weight, 1.0 / weight
