"""How bodies and joints of one world move by MuJoCo's data in C, in double precision and under Newton's numbers.

Newton's state in between costs more than a small world's step: its kernels' launches, and arrays made anew.
"""

from __future__ import annotations

from typing import Any

import newton
import numpy as np

from wsim.geometry.rotations import cross
from wsim.solvers.flight import Flight

Array = np.ndarray


class MotionC:
    """Reads what `mj_data` of a solver say.

    Args:
        mujoco: The module.
        solver: Newton's MuJoCo solver, in C.
        flight: Its loose bodies.

    Attributes:
        axes: Newton's numbers of the degrees of freedom of joints along and about axes, (axes,).
        freedoms: MuJoCo's numbers of these, (axes,).
    """

    def __init__(self, mujoco: Any, solver: Any, flight: Flight) -> None:
        self._mujoco, self._model, self._data, self._flight = mujoco, solver.mj_model, solver.mj_data, flight
        newtons, flags = solver.mjc_body_to_newton.numpy()[0], solver.model.body_flags.numpy()
        known, kinematic = newtons >= 0, int(newton.BodyFlags.KINEMATIC)
        # What hangs on a kinematic body is where that is, which goes as is stated.
        led = (known & ((flags[newtons] & kinematic) != 0))[self._model.body_rootid]
        self._ours = np.flatnonzero(known & ~led)
        self._newtons = newtons[self._ours]
        self._bodies = solver.model.body_count
        self.axes, self.freedoms = _axes(solver)

    def place(self, state: Any) -> None:
        """Put bodies where MuJoCo has them.

        Newton works poses out of joint coordinates in single precision, by turns that lose their length from joint to
        joint: the end of a chain of 30 links of 7 cm is 4 um off.
        """
        self._mujoco.mj_kinematics(self._model, self._data)
        poses = state.body_q.numpy()  # of a CPU's array it is the array
        poses[self._newtons, :3] = self._data.xpos[self._ours]
        poses[self._newtons, 3:] = self._data.xquat[self._ours][:, [1, 2, 3, 0]]

    def tell(self, state: Any) -> None:
        """Give `state` where bodies are and how they go, and nothing of joints."""
        self.place(state)
        state.body_qd.numpy()[self._newtons] = self._twists()

    def twists(self) -> Array:
        """Velocities of bodies' centres of mass [m/s] and how they turn [rad/s], in the world's axes, (bodies, 6)."""
        self._mujoco.mj_kinematics(self._model, self._data)
        found = np.zeros((self._bodies, 6))
        found[self._newtons] = self._twists()
        return found

    def _twists(self) -> Array:
        mujoco, model, data, ours = self._mujoco, self._model, self._data, self._ours
        mujoco.mj_comPos(model, data)
        self._flight.keep()  # what it says is of what it keeps
        self._flight.say(centred=True)
        mujoco.mj_comVel(model, data)
        self._flight.say(centred=False)
        spin, way = data.cvel[ours, :3], data.cvel[ours, 3:]  # of what is at the tree's centre of mass
        arm = data.xipos[ours] - data.subtree_com[model.body_rootid[ours]]
        return np.concatenate([way + cross(spin, arm), spin], axis=1)


def _axes(solver: Any) -> tuple[Array, Array]:
    """Newton's and MuJoCo's numbers of the degrees of freedom along and about axes."""
    model = solver.model
    ours: list[int] = []
    newtons: list[int] = []
    firsts, starts = solver.mj_qd_start.numpy(), model.joint_qd_start.numpy()
    kinematic = (model.body_flags.numpy() & int(newton.BodyFlags.KINEMATIC)) != 0
    counts, child = model.joint_dof_dim.numpy().sum(axis=1), model.joint_child.numpy()
    turns = (newton.JointType.FREE, newton.JointType.DISTANCE, newton.JointType.BALL)  # without axes of their own
    for joint, (first, kind) in enumerate(zip(firsts, model.joint_type.numpy(), strict=False)):
        if first >= 0 and kind not in turns and not kinematic[child[joint]]:
            newtons += range(starts[joint], starts[joint] + counts[joint])
            ours += range(first, first + counts[joint])
    return np.array(newtons, dtype=int), np.array(ours, dtype=int)
