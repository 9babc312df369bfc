"""What the books need of steps that MuJoCo takes in C in one go, read from its data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

Array = np.ndarray


@dataclass(frozen=True)
class Steps:
    """S steps of one world.

    `rates` (S + 1, n) are the velocities of joints along and about their axes [m/s or rad/s], from the first step's
    start to the last one's end, and `efforts` (S, n) what drives give there at each step's end [N or N m]; `dofs` (n,)
    are the model's numbers of these degrees of freedom. `twists` (S + 1, bodies, 6) are the velocities of bodies'
    centres of mass [m/s] and how bodies turn [rad/s], in the world's axes; None where nothing pushes a body.
    """

    dofs: Array
    rates: Array
    efforts: Array
    twists: Array | None


class StepNotes:
    """Takes them down.

    Args:
        model: The Newton model.
        solver: A `wsim.solvers.solver_rigid.SolverRigid` in C.

    Attributes:
        hold: Whether they are all that the model's drives and rotors need: none is on a joint without axes of its own.
    """

    def __init__(self, model: Any, solver: Any) -> None:
        self._data, self._motion = solver.mj_data, solver.motion
        self._others = np.ones(model.joint_dof_count, dtype=bool)
        self._others[self._motion.axes] = False
        own = (model.joint_target_ke, model.joint_target_kd, model.joint_armature) if model.joint_dof_count else ()
        self.hold = not any(bool(each.numpy()[self._others].any()) for each in own)

    def tell_all(self, control: Any) -> bool:
        """Whether what pushes joints does so along or about axes."""
        return not control.joint_f.numpy()[self._others].any()

    def begin(self, force: Any) -> None:
        """Begin anew, of steps in which bodies are pushed by a `force`."""
        self._rates: list[Array] = []
        self._efforts: list[Array] = []
        self._twists: list[Array] = []
        self._pushed = bool(force.numpy().any())

    def note(self) -> None:
        """Take down what MuJoCo's data say now, at a step's end or before the first."""
        self._rates.append(self._data.qvel[self._motion.freedoms])
        self._efforts.append(self._data.qfrc_actuator[self._motion.freedoms])
        if self._pushed:
            self._twists.append(self._motion.twists())

    def end(self) -> Steps:
        """What was taken down."""
        twists = np.array(self._twists) if self._pushed else None
        return Steps(self._motion.axes, np.array(self._rates), np.array(self._efforts[1:]), twists)
