"""MuJoCo's generalised states → poses and velocities of bodies."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from wsim.errors import UserError
from wsim.importers.mujoco_names import body_name


def load_model(path: Path) -> Any:
    """MuJoCo's compiled model of an MJCF or URDF file; UserError with what MuJoCo says of it."""
    try:
        return mujoco.MjModel.from_xml_path(str(path))
    except ValueError as error:
        raise UserError(f"{path} is no model that MuJoCo reads: {error}") from error


def bodies_of_states(path: Path, qpos: np.ndarray, qvel: np.ndarray) -> dict[str, np.ndarray]:
    """Forward kinematics: `body_names`, `xpos`, `xquat` (wxyz) and `body_qd` of states (T, nq) and (T, nv).

    Velocities are those of the centres of mass (linear) and of the bodies (angular), in the world's frame.

    Raises:
        UserError: If the states are not those of the model.
    """
    model = load_model(path)
    for name, array, width in (("qpos", qpos, model.nq), ("qvel", qvel, model.nv)):
        if array.shape != (len(qpos), width):
            raise UserError(f"{name} has shape {array.shape}; {path} needs ({len(qpos)}, {width})")
    data, twist, bodies = mujoco.MjData(model), np.zeros(6), range(1, model.nbody)
    position, rotation = np.zeros((len(qpos), model.nbody, 3)), np.zeros((len(qpos), model.nbody, 4))
    velocity = np.zeros((len(qpos), model.nbody, 6))
    for k in range(len(qpos)):
        data.qpos[:], data.qvel[:] = qpos[k], qvel[k]
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_comVel(model, data)
        position[k], rotation[k] = data.xpos, data.xquat
        for body in bodies:
            mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_BODY, body, twist, 0)
            velocity[k, body] = [*twist[3:], *twist[:3]]  # MuJoCo has the angular part first
    return {
        "body_names": np.array([body_name(model, body) for body in bodies]),
        "xpos": position[:, 1:],
        "xquat": rotation[:, 1:],
        "body_qd": velocity[:, 1:],
        "controlled": np.array(model.nu > 0),
    }
