"""What contacts press with at the end of a step: net force and load of each body, and the deepest of each world."""

from __future__ import annotations

from typing import Any

import numpy as np
import warp as wp

from wsim.kernels.tracks import sum_contacts


class Pressed:
    """Of all worlds of a model, on its device.

    Args:
        model: The Newton model.
        solver: Its bodies'.
        on_c: Whether MuJoCo steps in C.

    Attributes:
        force: On each body [N], (bodies, 3).
        load: On each body, of contacts that press whichever way [N], (bodies,).
        deepest: Of each world [m], (W,).
    """

    def __init__(self, model: Any, solver: Any, on_c: bool) -> None:
        self._model, self._solver, self._on_c = model, solver, on_c
        with wp.ScopedDevice(model.device):
            self.force: Any = wp.zeros((model.body_count, 3), dtype=wp.float64)
            self.load: Any = wp.zeros(model.body_count, dtype=wp.float64)
            self.deepest: Any = wp.zeros(max(1, model.world_count), dtype=wp.float64)

    def measure(self) -> None:
        """Work them out for the step that was taken last."""
        for array in (self.force, self.load, self.deepest):
            array.zero_()
        if self._on_c:  # on a CPU these are the arrays themselves
            self._of_c(self.force.numpy(), self.load.numpy(), self.deepest.numpy())
            return
        data, contact = self._solver.mjw_data, self._solver.mjw_data.contact
        wp.launch(
            sum_contacts,
            dim=data.naconmax,
            inputs=[
                data.nacon, contact.worldid, contact.geom, contact.frame, contact.dist, contact.efc_address,
                data.efc.force, self._solver.mjc_geom_to_newton_shape, self._model.shape_body,
            ],
            outputs=[self.force, self.load, self.deepest],
            device=self._model.device,
        )  # fmt: skip

    def _of_c(self, force: np.ndarray, load: np.ndarray, deepest: np.ndarray) -> None:
        mujoco = self._solver.import_mujoco()[0]
        mj_model, mj_data = self._solver.mj_model, self._solver.mj_data
        shapes = self._solver.mjc_geom_to_newton_shape.numpy()[0]
        bodies = np.append(self._model.shape_body.numpy(), -1)
        wrench = np.zeros(6)
        for k in range(mj_data.ncon):
            contact = mj_data.contact[k]
            deepest[0] = max(deepest[0], -float(contact.dist))
            mujoco.mj_contactForce(mj_model, mj_data, k, wrench)
            # The frame's rows are its axes; the first points from the first geom to the second, which it pushes.
            push = np.asarray(contact.frame).reshape(3, 3).T @ wrench[:3]
            for geom, sign in ((contact.geom[0], -1.0), (contact.geom[1], 1.0)):
                body = bodies[shapes[geom]]
                if body >= 0:
                    force[body] += sign * push
                    load[body] += np.sqrt(push @ push)
