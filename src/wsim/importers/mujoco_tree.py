"""Which of a MuJoCo model's bodies move as one, and where they are in its reference pose."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from wsim.geometry.rotations import conjugate, multiply, rotate
from wsim.scene.solids import about_all

Pose = tuple[np.ndarray, np.ndarray]  # position (3,) [m], quaternion xyzw (4,)


class Tree:
    """A model's bodies by the one that has the joints: 0 is the world, and all that nothing lets move."""

    def __init__(self, model: Any) -> None:
        self._model = model
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        self._poses = [(data.xpos[b].copy(), self.xyzw(data.xquat[b])) for b in range(model.nbody)]
        self._root = [0] * model.nbody
        for b in range(1, model.nbody):
            moves = model.body_jntnum[b] > 0 or model.body_mocapid[b] >= 0
            self._root[b] = b if moves else self._root[model.body_parentid[b]]

    @property
    def roots(self) -> list[int]:
        """The bodies that move by themselves."""
        return [b for b, root in enumerate(self._root) if b == root and b > 0]

    def root(self, b: int) -> int:
        """The body that b moves with; 0 where it does not."""
        return self._root[b]

    def parent(self, root: int) -> int:
        """The root of what a root hangs from."""
        return self._root[self._model.body_parentid[root]]

    def members(self, root: int) -> list[int]:
        """All that moves as a root does, itself first."""
        return [b for b, one in enumerate(self._root) if one == root]

    def geoms(self, b: int) -> range:
        """One body's geometries."""
        first = int(self._model.body_geomadr[b])
        return range(first, first + int(self._model.body_geomnum[b]))

    def pose(self, b: int) -> Pose:
        """Of a body, in the world."""
        return self._poses[b]

    def seen_from(self, root: int, b: int) -> Pose:
        """The pose of a body in another's frame."""
        (at, facing), (place, turn) = self._poses[root], self._poses[b]
        back = conjugate(facing)
        return rotate(back, place - at), multiply(back, turn)

    def centre(self, root: int) -> np.ndarray:
        """Centre of mass of all that moves with a root, in its frame, (3,) [m]."""
        return self.weight(self.members(root), self.pose(root))[1]

    def weight(self, members: list[int], frame: Pose) -> tuple[float, np.ndarray, np.ndarray]:
        """Mass [kg], centre of mass (3,) [m] and inertia about it (3, 3) [kg m^2] of bodies together, in a frame."""
        model, (origin, facing) = self._model, frame
        masses, back = model.body_mass[members], conjugate(facing)
        places, inertias = [], []
        for b in members:
            at, turn = self._poses[b]
            place, turn = rotate(back, at - origin), multiply(back, turn)
            places.append(place + rotate(turn, model.body_ipos[b]))
            own = multiply(turn, self.xyzw(model.body_iquat[b]))
            axes = np.stack([rotate(own, axis) for axis in np.eye(3)], axis=1)
            inertias.append(axes @ np.diag(model.body_inertia[b]) @ axes.T)
        mass = float(masses.sum())
        if mass <= 0.0:
            return mass, places[0], np.sum(inertias, axis=0)
        return mass, *about_all(masses, places, inertias)

    @staticmethod
    def xyzw(wxyz: np.ndarray) -> np.ndarray:
        """A quaternion in the world's order."""
        return np.array([wxyz[1], wxyz[2], wxyz[3], wxyz[0]], dtype=np.float64)
