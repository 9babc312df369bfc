"""Steps of Runge and Kutta's fourth order for those worlds of a batch that touch nothing.

A mechanism keeps its energy only with a higher order, and contacts and stops know none: a world takes the one step or
the other as it has, at the step's start, a row that pushes and does not pull.
"""

from __future__ import annotations

from typing import Any

import warp as wp

from wsim.kernels.smooth_steps import count_touching, find_touching, take_where_free


class SmoothStepsWarp:
    """Makes the smooth step of all worlds beside the law's, and chooses.

    Args:
        mujoco: The module of MuJoCo in C, for its flags.
        warp: The module of MuJoCo Warp.
        model: MuJoCo Warp's model.
        data: MuJoCo Warp's data.
        steps: Of the first order that each world has made since its last smooth one, (worlds,); counted here.
    """

    def __init__(self, mujoco: Any, warp: Any, model: Any, data: Any, steps: Any) -> None:
        self.mujoco, self.warp, self._steps = mujoco, warp, steps
        bits = mujoco.mjtDisableBit
        # Dry friction is none of its own steps' either; without it, drives are MuJoCo's actuators.
        self.unilateral = int(bits.mjDSBL_CONTACT | bits.mjDSBL_LIMIT | bits.mjDSBL_FRICTIONLOSS)
        self._kept = [data.qpos, data.qvel, data.qacc_warmstart, data.time]
        with wp.ScopedDevice(data.qpos.device):
            self._start = [wp.empty_like(array) for array in self._kept]
            self._smooth = [wp.empty_like(array) for array in (data.qpos, data.qvel)]
            self._touches = wp.zeros(data.nworld, dtype=int)

    def before(self, model: Any, data: Any) -> None:
        """Make the smooth step from the present state, keep it, and go back."""
        for kept, array in zip(self._start, self._kept, strict=True):
            wp.copy(kept, array)
        # Its stages must not find a contact that the step did not start with: it would be as soft as MuJoCo's own.
        flags = model.opt.disableflags
        model.opt.disableflags = flags | self.unilateral
        self.warp.forward(model, data)
        self.warp.rungekutta4(model, data)
        model.opt.disableflags = flags
        for smooth, array in zip(self._smooth, (data.qpos, data.qvel), strict=True):
            wp.copy(smooth, array)
        for kept, array in zip(self._start, self._kept, strict=True):
            wp.copy(array, kept)

    def after(self, model: Any, data: Any, breaks: Any = None) -> None:
        """Take the smooth step in the worlds in which the law's had nothing to do, and where no joint `breaks`."""
        if breaks is None:
            self._touches.zero_()
        else:
            wp.copy(self._touches, breaks)
        wp.launch(
            find_touching,
            dim=(data.nworld, data.njmax),
            inputs=[data.nefc, data.efc.type],
            outputs=[self._touches],
        )
        wp.launch(count_touching, dim=data.nworld, inputs=[self._touches], outputs=[self._steps])
        for smooth, array in zip(self._smooth, (data.qpos, data.qvel), strict=True):
            wp.launch(take_where_free, dim=array.shape, inputs=[self._touches, smooth], outputs=[array])
