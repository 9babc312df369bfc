"""Steps of Runge and Kutta's fourth order in MuJoCo Warp, for mechanisms that touch nothing (`smooth_steps.py`)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp

from wsim.kernels.smooth_steps import count_touching, find_touching, keep_where_touched
from wsim.solvers.smooth_steps import Owners


class SmoothStepsWarp:
    """Makes the smooth step of all worlds after the law's, from where that began, and chooses.

    Args:
        mujoco: The module of MuJoCo in C, for its flags.
        warp: The module of MuJoCo Warp.
        model: MuJoCo Warp's model.
        data: MuJoCo Warp's data.
        owners: Which mechanism is whose.
        steps: Of the first order since the last smooth one of each world's mechanisms, and before them of what is none,
            (worlds, mechanisms); counted here.
    """

    def __init__(self, mujoco: Any, warp: Any, model: Any, data: Any, owners: Owners, steps: Any) -> None:
        self.mujoco, self.warp, self._steps = mujoco, warp, steps
        bits = mujoco.mjtDisableBit
        # Dry friction is none of its own steps' either; without it, drives are MuJoCo's actuators.
        self.unilateral = int(bits.mjDSBL_CONTACT | bits.mjDSBL_LIMIT | bits.mjDSBL_FRICTIONLOSS)
        self._state = [data.qpos, data.qvel]
        # Of the law's step, beside where it ended: what the next one begins with, and what is told of its contacts.
        self._law = [data.qacc_warmstart, data.time, data.nacon, data.nefc, data.efc.force]
        with wp.ScopedDevice(data.qpos.device):
            self._start, self._end = ([wp.empty_like(array) for array in self._state] for _ in range(2))
            self._kept = [wp.empty_like(array) for array in self._law]
            self._touches = wp.zeros((data.nworld, owners.count), dtype=int)
            self._none_breaks = wp.zeros(data.nworld, dtype=int)
            of_rows = owners.of_geom, owners.of_joint, owners.of_dof, np.append(owners.of_tendon, 0)
            self._of_rows = [wp.array(each, dtype=int) for each in of_rows]
            self._of_values = [wp.array(each, dtype=int) for each in (owners.of_place, owners.of_dof)]

    def begin(self) -> None:
        """Note where the step begins, after its blows."""
        _copy(self._state, self._start)

    def end(self, model: Any, data: Any, breaks: Any = None) -> None:
        """Take the smooth step where the law's had nothing to do, but in no world in which a joint `breaks`."""
        efc = data.efc
        self._touches.zero_()
        wp.launch(
            find_touching,
            dim=(data.nworld, data.njmax),
            inputs=[data.nefc, efc.type, efc.id, efc.force, data.contact.geom, *self._of_rows],
            outputs=[self._touches],
        )
        broken = self._none_breaks if breaks is None else breaks
        wp.launch(count_touching, dim=self._touches.shape, inputs=[broken], outputs=[self._touches, self._steps])
        _copy(self._state, self._end)
        _copy(self._law, self._kept)
        _copy(self._start, self._state)
        # Its stages must not find a contact that the step did not start with: it would be as soft as MuJoCo's own.
        flags = model.opt.disableflags
        model.opt.disableflags = flags | self.unilateral
        self.warp.forward(model, data)
        self.warp.rungekutta4(model, data)
        model.opt.disableflags = flags
        _copy(self._kept, self._law)
        for end, array, owner in zip(self._end, self._state, self._of_values, strict=True):
            wp.launch(keep_where_touched, dim=array.shape, inputs=[self._touches, owner, end], outputs=[array])


def _copy(arrays: Sequence[Any], into: Sequence[Any]) -> None:
    for source, target in zip(arrays, into, strict=True):
        wp.copy(target, source)
