"""What constraints that close loops ask for, as far as motion can give it.

A loop of hinges in a plane is held in it by more rows than it has ways to leave it, and single precision tilts its axes
by 1e-7. Of what no motion closes the rows would pull at each other, with gap / (settle_time h) over what MuJoCo's
regularisation gives way: by 50 N in a linkage of 1 kg, and the more the shorter the step; pins broke that bore a fifth
of their limit. So rows ask for what lies in the range of their Jacobian, weighed by how easily its coordinates move.

Where a parallelogram passes its dead point one of these ways ends and begins anew. What rounding leaves of a gap there
would be closed by a speed without end: one pass took 6e-4 of the energy at 1.2 ms, and 1.7e-3 at 0.4. So what closes
along a way waits while that way changes by as much as it is within a few steps.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

Array = np.ndarray
CLOSES = 1e-5  # of the fastest, by which a constraint moves at least along what can be closed
STEPS = 30.0  # in which a way does not end along which a gap is closed


class ClosingC:
    """One world on the CPU.

    Args:
        mujoco: The module.
        model: MuJoCo's model.
    """

    def __init__(self, mujoco: Any, model: Any) -> None:
        self._mujoco, self._model = mujoco, model
        held = (model.eq_type != int(mujoco.mjtEq.mjEQ_JOINT)) & (model.eq_active0 != 0)
        self.idle = not held.any()
        self._ease = np.sqrt(model.dof_invweight0)
        self.forget()

    def forget(self) -> None:
        """Know of no step before the next one."""
        self._now, self._change = self._none(), np.zeros(0)

    @staticmethod
    def _none() -> tuple[Array, Array]:
        return np.zeros((0, 0)), np.zeros(0)

    def begin(self, data: Any) -> None:
        """Find the ways of a step, whose constraints are known, and how they changed since the one before."""
        if self.idle:
            return
        before, self._now = self._now[1], self._ways(data)
        now = self._now[1]
        self._change = np.abs(now - before) if len(now) == len(before) else np.zeros(len(now))

    def aim(self, data: Any) -> None:
        """Have the constraints, whose reference accelerations are known, ask for no more than motion can give."""
        if not self.idle:
            self._aim(data, *self._now)

    def _aim_stage(self, _: Any, data: Any) -> None:
        ways = self._ways(data)
        if len(ways[1]) == len(self._change):
            self._aim(data, *ways)

    def _ways(self, data: Any) -> tuple[Array, Array]:
        """In which constraints can move, (ne, ways), and by how much, (ways,); none of what has no numbers any more."""
        if not data.ne:
            return self._none()
        rows = np.zeros((data.nefc, self._model.nv))
        if self._mujoco.mj_isSparse(self._model):
            self._mujoco.mju_sparse2dense(rows, data.efc_J, data.efc_J_rownnz, data.efc_J_rowadr, data.efc_J_colind)
        else:
            rows[:] = data.efc_J.reshape(rows.shape)
        if not np.isfinite(rows).all():
            return self._none()
        ways, sizes, _ = np.linalg.svd(rows[: data.ne] * self._ease, full_matrices=False)
        return ways, sizes

    def _aim(self, data: Any, ways: Array, sizes: Array) -> None:
        if len(ways) != data.ne or not data.ne:
            return
        share = 1.0 / (1.0 + (STEPS * self._change / np.maximum(sizes, 1e-300)) ** 2)
        share[sizes <= CLOSES * sizes.max()] = 0.0
        data.efc_aref[: data.ne] = ways @ (share * (ways.T @ data.efc_aref[: data.ne]))

    @contextmanager
    def stages(self) -> Iterator[None]:
        """Aim so in all of MuJoCo's own stages meanwhile: it calls for control once references are known."""
        if self.idle:
            yield
            return
        self._mujoco.set_mjcb_control(self._aim_stage)
        try:
            yield
        finally:
            self._mujoco.set_mjcb_control(None)
