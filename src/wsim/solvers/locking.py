"""Kinematic bodies as MuJoCo has them: with inertia that nothing moves."""

from __future__ import annotations

from typing import Any

import numpy as np

Array = np.ndarray
RATIO = 1e6  # of a kinematic body's inertia to that of all that moves: what these move it by is lost in single precision


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
