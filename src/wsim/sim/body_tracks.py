"""What the bodies of all worlds do, frame by frame: kept on the device, and read when all is done."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import warp as wp

from wsim.kernels.tracks import keep_deepest, keep_frame

if TYPE_CHECKING:
    from wsim.sim.rigid import RigidBodies
    from wsim.sim.simulation import Simulation

Array = np.ndarray


class BodyTracks:
    """Poses, velocities and contact forces of W worlds over T frames, of B bodies each.

    They take 64 bytes of the device for each body, frame and world.

    Args:
        simulation: At its start.
        rigid: Its bodies.
        frames: T.

    Attributes:
        q: (W, T, B) transforms, world frame.
        qd: (W, T, B) velocities of the centre of mass, and of turning.
        force: (W, T, B) net contact forces [N].
        deepest: (W, T), the solver's deepest contact [m].
    """

    def __init__(self, simulation: Simulation, rigid: RigidBodies, frames: int) -> None:
        self._simulation, self._rigid, self._device = simulation, rigid, simulation.device
        worlds, rows = max(1, simulation.model.world_count), simulation.built.bodies
        shape = worlds, frames, len(rows)
        self._of_a_world = simulation.model.body_count // worlds
        self._before: Any = None
        with wp.ScopedDevice(self._device):
            self._rows = wp.array(rows, dtype=int)
            self.q: Any = wp.zeros(shape, dtype=wp.transform)
            self.qd: Any = wp.zeros(shape, dtype=wp.spatial_vector)
            self.force: Any = wp.zeros(shape, dtype=wp.vec3)
            self.deepest: Any = wp.zeros(shape[:2], dtype=wp.float64)

    def take(self, frame: int) -> None:
        """Keep the present state as a frame. Returns once the frame before it is there."""
        state, pressed = self._simulation.state, self._rigid.pressed
        pressed.measure()
        wp.launch(
            keep_frame,
            dim=(self.q.shape[0], self.q.shape[2]),
            inputs=[state.body_q, state.body_qd, pressed.force, self._rows, self._of_a_world, frame],
            outputs=[self.q, self.qd, self.force],
            device=self._device,
        )
        wp.launch(
            keep_deepest,
            dim=self.deepest.shape[0],
            inputs=[pressed.deepest, frame],
            outputs=[self.deepest],
            device=self._device,
        )
        if self._device.is_cuda:
            before, self._before = self._before, wp.get_stream(self._device).record_event()
            if before is not None:
                wp.synchronize_event(before)

    def read(self, worlds: Sequence[int]) -> tuple[Array, Array, Array, Array]:
        """Of some worlds poses (N, T, B, 7), velocities (N, T, B, 6), forces (N, T, B, 3), deepest contacts (N, T)."""
        q, qd, force = (self._chosen(array, worlds) for array in (self.q, self.qd, self.force))
        return q, qd, force, self._chosen(self.deepest, worlds)

    def read_first(self) -> tuple[Array, Array, Array]:
        """Poses, velocities and forces of all worlds at the first frame alone, with an axis of one frame."""
        q, qd, force = (array[:, :1].contiguous().numpy() for array in (self.q, self.qd, self.force))
        return q, qd, force

    def _chosen(self, array: Any, worlds: Sequence[int]) -> Array:
        if list(worlds) == list(range(array.shape[0])):
            found: Array = array.numpy()
            return found
        if not len(worlds):
            return self._chosen(array, [0])[:0]
        which = wp.array(list(worlds), dtype=int, device=self._device)
        some: Array = wp.indexedarray(array, [which, *[None] * (array.ndim - 1)]).contiguous().numpy()
        return some
