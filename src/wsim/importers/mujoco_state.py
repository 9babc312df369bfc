"""MuJoCo's generalised states → poses and velocities of bodies."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from wsim.errors import UserError
from wsim.importers.mujoco_names import body_name
from wsim.importers.mujoco_tree import Tree


def load_model(path: Path) -> Any:
    """MuJoCo's compiled model of an MJCF or URDF file; UserError with what MuJoCo says of it."""
    try:
        return mujoco.MjModel.from_xml_path(str(path))
    except ValueError as error:
        raise UserError(f"{path} is no model that MuJoCo reads: {error}") from error


def bodies_of_states(path: Path, qpos: np.ndarray, qvel: np.ndarray) -> dict[str, np.ndarray]:
    """Forward kinematics: `body_names`, `xpos`, `xquat` (wxyz) and `body_qd` of states (T, nq) and (T, nv).

    `held_energy` (T,) [J] is what the springs and the rotors of joints and tendons hold.
    Velocities are those of the centres of mass of what moves as one (linear) and of the bodies (angular), in the
    world's frame.

    Raises:
        UserError: If the states are not those of the model.
    """
    model = load_model(path)
    for name, array, width in (("qpos", qpos, model.nq), ("qvel", qvel, model.nv)):
        if array.shape != (len(qpos), width):
            raise UserError(f"{name} has shape {array.shape}; {path} needs ({len(qpos)}, {width})")
    data, twist, bodies = mujoco.MjData(model), np.zeros(6), range(1, model.nbody)
    position, rotation = np.zeros((len(qpos), model.nbody, 3)), np.zeros((len(qpos), model.nbody, 4))
    velocity, held = np.zeros((len(qpos), model.nbody, 6)), np.zeros(len(qpos))
    tree = Tree(model)  # twists are those of each body's own centre
    off = {b: tree.centre(b) - model.body_ipos[b] if tree.root(b) == b else np.zeros(3) for b in bodies}
    for k in range(len(qpos)):
        data.qpos[:], data.qvel[:] = qpos[k], qvel[k]
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_comVel(model, data)
        held[k] = _held(model, data)
        position[k], rotation[k] = data.xpos, data.xquat
        for body in bodies:
            mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_BODY, body, twist, 0)
            arm = data.xmat[body].reshape(3, 3) @ off[body]
            velocity[k, body] = [*(twist[3:] + np.cross(twist[:3], arm)), *twist[:3]]  # the angular part comes first
    return {
        "body_names": np.array([body_name(model, body) for body in bodies]),
        "xpos": position[:, 1:],
        "xquat": rotation[:, 1:],
        "body_qd": velocity[:, 1:],
        "held_energy": held,
    }


def _held(model: Any, data: Any) -> float:
    """Energy of springs and rotors [J]: MuJoCo's own potential energy less that of gravity."""
    mujoco.mj_tendon(model, data)
    mujoco.mj_transmission(model, data)
    mujoco.mj_fwdVelocity(model, data)
    mujoco.mj_energyPos(model, data)
    pulled = not model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_GRAVITY)
    gravity = -float(model.body_mass @ data.xipos @ model.opt.gravity) if pulled else 0.0
    rotors = 0.5 * float(model.dof_armature @ data.qvel**2 + model.tendon_armature @ data.ten_velocity**2)
    return float(data.energy[0]) - gravity + rotors
