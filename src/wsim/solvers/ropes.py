"""What a taut rope's way would grow by in a step beyond what the speeds at its start make of it: they turn with it.

A bob that swings by v on a rope of length l goes straight in a step of h, and is then v² h² / 2 l farther out. Left to
fade, that is a stretch of settle_time v² h / 2 l, 1 % of a rope of 1 cm, and the energy goes with it. A row that knows
of it asks for a length, not for a speed: the steps are those of the leapfrog under a constraint (Ryckaert, Ciccotti,
Berendsen 1977), which keep both. The bend is measured a step back, where a rope has been: a step ahead MuJoCo may let
go of a wheel.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import warp as wp
from mujoco_warp._src.forward import _next_position

Array = np.ndarray


class RopesC:
    """In C: lengths a step back, on numbers of their own."""

    def __init__(self, mujoco: Any, model: Any) -> None:
        self._mujoco, self._model, self._back = mujoco, model, mujoco.MjData(model)

    def growth(self, data: Any, tendons: Array, speed: Array, h: float) -> Array:
        """Of the ways of some tendons [m], (n,), beyond that of the `speed` of their slack, (n,) [m/s]."""
        mujoco, model, back = self._mujoco, self._model, self._back
        back.qpos[:] = data.qpos
        mujoco.mj_integratePos(model, back.qpos, data.qvel, -h)
        mujoco.mj_kinematics(model, back)
        mujoco.mj_comPos(model, back)
        mujoco.mj_tendon(model, back)
        return np.asarray(back.ten_length[tendons] - data.ten_length[tendons] - h * speed)


class RopesWarp:
    """In Warp: lengths a step back, of all tendons of all worlds, (worlds, tendons) [m]."""

    def __init__(self, warp: Any, data: Any) -> None:
        self._warp, self._kept = warp, wp.empty_like(data.qpos)
        self.length = wp.empty_like(data.ten_length)

    def look_back(self, model: Any, data: Any) -> None:
        """Before a step's positions are worked out: go a step back, measure, and come again."""
        wp.copy(self._kept, data.qpos)
        wp.launch(
            _next_position,
            dim=(data.nworld, model.njnt),
            inputs=[
                model.opt.timestep,
                model.jnt_type,
                model.jnt_qposadr,
                model.jnt_dofadr,
                self._kept,
                data.qvel,
                -1.0,
            ],
            outputs=[data.qpos],
        )
        for work in (self._warp.kinematics, self._warp.com_pos, self._warp.tendon):
            work(model, data)
        wp.copy(self.length, data.ten_length)
        wp.copy(data.qpos, self._kept)
