"""What acts along a robot's joints: actuators as drives, springs, dampers, rotors, dry friction."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from wsim.importers.mujoco_joints import JOINTED, KINDS, freedoms, kind_of
from wsim.importers.mujoco_names import clean, element
from wsim.intake.robot_model import Motor, Robot, RobotJoint


def drive_joints(model: Any, robot: Robot) -> None:
    """Give each joint what acts along it; what is not carried is noted."""
    known = {joint.name: joint for joint in robot.joints}
    numbers = {clean(element(model, "joint", j)): j for j in range(model.njnt) if kind_of(model, j) in KINDS}
    for name, joint in known.items():
        _act(model, numbers[name], joint, robot.notes)
    for a in range(model.nu):
        j = int(model.actuator_trnid[a, 0])
        on_joint = mujoco.mjtTrn(int(model.actuator_trntype[a])) in JOINTED
        driven = known.get(clean(element(model, "joint", j))) if on_joint else None
        motor = _motor(model, a) if driven is not None and driven.kind != "spherical" else None
        if driven is None or motor is None:
            robot.notes.append("not carried: actuators on anything but a hinge or a slider, and those that lag")
        elif driven.motor is not None:
            robot.notes.append(f"{driven.name} has several actuators: the first drives it")
        else:
            driven.motor = motor
            driven.effort = _least(driven.effort, motor.most)
            motor.most = driven.effort


def _act(model: Any, j: int, joint: RobotJoint, notes: list[str]) -> None:
    dof = freedoms(model, j).start
    damping, spring = float(model.dof_damping[dof]), float(model.jnt_stiffness[j])
    joint.armature = float(model.dof_armature[dof])
    if joint.kind == "spherical":
        if damping or spring or joint.armature or model.dof_frictionloss[dof] or model.jnt_limited[j]:
            notes.append("not carried: springs, dampers, rotors, friction and limits of ball joints")
        joint.armature = 0.0
        return
    joint.damping, joint.stiffness = damping, spring
    joint.spring_zero = float(model.qpos_spring[int(model.jnt_qposadr[j])])
    joint.friction = float(model.dof_frictionloss[dof])
    if np.any(model.jnt_stiffnesspoly[j]) or np.any(model.dof_dampingpoly[dof]):
        notes.append(f"springs and dampers act by their linear part alone: {joint.name}")
    if model.jnt_actfrclimited[j]:
        joint.effort = float(np.abs(model.jnt_actfrcrange[j]).max()) or None


def _motor(model: Any, a: int) -> Motor | None:
    """An actuator's law as a drive; None where it has one of another kind."""
    gains, biases = mujoco.mjtGain, mujoco.mjtBias
    plain = model.actuator_gaintype[a] == int(gains.mjGAIN_FIXED)
    plain &= model.actuator_biastype[a] in (int(biases.mjBIAS_NONE), int(biases.mjBIAS_AFFINE))
    if not plain or model.actuator_dyntype[a] not in (
        int(mujoco.mjtDyn.mjDYN_NONE), int(mujoco.mjtDyn.mjDYN_FILTEREXACT), int(mujoco.mjtDyn.mjDYN_FILTER)
    ):  # fmt: skip
        return None
    gear, gain = abs(float(model.actuator_gear[a, 0])), abs(float(model.actuator_gainprm[a, 0]))
    stiffness, damping = 0.0, 0.0
    if model.actuator_biastype[a] == int(biases.mjBIAS_AFFINE):
        stiffness, damping = (max(0.0, -float(x)) * gear * gear for x in model.actuator_biasprm[a, 1:3])
    most = None
    if model.actuator_forcelimited[a]:
        most = gear * float(np.abs(model.actuator_forcerange[a]).max())
    elif not stiffness and not damping and model.actuator_ctrllimited[a]:
        most = gear * gain * float(np.abs(model.actuator_ctrlrange[a]).max())
    return Motor(stiffness, damping, most or None)


def _least(one: float | None, two: float | None) -> float | None:
    there = [value for value in (one, two) if value is not None]
    return min(there, default=None)
