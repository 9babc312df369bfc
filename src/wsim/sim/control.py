"""Drives a simulation by arrays with a leading world axis: the seam for a program's `control(world, t)`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from wsim.scene.world import World
from wsim.sim.joint_arrays import in_every_world, joint_indices

if TYPE_CHECKING:
    from wsim.sim.simulation import Simulation

Arrays = Mapping[str, np.ndarray]
ONE_DOF = ("revolute", "prismatic")


def driven_joints(world: World) -> list[str]:
    """Prim paths of the joints with one coordinate, in the order of the arrays; what closes a loop has none."""
    return [joint.prim for joint in world.joints if joint.kind in ONE_DOF and not joint.closing]


class ArrayController:
    """Calls `exchange(t, state)` once a control step, and applies what it answers.

    Args:
        exchange: Takes `body_q` (W, B, 7), `body_qd` (W, B, 6), `joint_q`, `joint_qd` and `joint_target` (W, J), and
            `sensed` (W, n), what sensors told last (`wsim.sim.sensors.channels`);
            answers `joint_target` (W, J) [rad or m], `joint_force` (W, J) [N m or N] and `body_force` (W, B, 6), the
            force [N] and torque [N m] at the centre of mass in the world frame. B follows the world's bodies, J
            `driven_joints`.
    """

    def __init__(self, exchange: Callable[[float, Arrays], Arrays]) -> None:
        self.exchange = exchange

    def __call__(self, t: float, simulation: Simulation) -> None:
        """Read the state, ask, and set the simulation's control."""
        model, state, control = simulation.model, simulation.state, simulation.control
        worlds = max(1, model.world_count)
        bodies = in_every_world(simulation.built.bodies, worlds, model.body_count)
        coordinate, dof, target = joint_indices(model, worlds, driven_joints(simulation.world))
        targets = control.joint_target_q.numpy()
        answer = self.exchange(
            t,
            {
                "body_q": state.body_q.numpy()[bodies],
                "body_qd": state.body_qd.numpy()[bodies],
                "joint_q": state.joint_q.numpy()[coordinate],
                "joint_qd": state.joint_qd.numpy()[dof],
                "joint_target": targets[target],
                "sensed": simulation.sensors.flat(),
            },
        )
        if simulation.rigid and simulation.rigid.ledger:
            simulation.rigid.ledger.retarget(dof.ravel(), (answer["joint_target"] - targets[target]).ravel())
        targets[target] = answer["joint_target"]
        control.joint_target_q.assign(targets)
        forces = control.joint_f.numpy()
        forces[dof] = answer["joint_force"]
        control.joint_f.assign(forces)
        if simulation.control_force is not None:
            wrench = simulation.control_force.numpy()
            wrench[bodies] = answer["body_force"]
            simulation.control_force.assign(wrench)
