"""Contacts of cylinders with boxes, capsules and each other; MuJoCo would find them nearly, or not at all."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp

from wsim.kernels.cylinder_contacts import touch_cylinders
from wsim.kernels.own_rows import add_touches
from wsim.kernels.touches import Touches
from wsim.solvers.own_contacts import put_in_c, rows_of

Array = np.ndarray
POINTS = 8  # of a pair at most


def tilt_cylinders(mujoco: Any, model: Any, angle: float = 1e-6) -> None:
    """Turn each cylinder by `angle` [rad] in its body.

    MuJoCo takes the points of a cylinder on a plane from the direction in which its axis leans; of one that leans by no
    more than the rounding of its pose that direction is noise, and the points come and go (mujoco 3.17).
    """
    for geom in np.flatnonzero(model.geom_type == mujoco.mjtGeom.mjGEOM_CYLINDER):
        turned = np.zeros(4)
        lean = np.array([1.0, 0.5 * angle, 0.0, 0.0])
        mujoco.mju_mulQuat(turned, model.geom_quat[geom], lean / np.linalg.norm(lean))
        model.geom_quat[geom] = turned
        model.geom_sameframe[geom] = mujoco.mjtSameFrame.mjSAMEFRAME_NONE


class CylinderContacts:
    """Finds the contacts of pairs of shapes of which one is a cylinder, and MuJoCo does not see the other touch it.

    Args:
        pairs: Of shapes of the model's first world, a cylinder first.
        reach: Gap at which a contact is one [m].
    """

    def __init__(self, pairs: Sequence[tuple[int, int]], reach: float) -> None:
        self.pairs, self.reach = pairs, reach

    def bind(self, geom_shapes: Array) -> None:
        """Learn MuJoCo's geoms, from Newton's shape of each in the first world, (geoms,)."""
        geom = {int(shape): k for k, shape in enumerate(geom_shapes) if shape >= 0}
        self._geoms = np.array([[geom[one], geom[two]] for one, two in self.pairs], dtype=np.int32)

    def bind_c(self, model: Any, data: Any) -> None:
        """Look at MuJoCo's model and data in C from here on."""
        with wp.ScopedDevice("cpu"):
            self._found = _touches(POINTS * len(self._geoms))
            self._launch = wp.launch(
                touch_cylinders,
                dim=(1, len(self._geoms)),
                inputs=[
                    wp.array(model.geom_type, dtype=int),
                    wp.array(model.geom_size[None], dtype=wp.vec3d, copy=False),
                    wp.array(self._geoms, dtype=wp.vec2i),
                    wp.array(data.geom_xpos[None], dtype=wp.vec3d, copy=False),
                    wp.array(data.geom_xmat.reshape(1, -1, 3, 3), dtype=wp.mat33d, copy=False),
                    self.reach,
                    self._found,
                ],
                record_cmd=True,
            )
        arrays = (self._found.count, self._found.pair, self._found.position, self._found.normal, self._found.distance)
        self._seen = [array.numpy() for array in arrays]  # the same memory

    def add_to_c(self, mujoco: Any, model: Any, data: Any) -> None:
        """Add what touches now to MuJoCo's contacts."""
        count, pair, position, normal, distance = self._seen
        count[0] = 0
        self._launch.launch()
        found = slice(0, min(int(count[0]), len(pair)))
        if count[0]:
            geoms = self._geoms[pair[found]]
            put_in_c(mujoco, model, data, geoms, position[found], normal[found], distance[found], self.reach)

    def bind_warp(self, model: Any, data: Any) -> None:
        """Look at MuJoCo Warp's model and data from here on."""
        with wp.ScopedDevice(data.qpos.device):
            self._found, self._rows = _touches(data.naconmax), rows_of(model, data, self.reach)
            self._pairs = wp.array(self._geoms, dtype=wp.vec2i)

    def add_to_warp(self, model: Any, data: Any) -> None:
        """The same for MuJoCo Warp's."""
        found, device = self._found, data.qpos.device
        found.count.zero_()
        wp.launch(
            touch_cylinders,
            dim=(data.nworld, len(self._geoms)),
            inputs=[model.geom_type, model.geom_size, self._pairs, data.geom_xpos, data.geom_xmat, self.reach, found],
            device=device,
        )
        wp.launch(add_touches, dim=data.naconmax, inputs=[found, self._pairs, self._rows], device=device)


def _touches(most: int) -> Any:
    found = Touches()
    found.count, found.pair, found.world = wp.zeros(1, dtype=int), wp.zeros(most, dtype=int), wp.zeros(most, dtype=int)
    found.position, found.normal = wp.zeros(most, dtype=wp.vec3), wp.zeros(most, dtype=wp.vec3)
    found.distance = wp.zeros(most, dtype=float)
    return found
