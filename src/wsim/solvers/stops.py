"""Joints at their stops and ropes that are taut: the speeds that MuJoCo's rows of them should have."""

from __future__ import annotations

from typing import Any

import numpy as np

from wsim.solvers.contact_config import ContactConfig
from wsim.solvers.ropes import RopesC
from wsim.solvers.targets import settling

Array = np.ndarray


class StopsC:
    """One world on the CPU.

    Args:
        mujoco: The module.
        model: MuJoCo's model.
        config: How the law is applied.

    Attributes:
        kinds: Of the rows (mjtConstraint): of joints, and of ropes.
        at_once: Whether they end what approaches at once, where a step else shares that with the next.
    """

    def __init__(self, mujoco: Any, model: Any, config: ContactConfig) -> None:
        self._model, self._config, self.at_once = model, config, False
        rows = mujoco.mjtConstraint
        self.kinds = (int(rows.mjCNSTR_LIMIT_JOINT), int(rows.mjCNSTR_LIMIT_TENDON))
        self._none = not model.jnt_limited.any() and not model.tendon_limited.any()
        self._ropes = RopesC(mujoco, model) if model.tendon_limited.any() else None

    def aim(self, data: Any) -> None:
        """Ask for the speeds."""
        if self._none:
            return
        rows, goal, excess = self._goals(data)
        h = self._model.opt.timestep
        if self.at_once:
            goal = np.where(excess >= self._config.steady * h, 0.0, goal)
        data.efc_aref[rows] = (goal - data.efc_vel[rows]) / h

    def ends(self, data: Any, rows: Array) -> Array:
        """By how much some `rows` of joints approach too fast to reach their stops by the step's end, (n,); all stops
        and ropes where they end that at once."""
        if self.at_once:
            return self._goals(data)[2]
        goal = settling(data.efc_pos[rows], self._model.opt.timestep, self._config)
        return np.asarray(goal - data.efc_vel[rows])

    def _goals(self, data: Any) -> tuple[Array, Array, Array]:
        """Their rows, what they should end a step with, and by how much they approach faster, (rows,) each: of ropes,
        than what swings on a taut one."""
        rows = np.flatnonzero((data.efc_type == self.kinds[0]) | (data.efc_type == self.kinds[1]))
        h, speed = self._model.opt.timestep, data.efc_vel[rows]
        goal, bend = settling(data.efc_pos[rows], h, self._config), np.zeros(len(rows))
        taut = data.efc_type[rows] == self.kinds[1]
        if self._ropes is not None and taut.any():
            bend[taut] = self._ropes.growth(data, data.efc_id[rows[taut]], speed[taut], h) / h
        return rows, goal + bend, goal - speed - 2.0 * np.abs(bend)
