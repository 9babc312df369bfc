"""Kinematic bodies as MuJoCo has them: with inertia that nothing moves."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import warp as wp

from wsim.kernels.kinematic import push

Array = np.ndarray
RATIO = (
    1e6  # of a kinematic body's inertia to that of all that moves: what these move it by is lost in single precision
)


def locked(mujoco: Any, model: Any, bodies: Array) -> Array:
    """Armature of all degrees of freedom, (nv,) [kg or kg m^2], with that which locks some bodies' own.

    Such a body goes on with the velocity that it is given, whatever pushes it or hangs on it. Against turns it has the
    inertia of all that moves at the distance of the farthest, or at 1 m.

    Args:
        mujoco: The module.
        model: MuJoCo's model.
        bodies: Kinematic ones, each on a free joint.
    """
    armature: Array = model.dof_armature.copy()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    moves = model.body_treeid >= 0
    mass = RATIO * float(model.body_mass[moves].sum())
    for body in bodies:
        far = np.linalg.norm(data.xipos[moves] - data.xpos[body], axis=1)
        first = model.body_dofadr[body]
        armature[first : first + 3] = mass
        armature[first + 3 : first + 6] = mass * max(1.0, float(far.max())) ** 2
    return armature


class LeadsC:
    """Takes kinematic bodies from the velocity of one step to that of the next by a force that lasts all the step.

    What hangs on such a body has a velocity relative to it, and would else go along with every change of it as if it
    had no inertia: a pendulum would not feel that its pivot is pulled away.

    Args:
        freedoms: Of the bodies in qvel, (n,).
        inertia: Theirs (`locked`), (n,).
    """

    def __init__(self, freedoms: Array, inertia: Array) -> None:
        self._freedoms, self._inertia = freedoms, inertia
        self.forget()

    def forget(self) -> None:
        """Have the next step start with its own velocity."""
        self._before: Array = np.full(len(self._freedoms), np.nan)

    def push(self, data: Any, dt: float) -> None:
        """Have `data`, which has the velocity of a step of `dt` [s], start with that of the step before."""
        speed = data.qvel[self._freedoms]
        start = np.where(np.isnan(self._before), speed, self._before)
        data.qfrc_applied[self._freedoms] = self._inertia * (speed - start) / dt
        data.qvel[self._freedoms], self._before = start, speed


class LeadsWarp:
    """The same in all worlds of a batch; the inertia is that of all alike, or of each, (N, n)."""

    def __init__(self, freedoms: Array, inertia: Array, worlds: int) -> None:
        self._freedoms, self._inertia = wp.array(freedoms, dtype=int), wp.array(inertia, dtype=float)
        self._before = wp.full((worlds, len(freedoms)), math.nan, dtype=float)

    def forget(self) -> None:
        """Have the next step start with its own velocity."""
        self._before.fill_(math.nan)

    def push(self, data: Any, dt: float) -> None:
        """Have `data`, which has the velocity of a step of `dt` [s], start with that of the step before."""
        wp.launch(
            push,
            dim=self._before.shape,
            inputs=[self._freedoms, self._inertia, dt],
            outputs=[self._before, data.qvel, data.qfrc_applied],
            device=self._before.device,
        )


def leads(model: Any, inertia: Array, bodies: Array, worlds: int | None) -> LeadsC | LeadsWarp:
    """Of some kinematic bodies in C, or in so many worlds of Warp's.

    Args:
        model: MuJoCo's.
        inertia: `locked`, of all worlds alike or of each, (N, nv).
        bodies: MuJoCo's numbers of them.
        worlds: None in C.
    """
    freedoms = (model.body_dofadr[bodies][:, None] + np.arange(6)).ravel()
    if worlds is None:
        return LeadsC(freedoms, inertia[0, freedoms])
    return LeadsWarp(freedoms, inertia[:, freedoms], worlds)
