"""A body that is led: its pose and velocity are known at every step, whatever the water does."""

from __future__ import annotations

import newton
import numpy as np
import warp as wp


@wp.kernel
def _lead(
    # Data in:
    body: int,
    poses: wp.array(dtype=wp.transform),
    twists: wp.array(dtype=wp.spatial_vector),
    # Data out:
    step: wp.array(dtype=int),
    body_q: wp.array(dtype=wp.transform),
    body_qd: wp.array(dtype=wp.spatial_vector),
):
    """Put the body where it is at this step, and count."""
    k = wp.min(step[0], poses.shape[0] - 1)
    body_q[body] = poses[k]
    body_qd[body] = twists[k]
    step[0] = step[0] + 1


class Led:
    """Leads one body through given poses.

    Args:
        state: Of the model.
        body: Which one.
        position: Of its origin at the start of each step [m], shape (steps, 3).
        velocity: Of its origin [m/s], shape (steps, 3); its centre of mass is at its origin.
        rotation: xyzw, shape (steps, 4); upright if left out.
        spin: Angular velocity [rad/s], shape (steps, 3).
    """

    def __init__(
        self,
        state: newton.State,
        body: int,
        position: np.ndarray,
        velocity: np.ndarray,
        rotation: np.ndarray | None = None,
        spin: np.ndarray | None = None,
    ) -> None:
        count = len(position)
        turned = np.tile([0.0, 0.0, 0.0, 1.0], (count, 1)) if rotation is None else rotation
        turning = np.zeros((count, 3)) if spin is None else spin
        device = state.body_q.device
        self._state, self._body = state, body
        self._poses = wp.array(np.hstack([position, turned]).astype(np.float32), dtype=wp.transform, device=device)
        self._twists = wp.array(
            np.hstack([velocity, turning]).astype(np.float32), dtype=wp.spatial_vector, device=device
        )
        self._step = wp.zeros(1, dtype=int, device=device)

    def move(self) -> None:
        """To where it is at this step; on the device alone, so that a graph can capture it."""
        wp.launch(
            _lead,
            dim=1,
            inputs=[self._body, self._poses, self._twists],
            outputs=[self._step, self._state.body_q, self._state.body_qd],
            device=self._state.body_q.device,
        )


@wp.kernel
def _add(body: int, wrench: wp.array(dtype=wp.spatial_vector), total: wp.array(dtype=wp.spatial_vector)):
    total[0] = total[0] + wrench[body]


def add_wrench(total: wp.array, wrench: wp.array, body: int) -> None:
    """Add a body's wrench of this step to `total`; on the device alone, so that a graph can capture it."""
    wp.launch(_add, dim=1, inputs=[body, wrench], outputs=[total], device=total.device)
